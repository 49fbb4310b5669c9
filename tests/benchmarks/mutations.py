"""What the tests see: each fault of a table, put into a copy of the tree, must turn a test red.

Run with `python -m tests.benchmarks.mutations [--only 3,17] [--baseline] [--find]`. The tree itself is never
changed. A fault is `caught` where its tests fail and `survived` where they pass. It is
`stale` where its text is not found exactly once, or where the core does not compile with it: then the table
has to follow the code. `--baseline` first runs the tests without a fault; `--find` only looks for the texts.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.benchmarks.faults import FAULTS, Fault

ROOT = Path(__file__).parents[2]
SUFFIXES = (".c", ".h", ".py")
PASSED, FAILED, UNCOMPILED = 0, 1, -1  # how pytest ends, and how it does not


def place_of(fault: Fault, root: Path) -> Path | str:
    """The file of modelgen that holds the text; else what is wrong."""
    files = sorted(path for path in (root / "modelgen").rglob("*") if path.suffix in SUFFIXES)
    counts = {path: len(re.findall(fault.old, path.read_text(encoding="utf-8"))) for path in files}
    found = [path for path, count in counts.items() if count]
    if sum(counts.values()) == 1:
        return found[0]
    return f"its text is found {sum(counts.values())} times {[path.name for path in found]}"


def copied(folder: Path) -> Path:
    """What git tracks, or would, copied."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, names.split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    return folder


def outcome_of(tests: tuple[str, ...], root: Path) -> tuple[int, str]:
    """How pytest ends in the copy, and the first test that fails, or that the core did not compile."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider", *tests]
    hidden = ("PYTHONPATH", "MODELGEN_POOL")
    kept = {key: value for key, value in os.environ.items() if key not in hidden}
    environment = {**kept, "MODELGEN_CACHE": str(root / ".cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    answer = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, check=False)
    if re.search(r"\.[ch]:\d+:\d+: error:", answer.stdout):
        return UNCOMPILED, "the core does not compile with it"
    first = re.search(r"^(?:FAILED|ERROR) (\S+)", answer.stdout, flags=re.MULTILINE)
    return answer.returncode, first.group(1) if first else ""


def verdict(fault: Fault, root: Path) -> str:
    """Puts the fault into the copy, runs its tests, and takes it out again."""
    place = place_of(fault, root)
    if isinstance(place, str):
        return f"stale: {place}"
    text = place.read_text(encoding="utf-8")
    place.write_text(re.sub(fault.old, fault.new, text), encoding="utf-8")
    code, first = outcome_of(fault.tests, root)
    place.write_text(text, encoding="utf-8")
    if code == FAILED:
        return f"caught by {first}"
    return "survived" if code == PASSED else f"stale: {first or f'pytest ended with {code}'}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--only", default="", help="numbers of faults, separated by commas")
    parser.add_argument("--baseline", action="store_true", help="first run the tests without a fault")
    parser.add_argument("--find", action="store_true", help="only look whether each text is found once")
    options = parser.parse_args()
    chosen = [int(number) for number in options.only.split(",") if number] or range(1, len(FAULTS) + 1)
    if options.find:
        for number in chosen:
            print(f"{number:2}  {place_of(FAULTS[number - 1], ROOT)}")
        return
    caught = 0
    with TemporaryDirectory(prefix="modelgen-mutations-") as name:
        root = copied(Path(name))
        if options.baseline:
            tests = {test: None for number in chosen for test in FAULTS[number - 1].tests}
            code, first = outcome_of(tuple(tests), root)
            print(f"without a fault: {'passed' if code == PASSED else f'failed, {first}'}", flush=True)
        for number in chosen:
            fault, begun = FAULTS[number - 1], time.monotonic()
            said = verdict(fault, root)
            caught += said.startswith("caught")
            seconds = time.monotonic() - begun
            print(f"{number:2}  {seconds:5.0f} s  {fault.subject}: {fault.what}: {said}", flush=True)
    print(f"{caught} of {len(chosen)} caught")


if __name__ == "__main__":
    main()
