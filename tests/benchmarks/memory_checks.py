"""Memory of the core: sanitizers and patterns of memory over scenes (`tests.memory.digests`).

    python -m tests.benchmarks.memory_checks sanitizers --scenes shipped found random:60 --seconds 0.5
    python -m tests.benchmarks.memory_checks patterns --scenes shipped found --processes 10

`sanitizers` builds the debug core with AddressSanitizer and UndefinedBehaviorSanitizer of GCC, which
needs their libraries, and runs each scene in a process of its own: a finding, or an assertion that
fails, ends it. `patterns` runs the scenes in fresh processes, with the patterns 1 to 5 of the debug core
in turn, and compares the lines with those of the release core. Scenes: `shipped`, `found` (those of
`tests/memory/scenes`), `random:N` (`tests.benchmarks.random_scenes`), or files. Printed are findings,
then one line of counts; libraries are kept in the folder `--out`. The exit code is 1 if there is a
finding.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

from modelgen.codegen.built_files import CACHE
from modelgen.codegen.compiler import DEBUG, FILLS
from tests.benchmarks.random_scenes import random_scene
from tests.running import FILES

ROOT = Path(__file__).parents[2]
FOUND = ROOT / "tests" / "memory" / "scenes"
COMPILER = "gcc -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -O0"
LIBRARIES = ("libasan.so", "libubsan.so")


def scene_files(chosen: list[str], folder: Path) -> list[Path]:
    """The files of the scenes that are named; random ones are written into the folder."""
    files: list[Path] = []
    for name in chosen:
        kind, _, count = name.partition(":")
        if kind == "random":
            folder.mkdir(parents=True, exist_ok=True)
            for seed in range(int(count)):
                files.append(folder / f"random{seed}.toml")
                files[-1].write_text(random_scene(seed), encoding="utf-8")
        else:
            named = {"shipped": FILES, "found": tuple(sorted(FOUND.glob("*.toml")))}
            files += named.get(name, (Path(name),))
    return [file.absolute() for file in files]


def lines(
    files: list[Path], seconds: float, folder: Path, **environment: str
) -> subprocess.CompletedProcess[str]:
    """A process that prints the digests of the runs of some scenes; 0 s: that only builds them."""
    command = [sys.executable, "-m", "tests.memory.digests", str(folder), str(seconds), *map(str, files)]
    inherited = {name: value for name, value in os.environ.items() if name != DEBUG}
    return subprocess.run(
        command, cwd=ROOT, env=inherited | environment, capture_output=True, text=True, check=False
    )


def sanitizer_findings(files: list[Path], seconds: float, folder: Path) -> int:
    """Runs each scene under the sanitizers; the number of those that end with a finding."""
    found = refused = 0
    paths = (
        subprocess.run(["gcc", f"-print-file-name={name}"], capture_output=True, text=True, check=True)
        for name in LIBRARIES
    )
    preloaded = {"LD_PRELOAD": " ".join(path.stdout.strip() for path in paths)}
    built = {"CC": COMPILER, DEBUG: FILLS[0], CACHE: str(folder / "core")}
    for file in files:
        lines([file], 0.0, folder, **built)
        done = lines([file], seconds, folder, ASAN_OPTIONS="detect_leaks=0", **built, **preloaded)
        refused += int("refused" in done.stdout)
        if done.returncode:
            found += 1
            told = [
                line
                for line in done.stderr.splitlines()
                if "ERROR" in line or "error" in line or "Asser" in line
            ]
            print(f"{file.stem}: {told[0] if told else done.stderr[-300:]}", flush=True)
    print(f"{len(files)} scenes under the sanitizers: {found} findings, {refused} refused")
    return found


def pattern_findings(files: list[Path], seconds: float, folder: Path, processes: int) -> int:
    """Runs the scenes in fresh processes, with the patterns in turn; the number of lines that differ."""
    expected = lines(files, seconds, folder / "release")
    found = int(expected.returncode != 0)
    for number in range(processes):
        fill = FILLS[number % len(FILLS)]
        told = lines(files, seconds, folder / f"fill{fill}", **{DEBUG: fill}).stdout.splitlines()
        for ours, theirs in zip(expected.stdout.splitlines(), told, strict=False):
            if ours != theirs:
                found += 1
                print(f"pattern {fill}: {theirs} in place of {ours}", flush=True)
        found += int(len(told) != len(expected.stdout.splitlines()))
    print(f"{len(files)} scenes in {processes} fresh processes: {found} differences")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("study", choices=("sanitizers", "patterns"))
    parser.add_argument("--scenes", nargs="+", default=["shipped", "found"])
    parser.add_argument("--seconds", type=float, default=0.5, help="of each scene")
    parser.add_argument("--processes", type=int, default=10)
    parser.add_argument("--out", type=Path, default=Path("generated/memory_checks"))
    given = parser.parse_args()
    folder = given.out.absolute()
    files = scene_files(given.scenes, folder / "random")
    if given.study == "sanitizers":
        return int(sanitizer_findings(files, given.seconds, folder) > 0)
    return int(pattern_findings(files, given.seconds, folder, given.processes) > 0)


if __name__ == "__main__":
    sys.exit(main())
