"""Frictionless motion with restitution 1 keeps the symplectic form, through blows as well."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.runtime.core_session import Session
from modelgen.runtime.sensitivity import TangentRun
from modelgen.runtime.sensitivity_directions import QUANTITIES, direction_arrays, directions_of
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

EGG = """
[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.12, 0.09, 0.07] }
mass = 1.2
inertia = [0.0031, 0.0046, 0.0054]
position = [0.0, 0.0, 0.3]
rpy = [0.4, 0.2, 0.3]
velocity = [0.3, -0.2, 0.0]
angular_velocity = [2.0, -3.0, 1.0]
"""
FLOOR = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[contact]]
between = ["egg", "floor"]
restitution = 1.0
"""
STONE = """
[[body]]
name = "stone"
shape = { kind = "sphere", radius = 0.1 }
mass = 0.7
inertia = [0.003, 0.003, 0.003]
position = [0.5, 0.05, 0.32]
velocity = [-1.0, 0.0, 0.0]
center_of_mass = [0.02, 0.01, 0.0]

[[contact]]
between = ["egg", "stone"]
restitution = 1.0
"""
MASSES = {"egg": (1.2, np.diag([0.0031, 0.0046, 0.0054])), "stone": (0.7, np.diag([0.003, 0.003, 0.003]))}
FREE = "gravity = [0.0, 0.0, 0.0]\n"


def canonical(session: Session, derivatives: Array) -> tuple[Array, Array]:
    """The changes (n, 12 a body) of place, turn about body axes, momentum and angular momentum in body axes,
    and the symplectic form of two of them, dx . dp' - dp . dx' + L . (turn x turn')."""
    instance, parts, angular = session.instance, [], []
    for body in instance["bodies"]:
        if body["motion"] != "free":
            continue
        q, u = body["q"], instance["n_q"] + body["u"]
        mass, inertia = MASSES[body["name"]]
        w, vector = float(session.x[q + 3]), session.x[q + 4 : q + 7]
        turned, rest = derivatives[:, q + 3], derivatives[:, q + 4 : q + 7]
        turn = 2 * (w * rest - turned[:, None] * vector - np.cross(vector, rest))
        parts.append(
            np.hstack(
                [
                    derivatives[:, q : q + 3],
                    turn,
                    mass * derivatives[:, u : u + 3],
                    derivatives[:, u + 3 : u + 6] @ inertia,
                ]
            )
        )
        angular.append(inertia @ session.x[u + 3 : u + 6])
    form = np.zeros((12 * len(parts), 12 * len(parts)))
    for k, momentum in enumerate(angular):
        at = form[12 * k : 12 * k + 12, 12 * k : 12 * k + 12]
        at[:6, 6:], at[6:, :6] = np.eye(6), -np.eye(6)
        for i in range(3):
            at[3 + i, 3:6] = np.cross(momentum, np.eye(3)[i])  # L . (e_i x turn') = (L x e_i) . turn'
    return np.hstack(parts).astype(float), form


@pytest.mark.cases(2)
@pytest.mark.parametrize(
    ("text", "t", "blows"), [(EGG + FLOOR, 0.9, 2), (FREE + EGG + STONE, 0.6, 1), (EGG + FLOOR, 0.2, 0)]
)
def test_the_symplectic_form_is_kept(text: str, t: float, blows: int) -> None:
    library = differentiable(read_text(text, "scene.toml"))
    bodies = [b["name"] for b in library.manifest.instance["bodies"] if b["motion"] == "free"]
    names = [f"{body}.{quantity}" for body in bodies for quantity in QUANTITIES]
    directions = directions_of(library.manifest.instance, names)
    session = Session(library, accuracy_of(library.manifest.instance, "tight", {}))
    run = TangentRun(session, direction_arrays(library, directions), len(directions))
    before, form = canonical(session, run.state_derivatives())
    assert np.linalg.matrix_rank(before) == len(directions)
    start = before @ form @ before.T
    run.go_on(t)
    assert len(run.events()) >= blows
    after, form = canonical(session, run.state_derivatives())
    assert np.max(np.abs(after @ form @ after.T - start)) < 1e-9 * np.max(np.abs(start))
