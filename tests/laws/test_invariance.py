"""Moving the world changes nothing, swapping o and f signs only; placements and simpler motions are exact."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.contact.form_table import FORMS, contact_kernels, eta_layout
from modelgen.model import BodyMotion
from tests.laws.configurations import (
    Array,
    columns,
    eta_of,
    parameters,
    pose_of,
    random_pairs,
    rotation_of,
    rotation_taking,
    turned,
)
from tests.laws.families import CASES, SPARSE, kind_of
from tests.laws.shapes import SPECIMENS

COUNT = 12
CLOSE = {"rtol": 1e-9, "atol": 1e-9}
SWAPPED = [
    (o, f, form)
    for o, f, form in CASES
    if FORMS[form].applies(SPECIMENS[f].kind, SPECIMENS[o].kind) and "plane" not in o + f
]
EYE = np.tile(np.eye(3), (COUNT, 1, 1))


def random_rotations(seed: int) -> Array:
    random = np.random.default_rng(seed)
    a, b = (axis / np.linalg.norm(axis, axis=0) for axis in random.normal(size=(2, 3, COUNT)))
    return rotation_taking(a, b, random.uniform(-3, 3, COUNT))


def composed(R: Array, p: Array, pose: Array) -> Array:
    """The pose seen from a frame in which its world has the pose (p, R)."""
    return pose_of(p + turned(R, pose[:3]), R @ rotation_of(pose))


def rates(o: str, f: str, form: str, at: tuple[Array, ...], **kind: str) -> tuple[Array, ...]:
    return columns(contact_kernels(kind_of(o, f, form, **kind)).rates, *at)  # type: ignore[arg-type]


@pytest.mark.cases(50)
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_moving_the_world_changes_nothing(o: str, f: str, form: str) -> None:
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=5)
    eta, numbers = eta_of(eta_layout(kind_of(o, f, form)), at), parameters(o, f, COUNT)
    G, g = random_rotations(6), np.random.default_rng(7).normal(size=(3, COUNT))

    def moved(twist: Array) -> Array:
        return np.concatenate([turned(G, twist[:3]), twist[3:]])

    here = rates(o, f, form, (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, numbers))
    poses = composed(G, g, at.pose_o), composed(G, g, at.pose_f)
    there = rates(o, f, form, (poses[0], moved(at.twist_o), poses[1], moved(at.twist_f), eta, numbers))
    d, J_o, J_f, gamma, eta_dot, normal = here
    expected = (d, moved(J_o), moved(J_f), gamma, eta_dot, turned(G, normal))
    for found, wanted in zip(there, expected, strict=True):
        np.testing.assert_allclose(found, wanted, **CLOSE)


@pytest.mark.cases(30)
@pytest.mark.parametrize(("o", "f", "form"), SWAPPED)
def test_swapping_the_bodies_changes_signs_only(o: str, f: str, form: str) -> None:
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=8)
    kind, other = kind_of(o, f, form), kind_of(f, o, form)
    layout, back = eta_layout(kind), eta_layout(other)
    carried = {
        "none": (at.x_o[:0], at.x_f[:0]),
        "chart": (at.alpha[:2], at.alpha[2:]),
        "point": (at.x_o, at.x_f),
    }
    eta = np.concatenate([carried[back[0]][1], carried[back[1]][0]])
    straight = (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(layout, at), parameters(o, f, COUNT))
    swapped = (at.pose_f, at.twist_f, at.pose_o, at.twist_o, eta, parameters(f, o, COUNT))
    d, J_o, J_f, gamma, _, normal = rates(o, f, form, straight)
    for found, wanted in zip(rates(f, o, form, swapped), (d, J_f, J_o, gamma, None, -normal), strict=True):
        if wanted is not None:
            np.testing.assert_allclose(found, wanted, **CLOSE)


@pytest.mark.parametrize(("o", "f", "form"), SPARSE)
def test_a_placed_shape_is_a_shape_moved(o: str, f: str, form: str) -> None:
    """The placed kernel at body poses against the plain one at shape poses and velocities."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=9)
    eta, numbers = eta_of(eta_layout(kind_of(o, f, form)), at), parameters(o, f, COUNT)
    random = np.random.default_rng(10)
    sides = []
    for seed, pose, twist in ((11, at.pose_o, at.twist_o), (12, at.pose_f, at.twist_f)):
        arm, R_p = random.normal(size=(3, COUNT)), random_rotations(seed)
        R_b = rotation_of(pose) @ R_p.transpose(0, 2, 1)
        w = turned(R_p, twist[3:])  # body axes
        p_b = pose[:3] - turned(R_b, arm)
        v_b = twist[:3] - turned(R_b, np.cross(w, arm, axis=0))
        bend = turned(R_b, np.cross(w, np.cross(w, arm, axis=0), axis=0))
        sides.append((pose_of(p_b, R_b), np.concatenate([v_b, w]), pose_of(arm, R_p), arm, R_p, R_b, bend))
    n_o = len(SPECIMENS[o].parameters)
    placed_numbers = np.concatenate([numbers[:n_o], sides[0][2], numbers[n_o:], sides[1][2]])
    plain = (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, numbers)
    d, J_o, J_f, gamma, eta_dot, normal = rates(o, f, form, plain)
    placed_at = (sides[0][0], sides[0][1], sides[1][0], sides[1][1], eta, placed_numbers)
    placed = rates(o, f, form, placed_at, placement="general")
    rows = []
    for J, (_, _, _, arm, R_p, R_b, _) in zip((J_o, J_f), sides, strict=True):
        force = turned(R_b.transpose(0, 2, 1), J[:3])
        rows.append(np.concatenate([J[:3], np.cross(arm, force, axis=0) + turned(R_p, J[3:])]))
    bend = sum(np.sum(J[:3] * side[6], axis=0) for J, side in zip((J_o, J_f), sides, strict=True))
    for found, wanted in zip(placed, (d, *rows, gamma + bend, eta_dot, normal), strict=True):
        np.testing.assert_allclose(found, wanted, **CLOSE)


@pytest.mark.cases(34)
@pytest.mark.parametrize("motion", ["fixed", "point", "driven"])
@pytest.mark.parametrize(("o", "f", "form"), SPARSE)
def test_a_simpler_motion_is_a_free_body_that_does_less(
    o: str, f: str, form: str, motion: BodyMotion
) -> None:
    """fixed at the world frame: no twist; point: no turning; driven: as free."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=13)
    size = {"fixed": 0, "point": 3, "driven": 6}[motion]
    pose_f = at.pose_f
    if motion != "driven":  # o at the world frame
        R, p = rotation_of(at.pose_o).transpose(0, 2, 1), at.pose_o[:3]
        pose_f = composed(R, -turned(R, p), at.pose_f)
    pose_o = at.pose_o if motion == "driven" else pose_of(np.zeros((3, COUNT)), EYE)
    twist_o = at.twist_o * (np.arange(6) < size)[:, None]
    eta, numbers = eta_of(eta_layout(kind_of(o, f, form)), at), parameters(o, f, COUNT)
    free = rates(o, f, form, (pose_o, twist_o, pose_f, at.twist_f, eta, numbers))
    arguments = (pose_o[:0], twist_o[:0]) if motion == "fixed" else (pose_o, twist_o)
    found = columns(
        contact_kernels(kind_of(o, f, form, (motion, "free"), pose="identity")).rates,
        *arguments, pose_f, at.twist_f, eta, numbers,
    )  # fmt: skip
    for index, (got, wanted) in enumerate(zip(found, free, strict=True)):
        np.testing.assert_allclose(got, wanted[:size] if index == 1 else wanted, **CLOSE)
