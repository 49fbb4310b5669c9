"""Programs of MacMPEC (S. Leyffer) solved with the solver of plans, beside their published optimal values.

    python -m tests.benchmarks.macmpec [--source URL] [--only NAME ..] [--largest 700] [--out FILE]

The AMPL text of the programs and their table are cloned by git from `--source`, a URL or a folder with a
repository, into a temporary folder, and kept nowhere. Each program is written to FILE as a line of JSON as
soon as it is solved; those that FILE holds already are not solved again. Told are the value found, the
published one, iterations of IPOPT in all, and what is left of complementarity and constraints. A program
counts as

- equal: to all published digits, or to 1e-5 of max(1, value);
- lower: feasible, with a better value than the published one;
- higher: feasible, with a worse value: another stationary point;
- failed: the homotopy came to no relaxation that is small enough.

`--largest` leaves out programs of more variables.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import subprocess
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from modelgen.optimal_control.relaxation import RelaxedSolver
from tests.ampl.program import AmplProgram, read_program
from tests.ampl.tokens import AmplError

SOURCE = "https://github.com/blegat/MacMPEC.jl"
FEASIBLE = 1e-6
DIGITS = 1e-5


def cloned(source: str, folder: Path) -> Path:
    """The folder `data` of the repository."""
    subprocess.run(["git", "clone", "--quiet", "--depth", "1", source, str(folder / "macmpec")], check=True)
    return folder / "macmpec" / "data"


@dataclass(frozen=True)
class Listed:
    name: str
    files: tuple[Path, ...]
    published: float
    variables: int


def listed(data: Path) -> list[Listed]:
    """The programs that have a published value."""
    found, seen = [], Counter[str]()
    with open(data / "collection.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            try:
                value = float(row["solution"])
            except ValueError:  # told to be infeasible, or without a value
                continue
            names = [row["mod file"]] + ([] if row["dat file"] == "n/a" else [row["dat file"]])
            name = row["name"]
            if name == "TrafficSignalCycle":
                name = Path(names[1]).stem
            seen[name] += 1
            files = tuple(data / "ampl" / each for each in names)
            if seen[name] > 1:
                name = f"{name}-{seen[name]}"
            found.append(Listed(name, files, value, int(row["classification"].split("-")[3])))
    return found


def verdict(value: float, sign: float, published: float, success: bool, violation: float) -> str:
    if not success or violation > FEASIBLE:
        return "failed"
    digits = max(DIGITS * max(1.0, abs(published)), 0.5 * unit(published))
    # some programs that are maximised are listed with the value of their negative
    apart = min(value - published, value + published, key=abs) if sign < 0 else value - published
    if abs(apart) <= digits:
        return "equal"
    return "lower" if sign * (value - published) < 0 else "higher"


def unit(published: float) -> float:
    """Of the last of the six digits with which values are published."""
    return 10.0 ** (math.floor(math.log10(abs(published))) - 5) if published else 0.0


def solved(problem: AmplProgram) -> dict[str, Any]:
    began = time.process_time()
    found = RelaxedSolver(problem.program).solve(problem.start)
    return {
        "value": problem.sign * found.value,
        "iterations": found.iterations,
        "success": found.converged,
        "stationary": found.success,
        "complementarity": found.complementarity,
        "violation": found.violation,
        "seconds": time.process_time() - began,
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--source", default=SOURCE)
    parser.add_argument("--only", nargs="+")
    parser.add_argument("--largest", type=int, default=700)
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "macmpec.jsonl")
    given = parser.parse_args()
    known = {}
    if given.out.exists():
        known = {row["name"]: row for row in map(json.loads, given.out.read_text().splitlines())}
    counts = Counter[str]()
    print(f"{'program':14s} {'variables':>9s} {'pairs':>5s} {'found':>14s} {'published':>12s}  iterations")
    with tempfile.TemporaryDirectory() as folder:
        for each in listed(cloned(given.source, Path(folder))):
            if each.variables > given.largest or (given.only and each.name not in given.only):
                continue
            row = known.get(each.name) or row_of(each)
            if each.name not in known:
                with open(given.out, "a", encoding="utf-8") as out:
                    out.write(json.dumps(row) + "\n")
            counts[row["verdict"]] += 1
            print(line(row), flush=True)
    print(", ".join(f"{count} {name}" for name, count in counts.most_common()))


def row_of(each: Listed) -> dict[str, Any]:
    row: dict[str, Any] = {"name": each.name, "published": each.published}
    try:
        problem = read_program(*each.files)
    except (AmplError, KeyError) as error:
        return row | {"verdict": "not read", "error": str(error)}
    row |= {"variables": problem.program.x.numel(), "pairs": problem.program.first.numel()}
    row |= solved(problem)
    how = verdict(row["value"], problem.sign, each.published, row["success"], row["violation"])
    return row | {"verdict": how}


def line(row: dict[str, Any]) -> str:
    if "variables" not in row:
        return f"{row['name']:14s} {row['verdict']}: {row['error']}"
    text = f"{row['name']:14s} {row['variables']:9d} {row['pairs']:5d} "
    return text + (
        f"{row['value']:14.7g} {row['published']:12.6g} {row['iterations']:6d}  {row['verdict']:6s}"
        f" {'stationary' if row['stationary'] else '':10s} complementarity {row['complementarity']:.0e},"
        f" violation {row['violation']:.0e}"
    )


if __name__ == "__main__":
    main()
