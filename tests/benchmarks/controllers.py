"""The cost of a run under a controller, for each call of it: python -m tests.benchmarks.controllers

An ellipsoid that slides on a plane without friction, pushed by a PD controller every 0.1 ms, in Python and
as compiled expressions, and with inputs that change without sensors; by fixed and by adaptive steps. CPU
time, the least of some rounds, and the evaluations of the right-hand side for each call.
"""

from __future__ import annotations

from time import process_time
from typing import Any

from modelgen import build, derive, emit, require, start
from modelgen.runtime.settings import Stepping
from modelgen.scene.read import read_text
from tests.running import SCENES

EVERY, UNTIL, ROUNDS = 1e-4, 1.0, 5
MORE = """
[[input]]
name = "push"

[[force]]
body = "egg"
force = ["push", "0", "0"]

[[sensor]]
name = "place"
of = "egg.position"

[[sensor]]
name = "speed"
of = "egg.velocity"
"""


def python(t: float, shown: Any) -> float:
    return float(-40 * shown["place"][0] - 8 * shown["speed"][0])


def blind(t: float, shown: Any) -> float:
    return -t


CONTROLLERS = {"Python": python, "Python, no sensor": blind, "compiled": {"push": "-40*place_x - 8*speed_x"}}
METHODS: tuple[Stepping, ...] = ({"method": "rk4", "step": EVERY}, {})


def main() -> None:
    scene = read_text((SCENES / "ellipsoid_on_plane.toml").read_text() + MORE, "pushed.toml")
    library = build(emit(derive(require(scene))))
    print("| controller | method | us a call | calls/s | evaluations a call |\n|---|---|---|---|---|")
    for name, controller in CONTROLLERS.items():
        for stepping in METHODS:
            spent = []
            for _ in range(ROUNDS):
                sim = start(library, **stepping)
                sim.controller(controller, every=EVERY)
                begun = process_time()
                sim.step(until=UNTIL)
                spent.append((process_time() - begun) * EVERY / UNTIL)
            evaluations = sim.session.run.rhs_evals * EVERY / UNTIL
            cells = f"{1e6 * min(spent):.2f} | {1 / min(spent):.2e} | {evaluations:.1f}"
            print(f"| {name} | {stepping.get('method', 'dop853')} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
