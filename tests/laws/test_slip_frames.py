"""Nothing depends on the frame of the tangential rows, on the order of the bodies, on where the world is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from modelgen.model import BodyMotion
from tests.laws.configurations import (
    Array,
    columns,
    eta_of,
    parameters,
    pose_of,
    random_pairs,
    rotation_of,
    turned,
)
from tests.laws.families import CASES, ONE_OF_EACH, kind_of
from tests.laws.shapes import SPECIMENS
from tests.laws.slip import times
from tests.laws.test_invariance import CLOSE, COUNT, EYE, SWAPPED, composed, random_rotations

FEW = CASES[::4]
IN_EACH_FORM = [
    pytest.param(*case, marks=() if case in ONE_OF_EACH else pytest.mark.slow)
    for case in (*FEW, *sorted(ONE_OF_EACH - set(FEW)))
]
ROUND = [pytest.param(*case, marks=() if case in ONE_OF_EACH else pytest.mark.slow) for case in SWAPPED]


def rates(o: str, f: str, form: str, at: tuple[Array, ...], **kind: Any) -> dict[str, Array]:
    function = contact_kernels(kind_of(o, f, form, **{"rows": 6, **kind})).rates
    return dict(zip(function.name_out(), columns(function, *at), strict=True))


def arguments(o: str, f: str, form: str, seed: int) -> tuple[Array, ...]:
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=seed)
    eta = eta_of(eta_layout(kind_of(o, f, form)), at)
    return at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, parameters(o, f, COUNT)


def seen(found: dict[str, Array], at: tuple[Array, ...], force: Array) -> dict[str, Array]:
    """What no frame can change: slip and rolling as vectors, how their squares grow, and what a force does.

    `force` (3,n) world; the wrench is J^T of its components, and its power that of the components.
    """
    rows = len(found["gamma"])
    speed = times(found["J_o"], at[1], rows) + times(found["J_f"], at[3], rows)
    T = found["tangents"].reshape(2, 3, -1)
    components = np.einsum("kin,in->kn", T, force)
    wrench = [
        np.einsum("kn,kjn->jn", components, found[side].reshape(rows, -1, force.shape[1])[1:3])
        for side in ("J_o", "J_f")
    ]
    return {
        "slip": np.einsum("kin,kn->in", T, speed[1:3]),
        "rolling": np.einsum("kin,kn->in", T, speed[4:6]),
        "spin": speed[3] * found["normal"],
        "growth": np.array(
            [np.sum(speed[k] * found["gamma"][k], axis=0) for k in (slice(1, 3), slice(4, 6))]
        ),
        "wrench_o": wrench[0],
        "wrench_f": wrench[1],
        "power": np.sum(components * speed[1:3], axis=0),
    }


def friction(count: int) -> Array:
    return np.random.default_rng(4).normal(size=(3, count))


@pytest.mark.parametrize(("o", "f", "form"), ROUND)
def test_swapping_the_bodies_turns_vectors_round_and_keeps_power(o: str, f: str, form: str) -> None:
    """The frame is then of the other body."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=8)
    carried = {
        "none": (at.x_o[:0], at.x_f[:0]), "chart": (at.alpha[:2], at.alpha[2:]), "point": (at.x_o, at.x_f)
    }  # fmt: skip
    back = eta_layout(kind_of(f, o, form))
    eta = np.concatenate([carried[back[0]][1], carried[back[1]][0]])
    one = arguments(o, f, form, 8)
    other = (at.pose_f, at.twist_f, at.pose_o, at.twist_o, eta, parameters(f, o, COUNT))
    force = friction(COUNT)
    here = seen(rates(o, f, form, one), one, force)
    there = seen(rates(f, o, form, other), other, -force)
    for name, sign in (("slip", -1), ("rolling", -1), ("spin", -1), ("growth", 1), ("power", 1)):
        np.testing.assert_allclose(there[name], sign * here[name], **CLOSE)
    np.testing.assert_allclose(there["wrench_o"], here["wrench_f"], **CLOSE)
    np.testing.assert_allclose(there["wrench_f"], here["wrench_o"], **CLOSE)


@pytest.mark.parametrize(("o", "f"), [("sphere", "sphere"), ("sphere", "ellipsoid"), ("plane", "torus")])
def test_a_symmetric_shape_placed_otherwise_has_another_frame_and_nothing_else(o: str, f: str) -> None:
    """A ball, or a plane about its normal, turned in its body."""
    form = "explicit" if f == "sphere" else "implicit"
    at = arguments(o, f, form, 12)
    random = random_rotations(5)
    if o == "plane":
        c, s, zero = np.cos(np.arange(COUNT) + 1), np.sin(np.arange(COUNT) + 1), np.zeros(COUNT)
        random = np.array([[c, -s, zero], [s, c, zero], [zero, zero, zero + 1]]).transpose(2, 0, 1)
    placement = pose_of(np.zeros((3, COUNT)), random)
    still = pose_of(np.zeros((3, COUNT)), EYE)
    n_o, layout = len(SPECIMENS[o].parameters), eta_layout(kind_of(o, f, form))
    eta = at[4].copy()
    if layout[0] == "point":
        eta[:3] = turned(random.transpose(0, 2, 1), eta[:3])
    numbers = np.concatenate([at[5][:n_o], placement, at[5][n_o:], still])
    turned_at = (*at[:4], eta, numbers)
    plain = rates(o, f, form, at)
    placed = rates(o, f, form, turned_at, placement="general")
    assert np.abs(placed["tangents"] - plain["tangents"]).max(axis=0).min() > 1e-3
    force = friction(COUNT)
    one, other = seen(plain, at, force), seen(placed, turned_at, force)
    for name, value in one.items():
        np.testing.assert_allclose(other[name], value, **CLOSE)


@pytest.mark.cases(20)
@pytest.mark.parametrize(("o", "f", "form"), FEW)
def test_moving_the_world_turns_the_frame_with_it(o: str, f: str, form: str) -> None:
    at = arguments(o, f, form, 5)
    G, g = random_rotations(6), np.random.default_rng(7).normal(size=(3, COUNT))

    def moved(vector: Array) -> Array:
        blocks = vector.reshape(-1, 6, COUNT)
        return np.concatenate([np.concatenate([turned(G, block[:3]), block[3:]]) for block in blocks])

    poses = composed(G, g, at[0]), composed(G, g, at[2])
    here = rates(o, f, form, at)
    there = rates(o, f, form, (poses[0], moved(at[1]), poses[1], moved(at[3]), at[4], at[5]))
    frame = np.concatenate([turned(G, t) for t in here["tangents"].reshape(2, 3, -1)])
    for found, wanted in (
        (there["J_o"], moved(here["J_o"])), (there["J_f"], moved(here["J_f"])),
        (there["gamma"], here["gamma"]), (there["tangents"], frame),
    ):  # fmt: skip
        np.testing.assert_allclose(found, wanted, **CLOSE)


@pytest.mark.cases(17)
@pytest.mark.parametrize("motion", ["fixed", "point", "driven"])
@pytest.mark.parametrize(("o", "f", "form"), IN_EACH_FORM)
def test_a_simpler_motion_is_a_free_body_that_does_less(
    o: str, f: str, form: str, motion: BodyMotion
) -> None:
    """fixed at the world frame: no columns; point: three, and no turning; driven: as free."""
    pose_o, twist_o, pose_f, *rest = arguments(o, f, form, 13)
    size = {"fixed": 0, "point": 3, "driven": 6}[motion]
    if motion != "driven":
        R, p = rotation_of(pose_o).transpose(0, 2, 1), pose_o[:3]
        pose_o, pose_f = pose_of(np.zeros((3, COUNT)), EYE), composed(R, -turned(R, p), pose_f)
    twist_o = twist_o * (np.arange(6) < size)[:, None]
    free = rates(o, f, form, (pose_o, twist_o, pose_f, *rest))
    given = (pose_o[:0], twist_o[:0]) if motion == "fixed" else (pose_o, twist_o)
    found = rates(o, f, form, (*given, pose_f, *rest), motions=(motion, "free"), pose="identity")
    free["J_o"] = free["J_o"].reshape(6, 6, COUNT)[:, :size].reshape(6 * size, COUNT)
    for name, wanted in free.items():
        np.testing.assert_allclose(found[name], wanted, **CLOSE)
