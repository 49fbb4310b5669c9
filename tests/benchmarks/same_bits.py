"""Whether exported scenes compute the same bits on other machines: `python -m tests.benchmarks.same_bits`.

Each scene is exported as C, and its self-test is compiled and run for every target that can be run here.
Printed are, by target: scenes whose states at all vectors are the same 17-digit text as those of gcc, x86-64,
scenes whose self-test passes, and the elementary functions that core and kernels call.
"""

from __future__ import annotations

import argparse
import hashlib
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from modelgen import derive, emit, read, require
from modelgen.export.c_folder import program_files
from modelgen.export.scene_text import source
from modelgen.export.vectors import vectors_of
from modelgen.runtime.session import Session
from modelgen.runtime.settings import accuracy_of
from tests.export.folders import ZIG, runner
from tests.registry import REGISTRY
from tests.running import SCENES, scene_of

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno")
UNITS = ("scene.c", "selftest.c")
MACHINES = (
    *("x86_64-linux-gnu", "x86_64-linux-musl", "aarch64-linux-musl", "arm-linux-musleabihf"),
    "wasm32-wasi",
)


@dataclass(frozen=True, slots=True)
class Target:
    name: str
    compiler: Sequence[str]
    machine: str  # as zig names it
    by: tuple[str, ...]


def targets(folder: Path) -> Iterator[Target]:
    """Those that compile and run here, gcc first."""
    if shutil.which("gcc"):
        yield Target("x86-64 gcc, glibc", ["gcc"], "x86_64-linux-gnu", ())
    for machine in MACHINES:
        by = runner(machine, folder)
        if by is not None:
            yield Target(f"zig {machine}", [*ZIG, "-target", machine], machine, by)


def compiled_core(target: Target, folder: Path, runtime: str, header: str) -> Path:
    """The core as an object of a target."""
    place = folder / target.name.replace(" ", "_").replace(",", "")
    place.mkdir()
    (place / "modelgen.h").write_text(header)
    (place / "core.c").write_text(runtime)
    subprocess.run([*target.compiler, *FLAGS, "-c", "core.c", "-o", "core.o"], cwd=place, check=True)
    return place / "core.o"


def states(target: Target, folder: Path, core: Path) -> tuple[str, bool]:
    """What the self-test of a folder prints, and whether it passes."""
    command = [*target.compiler, *FLAGS, *UNITS, str(core), "-lm", "-o", "selftest"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    done = subprocess.run(
        [*target.by, str(folder / "selftest"), "print"], capture_output=True, text=True, check=False
    )
    return done.stdout, done.returncode == 0


def called(objects: Sequence[Path]) -> list[str]:
    """Names that objects leave to the C library."""
    command = ["nm", "-u", *map(str, objects)]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    names = re.findall(r"U (\w+)", told)
    return sorted({name for name in names if not name.startswith(("mg_", "scene_", "_"))})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="*", default=list(REGISTRY)[:30])
    chosen = parser.parse_args().scenes
    with tempfile.TemporaryDirectory(prefix="modelgen-") as name:
        folder = Path(name)
        known, cores = list(targets(folder)), {}
        same, passed, functions = ({target.name: [] for target in known} for _ in range(3))
        for scene in chosen:
            place = folder / scene
            place.mkdir()
            library = scene_of(scene)
            accuracy = accuracy_of(library.manifest.instance, None, {})
            package = emit(derive(require(read(SCENES / f"{scene}.toml"))))
            files = program_files(Session(library, accuracy), package)
            files |= {"vectors.h": vectors_of(library, accuracy).text, "selftest.c": source("selftest.c")}
            for file, text in files.items():
                (place / file).write_text(text)
            digests = []
            for target in known:
                if target.name not in cores:
                    texts = files["modelgen_runtime.c"], files["modelgen.h"]
                    cores[target.name] = compiled_core(target, folder, *texts)
                text, is_passed = states(target, place, cores[target.name])
                digests.append(hashlib.sha256(text.encode()).hexdigest()[:8])
                same[target.name] += [scene] * (digests[-1] == digests[0] and bool(text))
                passed[target.name] += [scene] * is_passed
            gcc = known[0]
            subprocess.run([*gcc.compiler, *FLAGS, "-c", "scene.c"], cwd=place, check=True)
            functions[gcc.name] += called([place / "scene.o"])
            print(f"{scene:24} {' '.join(digests)}", flush=True)
        for target in known:
            other = sorted(set(chosen) - set(passed[target.name]))
            counts = f"same {len(same[target.name])} of {len(chosen)}, passed {len(passed[target.name])}"
            print(f"{target.name:32} {counts}", *other)
        print("core calls", *called([cores[known[0].name]]))
        print("kernels call", *sorted(set(functions[known[0].name])))


if __name__ == "__main__":
    main()
