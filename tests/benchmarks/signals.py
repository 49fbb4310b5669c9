"""SIGINT, SIGTERM and SIGKILL at instants spread over each command: `python -m tests.benchmarks.signals
[MEMBERS] [--count 50] [--instant K]`.

Each case copies a prepared folder, which holds older outputs, starts the command, sends it one signal (to
this process alone, not to the compilers that it started), and runs the same command again. It is right if

- the process ended within END_S of the signal; after SIGINT or SIGTERM with the exit code of an interruption
  and one short line, or, where the work was done by then, as without the signal; and left no process, no
  temporary file;
- each file is then as it was before, or as the undisturbed command writes it; of an interrupted run it may be
  the part that was computed, whose samples are those of the undisturbed run; of a sweep no run is lost;
- the same command then prints and leaves what it does undisturbed, byte for byte but for times on the clock,
  and nothing beside that: no file, folder or process of the one that was killed, no port that is taken. A
  sweep goes on with each run that was kept.

Members: `core` (a build with an empty cache), `build`, `run`, `sweep`, `export`, `page` (`view --out`),
`live` (`view` in the browser), `fit`; `--count` instants of each member for each signal. The compiler does
not optimise, on which no judgement depends. Signals that find the interpreter before the first line of the
program are counted beside.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "balancing_wheel.toml"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
INTERRUPTED = 130
END_S = 1.0  # s, most time between a signal and the end of the process
PATIENCE_S = 300.0  # s, after which a command is ended
COMPILED_S = 20.0  # s, most time until compilers of a killed command have ended
BEYOND = 1.1  # times the undisturbed command, over which the instants are spread
LINE = 200  # letters of a message, at most
MARK = "MODELGEN_STUDY"  # environment variable by which processes are found
PLAIN = '#!/bin/sh\nexec cc "$@" -O0\n'
LEFT = (".modelgen-", ".build-")
CLOCK = ("wall_s", "cpu_s", "known")  # facts that differ between equal runs, and of a sweep that goes on
OLDER = b"older\n"


@dataclass(frozen=True)
class Told:
    """How a command ended."""

    code: int
    out: str
    err: str
    took: float = 0.0  # s after the signal, or from the start
    early: bool = False  # the signal found no program yet

    @property
    def facts(self) -> Any:
        try:
            return _timeless(json.loads(self.out))
        except ValueError:
            return self.out


@dataclass(frozen=True)
class Member:
    """A command: its words, and what its folder holds before it."""

    words: str
    before: str = ""  # a command that is run in the folder
    older: tuple[str, ...] = ()  # files that are there with another content
    fresh_cache: bool = False
    serves: bool = False


BUILD = "build wheel.toml --json"
MEMBERS: dict[str, Member] = {
    "core": Member(BUILD, fresh_cache=True),
    "build": Member(BUILD, older=("generated/wheel/instance.json", "generated/wheel/library.json")),
    "run": Member("simulate wheel.toml --until 4 --json --out run.npz", BUILD, ("run.npz",)),
    "sweep": Member(
        "sweep wheel.toml --vary torque=0:1:24 --until 0.2 --keep trajectories --threads 2 --json --out out",
        BUILD,
    ),
    "export": Member("export wheel.toml --to fmu --json --out out", older=("out/wheel.fmi2.fmu", "out/mine")),
    "page": Member("view wheel.toml --until 0.5 --json --out page.html", BUILD, ("page.html",)),
    "live": Member("view wheel.toml --port PORT", BUILD, serves=True),
    "fit": Member("fit wheel.toml recorded.csv --of axle,lean --by torque --json"),
}


class Place:
    """A folder with a cache, temporary files and a compiler of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.work = folder, folder / "work"
        self.cache, self.temporary = folder / "cache", folder / "temporary"
        self.temporary.mkdir()
        self.token = f"{os.getpid()}-{random.randrange(1 << 32)}"
        compiler = folder / "cc"
        compiler.write_text(PLAIN)
        compiler.chmod(0o755)
        with socket.socket() as found:
            found.bind(("127.0.0.1", 0))
            self.port = found.getsockname()[1]
        self.environment = os.environ | {
            "CC": str(compiler),
            "MODELGEN_CACHE": str(self.cache),
            "TMPDIR": str(self.temporary),
            "PYTHONPATH": str(ROOT),
            MARK: self.token,
        }

    def words(self, words: str) -> list[str]:
        return [sys.executable, "-m", "modelgen", *words.replace("PORT", str(self.port)).split()]

    def call(self, member: Member, number: int | None = None, after: float = 0.0) -> Told:
        """The command, with a signal so long after its start, s. A page is asked for, and then ended."""
        begun = time.perf_counter()
        with (self.folder / "out").open("w+") as out, (self.folder / "err").open("w+") as err:
            child = subprocess.Popen(
                self.words(member.words), cwd=self.work, env=self.environment, stdout=out, stderr=err
            )
            early = False
            if number is not None:
                time.sleep(max(after - (time.perf_counter() - begun), 0.0))
                early = not self.has_begun(child.pid)
            elif member.serves:
                self.ask(self.folder / "out")
                number = signal.SIGINT
            if number is not None:
                begun = time.perf_counter()
                child.send_signal(number)
            try:
                child.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
            took = time.perf_counter() - begun
            out.seek(0), err.seek(0)
            return Told(child.returncode, out.read(), err.read(), took, early)

    def has_begun(self, pid: int) -> bool:
        """Whether a process has set its own answer to SIGTERM, as the first lines of the program do."""
        try:
            status = Path(f"/proc/{pid}/status").read_text()
        except OSError:
            return True
        caught = re.search(r"SigCgt:\s*([0-9a-f]+)", status)
        ignored = re.search(r"SigIgn:\s*([0-9a-f]+)", status)
        if caught is None or ignored is None:  # it has ended
            return True
        either = int(caught[1], 16) | int(ignored[1], 16)
        return bool(either >> (signal.SIGTERM - 1) & 1) or "Z" in status.split("State:")[1][:4]

    def ask(self, out: Path) -> None:
        """Wait until the page is told and answers."""
        for _ in range(300):
            try:
                if "plays" in out.read_text():
                    urllib.request.urlopen(f"http://127.0.0.1:{self.port}/", timeout=5).close()
                    return
            except OSError:
                pass
            time.sleep(0.1)

    def is_free(self) -> bool:
        with socket.socket() as tried:
            tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                tried.bind(("127.0.0.1", self.port))
            except OSError:
                return False
        return True

    def processes(self) -> list[str]:
        """The commands of the processes that this study started and that live."""
        found = []
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                if f"{MARK}={self.token}".encode() in (entry / "environ").read_bytes():
                    found.append((entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()[:80])
            except OSError:
                continue
        return found

    def processes_after(self, patience: float) -> list[str]:
        end = time.perf_counter() + patience
        while (found := self.processes()) and time.perf_counter() < end:
            time.sleep(0.05)
        return found

    def leftovers(self) -> list[str]:
        """Files and folders that were to be temporary."""
        beside = [
            str(path)
            for top in (self.work, self.cache)
            for path in top.rglob("*")
            if path.name.startswith(LEFT)
        ]
        return beside + [str(path) for path in self.temporary.iterdir()]


def _timeless(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _timeless(entry) for key, entry in value.items() if key not in CLOCK}
    return [_timeless(entry) for entry in value] if isinstance(value, list) else value


def content(path: Path) -> Any:
    """What a file holds, without times on the clock."""
    if path.suffix == ".npz" and path.read_bytes() != OLDER:
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files if name != "digest"}
        facts = _timeless(json.loads(str(arrays.pop("summary"))))
        return {name: values.tobytes() for name, values in arrays.items()} | {"summary": facts}
    text = path.read_bytes()
    return re.sub(rb'"wall_s": [^,}]*', b"", text) if path.suffix == ".html" else text


def files(folder: Path) -> dict[str, Any]:
    """All files but those of Python and temporary ones, by their path."""
    return {
        str(path.relative_to(folder)): content(path)
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not any(part.startswith(LEFT) for part in path.parts)
    }


def is_part_of_run(part: Path, whole: Path) -> bool:
    """Whether a file of a run holds the first samples of another, and one more at its end."""
    from modelgen.report.run_files import load

    (few, many), kept = (load(path).columns for path in (part, whole)), 0
    for k, t in enumerate(few["t"]):
        at = np.flatnonzero(many["t"] == t)
        kept += len(at) == 1 and all(np.array_equal(few[name][k], many[name][at[0]]) for name in "pv")
    return kept >= len(few["t"]) - 1


def runs_of(folder: Path) -> list[int]:
    """The runs in the table of a sweep, which must be readable."""
    from modelgen import load_sweep

    if not (folder / "sweep.json").exists():
        return []
    return [int(number) for number in load_sweep(folder).columns["run"]]


class Trial:
    """A member with its prepared folder, and what it does undisturbed."""

    def __init__(self, place: Place, name: str) -> None:
        self.place, self.name, self.member = place, name, MEMBERS[name]
        self.prepared, self.prepared_cache = place.folder / f"{name}.before", place.folder / f"{name}.cache"
        shutil.rmtree(place.work, ignore_errors=True)
        place.work.mkdir()
        shutil.copy(SCENE, place.work / "wheel.toml")
        self.run("simulate wheel.toml --input torque=1.5 --until 0.1 --samples 10 --out w.csv")
        rows = [line.split(",") for line in (place.work / "w.csv").read_text().splitlines()]
        columns = [k for k, each in enumerate(rows[0]) if each.split("_")[0] in ("t", "axle", "lean")]
        recorded = "\n".join(",".join(row[k] for k in columns) for row in rows) + "\n"
        shutil.rmtree(place.work / "generated")
        (place.work / "w.csv").unlink()
        (place.work / "recorded.csv").write_text(recorded)
        if self.member.before:
            self.run(self.member.before)
        for older in self.member.older:
            (place.work / older).parent.mkdir(parents=True, exist_ok=True)
            (place.work / older).write_bytes(OLDER)
        shutil.copytree(place.work, self.prepared)
        self.before = files(self.prepared)
        self.right = place.call(self.member)  # fills the cache
        if self.right.code:
            raise SystemExit(f"{name}: {self.right}")
        shutil.copytree(place.cache, self.prepared_cache)
        self.reset()
        begun = time.perf_counter()
        self.right = place.call(self.member)
        self.lasts = time.perf_counter() - begun
        self.after = files(place.work)
        shutil.copytree(place.work, place.folder / f"{name}.after")
        if self.right.code or place.leftovers():
            raise SystemExit(f"{name}: {self.right} {place.leftovers()}")

    def run(self, words: str) -> None:
        place = self.place
        told = subprocess.run(
            place.words(words), cwd=place.work, env=place.environment, capture_output=True, text=True
        )
        if told.returncode:
            raise SystemExit(f"{words}: {told.stderr}")

    def reset(self) -> None:
        shutil.rmtree(self.place.work, ignore_errors=True)
        shutil.copytree(self.prepared, self.place.work)
        shutil.rmtree(self.place.temporary)
        self.place.temporary.mkdir()
        shutil.rmtree(self.place.cache)
        if self.member.fresh_cache:
            self.place.cache.mkdir()
            shutil.copy(self.prepared_cache / "key", self.place.cache / "key")
        else:
            shutil.copytree(self.prepared_cache, self.place.cache)

    def is_undisturbed(self, told: Told) -> bool:
        return (told.code, told.facts) == (self.right.code, self.right.facts)

    def faults(self, number: signal.Signals, after: float) -> tuple[Told, list[str]]:
        """How a case ended, and all that is wrong about it."""
        self.reset()
        place, wrong = self.place, list[str]()
        told = place.call(self.member, number, after)
        if told.took > END_S and not told.early:
            wrong.append(f"it took {told.took:.1f} s to end")
        if number != signal.SIGKILL and not told.early:
            wrong += self.faults_of_message(told)
            wrong += [f"{each} lives" for each in place.processes_after(0.2)]
            wrong += [f"{each} is left" for each in place.leftovers()]
        wrong += self.faults_of_files()
        if self.member.serves and not place.is_free():
            wrong.append("the port is taken")
        kept = runs_of(place.work / "out")
        following = place.call(self.member)
        if not self.is_undisturbed(following):
            wrong.append(f"the next command: {following.code} {following.out[-200:]} {following.err[-300:]}")
        elif self.name == "sweep" and json.loads(following.out)["known"] != len(kept):
            wrong.append(f"{json.loads(following.out)['known']} runs of {len(kept)} are known")
        wrong += [f"{each} lives on" for each in place.processes_after(COMPILED_S)]
        found = files(place.work)
        names = [name for name in {**found, **self.after} if found.get(name) != self.after.get(name)]
        wrong += [f"after the next command {name} differs" for name in names]
        wrong += [f"{each} is left after the next command" for each in place.leftovers()]
        return told, wrong

    def faults_of_message(self, told: Told) -> Iterator[str]:
        lines = [line for line in told.err.splitlines() if not line.startswith("modelgen: compiling")]
        if self.is_undisturbed(told) and not lines:
            return
        if self.member.serves and told.code == 0 and not lines:
            return
        if told.code != INTERRUPTED:
            yield f"exit code {told.code}"
        if len(lines) != 1 or len(lines[0]) > LINE or "interrupted" not in lines[0]:
            yield f"it tells {told.err[-600:]!r}"

    def faults_of_files(self) -> Iterator[str]:
        found = files(self.place.work)
        for name in {**self.before, **found}:
            value = found.get(name)
            if name in found and value in (self.before.get(name), self.after.get(name)):
                continue
            if name.startswith(("out/parts/", "out/runs/")):
                continue
            whole = self.place.folder / "run.after" / name
            if name == "run.npz" and name in found and is_part_of_run(self.place.work / name, whole):
                continue
            if name == "page.html" and value is not None and value.rstrip().endswith(b"</html>"):
                continue  # of the part of a run that was computed
            yield f"{name} is {'lost' if name not in found else 'neither older nor new'}"
        runs = runs_of(self.place.work / "out")
        if len(runs) != len(set(runs)):
            yield "a run is in the table twice"


def study(place: Place, names: list[str], count: int, only: int | None) -> int:
    total = 0
    print("| command | signal | cases | wrong | before the program | done | longest to the end, s |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in names:
        trial, draw = Trial(place, name), random.Random(name)
        for number in SIGNALS:
            tally, longest = Counter[str](), 0.0
            for k in range(count):
                after = (k + draw.random()) / count * BEYOND * trial.lasts
                if only not in (None, k):
                    continue
                told, wrong = trial.faults(number, after)
                longest = longest if told.early else max(longest, told.took)
                tally["cases"] += 1
                tally["wrong"] += bool(wrong)
                tally["early"] += told.early
                tally["done"] += trial.is_undisturbed(told)
                for each in wrong:
                    print(
                        f"{name} {number.name} {k} after {after:.3f} s: {each}", file=sys.stderr, flush=True
                    )
            total += tally["wrong"]
            print(
                f"| {name} | {number.name} | {tally['cases']} | {tally['wrong']} | {tally['early']}"
                f" | {tally['done']} | {longest:.2f} |",
                flush=True,
            )
    return total


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("members", nargs="*", metavar="MEMBERS", help=", ".join(MEMBERS))
    parser.add_argument("--count", type=int, default=50, help="instants of each member and signal")
    parser.add_argument("--instant", type=int, help="this one alone")
    given = parser.parse_args()
    if unknown := set(given.members) - set(MEMBERS):
        parser.error(f"no such members: {', '.join(sorted(unknown))}")
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background commands ignore it
    with TemporaryDirectory() as name:
        place = Place(Path(name).resolve())
        return int(study(place, given.members or list(MEMBERS), given.count, given.instant) > 0)


if __name__ == "__main__":
    sys.exit(main())
