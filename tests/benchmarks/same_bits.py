"""Whether exported scenes compute the same bits on other machines: `python -m tests.benchmarks.same_bits`.

Each scene is exported as C, and its self-test is compiled and run for every target that can be run here.
Printed are, by target: scenes whose states at all vectors are the same 17-digit text as those of gcc, x86-64,
scenes whose self-test passes, and functions of the C library that core and kernels call. `--out FILE` keeps
the digests of each scene; scenes that it holds are not run again.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from modelgen import derive, emit, read, require
from modelgen.export.c_folder import program_files
from modelgen.export.reference_vectors import vectors_of
from modelgen.export.scene_header_and_tables import source
from modelgen.runtime.core_session import Session
from modelgen.runtime.settings import accuracy_of
from tests.export.folders import ZIG, runner
from tests.registry import REGISTRY
from tests.running import SCENES, scene_of

NATIVE = ("-O3", "-march=native")  # of one more target
AARCH64 = ("aarch64-linux-gnu-gcc", "qemu-aarch64")  # compiler and emulator
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
    by: tuple[str, ...]
    flags: tuple[str, ...] = ()  # beside FLAGS


def targets(folder: Path) -> Iterator[Target]:
    """Those that compile and run here, gcc first."""
    if shutil.which("gcc"):
        yield Target("x86-64 gcc, glibc", ["gcc"], ())
        yield Target("x86-64 gcc, this processor", ["gcc"], (), NATIVE)
    if shutil.which("clang"):
        yield Target("x86-64 clang, glibc", ["clang"], ())
    if all(map(shutil.which, AARCH64)):
        yield Target("aarch64 gcc, glibc", AARCH64[:1], AARCH64[1:], ("-static",))
    for machine in MACHINES:
        by = runner(machine, folder)
        if by is not None:
            yield Target(f"zig {machine}", [*ZIG, "-target", machine], by)


def compiled_core(target: Target, folder: Path, runtime: str, header: str) -> Path:
    """The core as an object of a target."""
    place = folder / target.name.replace(" ", "_").replace(",", "")
    place.mkdir()
    (place / "modelgen.h").write_text(header)
    (place / "core.c").write_text(runtime)
    subprocess.run(
        [*target.compiler, *FLAGS, *target.flags, "-c", "core.c", "-o", "core.o"], cwd=place, check=True
    )
    return place / "core.o"


def states(target: Target, folder: Path, core: Path) -> tuple[str, bool]:
    """What the self-test of a folder prints, and whether it passes."""
    command = [*target.compiler, *FLAGS, *target.flags, *UNITS, str(core), "-lm", "-o", "selftest"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    done = subprocess.run(
        [*target.by, str(folder / "selftest"), "print"], capture_output=True, text=True, check=False
    )
    return done.stdout, done.returncode == 0


def called(objects: Sequence[Path]) -> list[str]:
    """Names that objects leave to the C library."""
    if not objects:
        return []
    command = ["nm", "-u", *map(str, objects)]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    names = re.findall(r"U (\w+)", told)
    return sorted({name for name in names if not name.startswith(("mg_", "scene_", "_"))})


@dataclass(frozen=True, slots=True)
class Outcome:
    """Of one scene."""

    digests: list[str]  # of what each target prints
    passed: list[bool]  # whether its self-test passes
    called: list[str]  # of the C library by its kernels


class Exported:
    """Scenes exported into a folder, and the core compiled once for each target."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.targets = list(targets(folder))
        self.cores: dict[str, Path] = {}

    def run(self, scene: str) -> Outcome:
        place = self.folder / scene
        place.mkdir()
        library = scene_of(scene)
        accuracy = accuracy_of(library.manifest.instance, None, {})
        package = emit(derive(require(read(SCENES / f"{scene}.toml"))))
        files = program_files(Session(library, accuracy), package)
        files |= {"vectors.h": vectors_of(library, accuracy).text, "selftest.c": source("selftest.c")}
        for file, text in files.items():
            (place / file).write_text(text)
        found = Outcome([], [], [])
        for target in self.targets:
            if target.name not in self.cores:
                texts = files["modelgen_runtime.c"], files["modelgen.h"]
                self.cores[target.name] = compiled_core(target, self.folder, *texts)
            text, is_passed = states(target, place, self.cores[target.name])
            found.digests.append(hashlib.sha256(text.encode()).hexdigest()[:8] if text else "nothing")
            found.passed.append(is_passed)
        subprocess.run(["gcc", *FLAGS, "-c", "scene.c"], cwd=place, check=True)
        found.called.extend(called([place / "scene.o"]))
        return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="*", default=list(REGISTRY)[:30])
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    known: dict[str, Outcome] = {}
    if given.out and given.out.exists():
        for line in given.out.read_text().splitlines():
            name, told = json.loads(line)
            known[name] = Outcome(**told)
    with tempfile.TemporaryDirectory(prefix="modelgen-") as name:
        exported = Exported(Path(name))
        for scene in given.scenes:
            if scene not in known:
                known[scene] = exported.run(scene)
                if given.out:
                    with given.out.open("a") as file:
                        file.write(json.dumps([scene, asdict(known[scene])]) + "\n")
            print(f"{scene:24} {' '.join(known[scene].digests)}", flush=True)
        chosen = {scene: known[scene] for scene in given.scenes}
        for k, target in enumerate(exported.targets):
            same = [
                scene for scene, each in chosen.items() if each.digests[k] == each.digests[0] != "nothing"
            ]
            passed = [scene for scene, each in chosen.items() if each.passed[k]]
            counts = f"same {len(same)} of {len(chosen)}, passed {len(passed)}"
            print(f"{target.name:32} {counts}", *sorted(set(chosen) - set(same)))
        cores = [exported.cores[exported.targets[0].name]] if exported.cores else []
        print("core calls", *called(cores))
        print("kernels call", *sorted({each for outcome in chosen.values() for each in outcome.called}))


if __name__ == "__main__":
    main()
