"""Scenes that must move as a given one does: turned, mirrored, scaled, or with its parts in another order.

Scenes are plain tables, of the kinds of entries that `tests.benchmarks.verdict_scenes` writes. Each function
returns the tables of the twin, and where a body of the scene is in it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.running import copied

Array = np.ndarray[Any, np.dtype[np.float64]]
Tables = dict[str, Any]
Text = str | float
Vector = Sequence[Any]  # of numbers or expressions

LENGTHS = (
    *("radius", "bore", "length", "major", "minor", "radius_bottom", "radius_top", "size", "semi_axes"),
    *("vertices", "points", "heights", "at"),
)  # keys of shapes
ORIGINS = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
MIRROR = np.diag([1.0, -1.0, 1.0])
SPEEDS = re.compile(r"\bv([xyz])\b")


class Twin(NamedTuple):
    """The tables, and the positions (.., 3) and quaternions (.., 4) in them of those in the scene."""

    tables: Tables
    positions: Callable[[Array], Array]
    quaternions: Callable[[Array], Array]


def rotated(tables: Tables, rotation: Rotation) -> Twin:
    """The whole scene turned about the origin, with gravity."""
    turn = rotation.as_matrix()
    twin = _mapped(tables, turn, turn, lambda q: _turned(rotation, q))
    return Twin(twin, lambda p: p @ turn.T, lambda q: _turned(rotation, q))


def scaled(tables: Tables, scale: float) -> Twin:
    """The scene with all lengths, forces and gravity `scale` times as large, at the same masses and times."""
    twin = _mapped(tables, scale * np.eye(3), np.eye(3), lambda q: q)
    for body in twin["body"]:
        for each in _shapes(body):
            _scale_shape(each, scale)
        if "inertia" in body:
            body["inertia"] = [scale**2 * each for each in body["inertia"]]
        if "density" in body:
            body["density"] /= scale**3
        if "center_of_mass" in body:
            body["center_of_mass"] = [scale * each for each in body["center_of_mass"]]
    for contact in twin["contact"]:
        for key in ("rolling_resistance", "spinning_resistance"):
            if key in contact:
                contact[key] *= scale
    for joint in twin.get("joint", ()):
        _scale_joint(joint, scale)
    for spring in twin.get("spring", ()):
        spring["anchors"] = [[scale * each for each in anchor] for anchor in spring.get("anchors", ORIGINS)]
        spring["rest_length"] = scale * spring.get("rest_length", 0.0)
    return Twin(twin, lambda p: scale * p, lambda q: q)


def mirrored(tables: Tables) -> Twin:
    """The scene in a mirror y = 0, the axes of its bodies too."""
    twin = _mapped(tables, MIRROR, -MIRROR, _mirrored)
    for body in twin["body"]:
        for each in _shapes(body):
            _mirror_shape(each)
        if "center_of_mass" in body:
            body["center_of_mass"] = (MIRROR @ body["center_of_mass"]).tolist()
    for joint in twin.get("joint", ()):
        if joint["kind"] == "revolute":
            _reverse(joint)
    for spring in twin.get("spring", ()):
        spring["anchors"] = [(MIRROR @ anchor).tolist() for anchor in spring.get("anchors", ORIGINS)]
    return Twin(twin, lambda p: p @ MIRROR, _mirrored)


def reordered(tables: Tables) -> Twin:
    """The same scene with bodies, contacts and joints written the other way round."""
    twin: Tables = copied(tables)
    for key in ("body", "contact", "joint"):
        twin[key] = twin.get(key, [])[::-1]
    for contact in twin["contact"]:
        contact["between"] = contact["between"][::-1]
    return Twin(twin, lambda p: p, lambda q: q)


def tilted(tables: Tables, by: float, seed: int) -> Twin:
    """The same scene, with gravity and velocities that differ by a small part in random directions: impacts
    whose order is left open may come in the other one."""
    twin, random = copied(tables), np.random.default_rng(seed)
    gravity = np.array(_gravity(tables))
    size = np.linalg.norm(gravity) or 1.0
    twin["gravity"] = [float(each) for each in gravity + by * size * random.normal(size=3)]
    for body in twin["body"]:
        for key in ("velocity", "angular_velocity"):
            if key in body:
                body[key] = [each * (1 + by * random.normal()) for each in body[key]]
    return Twin(twin, lambda p: p, lambda q: q)


def _gravity(tables: Tables) -> list[float]:
    return list(tables.get("gravity", [0.0, 0.0, -9.81]))


def _shapes(body: Tables) -> list[Tables]:
    found = body.get("shape", [])
    return [found] if isinstance(found, dict) else found


def _quaternion(table: Mapping[str, Any]) -> Array | None:
    if "quaternion" in table:
        return np.array(table["quaternion"], dtype=float)
    if "rpy" in table:
        found: Array = np.roll(Rotation.from_euler("xyz", table["rpy"]).as_quat(), 1)
        return found
    return None


def _turned(rotation: Rotation, q: Array) -> Array:
    """Quaternions (.., 4) after a rotation of the world."""
    flat = np.asarray(q, dtype=float).reshape(-1, 4)
    found = (rotation * Rotation.from_quat(np.roll(flat, -1, axis=1))).as_quat()
    result: Array = np.roll(found, 1, axis=1).reshape(np.shape(q))
    return result


def _mirrored(q: Array) -> Array:
    return np.asarray(q) * [1.0, -1.0, 1.0, -1.0]


def _mapped(tables: Tables, polar: Array, axial: Array, turned: Callable[[Array], Array]) -> Tables:
    """The scene with positions, velocities, forces and gravity mapped by `polar`, and angular velocities and
    torques by `axial`, which keeps their size."""
    twin: Tables = copied(tables)
    twin["gravity"] = (polar @ _gravity(tables)).tolist()
    for body in twin["body"]:
        _place(body, polar, turned)
        if "velocity" in body:
            body["velocity"] = (polar @ body["velocity"]).tolist()
        if "angular_velocity" in body:
            body["angular_velocity"] = (axial @ body["angular_velocity"]).tolist()
        for key, by in (("position", polar), ("rotation_vector", axial)):
            if key in body.get("path", ()):
                body["path"][key] = _combined(by, body["path"][key])
    for joint in twin.get("joint", ()):
        _place(joint, polar, turned)
    for load in twin.get("force", ()):
        back = np.linalg.inv(polar)
        seen = {axis: _sum(back[k], [f"v{each}" for each in "xyz"]) for k, axis in enumerate("xyz")}
        load["force"] = _combined(polar, [_with_speeds(str(each), seen) for each in load["force"]])
    return twin


def _with_speeds(text: str, seen: Mapping[str, Text]) -> str:
    return SPEEDS.sub(lambda found: f"({seen[found[1]]})", text)


def _place(table: Tables, polar: Array, turned: Callable[[Array], Array]) -> None:
    table["position"] = (polar @ table.get("position", [0.0, 0.0, 0.0])).tolist()
    q = _quaternion(table)
    table.pop("rpy", None)
    table["quaternion"] = turned(np.array([1.0, 0.0, 0.0, 0.0]) if q is None else q).tolist()


def _combined(matrix: Array, texts: Vector) -> list[Text]:
    return [_sum(line, texts) for line in matrix]


def _sum(numbers: Array, texts: Vector) -> Text:
    """A sum of expressions with factors, as an expression."""
    parts = [f"{float(n)!r} * ({each})" for n, each in zip(numbers, texts, strict=True) if n and each != 0.0]
    return " + ".join(parts).replace("+ -", "- ") or 0.0


def _times(scale: float, value: Any) -> Any:
    if isinstance(value, str):
        return value if value == "none" else f"{scale!r} * ({value})"
    return [_times(scale, each) for each in value] if isinstance(value, list) else scale * value


def _scale_shape(shape: Tables, scale: float) -> None:
    for key in (*LENGTHS, "position", "x", "y", "z", "r"):
        if key in shape:
            shape[key] = _times(scale, shape[key])


def _scale_joint(joint: Tables, scale: float) -> None:
    """Of a joint with an angle, torques are scaled; of others, lengths."""
    slides = joint["kind"] in ("prismatic", "distance", "rope")
    for key in ("limits", "rest", "motion", "distance") if slides else ():
        if key in joint:
            joint[key] = _times(scale, joint[key])
    for key in () if slides else ("stiffness", "damping"):
        if key in joint:
            joint[key] *= scale**2


def _mirror_shape(shape: Tables) -> None:
    """Kinds of which the mirror of y makes others; the expressions of outlines and curves are even."""
    if "position" in shape:
        shape["position"] = (MIRROR @ shape["position"]).tolist()
    q = _quaternion(shape)
    if q is not None:
        shape.pop("rpy", None)
        shape["quaternion"] = _mirrored(q).tolist()
    if shape["kind"] == "polyhedron":
        shape["vertices"] = [[x, -y, z] for x, y, z in shape["vertices"]]
    elif shape["kind"] == "extrusion" and "points" in shape:
        shape["points"] = [[x, -y] for x, y in shape["points"]][::-1]
    elif shape["kind"] == "height_field":
        shape["y"] = [-each for each in shape["y"]][::-1]
        shape["heights"] = [line[::-1] for line in shape["heights"]]
    elif shape["kind"] == "chart":
        shape |= {"y": f"-({shape['y']})", "cavity": not shape.get("cavity", False)}


def _reverse(joint: Tables) -> None:
    """A hinge whose angle has the other sign."""
    if "limits" in joint:
        joint["limits"] = [each if each == "none" else -each for each in joint["limits"][::-1]]
    if "rest" in joint:
        joint["rest"] = -joint["rest"]
    if "motion" in joint:
        joint["motion"] = f"-({joint['motion']})"
