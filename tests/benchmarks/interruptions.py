"""Ctrl-C (SIGINT) at random instants of heavy work: how long until the process ends, and its exit code.

Run with `python -m tests.benchmarks.interruptions [--instants 20] [--members heap200 sweep]`. Each instant
has a process of its own: heaps of 50 and 200 spheres and a stack by time-stepping, a spline that falls on a
spline, searches of two splines and of two polyhedra of 128 sides, a sweep, a batch, derivatives forward and
backward. Scenes are built before. A row tells the time to the end, the CPU time that the process used after
the signal, which other programs on the machine do not lengthen, and the exit code, 130 of an interrupted
command. The exit code is 1 if an end took more than ANSWER_S, or told another code.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from modelgen import (
    build,
    derive,
    distance_minima,
    emit,
    gradient,
    read,
    require,
    sensitivity,
    simulate_batch,
)
from modelgen.cli import INTERRUPTED
from modelgen.cli import main as command_line
from modelgen.codegen.library import Library
from modelgen.runtime.sensitivity import outputs_of
from tests.benchmarks.random_scenes import SHAPES
from tests.memory.cases import FLOOR, heap, stack

ANSWER_S = 0.5  # s, most time between Ctrl-C and the end of a process
EARLIEST, LATEST = 0.5, 8.0  # s after the beginning of the work
READY = "begins"
UNTIL = 600.0  # s, of runs that do not come to their end
SIDES, POSES = 128, 100_000
TICK = os.sysconf("SC_CLK_TCK")


def _splines() -> str:
    points = np.array(SHAPES["bspline"](lambda: 0.05)["points"]).tolist()
    shape = f'shape = {{ kind = "bspline", periodic = [true, true], points = {points} }}\n'
    body = (
        "mass = 1.0\ninertia = [0.004, 0.004, 0.004]\nposition = [0.03, 0.02, 0.3]\nrpy = [0.4, 0.3, 0.0]\n"
    )
    return (
        f"[run]\nuntil = {UNTIL}\n{FLOOR}"
        + f'[[body]]\nname = "a"\nmotion = "fixed"\nposition = [0.0, 0.0, 0.1]\n{shape}'
        + f'[[body]]\nname = "b"\n{shape}{body}[[contact]]\nbetween = ["a", "b"]\nfriction = 0.3\n'
        + '[[contact]]\nbetween = ["b", "floor"]\n'
    )


def _polyhedra() -> str:
    turn = 2 * np.pi * np.arange(SIDES // 2) / (SIDES // 2)
    ring = np.stack([0.1 * np.cos(turn), 0.1 * np.sin(turn)], axis=1)
    vertices = [[x, y, z] for z in (-0.05, 0.05) for x, y in ring.tolist()]
    shape = f'shape = {{ kind = "polyhedron", vertices = {vertices} }}\ndensity = 1000.0\n'
    return (
        f"[run]\nuntil = {UNTIL}\n"
        + f'[[body]]\nname = "a"\nmotion = "fixed"\n{shape}'.replace("density = 1000.0\n", "")
        + f'[[body]]\nname = "b"\nposition = [0.0, 0.0, 0.5]\n{shape}[[contact]]\nbetween = ["a", "b"]\n'
    )


PENDULUM = f"""[run]
until = {UNTIL}
accuracy = "tight"
[[parameter]]
name = "m"
value = 1.0
{FLOOR}[[body]]
name = "ball"
shape = {{ kind = "ellipsoid", semi_axes = [0.1, 0.08, 0.07] }}
mass = "m"
inertia = [0.004, 0.005, 0.006]
position = [0.0, 0.0, 0.2]
velocity = [1.0, 0.0, 0.0]
[[contact]]
between = ["ball", "floor"]
friction = 0.3
restitution = 0.5
"""


def _simulate(scene: Path) -> None:
    sys.argv = ["modelgen", "simulate", scene.name]
    command_line()


def _sweep(scene: Path) -> None:
    words = ["--vary", "m=0.5:2:8192", "--until", "60", "--out"]
    sys.argv = ["modelgen", "sweep", scene.name, *words, f"sweep{os.getpid()}"]
    command_line()


def _batch(library: Library) -> None:
    instance = library.manifest.instance
    q, u = ([[*instance[name]]] * 500 for name in ("initial_q", "initial_u"))
    simulate_batch(library, np.array(q), np.array(u), until=UNTIL)


def _derivatives(library: Library) -> None:
    of = list(outputs_of(library.manifest.instance))
    while True:
        sensitivity(library, 3.0, of=of, by=["m", "ball.velocity"])


def _backward(library: Library) -> None:
    from casadi import SX, Function, sumsqr  # of this member alone

    of = [name for name in outputs_of(library.manifest.instance) if name.endswith("position")]
    shown = SX.sym("shown", 1, 3)
    loss = Function("loss", [shown], [sumsqr(shown)])
    while True:  # of which a part is the way back
        gradient(library, 3.0, loss, of=of, by=["m", "ball.velocity"])


def _minima(library: Library) -> None:
    random = np.random.default_rng(0)
    poses = np.broadcast_to(np.eye(3, 4), (POSES, 3, 4)).copy()
    fixed = poses[:1].copy()
    poses[:, :, 3] = random.uniform(-0.2, 0.2, (POSES, 3))
    distance_minima(library, "a-b", fixed, poses)


RUN: dict[str, tuple[Callable[[], str], Callable[[Path], None]]] = {
    "heap50": (lambda: heap(50, "sphere"), _simulate),
    "heap200": (lambda: heap(200, "sphere"), _simulate),
    "stack20": (lambda: stack(20), _simulate),
    "splines": (_splines, _simulate),
    "sweep": (lambda: PENDULUM, _sweep),
}
CALLED: dict[str, tuple[Callable[[], str], Callable[[Library], None]]] = {
    "spline_search": (_splines, _minima),
    "polyhedron_search": (_polyhedra, _minima),
    "batch": (lambda: PENDULUM, _batch),
    "derivatives": (lambda: PENDULUM, _derivatives),
    "backward": (lambda: PENDULUM, _backward),
}
MEMBERS = (*RUN, *CALLED)


def _built(name: str, folder: Path) -> Library:
    package = emit(
        derive(require(read(folder / f"{name}.toml"))), derivatives=name in ("derivatives", "backward")
    )
    return build(package, folder=folder / name)


def work(name: str, folder: Path) -> None:
    """The heavy work of a member, in this process, which says when it begins."""
    os.chdir(folder)
    library = _built(name, folder) if name in CALLED else None
    try:
        print(READY, flush=True)
        if library is None:
            RUN[name][1](folder / f"{name}.toml")
        else:
            CALLED[name][1](library)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def _spent(pid: int) -> float:
    """CPU time of a process and of those that it has waited for so far, s."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / TICK


def interrupted(name: str, folder: Path, after: float) -> tuple[float, float, int]:
    """Time and CPU time of a member from a signal to its end, s, and its exit code."""
    command = [sys.executable, "-m", "tests.benchmarks.interruptions", "--work", name, "--out", str(folder)]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert child.stdout is not None
    child.stdout.readline()
    time.sleep(after)
    assert child.poll() is None, f"the work of {name} is too short: it ended before the signal"
    before = _spent(child.pid)
    child.send_signal(signal.SIGINT)
    sent = time.perf_counter()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return time.perf_counter() - sent, usage.ru_utime + usage.ru_stime - before, child.returncode


def study(names: Sequence[str], instants: int, folder: Path) -> int:
    random, late = np.random.default_rng(0), 0
    print("| member | after, s | to the end, s | CPU, s | exit code |\n|---|---|---|---|---|")
    for name in names:
        (folder / f"{name}.toml").write_text((RUN | CALLED)[name][0](), encoding="utf-8")
        words = ["sweep", "--vary", "m=1", "--out", "known"] if name == "sweep" else ["build"]
        if name in RUN:
            command = [sys.executable, "-m", "modelgen", words[0], f"{name}.toml", *words[1:]]
            subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        else:
            _built(name, folder)
    worst, most = 0.0, 0.0
    for instant in range(instants):
        name, after = names[instant % len(names)], float(random.uniform(EARLIEST, LATEST))
        wall, cpu, code = interrupted(name, folder, after)
        worst, most = max(worst, wall), max(most, cpu)
        late += int(wall > ANSWER_S or code != INTERRUPTED)
        print(f"| {name} | {after:.2f} | {wall:.3f} | {cpu:.2f} | {code} |", flush=True)
    print(f"{instants} instants: at most {worst:.3f} s to the end, {most:.2f} s of CPU time; {late} late")
    return late


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--instants", type=int, default=2 * len(MEMBERS))
    parser.add_argument("--members", nargs="+", choices=MEMBERS, default=list(MEMBERS))
    parser.add_argument("--work", choices=MEMBERS, help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.work:
        work(given.work, given.out)
        return 0
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background commands ignore it
    with TemporaryDirectory() as folder:
        return int(study(given.members, given.instants, Path(folder)) > 0)


if __name__ == "__main__":
    sys.exit(main())
