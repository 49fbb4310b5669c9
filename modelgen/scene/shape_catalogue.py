"""The catalogue of shapes: names, parameters in the order of the generated C, keys and constraints.

Shape frames: plane z = 0 with exterior +z; sphere, ellipsoid and superellipsoid centred at the origin;
torus, cylinder and cone about z; paraboloid z = x^2/(2 rho_x) + y^2/(2 rho_y) with exterior +z.
A cavity has its material on the other side of the surface. Curves have no inside: line, segment and helix run
along z, edge along x, circle and ellipse_curve lie in the xy-plane about z. A point is a ball of radius 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from modelgen.scene.scalar_types import NUMBER, POSITIVE, Choice, ExpressionText, Lead, Real, Switch
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, NamedNumbers, Sequence

PARAMETER_NAMES = r"^(?!pi$|u$|v$)[A-Za-z](?!.*__)[A-Za-z0-9_]{0,31}$"
CURVE_PARAMETER_NAMES = r"^(?!pi$|t$)[A-Za-z](?!.*__)[A-Za-z0-9_]{0,31}$"


@dataclass(frozen=True, slots=True)
class ShapeSpec:
    """One shape of the catalogue.

    `parameters` in C order are the numbers of `fields`, read one after the other. `constraint` takes them
    in that order and returns how they break `rule`, or an empty text.
    """

    kind: str
    doc: str
    parameters: tuple[str, ...]
    fields: tuple[Field, ...]
    closed: bool  # bounds a finite volume
    implicit: bool  # has a smooth function that vanishes on the surface
    constraint: Callable[[tuple[float, ...]], str] = lambda values: ""
    rule: str = ""
    curve: bool = False  # a curve instead of a surface: no inside, no cavity
    point: bool = False  # a point instead of a surface
    optional: tuple[Field, ...] = ()  # numbers which, where written, make a composite shape of it

    def values(self, read: Mapping[str, Any]) -> tuple[float, ...]:
        """The parameters in C order from the fields as read."""
        flat: list[float] = []
        for field in self.fields:
            value = read[field.key]
            flat.extend(value if isinstance(value, tuple) else (value,))
        return tuple(flat)

    def numbers(self, read: Mapping[str, Any], place: Place) -> tuple[tuple[str, float], ...]:
        """Their names and values, optional ones last; raises SceneError where they break the rule."""
        flat = self.values(read)
        broken = self.constraint(flat)
        if broken:
            raise place.error(broken, self.rule)
        written = ((field.key, read[field.key]) for field in self.optional if read.get(field.key) is not None)
        return (*zip(self.parameters, flat, strict=True), *written)


def torus_constraint(values: tuple[float, ...]) -> str:
    major, minor = values
    return "" if major > minor else f"major {major:g} is not larger than minor {minor:g}"


def _paraboloid_constraint(values: tuple[float, ...]) -> str:
    flat = [value for value in values if abs(value) < POSITIVE.minimum]
    return f"the radius {flat[0]:g}" if flat else ""


def _curve(kind: str, doc: str, parameters: tuple[str, ...], fields: tuple[Field, ...]) -> ShapeSpec:
    return ShapeSpec(kind, doc, parameters, fields, closed=False, implicit=False, curve=True)


_SEMI_AXES = Field(
    "semi_axes", Sequence(POSITIVE, 3, "[a, b, c]"), "semi-axes [a, b, c] along x, y, z, m", required=True
)
_RADIUS = Field("radius", POSITIVE, "radius, m", required=True)
_COMPONENT = ExpressionText("expression of u, v and the parameters, m")

_CATALOGUE = (
    ShapeSpec("plane", "the plane z = 0, exterior +z", (), (), closed=False, implicit=True),
    ShapeSpec("sphere", "a sphere about the origin", ("radius",), (_RADIUS,), closed=True, implicit=True),
    ShapeSpec(
        "ellipsoid", "(x/a)^2 + (y/b)^2 + (z/c)^2 = 1", ("a", "b", "c"), (_SEMI_AXES,),
        closed=True, implicit=True,
    ),
    ShapeSpec(
        "torus", "a ring about z", ("major", "minor"),
        (
            Field("major", POSITIVE, "radius of the circle of tube centres, m", required=True),
            Field("minor", POSITIVE, "radius of the tube, m", required=True),
        ),
        closed=True, implicit=True, constraint=torus_constraint, rule="major must be larger than minor",
    ),
    ShapeSpec(
        "cylinder", "a cylinder about z, infinite without a length", ("radius",), (_RADIUS,),
        closed=False, implicit=True,
        optional=(Field("length", POSITIVE, "length from end to end, m; infinite if absent"),),
    ),
    ShapeSpec(
        "cone", "an infinite cone about z below its apex at the origin",
        ("half_angle",),
        (Field("half_angle", Real(1e-3, 1.57), "angle between axis and surface, rad", required=True),),
        closed=False, implicit=True,
    ),
    ShapeSpec(
        "paraboloid", "z = x^2/(2 rho_x) + y^2/(2 rho_y), exterior +z", ("rho_x", "rho_y"),
        (
            Field(
                "radii", Sequence(NUMBER, 2),
                "radii of curvature [rho_x, rho_y] at the origin, m, positive: a bowl", required=True,
            ),
        ),
        closed=False, implicit=True, constraint=_paraboloid_constraint, rule="radii must not be zero",
    ),
    ShapeSpec(
        "superellipsoid", "(|x/a|^p + |y/b|^p)^(q/p) + |z/c|^q = 1", ("a", "b", "c", "p", "q"),
        (
            _SEMI_AXES,
            Field("exponents", Sequence(Real(2.0, 64.0), 2), "exponents [p, q], from 2 up", required=True),
        ),
        closed=True, implicit=True,
    ),
    _curve("line", "the z axis, without ends", (), ()),
    _curve(
        "segment", "the z axis from -length/2 to length/2", ("length",),
        (Field("length", POSITIVE, "length, m", required=True),),
    ),
    _curve(
        "edge", "the x axis from -length/2 to length/2, parameter x in m", ("length",),
        (Field("length", POSITIVE, "length, m", required=True),),
    ),
    _curve("circle", "(radius cos t, radius sin t, 0)", ("radius",), (_RADIUS,)),
    _curve(
        "ellipse_curve", "(a cos t, b sin t, 0)", ("a", "b"),
        (Field("semi_axes", Sequence(POSITIVE, 2), "semi-axes [a, b] along x, y, m", required=True),),
    ),
    _curve(
        "helix", "(radius cos t, radius sin t, pitch t), without ends", ("radius", "pitch"),
        (
            _RADIUS,
            Field("lead", Lead(), "rise along z in a turn, m; negative: left-handed", required=True),
        ),
    ),
    ShapeSpec(
        "point", "a point by itself", ("x", "y", "z"),
        (Field("at", Sequence(NUMBER, 3), "[x, y, z] in the shape frame, m", default=(0.0, 0.0, 0.0)),),
        closed=False, implicit=False, point=True,
    ),
)  # fmt: skip

CHART_FIELDS = (
    Field("x", _COMPONENT, "x(u, v), m", required=True),
    Field("y", _COMPONENT, "y(u, v), m", required=True),
    Field("z", _COMPONENT, "z(u, v), m; d(x,y,z)/du x d(x,y,z)/dv points to the exterior", required=True),
    Field("domain", Sequence(Sequence(NUMBER, 2), 2), "[[u_min, u_max], [v_min, v_max]]", required=True),
    Field(
        "periodic", Sequence(Switch(), 2), "whether [u, v] wrap around their domain", default=(False, False)
    ),
    Field(
        "poles",
        Sequence(Choice(("u_min", "u_max", "v_min", "v_max")), None),
        "ends of the domain that are one point, about which the other coordinate turns",
        default=(),
    ),
    Field(
        "parameters",
        NamedNumbers(PARAMETER_NAMES, "a letter, then letters, digits, single _ (not pi, u, v) are allowed"),
        "named numbers that x, y, z may use",
        default=(),
    ),
)

REVOLUTION_PARAMETERS = NamedNumbers(
    r"^(?!pi$|t$|u$|v$)[A-Za-z](?!.*__)[A-Za-z0-9_]{0,31}$",
    "a letter, then letters, digits, single _ (not pi, t, u, v) are allowed",
)

_OF_T = ExpressionText("expression of t and the parameters, m")

CURVE_FIELDS = (
    *(Field(key, _OF_T, f"{key}(t), m", required=True) for key in "xyz"),
    Field("domain", Sequence(NUMBER, 2), "[t_min, t_max]", required=True),
    Field("periodic", Switch(), "whether t wraps around its domain", default=False),
    Field(
        "parameters",
        NamedNumbers(
            CURVE_PARAMETER_NAMES, "a letter, then letters, digits, single _ (not pi, t) are allowed"
        ),
        "named numbers that x, y, z may use",
        default=(),
    ),
)

SHAPES: Mapping[str, ShapeSpec] = {spec.kind: spec for spec in _CATALOGUE}
