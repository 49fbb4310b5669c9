"""Memory of the core and of exported programs, over the scenes of `tests.memory.cases`.

    python -m tests.benchmarks.memory_checks sanitizers [--part 1/4] [--groups many errors]
    python -m tests.benchmarks.memory_checks threads | memcheck | self_tests | patterns | light_rim

`sanitizers`: all scenes on the debug core under AddressSanitizer and UndefinedBehaviorSanitizer of GCC, which
needs their libraries; a finding, or an assertion that fails, ends the process, and the next scene begins
another. `threads`: lanes of 5 exported scenes on two threads under ThreadSanitizer, one of which is asked
to stop. `memcheck`: 20 exported programs with scratch memory that is not cleared, under valgrind.
`self_tests`: those of the same exports, with the sanitizers. `patterns`: 60 scenes in ten fresh processes,
with patterns 1 to 5 of the debug core in turn, beside the release core. `light_rim`: that scene in 100
fresh processes.

Each prints a row for a finding, then a line of counts with the CPU time that it took; the exit code is 1 if
there is a finding. `--part I/N` takes every Nth scene, from the Ith on. What is built is kept in the folder
`--out`.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from hashlib import sha256
from itertools import groupby
from pathlib import Path

from modelgen import derive, read, require
from modelgen.codegen.amalgamation import runtime_text
from modelgen.codegen.built_files import CACHE
from modelgen.codegen.compiler import DEBUG, FILLS
from modelgen.export.export_formats import Choices, export
from tests.memory.cases import FOUND, Case, cases
from tests.running import SCENES

ROOT = Path(__file__).parents[2]
PROGRAMS = ROOT / "tests" / "memory" / "programs"
SANITIZE = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")
LIBRARIES = ("libasan.so", "libubsan.so")
STRICT = ("-std=c99", "-ffp-contract=off", "-fno-math-errno")
EXPORTED = (  # joints, limits, inputs, faces, splines, loads, driven bodies, friction of all kinds
    *("ball_in_bowl", "balancing_wheel", "box_dropped", "cube_toss", "double_pendulum", "four_bar"),
    *("glass_on_table", "gripper", "painleve_rod", "rolling_disc", "sliding_puck", "sphere_slide_to_roll"),
)
OF_FOUND = ("lim3", "light_rim", "stool_on_floor", "conveyor", "pyramid32_on_l", "tip", "latch", "spin_box")
IN_THREADS = ("glass_on_table", "cube_toss", "double_pendulum", "gripper", "sliding_puck")
PATTERNED, PROCESSES, RIMS = 60, 10, 100  # scenes and processes of `patterns`, processes of `light_rim`


def said(command: Sequence[object], **environment: str) -> subprocess.CompletedProcess[str]:
    """A process, with these variables and without that of the debug core."""
    inherited = {name: value for name, value in os.environ.items() if name != DEBUG}
    words = [str(word) for word in command]
    return subprocess.run(
        words, cwd=ROOT, env=inherited | environment, capture_output=True, text=True, check=False
    )


def digests(some: Sequence[Case], folder: Path, run: bool, **environment: str) -> Mapping[str, str]:
    """What is told of each case, run or only built, by as many processes as it takes; findings begin with
    an exclamation mark."""
    told: dict[str, str] = {}
    for _, group in groupby(some, lambda case: (case.words, case.seconds)):
        left = list(group)
        while left:
            seconds, files = left[0].seconds if run else 0.0, [case.file for case in left]
            command = [sys.executable, "-m", "tests.memory.digests", *left[0].words, folder, seconds, *files]
            done = said(command, **environment)
            lines = done.stdout.splitlines()
            told |= {case.file.stem: line for case, line in zip(left, lines, strict=False)}
            left = left[len(lines) :]
            if done.returncode and left:
                told[left.pop(0).file.stem] = f"! {_cause(done.stderr)}"
    return told


def _cause(stderr: str) -> str:
    """The line of a sanitizer, an assertion or valgrind, or the end of the text."""
    marks = ("ERROR: ", "runtime error", "Assertion", "WARNING: Thread", "depends on uninit", "Invalid ")
    lines = [line for line in stderr.splitlines() if any(mark in line for mark in marks)]
    return lines[0].strip() if lines else stderr.strip()[-300:]


def sanitizers(some: list[Case], folder: Path) -> int:
    """Findings of the sanitizers and of the assertions of the debug core."""
    paths = [said(["gcc", f"-print-file-name={name}"]).stdout.strip() for name in LIBRARIES]
    built = {"CC": " ".join(("gcc", *SANITIZE)), DEBUG: FILLS[0], CACHE: str(folder / "core")}
    digests(some, folder / "sanitized", False, **built)
    preloaded = {"LD_PRELOAD": " ".join(paths), "ASAN_OPTIONS": "detect_leaks=0"}
    told = digests(some, folder / "sanitized", True, **built, **preloaded)
    refused = Counter(case.group for case in some if "refused" in told[case.file.stem])
    groups = Counter(case.group for case in some)
    print("; ".join(f"{n} {group}, {refused[group]} refused" for group, n in groups.items()))
    return _tell(told)


def patterns(some: list[Case], folder: Path) -> int:
    """Lines of fresh processes under patterns of memory that are not those of the release core."""
    chosen = [case for case in some if case.group != "many"]
    chosen = [chosen[k * len(chosen) // PATTERNED] for k in range(min(PATTERNED, len(chosen)))]
    expected = digests(chosen, folder / "release", True)
    found: dict[str, str] = {}
    for number in range(PROCESSES):
        fill = FILLS[number % len(FILLS)]
        for name, line in digests(chosen, folder / f"fill{fill}", True, **{DEBUG: fill}).items():
            if line != expected[name]:
                found[f"{name}, pattern {fill}"] = f"! {line} in place of {expected[name]}"
    return _tell({**expected, **found})


def light_rim(some: list[Case], folder: Path) -> int:
    """Results of fresh processes that are not that of the first."""
    case = Case("found", FOUND / "light_rim.toml", 1.0, 1_000_000)
    told = [digests([case], folder / "release", True)["light_rim"] for _ in range(RIMS)]
    print(f"{RIMS} processes: {', '.join(f'{n} times {line}' for line, n in Counter(told).items())}")
    return len(set(told)) - 1


@cache
def exports(folder: Path) -> Path:
    """Where scenes are exported with the present core."""
    return folder / f"exported-{sha256(runtime_text().encode()).hexdigest()[:8]}"


@cache
def exported(name: str, folder: Path) -> Path:
    """The folder of an exported scene, shipped or found."""
    place = exports(folder) / name
    if not (place / "scene.c").exists():
        file = SCENES / f"{name}.toml" if name not in OF_FOUND else FOUND / f"{name}.toml"
        export(derive(require(read(file))), "c", place, place / ".library", Choices(figures=False))
    return place


def program(name: str, folder: Path, source: Path, flags: tuple[str, ...]) -> Path:
    """A program of an exported scene; the core is compiled once for the same flags."""
    place = exported(name, folder)
    core = exports(folder) / f"core{''.join(flags).replace('=', '_')}.o"
    common = ("gcc", *STRICT, *flags, f"-I{place}")
    steps = [] if core.exists() else [(*common, "-c", place / "modelgen_runtime.c", "-o", core)]
    for command in (*steps, (*common, place / "scene.c", source, core, "-lm", "-o", place / source.stem)):
        done = said(command)
        if done.returncode:
            raise SystemExit(f"{name}: {done.stderr[-2000:]}")
    return place / source.stem


def programs(
    names: Sequence[str],
    folder: Path,
    source: Callable[[str], Path],
    flags: tuple[str, ...],
    by: Sequence[str] = (),
) -> int:
    """Findings of a program of each of these exports, which ends with 0 where there is none."""
    told = {}
    for name in names:
        done = said([*by, program(name, folder, source(name), flags)])
        told[name] = f"! {done.returncode}: {_cause(done.stderr)}" if done.returncode else done.stdout.strip()
    return _tell(told)


def threads(some: list[Case], folder: Path) -> int:
    flags = ("-O1", "-g", "-fsanitize=thread", "-pthread")
    return programs(IN_THREADS, folder, lambda _: PROGRAMS / "two_threads.c", flags)


def memcheck(some: list[Case], folder: Path) -> int:
    by = ("valgrind", "-q", "--error-exitcode=9", "--max-stackframe=100000000")
    return programs(EXPORTED + OF_FOUND, folder, lambda _: PROGRAMS / "uncleared.c", ("-O1", "-g"), by)


def self_tests(some: list[Case], folder: Path) -> int:
    def source(name: str) -> Path:
        return exported(name, folder) / "selftest.c"

    return programs(EXPORTED + OF_FOUND, folder, source, ("-O1", *SANITIZE))


def _tell(told: Mapping[str, str]) -> int:
    """Prints a row for each finding, and counts; their number."""
    found = {name: line for name, line in told.items() if line.startswith("!")}
    if found:
        print("| scene | finding |\n|---|---|")
    for name, line in found.items():
        print(f"| {name} | {line[2:]} |", flush=True)
    print(f"{len(told)} told, {len(found)} findings")
    return len(found)


STUDIES = {each.__name__: each for each in (sanitizers, threads, memcheck, self_tests, patterns, light_rim)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument("--part", default="1/1", help="I/N: every Nth scene, from the Ith on")
    parser.add_argument("--groups", nargs="+", help="of scenes: shipped, found, many, shapes, random, ..")
    parser.add_argument("--out", type=Path, default=Path("generated/memory_checks"))
    given = parser.parse_args()
    folder = given.out.absolute()
    first, every = map(int, given.part.split("/"))
    some = cases(folder / "scenes")[first - 1 :: every]
    chosen = [case for case in some if not given.groups or case.group in given.groups]
    found = STUDIES[given.study](chosen, folder)
    spent = [sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    print(f"{given.study}, part {given.part}: {sum(spent) / 60:.1f} CPU minutes")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())
