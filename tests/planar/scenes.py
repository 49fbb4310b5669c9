"""Bodies on a table and on each other, under loads whose centre of pressure is known in closed form."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Event, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.running import library_of

G = 9.81
TIGHT = Accuracy.tight()
MASS, RADIUS, HEIGHT = 0.3, 0.04, 0.1  # of the glass; kg, m, m
INERTIA = [3.7e-4, 3.7e-4, 2.4e-4]


def table() -> Body:
    return make.fixed("table", make.plane())


def standing(shape: Shape, name: str = "body", height: float = HEIGHT / 2, **keys: object) -> Body:
    """A body of the glass's mass with its centre of mass at its origin, at rest at a height."""
    return make.dynamic(name, shape, **{"mass": MASS, "inertia": INERTIA, "position": [0, 0, height], **keys})


def pushed(
    shape: Shape,
    force: Sequence[str],
    point: Sequence[float],
    until: float,
    samples: int = 50,
    **keys: object,
) -> Trajectory:
    """A run of one body on the table, pushed at a point of its own."""
    scene = make.scene(
        "pushed", [table(), standing(shape, **keys)], contact=[{"between": ["body", "table"]}],
        force=[{"body": "body", "force": list(force), "point": list(point)}],
    )  # fmt: skip
    return simulate(library_of(scene), until=until, samples=samples, accuracy=TIGHT, estimate=False)


def events(path: Trajectory, kind: str) -> list[Event]:
    return [event for event in path.events if event.kind == kind]


def resting(path: Trajectory) -> np.ndarray:
    """The samples at which the first place holds a patch."""
    return np.flatnonzero(path.patch[:, 0] >= 0)
