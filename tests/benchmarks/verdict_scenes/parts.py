"""Tables of bodies and contacts from random numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

Random = np.random.Generator
Table = dict[str, Any]
Tables = dict[str, Any]

G = 9.81
DENSITY = 800.0  # kg/m^3
TURN = [0.0, 2 * np.pi]


def number(value: Any) -> float:
    """A number with five digits, as people write them."""
    return float(f"{float(value):.5g}")


def row(values: Any) -> list[float]:
    return [number(each) for each in values]


def turned(random: Random) -> list[float]:
    """A random orientation, as a quaternion."""
    q = random.normal(size=4)
    return [float(each) for each in q / np.linalg.norm(q)]


def ground(name: str = "floor") -> Table:
    return {"name": name, "motion": "fixed", "shape": {"kind": "plane"}}


def body(name: str, shape: Table | Sequence[Table], position: Any, **keys: Any) -> Table:
    """A body of one density, unless `keys` give another mass."""
    given = keys if "mass" in keys or "density" in keys else {"density": DENSITY, **keys}
    return {"name": name, "shape": shape, "position": row(position), **given}


def weighed(name: str, shape: Table, position: Any, mass: float, size: float, **keys: Any) -> Table:
    """A body whose mass does not follow from its shape: about that of a ball of `size`, m."""
    inertia = number(0.4 * mass * size**2)
    return body(name, shape, position, mass=number(mass), inertia=[inertia] * 3, **keys)


def contact(a: str, b: str, friction: float = 0.0, restitution: float = 0.0, **keys: Any) -> Table:
    found: Table = {"between": [a, b], **keys}
    if friction:
        found["friction"] = number(friction)
    if restitution:
        found["restitution"] = number(restitution)
    return found


def sizes(random: Random, low: float, high: float) -> Callable[[], float]:
    return lambda: number(random.uniform(low, high))


def solid(random: Random, kind: str, size: float) -> Table:
    """A solid of the catalogue whose half extents are 0.4 to 1 of `size`."""
    r = sizes(random, 0.4 * size, size)
    tall = sizes(random, 0.8 * size, 2 * size)
    table: dict[str, Callable[[], Table]] = {
        "sphere": lambda: {"radius": r()},
        "box": lambda: {"size": [tall(), tall(), tall()]},
        "cylinder": lambda: {"radius": r(), "length": tall()},
        "capsule": lambda: {"radius": number(r() / 2), "length": tall()},
        "ellipsoid": lambda: {"semi_axes": [r(), r(), r()]},
        "superellipsoid": lambda: {"semi_axes": [r(), r(), r()], "exponents": [2.5, 2.5]},
        "torus": lambda: {"major": number(0.7 * size), "minor": number(r() / 3)},
        "frustum": lambda: {"radius_bottom": r(), "radius_top": number(r() / 3), "length": tall()},
        "tube": lambda: {"radius": number(size), "bore": number(r() / 2), "length": tall()},
        "dome": lambda: {"radius": number(size), "length": number(size - r() / 4)},
        "polyhedron": lambda: {"vertices": [row(size * each) for each in _corners(random)]},
        "extrusion": lambda: {"length": tall(), "points": _outline(random, size)},
        "revolution": lambda: {
            "r": f"{r()} * sin(t) * (1.2 + 0.3 * cos(t))",
            "z": f"-{r()} * cos(t)",
            "domain": [0.0, float(np.pi)],
        },
        "disc": lambda: {"radius": r()},
    }
    return {"kind": kind, **table[kind]()}


def half_extent(shape: Table, axis: int) -> float:
    """How far a sphere, ellipsoid, box or cylinder reaches along an axis of its own, m."""
    if shape["kind"] == "sphere":
        return float(shape["radius"])
    if shape["kind"] == "cylinder":
        return float(shape["length"] / 2 if axis == 2 else shape["radius"])
    return float(shape["size"][axis] / 2 if shape["kind"] == "box" else shape["semi_axes"][axis])


SOLIDS = (
    "box",
    "capsule",
    "cylinder",
    "dome",
    "ellipsoid",
    "extrusion",
    "frustum",
    "polyhedron",
    "revolution",
    "superellipsoid",
    "torus",
    "tube",
)


def _corners(random: Random) -> Any:
    """Seven points on a ball."""
    points = random.normal(size=(7, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def _outline(random: Random, size: float) -> list[list[float]]:
    """A convex polygon of three to six corners on a circle."""
    n = int(random.integers(3, 7))
    angles = (np.arange(n) + random.uniform(-0.3, 0.3, n)) * 2 * np.pi / n
    return [row(size * np.array([np.cos(a), np.sin(a)])) for a in angles]


def scene(bodies: Sequence[Table], contacts: Sequence[Table], until: float, **keys: Any) -> Tables:
    return {
        "run": {"until": number(until), "samples": 20},
        "body": list(bodies),
        "contact": list(contacts),
        **keys,
    }
