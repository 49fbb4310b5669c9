"""Placed shapes and simpler motions of the explicit kinds are special cases of free bodies, term by term."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from modelgen.model import BodyMotion, ContactKind, Posing, ShapeKind, Side
from modelgen.notation import ETA_SIZE
from tests.curves.specimens import ALL
from tests.explicit.specimens import CENTRES
from tests.laws.configurations import Array, columns, pose_of, rotation_of, rotation_taking, turned

COUNT = 12
CLOSE = {"rtol": 1e-9, "atol": 1e-9}
CASES = [
    ("plane", "vertex", "explicit"), ("sphere", "vertex", "explicit"), ("torus", "vertex", "centre_surface"),
    ("patch", "ball", "centre_surface"), ("sphere", "ellipsoid", "centre_surface"),
    ("helix", "vertex", "centre_curve"), ("sphere", "circle", "centre_curve"),
    ("segment", "rod", "edge_edge"),
]  # fmt: skip


def shape(name: str) -> tuple[ShapeKind, tuple[float, ...]]:
    owner: Any = CENTRES[name] if name in CENTRES else ALL[name]
    return owner.kind, owner.parameters


def kind_of(
    o: str,
    f: str,
    form: str,
    motion: BodyMotion = "free",
    pose: Posing = "general",
    placed: Posing = "identity",
) -> ContactKind:
    one, two = Side(shape(o)[0], motion, pose, placed), Side(shape(f)[0], "free", "general", placed)
    return ContactKind("law", form, one, two)


def drawn(o: str, f: str, form: str) -> tuple[list[Array], list[Array], Array, list[Array]]:
    """Poses, twists, eta and lengths without any relation: the rates are functions of all of them."""
    random = np.random.default_rng(len(o) + 7 * len(f))
    poses = []
    for _ in range(2):
        axes = [axis / np.linalg.norm(axis, axis=0) for axis in random.normal(size=(2, 3, COUNT))]
        R = rotation_taking(*axes, random.uniform(-3, 3, COUNT))
        poses.append(pose_of(2 * random.normal(size=(3, COUNT)), R))
    eta = random.uniform(0.2, 0.8, (sum(ETA_SIZE[each] for each in eta_layout(kind_of(o, f, form))), COUNT))
    numbers = [np.tile(np.array(shape(name)[1]).reshape(-1, 1), COUNT) for name in (o, f)]
    return poses, list(random.normal(size=(2, 6, COUNT))), eta, numbers


@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_a_placed_shape_is_a_shape_moved(o: str, f: str, form: str) -> None:
    """The placed kernel at body poses against the plain one at shape poses and velocities."""
    poses, twists, eta, numbers = drawn(o, f, form)
    arms, turns = twists[0][3:] - twists[1][:3], [rotation_of(pose) for pose in poses[::-1]]
    bodies, rows = [], []
    for pose, twist, R_p in zip(poses, twists, turns, strict=True):
        R_b = rotation_of(pose) @ R_p.transpose(0, 2, 1)
        w = turned(R_p, twist[3:])
        v = twist[:3] - turned(R_b, np.cross(w, arms, axis=0))
        bend = turned(R_b, np.cross(w, np.cross(w, arms, axis=0), axis=0))
        bodies += [pose_of(pose[:3] - turned(R_b, arms), R_b), np.concatenate([v, w])]
        rows.append((R_b, R_p, bend))
    places = [pose_of(arms, R_p) for R_p in turns]
    all_numbers = np.concatenate([numbers[0], places[0], numbers[1], places[1]])
    plain = contact_kernels(kind_of(o, f, form)).rates
    d, J_o, J_f, gamma, eta_dot, normal = columns(
        plain, poses[0], twists[0], poses[1], twists[1], eta, np.concatenate(numbers)
    )
    carried = []
    for J, (R_b, R_p, bend) in zip((J_o, J_f), rows, strict=True):
        force = turned(R_b.transpose(0, 2, 1), J[:3])
        carried.append(np.concatenate([J[:3], np.cross(arms, force, axis=0) + turned(R_p, J[3:])]))
        gamma = gamma + np.sum(J[:3] * bend, axis=0)
    placed = columns(contact_kernels(kind_of(o, f, form, placed="general")).rates, *bodies, eta, all_numbers)
    for found, wanted in zip(placed, (d, *carried, gamma, eta_dot, normal), strict=True):
        np.testing.assert_allclose(found, wanted, **CLOSE)


@pytest.mark.parametrize("motion", ["fixed", "point", "driven"])
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_a_simpler_motion_is_a_free_body_that_does_less(
    o: str, f: str, form: str, motion: BodyMotion
) -> None:
    """fixed at the world frame: no twist; point: no turning; driven: as free."""
    poses, twists, eta, numbers = drawn(o, f, form)
    size = {"fixed": 0, "point": 3, "driven": 6}[motion]
    if motion != "driven":
        poses[0] = pose_of(np.zeros((3, COUNT)), np.tile(np.eye(3), (COUNT, 1, 1)))
    twists[0] = twists[0] * (np.arange(6) < size)[:, None]
    rest = poses[1], twists[1], eta, np.concatenate(numbers)
    free = columns(contact_kernels(kind_of(o, f, form)).rates, poses[0], twists[0], *rest)
    first = (poses[0][:0], twists[0][:0]) if motion == "fixed" else (poses[0], twists[0])
    found = columns(contact_kernels(kind_of(o, f, form, motion, "identity")).rates, *first, *rest)
    for index, (got, wanted) in enumerate(zip(found, free, strict=True)):
        np.testing.assert_allclose(got, wanted[:size] if index == 1 else wanted, **CLOSE)
