"""Scenes of one kind of contact or joint, to be inspected. Lengths in them are parameters of the formulas."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.contact.form_table import FORMS
from modelgen.errors import ModelgenError
from modelgen.joint.joint_equations import FORMS as JOINTS
from modelgen.name_suggestions import nearest
from modelgen.scene.expression import parse_expression
from modelgen.scene.joint_format import ARMATURE
from modelgen.scene.scene_types import Body, ContactPair, Joint, Pose, Scene, Shape, Vector
from modelgen.scene.shape_catalogue import SHAPES

MOTION = parse_expression("0.2*sin(3*t)", ("t",))
TEETH = (17.0, 40.0)
INERTIAS = (0.2, 0.3, 0.5)  # of the rates of a joint that may have an armature
NONE: Mapping[str, float] = {}
SPRUNG = ("revolute", "prismatic", "cylindrical", "universal", "screw")
LIMITED: Mapping[str, dict[str, Any]] = {  # bounds of the first coordinate, and of the second
    **{kind: {"limits": (-1.0, 1.0)} for kind in SPRUNG},
    "rope": {"limits": (0.1, 1.0)},
    "spherical": {"limits": (0.1, 1.0)},
    "planar": {"limits": (-1.0, 1.0), "limits_y": (-0.5, 0.5)},
}


def kind_scene(kind: str) -> Scene:
    """A scene of the kind "shape-shape", "shape-shape:form", "joint", "joint:motion" or "joint:armature",
    both bodies free.

    Raises ModelgenError if there is no such kind.
    """
    name, _, extra = kind.partition(":")
    return joint_scene(name, extra) if name in JOINTS else pair_scene(kind)


def joint_scene(name: str, extra: str) -> Scene:
    """One joint with limits and a spring where it takes them, or with a given motion, or with armature."""
    form = JOINTS[name]
    extras = [*(["motion"] if form.given else []), *(["armature"] if name in ARMATURE else [])]
    if extra not in ("", *extras):
        allowed = ", ".join(f"{name}:{each}" for each in extras)
        allowed = allowed or f"{name} alone: its motion cannot be given, and it has no armature"
        raise ModelgenError("inspect", f"no kind '{name}:{extra}'", allowed, "")
    far = name in ("distance", "rope")
    frames = (Pose((0.3, 0.0, 0.1)), Pose((-0.2, 0.1, 0.0)))
    joint = Joint("joint", name, ("a", "b"), frames, _numbers(name), **_optional(name, extra))
    place = {"a": (0.0, 0.0, 0.0), "b": (1.3 if far else 0.5, -0.1, 0.1)}
    bodies = tuple(_sample_body(each, None, position) for each, position in place.items())
    return Scene(name if not extra else f"{name}:{extra}", "inspect", bodies, (), joints=(joint,))


def _numbers(name: str) -> tuple[float, ...]:
    at_rest = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    return {"screw": (0.2,), "distance": (0.8,), "gear": (*TEETH, *at_rest, *at_rest)}.get(name, ())


def _optional(name: str, extra: str) -> dict[str, Any]:
    if extra == "motion":
        return {"motion": MOTION}
    if extra == "armature":
        return {"armature": INERTIAS[: len(ARMATURE[name])]}
    limits = {**LIMITED[name], "restitution": 0.5} if name in LIMITED else {}
    return {**limits, "stiffness": 40.0, "damping": 0.7, "rest": 0.3} if name in SPRUNG else limits


def pair_scene(kind: str, lengths: Mapping[str, Mapping[str, float]] | None = None) -> Scene:
    """A scene with one contact of the kind "shape-shape" or "shape-shape:form", both bodies free.

    Lengths in it are parameters of the formulas: those of the shapes of bodies `o` and `f` by name, and
    arbitrary ones where none are given.
    """
    pair, _, form = kind.partition(":")
    shapes = pair.split("-")
    if len(shapes) != 2 or not all(shape in SHAPES for shape in shapes):
        unknown = next((shape for shape in shapes if shape not in SHAPES), kind)
        allowed = (
            f"the file of a scene; a pair SHAPE-SHAPE or SHAPE-SHAPE:FORM of the shapes {', '.join(SHAPES)}; "
            f"a joint JOINT or JOINT:motion of {', '.join(JOINTS)}"
        )
        raise ModelgenError("inspect", f"no kind {kind!r}", allowed, nearest(unknown, (*SHAPES, *JOINTS)))
    if form and form not in FORMS:
        raise ModelgenError(
            "inspect", f"no form {form!r}", f"forms: {', '.join(FORMS)}", nearest(form, FORMS)
        )
    known = lengths or {}
    bodies = tuple(
        _sample_body(name, shape, lengths=known.get(name, {}))
        for name, shape in zip("of", shapes, strict=True)
    )
    between = (("o", "shape"), ("f", "shape"))
    return Scene(kind, "inspect", bodies, (ContactPair(between, form=form or "auto"),))


def _sample_body(
    name: str, shape: str | None, position: Vector = (0.0, 0.0, 0.0), lengths: Mapping[str, float] = NONE
) -> Body:
    inertia = ((3.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 5.0))
    shapes = _sample_shape(shape, lengths)
    return Body(name, "dynamic", shapes, mass=1.0, inertia=inertia, pose=Pose(position))


def _sample_shape(shape: str | None, lengths: Mapping[str, float]) -> tuple[Shape, ...]:
    if shape is None:
        return ()
    names = SHAPES[shape].parameters
    return (
        Shape(
            shape, tuple((each, lengths.get(each, float(len(names) + 1 - i))) for i, each in enumerate(names))
        ),
    )
