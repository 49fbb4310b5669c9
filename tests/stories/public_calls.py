"""A scene for which all functions of the package can be called, and what they return by name."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from modelgen import (
    derive,
    emit,
    fit,
    linearise,
    linearise_steady,
    record_of,
    require,
    simulate,
    start,
    start_many,
    sweep,
)
from modelgen.codegen.library import Library
from modelgen.derivation import Derivation
from modelgen.report.run_record import Record
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import compiled

TURN = np.eye(3).ravel()
BALL = """
[run]
until = 0.05
samples = 4

[[parameter]]
name = "height"
value = 0.05
minimum = 0.05

[[input]]
name = "push"
minimum = -5
maximum = 5

[[sensor]]
name = "place"
of = "ball.position"

[[sensor]]
name = "load"
of = "ball-floor.force"

[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.05 }
density = 900.0
position = [0.0, 0.0, "height"]

[[force]]
body = "ball"
force = ["push", "0", "0"]

[[contact]]
between = ["ball", "floor"]
friction = 0.3
"""


@cache
def derivation() -> Derivation:
    return derive(require(read_text(BALL, "ball.toml")))


@cache
def library() -> Library:
    return compiled(emit(derivation(), derivatives=True))


@cache
def trajectory() -> Trajectory:
    return simulate(library())


def record() -> Record:
    return record_of(trajectory(), library())


def mappings() -> dict[str, Any]:
    """All that is looked up by name, by where it stands; each with one name that it has."""
    sim, many = start(library()), start_many(library(), 2)
    small, steady = linearise(derivation(), library()), linearise_steady(derivation(), library())
    table = sweep(library(), {"push": [0.0, 1.0]}, threads=1)
    recorded = {"t": [0.0, 0.02, 0.04], "place_x": [0.0, 4e-4, 16e-4], "place_y": [0.0, 1e-5, 0.0]}
    fitted = fit(library(), recorded, by=["push"], evaluations=2)
    return {
        "sim.contacts": sim.contacts,
        "sim.inputs": sim.inputs,
        "sim.sensors": sim.sensors,
        "many.inputs": many.inputs,
        "many.sensors": many.sensors,
        "trajectory.parameters": trajectory().parameters,
        "trajectory.inputs": trajectory().inputs,
        "record.columns": record().columns,
        "record.summary": record().summary,
        **{f"linearised.{key}": getattr(small, key) for key in ("p", "quaternion", "coordinates")},
        **{f"linearised.{key}": getattr(small, key) for key in ("force", "friction")},
        **{f"steady.{key}": getattr(steady, key) for key in ("p", "quaternion", "v", "w", "coordinates")},
        **{f"steady.{key}": getattr(steady, key) for key in ("force", "friction")},
        "sweep.columns": table.columns,
        "sweep.outcomes": table.outcomes,
        "fit.inputs": fitted.inputs,
        "fit.noise": fitted.noise,
        "fit.residuals.rms": fitted.residuals[0].rms,
    }
