"""The one table of forms: when each applies, where it is regular, what its eta is, and its kernels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import casadi as ca

from modelgen.contact import form_builders
from modelgen.contact.contact_symbols import Layout
from modelgen.contact.kernels import ContactKernels
from modelgen.contact.parametrisations import (
    centre_curve_layout,
    centre_surface_layout,
    chart_layout,
    curve_chart_layout,
    curve_point_layout,
    curves_layout,
    edges_layout,
    mixed_layout,
    no_layout,
    point_layout,
)
from modelgen.contact.plane_support import support_of
from modelgen.contact.sphere_centres import has_centre
from modelgen.errors import SceneError
from modelgen.geometry.curves import CURVES, is_curve, is_straight
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import SURFACES, surface_of
from modelgen.model import ContactKind, Rows, ShapeKind, Side
from modelgen.name_suggestions import nearest


@dataclass(frozen=True)
class Form:
    """One way to write the equations of a contact, for a pair of shapes in canonical order."""

    name: str
    applies: Callable[[ShapeKind, ShapeKind], bool]
    regular: Callable[[Layout, ShapeKind, ShapeKind], bool]  # given that it applies
    layout: Callable[[ShapeKind, ShapeKind], Layout]
    build: Callable[[ContactKind], ContactKernels]
    citation: str
    angle: Callable[[ContactKind], ca.Function] | None = None  # psi and psi_dot, where the form has frames


def _is_plane(shape: ShapeKind) -> bool:
    return shape.kind == "plane"


def _has_equation(shape: ShapeKind) -> bool:
    return _is_surface(shape) and surface_of(shape).implicit is not None


def _is_surface(shape: ShapeKind) -> bool:
    return not is_curve(shape) and not is_point(shape)


def _plane_and_support(o: ShapeKind, f: ShapeKind) -> bool:
    return _is_plane(o) and support_of(f) is not None and not f.cavity


def _have_centres(o: ShapeKind, f: ShapeKind) -> bool:
    spheres = o.kind == "sphere" and has_centre(f) and not (o.cavity and f.cavity)
    return spheres or (has_centre(f) and _plane_and_support(o, f))


def _centre_and_surface(o: ShapeKind, f: ShapeKind) -> bool:
    return _is_surface(o) and not _is_plane(o) and (has_centre(f) or (has_centre(o) and _is_surface(f)))


def _centre_and_curve(o: ShapeKind, f: ShapeKind) -> bool:
    return (has_centre(o) and is_curve(f)) or (is_curve(o) and has_centre(f))


def _two_edges(o: ShapeKind, f: ShapeKind) -> bool:
    return is_straight(o) and is_straight(f)


def _not_two_planes(o: ShapeKind, f: ShapeKind) -> bool:
    return _is_surface(o) and _is_surface(f) and not _is_plane(f)


def _curve_on_equation(o: ShapeKind, f: ShapeKind) -> bool:
    return _has_equation(o) and is_curve(f)


def _curve_on_surface(o: ShapeKind, f: ShapeKind) -> bool:
    return _is_surface(o) and is_curve(f)


def _two_curves(o: ShapeKind, f: ShapeKind) -> bool:
    return is_curve(o) and is_curve(f)


def _always(layout: Layout, o: ShapeKind, f: ShapeKind) -> bool:
    return True


def _without_poles(layout: Layout, o: ShapeKind, f: ShapeKind) -> bool:
    """Whether every chart used as a parametrisation is regular everywhere, or has no alternative."""
    sides = zip(layout, (o, f), strict=True)
    return all(surface_of(shape).chart_regular for each, shape in sides if each == "chart")


def _never(layout: Layout, o: ShapeKind, f: ShapeKind) -> bool:
    """Singular where the pair itself is regular."""
    return False


def _bent(layout: Layout, o: ShapeKind, f: ShapeKind) -> bool:
    """As `_without_poles`, and not a straight line on a plane, which touches it nowhere or all along."""
    return not (_is_plane(o) and is_straight(f)) and _without_poles(layout, o, f)


def _have_equations(o: ShapeKind, f: ShapeKind) -> bool:
    return _has_equation(o) and _has_equation(f) and not _is_plane(f)


def _has_one_equation(o: ShapeKind, f: ShapeKind) -> bool:
    return (_has_equation(o) or _has_equation(f)) and _not_two_planes(o, f)


_ROW = "Lemma 3.1, Corollary 3.2 (signs corrected)"
_TABLE = (
    Form(
        "explicit", _have_centres, _always, no_layout, form_builders.build_explicit,
        f"{_ROW} for two centres, or a centre and a plane",
    ),
    Form(
        "support", _plane_and_support, _always, no_layout, form_builders.build_support,
        f"{_ROW} for a plane and a support map",
    ),
    Form(
        "implicit", _have_equations, _always, point_layout, form_builders.build_implicit,
        f"Theorem 4.1, {_ROW} in one tangent frame; eta = points of implicit surfaces",
    ),
    Form(
        "mixed", _has_one_equation, _without_poles, mixed_layout, form_builders.build_mixed,
        f"Theorem 4.1, {_ROW} in one tangent frame; eta = a point and chart coordinates",
    ),
    Form(
        "block", _not_two_planes, _without_poles, chart_layout, form_builders.build_block,
        f"Theorem 4.1 as the block form of the extremality system, {_ROW}; eta = two charts",
    ),
    Form(
        "paper", _not_two_planes, _without_poles, chart_layout, form_builders.build_paper,
        f"Theorem 4.1, Lemma 4.2, {_ROW}; eta = two charts",
        angle=form_builders.build_angle,
    ),
    Form(
        "differentiated", _not_two_planes, _without_poles, chart_layout, form_builders.build_differentiated,
        "implicit differentiation of the extremality system that replaces (2.1); eta = two charts",
    ),
    Form(
        "curve_implicit", _curve_on_equation, _bent, curve_point_layout, form_builders.build_curve_implicit,
        f"Theorem 4.6, {_ROW} in one tangent frame; eta = a point and a curve parameter",
    ),
    Form(
        "curve_block", _curve_on_surface, _bent, curve_chart_layout, form_builders.build_curve_block,
        f"Theorem 4.6 as the block form of the system, {_ROW}; eta = a chart and a curve parameter",
    ),
    Form(
        "curve_paper", _curve_on_surface, _bent, curve_chart_layout, form_builders.build_curve_paper,
        f"Theorem 4.6, Lemma 4.2, {_ROW}; eta = a chart and a curve parameter",
        angle=form_builders.build_curve_angles,
    ),
    Form(
        "curve_differentiated", _curve_on_surface, _bent, curve_chart_layout,
        form_builders.build_curve_differentiated,
        "implicit differentiation of the system of a curve and a surface; eta = chart and curve parameter",
    ),
    Form(
        "curves_block", _two_curves, _always, curves_layout, form_builders.build_curves_block,
        f"Theorem 4.3, Lemma 4.4 in block form, {_ROW}; eta = two curve parameters and two signs",
    ),
    Form(
        "curves_paper", _two_curves, _never, curves_layout, form_builders.build_curves_paper,
        f"Theorem 4.3, Corollary 4.5, {_ROW}; eta = two curve parameters and two signs",
        angle=form_builders.build_curves_angles,
    ),
    Form(
        "curves_differentiated", _two_curves, _always, curves_layout,
        form_builders.build_curves_differentiated,
        "implicit differentiation of the extremality system of two curves; eta = as curves_block",
    ),
    Form(
        "centre_surface", _centre_and_surface, _without_poles, centre_surface_layout,
        form_builders.build_centre_surface,
        f"Theorem 4.1 for a sphere or a point, {_ROW}; eta = the point of the surface, or its chart",
    ),
    Form(
        "centre_curve", _centre_and_curve, _always, centre_curve_layout, form_builders.build_centre_curve,
        f"Theorem 4.6 for a sphere or a point, {_ROW}; eta = a curve parameter",
    ),
    Form(
        "edge_edge", _two_edges, _always, edges_layout, form_builders.build_edge_edge,
        f"Theorem 4.3 for straight edges in closed form, {_ROW}; eta = the sign of the normal",
    ),
)  # fmt: skip

FORMS: Mapping[str, Form] = {form.name: form for form in _TABLE}

_RANK = {name: rank for rank, name in enumerate((*SURFACES, "chart", *CURVES, "curve", "point"))}


def order(a: ShapeKind, b: ShapeKind) -> bool:
    """True if (a, b) must be swapped to stand as (o, f): planes first, points last."""
    return _RANK[a.kind] > _RANK[b.kind]


def eta_layout(kind: ContactKind) -> Layout:
    """What carries the points of o and f in eta: keys of `notation.ETA_SIZE`."""
    return FORMS[kind.form].layout(kind.o.shape, kind.f.shape)


def regular_forms(o: Side, f: Side) -> tuple[str, ...]:
    """Names of the forms that apply to the pair and have no singularity of their own."""
    pair = (o.shape, f.shape)
    return tuple(
        form.name for form in _TABLE if form.applies(*pair) and form.regular(form.layout(*pair), *pair)
    )


@cache
def contact_kernels(kind: ContactKind) -> ContactKernels:
    """The kernels `mg_<name>_rates` and `mg_<name>_place`; SceneError if the kind's form does not apply."""
    where = f"contact {kind.o.shape.name}-{kind.f.shape.name}"
    form = FORMS.get(kind.form)
    if form is None:
        known = "forms: " + " ".join(FORMS)
        raise SceneError(where, f"no form {kind.form!r}", known, nearest(kind.form, FORMS))
    if not form.applies(kind.o.shape, kind.f.shape):
        fitting = [name for name, other in FORMS.items() if other.applies(kind.o.shape, kind.f.shape)]
        refuse_points(kind.o.shape, kind.f.shape)
        raise SceneError(where, f"the form {kind.form!r} does not apply", "forms: " + " ".join(fitting))
    return form.build(kind)


def refuse_points(o: ShapeKind, f: ShapeKind) -> None:
    """Raises SceneError for a point against a point, which no form describes."""
    if is_point(o) and is_point(f):
        raise SceneError(
            f"contact {o.name}-{f.name}",
            "two points have no normal where they touch, and their distance is never negative: "
            "no contact of theirs can close",
            "a point touches surfaces; a sphere touches points too",
            "give one of the points a radius: make it a sphere",
        )


@cache
def choose_form(o: Side, f: Side, rows: Rows = 1) -> str:
    """The regular form whose rates take the fewest instructions; SceneError if there is none."""
    refuse_points(o.shape, f.shape)
    names = regular_forms(o, f)
    if not names:
        raise no_isolated_points(f"contact {o.shape.name}-{f.shape.name}", o.shape.kind, f.shape.kind)
    return min(names, key=lambda name: instructions(ContactKind("candidate", name, o, f, rows)))


def no_isolated_points(where: str, a: str, b: str) -> SceneError:
    """The error of two kinds of shapes that touch along a line or all over."""
    return SceneError(
        where,
        f"no form has isolated contact points for {a} and {b}",
        "shapes that touch in points, or solids, whose faces rest on each other",
        "give one ends: a box for a plane, a segment for a line, a frustum for a cone, a cylinder a length",
    )


def instructions(kind: ContactKind) -> int:
    """Instruction count of the kind's rates."""
    return int(contact_kernels(kind).rates.n_instructions())
