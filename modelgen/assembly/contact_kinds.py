"""The kind of contact of a pair of shapes: the canonical order (o, f), the sides, and the form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from modelgen.assembly.friction_constraints import rows_of
from modelgen.assembly.masses import pose_numbers
from modelgen.contact.form_table import FORMS, choose_form, order, refuse_points
from modelgen.errors import SceneError
from modelgen.model import BodyMotion, ContactKind, Rows, ShapeKind, Side
from modelgen.name_suggestions import nearest
from modelgen.scene.contacts_and_loads import pair_names
from modelgen.scene.scene_types import IDENTITY_QUATERNION, Body, ContactPair, Scene, Shape, Vector

SUFFIX: Mapping[Rows, tuple[str, ...]] = {1: (), 3: ("slip",), 6: ("spin",)}


@dataclass(frozen=True, slots=True)
class Owner:
    """A body that takes part in a contact, with its motion and mass."""

    body: int
    motion: BodyMotion
    at_world: bool  # a fixed body whose frame is the world's
    centre: Vector  # of mass, body axes as written
    fold: bool  # numbers become constants


@dataclass(frozen=True)
class Partner:
    """A smooth shape of a body in a contact."""

    owner: Owner
    shape: Shape
    kind: ShapeKind

    @cached_property
    def side(self) -> Side:
        moved = self.shape.pose.position != self.owner.centre or not self._is_straight
        placed = moved or self.shape.repeated or self.shape.placed
        return Side(
            self.kind,
            self.owner.motion,
            "identity" if self.owner.motion == "fixed" and self.owner.at_world else "general",
            "general" if placed else "identity",
        )

    @property
    def _is_straight(self) -> bool:
        return self.shape.kind == "sphere" or self.shape.pose.quaternion == IDENTITY_QUATERNION

    @cached_property
    def parameters(self) -> tuple[float, ...]:
        """Parameters of the shape unless they are folded into the kernels, then its placement (12) unless it
        is the identity."""
        lengths = () if self.kind.folded is not None else tuple(value for _, value in self.shape.parameters)
        placed = self.side.placement == "general"
        return lengths + (pose_numbers(self.shape.pose, self.owner.centre) if placed else ())


def shape_kind(shape: Shape, fold: bool) -> ShapeKind:
    """The structure of a shape, named after its kind."""
    names = tuple(name for name, _ in shape.parameters)
    folded = tuple(value for _, value in shape.parameters) if fold else None
    name = f"{shape.kind}_cavity" if shape.cavity else shape.kind
    return ShapeKind(name, shape.kind, names, shape.cavity, shape.chart, shape.curve, folded)


def contact_names(scene: Scene) -> tuple[str, ...]:
    """`a-b`, or `a/shape-b/shape` where two bodies touch with several shapes."""
    return pair_names(scene.contacts)


def find_shape(body: Body, name: str, where: str) -> Shape:
    """The shape of that name; raises SceneError."""
    shapes = {shape.name: shape for shape in body.shapes}
    if name not in shapes:
        raise SceneError(
            where,
            f"body {body.name!r} has no shape {name!r}",
            f"shapes: {', '.join(shapes)}",
            nearest(name, shapes),
        )
    return shapes[name]


def find_body(scene: Scene, name: str, where: str) -> int:
    """The index of the body of that name; raises SceneError."""
    names = [body.name for body in scene.bodies]
    if name not in names:
        raise SceneError(
            where, f"no body named {name!r}", f"bodies: {', '.join(names)}", nearest(name, names)
        )
    return names.index(name)


def contact_kind_of(
    a: Partner, b: Partner, pair: ContactPair, where: str, rows: Rows | None = None
) -> tuple[ContactKind, bool]:
    """The kind of the contact with its sides in canonical order, and whether that order is (b, a)."""
    swapped = order(a.kind, b.kind)
    o, f = (b.side, a.side) if swapped else (a.side, b.side)
    rows = rows_of(pair) if rows is None else rows
    form = _form(o, f, rows, pair, where)
    name = "_".join([o.shape.name, f.shape.name, form, *SUFFIX[rows]])
    return ContactKind(name, form, o, f, rows), swapped


def place_of(pair: ContactPair, where: str) -> str:
    """The place of a pair in the scene, with the names of its bodies."""
    return f"{where} (contact {'-'.join(body for body, _ in pair.between)!r})"


def _form(o: Side, f: Side, rows: Rows, pair: ContactPair, where: str) -> str:
    wanted = pair.form
    try:
        refuse_points(o.shape, f.shape)
        if wanted == "auto":
            return choose_form(o, f, rows)
    except SceneError as error:
        raise SceneError(place_of(pair, where), error.found, error.allowed, error.remedy) from None
    fitting = [name for name, form in FORMS.items() if form.applies(o.shape, f.shape)]
    if wanted not in fitting:
        raise SceneError(
            f"{where}.form",
            f"the form {wanted!r} does not apply to {o.shape.kind} and {f.shape.kind}",
            f"allowed: {', '.join(['auto', *fitting])}",
            nearest(wanted, fitting),
        )
    return wanted
