"""Shapes and bodies from the values of their tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import hypot
from typing import Any

from modelgen.scene.custom_solid import read_solid
from modelgen.scene.finite_expressions import finite, triple
from modelgen.scene.free_form_values import Net
from modelgen.scene.free_shapes import FREE_SHAPES
from modelgen.scene.plausibility_remarks import remark_on_density
from modelgen.scene.pose_input import POSE_KEYS, read_pose
from modelgen.scene.prescribed_motions import check_motion, motion_names, motion_start
from modelgen.scene.scene_format import ZERO
from modelgen.scene.scene_types import Body, Path, Shape, Vector
from modelgen.scene.shape_catalogue import SHAPES
from modelgen.scene.solids_with_edges import SOLIDS
from modelgen.scene.source_location import Place
from modelgen.scene.user_chart import read_chart, read_curve


def read_shape(values: Mapping[str, Any], place: Place) -> Shape:
    """The shape from the values of its table; raises SceneError."""
    kind = values["kind"]
    values = _with_followed(values, place)
    common = {
        "kind": kind,
        "cavity": values.get("cavity", False),
        "pose": read_pose(values, place),
        "name": values["name"] or kind,
        "placed": place.follows(*POSE_KEYS),
        "stands_for": values["stands_for"],
    }
    if kind == "chart":
        return Shape(parameters=values["parameters"], chart=read_chart(values, place), **common)
    if kind == "curve":
        return Shape(parameters=values["parameters"], curve=read_curve(values, place), **common)
    if kind in FREE_SHAPES:
        return Shape(**(common | FREE_SHAPES[kind].read(values, place)))
    if kind == "solid":
        return Shape(**read_solid(values, place, read_shape), **common)
    if kind in SOLIDS:
        return Shape(**SOLIDS[kind].read(values, place), **common)
    return Shape(parameters=SHAPES[kind].numbers(values, place), **common)


def _with_followed(values: Mapping[str, Any], place: Place) -> Mapping[str, Any]:
    """The values of a shape; of one with expressions, its parameters with those of the scene in them."""
    if "parameters" not in values:
        return values
    own = dict(values["parameters"])
    for key in "xyrz":
        if isinstance(values.get(key), str):
            own |= place.key(key).followed_in(values[key], own)
    return {**values, "parameters": tuple(own.items())}


def body_of(values: Mapping[str, Any], shapes: tuple[Shape, ...], place: Place) -> Body:
    """The body from the values of its table and its shapes; raises SceneError."""
    _check_unique("shape", (each.name for each in shapes), place.key("shape"))
    motion = values["motion"]
    if place.follows("center_of_mass"):
        shapes = tuple(replace(shape, placed=True) for shape in shapes)
    common = {
        "name": values["name"],
        "motion": motion,
        "shapes": shapes,
        "pose": read_pose(values, place),
        "placed": place.follows(*POSE_KEYS),
    }
    if motion == "planar":
        common |= {"motion": "dynamic", "normal": _unit(values["normal"], place.key("normal"))}
    if motion == "driven":
        return Body(path=_path(values["path"], place.key("path")), **common)
    if motion == "fixed":
        return Body(**common)
    _check_mass(values, shapes, place)
    return Body(
        mass=values["mass"],
        density=values["density"],
        inertia=values["inertia"],
        center_of_mass=values["center_of_mass"] or ZERO,
        velocity=values["velocity"],
        angular_velocity=values["angular_velocity"],
        **common,
    )


def _unit(vector: Vector, place: Place) -> Vector:
    length = hypot(*vector)
    if not length > 0:
        raise place.error("a normal of length zero", "any other [x, y, z] is allowed", "write [0, 0, 1]")
    x, y, z = (each / length for each in vector)
    return x, y, z


def read_body(values: Mapping[str, Any], place: Place) -> Body:
    """The body from the values of its table, shapes included; raises SceneError."""
    return body_of(values, tuple(read_shape(each, at) for at, each in values["shape"]), place)


def unique_names(bodies: Iterable[Body], place: Place) -> None:
    """Raises SceneError where two bodies share a name."""
    _check_unique("body", (each.name for each in bodies), place)


def _check_unique(noun: str, names: Iterable[str], place: Place) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise place.item(index).error(f"a second {noun} named {name!r}", "", "give it another name")
        seen.add(name)


def _check_mass(values: Mapping[str, Any], shapes: tuple[Shape, ...], place: Place) -> None:
    if values["density"] is not None:
        _check_solid(shapes, place.key("density"))
        remark_on_density(values["density"], place.key("density"))
        return
    for key, other in (("mass", "inertia"), ("inertia", "mass")):
        if values[key] is None:
            raise place.error(
                f"a dynamic body without {key}", "mass and inertia, or density, are needed",
                f"add {key}" + ("" if values[other] is not None else f" and {other}, or density"),
            )  # fmt: skip


def _check_solid(shapes: tuple[Shape, ...], place: Place) -> None:
    if not shapes:
        raise place.error("a density without a shape", "", "add a shape, or give mass and inertia")
    for each in shapes:
        if each.kind == "solid":
            found = f"a density, but the volume of the user's own solid {each.name!r} is not computed"
            raise place.error(found, "density needs shapes of the catalogue", "give mass and inertia instead")
        if each.cavity or not _is_closed(each):
            what = "the cavity" if each.cavity else f"the {each.kind}"
            raise place.error(
                f"a density, but {what} {each.name!r} bounds no finite solid",
                "density needs closed shapes", _closing(each),
            )  # fmt: skip


def _closing(shape: Shape) -> str:
    """How to get a mass for a body with an open shape: some end where a further number is given."""
    ends = [field.key for field in SHAPES[shape.kind].optional] if shape.kind in SHAPES else []
    if shape.cavity or not ends:
        return "give mass and inertia instead"
    return f"add {' and '.join(ends)}, or give mass and inertia instead"


def _is_closed(shape: Shape) -> bool:
    if shape.kind in SOLIDS:
        return SOLIDS[shape.kind].closed
    spec = SHAPES.get(shape.kind)
    if spec is None:
        return shape.chart is not None or (isinstance(shape.spline, Net) and all(shape.spline.periodic))
    return spec.closed or len(shape.parameters) > len(spec.parameters)


def _path(values: Mapping[str, Any], place: Place) -> Path:
    found = []
    for key in ("position", "rotation_vector"):
        at = place.key(key)
        found.append(triple(values[key], motion_names(at), at))
        for index, expression in enumerate(found[-1]):
            check_motion(expression, at.item(index))
            finite(expression, motion_start(at), at.item(index))
    position, rotation = found
    return Path(position, rotation)
