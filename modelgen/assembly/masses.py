"""Mass, centre of mass and inertia of a body: as written, or from the density and the shapes."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import SceneError
from modelgen.geometry.mass_properties import mass_properties
from modelgen.model import InertiaKind
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body, Pose, Shape, Vector

Array = np.ndarray[Any, np.dtype[np.float64]]

ROUNDING = 4096 * sys.float_info.epsilon  # what a quadrature leaves of an exact zero or an exact equality


@dataclass(frozen=True, slots=True)
class Mass:
    """mass kg; centre (3) m in the body axes as written; inertia (3,3) kg m^2 about the centre, body axes."""

    mass: float
    centre: Vector
    inertia: Array | None = None


def pose_numbers(pose: Pose, shift: Vector = (0.0, 0.0, 0.0)) -> tuple[float, ...]:
    """The 12 numbers [p; R column by column] of a pose seen from a frame moved by `shift`."""
    position = (a - b for a, b in zip(pose.position, shift, strict=True))
    return (*position, *(float(x) for x in rotation_of(pose.quaternion).ravel(order="F")))


def mass_of(body: Body, where: str) -> Mass:
    """The mass of a dynamic body; raises SceneError if it has none."""
    if body.density is not None:
        return _from_density(body, body.density, where)
    if body.mass is None or not body.mass > 0:
        raise SceneError(
            where,
            f"the dynamic body {body.name!r} has mass {body.mass}",
            "a positive mass or a density",
            "add mass",
        )
    inertia = None if body.inertia is None else np.array(body.inertia)
    return Mass(body.mass, body.center_of_mass, inertia)


def _from_density(body: Body, density: float, where: str) -> Mass:
    if not body.shapes:
        raise SceneError(where, "a density without a shape", "a density needs a closed shape", "add a shape")
    parts = [_part(shape, density, where) for shape in body.shapes]
    mass = sum(part[0] for part in parts)
    centre = _snap(sum((part[0] * part[1] for part in parts), np.zeros(3)) / mass, parts, body)
    inertia: Array = np.zeros((3, 3))
    for part_mass, part_centre, part_inertia in parts:
        arm = part_centre - centre
        inertia += part_inertia + part_mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    x, y, z = (float(value) for value in centre)
    inertia = _clean(inertia)
    if not np.linalg.eigvalsh(inertia)[0] > 0:
        found = "moments of inertia that double precision cannot tell from zero"
        raise SceneError(where, found, "a body that can turn about any axis", "make it thicker")
    return Mass(float(mass), (x, y, z), inertia)


def _snap(centre: Array, parts: list[tuple[float, Array, Array]], body: Body) -> Array:
    """The centre, set equal to the origin of the body or of a shape if it differs from it only by
    rounding."""
    size = max(float(np.abs(at).max() + np.sqrt(np.trace(inertia) / mass)) for mass, at, inertia in parts)
    for anchor in ((0.0, 0.0, 0.0), *(shape.pose.position for shape in body.shapes)):
        centre = np.where(np.abs(centre - anchor) < ROUNDING * size, anchor, centre)
    return centre


def _part(shape: Shape, density: float, where: str) -> tuple[float, Array, Array]:
    """Mass, centre (3) and inertia (3,3) about it of the material in a shape, body axes."""
    try:
        mass, centre, inertia = mass_properties(shape, density)
    except SceneError as error:
        raise SceneError(f"{where}: {error.where}", error.found, error.allowed, error.remedy) from None
    R = rotation_of(shape.pose.quaternion)
    return mass, np.array(shape.pose.position) + R @ centre, R @ inertia @ R.T


def _clean(inertia: Array) -> Array:
    """The symmetric matrix with entries that differ from zero, or from each other, only by rounding made
    exact."""
    inertia = (inertia + inertia.T) / 2
    limit = ROUNDING * float(np.abs(inertia).max())
    inertia = np.where((np.abs(inertia) < limit) & ~np.eye(3, dtype=bool), 0.0, inertia)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if abs(inertia[i, i] - inertia[j, j]) < limit:
            inertia[j, j] = inertia[i, i]
    return inertia


def inertia_kind(inertia: Array) -> InertiaKind:
    """The structure of the matrix (3,3), from exact zeros and exact equalities."""
    if inertia[0, 1] or inertia[0, 2] or inertia[1, 2]:
        return "full"
    return "isotropic" if inertia[0, 0] == inertia[1, 1] == inertia[2, 2] else "diagonal"


def inertia_numbers(inertia: Array) -> tuple[float, ...]:
    """The parameters of the matrix's kind: [I], [Ixx, Iyy, Izz] or [Ixx, Iyy, Izz, Ixy, Ixz, Iyz]."""
    count = {"isotropic": 1, "diagonal": 3, "full": 6}[inertia_kind(inertia)]
    entries = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))[:count]
    return tuple(float(inertia[entry]) for entry in entries)


def inverse_numbers(mass: Mass, turns: bool) -> tuple[float, ...]:
    """[1/m, inverse inertia (9, column by column)]; the latter zero for a body that does not turn."""
    inverse: Array = np.zeros((3, 3))
    if turns and mass.inertia is not None:
        inverse = np.array(np.linalg.inv(mass.inertia), dtype=np.float64)
        if inertia_kind(mass.inertia) != "full":
            inverse = np.diag(1 / np.diag(mass.inertia))
    return (1 / mass.mass, *(float(x) for x in inverse.ravel(order="F")))
