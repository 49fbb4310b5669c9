"""Random steps of Gymnasium's hopper at `fast`: `python -m tests.benchmarks.hopper_steps [--count N]`.

The robot is imported from the package gymnasium. Random torques hold for 8 ms; an episode ends when the robot
has fallen, as Gymnasium says, or with `--lying` after 4 s, so that it also lies on its limbs. Episode k draws
from the seed k. CPU times find the steps that take long; callgrind counts the instructions of those, and of
the step of median time. Both have the call from Python in them.
"""

from __future__ import annotations

import argparse
from collections import Counter
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from modelgen import build, derive, emit, import_scene, require
from modelgen.codegen.library import Library
from modelgen.runtime.stepped_simulations import Simulations, start_many
from tests.benchmarks.counting import callgrind, countable

EVERY = 0.008  # s, a step: four of Gymnasium's 0.002 s
LOW, LEAN = 0.7, 0.2  # m and rad, height and lean of the torso at which Gymnasium's hopper has fallen
LONGEST = 500  # steps of an episode
STALL = 30  # times the median
MODULE = "tests.benchmarks.hopper_steps"


def hopper() -> Library:
    package = find_spec("gymnasium")
    assert package is not None, "gymnasium is not installed"
    assert package.origin is not None
    path = Path(package.origin).parent / "envs" / "mujoco" / "assets" / "hopper.xml"
    return build(emit(derive(require(import_scene(path).scene))))


def has_fallen(torso: np.ndarray) -> bool:
    """Whether a torso with this position and quaternion has fallen, by Gymnasium."""
    return bool(torso[2] < LOW or 2 * abs(np.arctan2(torso[5], torso[3])) > LEAN)


class Episode:
    """An episode of a robot, from the start of the scene on."""

    def __init__(self, robot: Simulations, seed: int) -> None:
        self.robot, self.random = robot, np.random.default_rng(seed)
        robot.reset([True])

    def set_torques(self) -> None:
        """Draw the torques of the next step."""
        for k, torque in enumerate(self.random.uniform(-1.0, 1.0, 3)):
            self.robot.inputs[f"u{k}"][:] = torque

    def before(self, number: int) -> bytes:
        """The state, torques included, before a step."""
        for _ in range(number):
            self.set_torques()
            self.robot.step(EVERY)
        self.set_torques()
        return self.robot.save()


def times(
    library: Library, count: int, first: int, lying: bool
) -> tuple[np.ndarray, np.ndarray, Counter[str]]:
    """CPU time of each step, s; its seed and number; outcomes of episodes that failed."""
    robot = start_many(library, 1, accuracy="fast")
    torso = next(body["q"] for body in library.manifest.instance["bodies"] if body["name"] == "torso")
    spent, where, failures = np.zeros(count), np.zeros((count, 2), dtype=int), Counter[str]()
    at, seed = 0, first
    while at < count:
        episode = Episode(robot, seed)
        for number in range(min(LONGEST, count - at)):
            episode.set_torques()
            begun = process_time()
            robot.step(EVERY)
            spent[at] = process_time() - begun
            where[at] = seed, number
            at += 1
            if robot.ended[0]:
                failures[str(robot.outcomes[0])] += 1
                break
            if not lying and has_fallen(robot.state[0, torso : torso + 7]):
                break
        seed += 1
    return spent, where, failures


def replay(folder: Path, steps: int) -> None:
    """Steps from the state saved in a folder, by the library there."""
    robot = start_many(Library.load(folder), 1, accuracy="fast")
    robot.load((folder / "state").read_bytes())
    for _ in range(steps):
        robot.step(EVERY)


def instructions(library: Library, seed: int, number: int) -> int:
    """Instructions of a step, with the call from Python: those of a process with it, less one without."""
    with TemporaryDirectory() as text:
        folder = Path(text)
        countable(library, folder)
        state = Episode(start_many(library, 1, accuracy="fast"), seed).before(number)
        (folder / "state").write_bytes(state)
        without, with_it = (callgrind(MODULE, "--replay", text, "--count", steps) for steps in (0, 1))
    return with_it - without


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first episode")
    parser.add_argument("--lying", action="store_true", help="go on after a fall")
    parser.add_argument("--worst", type=int, default=3, help="number of steps whose instructions are counted")
    parser.add_argument("--replay", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.replay:
        replay(given.replay, given.count)
        return
    library = hopper()
    spent, where, failures = times(library, given.count, given.first, given.lying)
    order = np.argsort(spent)
    median = float(np.median(spent))
    print(
        f"{len(spent)} steps, {len(np.unique(where[:, 0]))} episodes; CPU s {spent.sum():.1f}; "
        f"median {1e6 * median:.0f} us, longest {spent.max() / median:.0f} times that; "
        f"beyond {STALL} times: {(spent > STALL * median).sum()}; failed: {dict(failures) or 'none'}"
    )
    for at in order[::-1][: 4 * given.worst]:
        print(f"seed {where[at][0]}, step {where[at][1]}: {1e6 * spent[at]:.0f} us", flush=True)
    print(f"| seed | step | instructions | times the median step |\n{'| --- ' * 4}|", flush=True)
    typical = 0
    for at in (order[len(order) // 2], *order[::-1][: given.worst]):
        seed, number = map(int, where[at])
        found = instructions(library, seed, number)
        typical = typical or found
        print(f"| {seed} | {number} | {found:,} | {found / typical:.1f} |", flush=True)


if __name__ == "__main__":
    main()
