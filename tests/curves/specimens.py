"""Curves for the laws, written a second time, and the pairs that they stand in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from modelgen.contact.form_table import FORMS
from modelgen.model import ContactKind, ShapeKind, Side
from modelgen.scene.expression import parse_expression
from modelgen.scene.scene_types import Curve
from tests.laws.shapes import SPECIMENS, Specimen, casteljau

WAVE = ("t", "k*sin(2*t)", "t**3/4 + t/5")  # an inflection of the projection, no arc length
CONTROLS = (0.1, -0.2, 0.0, 0.5, 0.3, 0.1, 0.9, 0.2, 0.5, 1.2, -0.3, 0.4)
EDGE = ("t + 3*t**3/10", "k*(t + 3*t**3/10)", "0.1")  # straight, run through at a varying speed


@dataclass(frozen=True)
class Bend:
    """A curve for the laws: its kind, its independent formula, lengths, and the range of its parameter."""

    kind: ShapeKind
    curve: Callable[[Any, Any, Any], list[Any]]
    parameters: tuple[float, ...]
    box: tuple[tuple[float, float]]


def _line(m: Any, t: Any, p: Any) -> list[Any]:
    return [0 * t, 0 * t, t]


def _segment(m: Any, t: Any, p: Any) -> list[Any]:
    return [0 * t, 0 * t, p[0] * t]


def _rod(m: Any, t: Any, p: Any) -> list[Any]:
    return [t, 0 * t, 0 * t]


def _ellipse(m: Any, t: Any, p: Any) -> list[Any]:
    return [p[0] * m.cos(t), p[1] * m.sin(t), 0 * t]


def _circle(m: Any, t: Any, p: Any) -> list[Any]:
    return _ellipse(m, t, [p[0], p[0]])


def _helix(m: Any, t: Any, p: Any) -> list[Any]:
    return [p[0] * m.cos(t), p[0] * m.sin(t), p[1] * t]


def _wave(m: Any, t: Any, p: Any) -> list[Any]:
    return [t, p[0] * m.sin(2 * t), t**3 / 4 + t / 5]


def _edge(m: Any, t: Any, p: Any) -> list[Any]:
    along = t + 3 * t**3 / 10
    return [along, p[0] * along, 0 * t + m.mpf("0.1") if hasattr(m, "mpf") else 0 * t + 0.1]


def _bezier(m: Any, t: Any, p: Any) -> list[Any]:
    return casteljau([[p[k] + (p[3 * n + k] if n else 0) for k in range(3)] for n in range(4)], t)


def _bend(name: str, curve: Any, names: str, parameters: tuple[float, ...], reach: float) -> Bend:
    texts = {"wave": WAVE, "edge": EDGE}.get(name)
    own = None
    if texts:
        x, y, z = (parse_expression(text, ("t", "k")) for text in texts)
        own = Curve((x, y, z), (-reach, reach))
    known = "curve" if own else {"rod": "edge"}.get(name, name)
    kind = ShapeKind(name, known, tuple(names.split()), curve=own)
    return Bend(kind, curve, parameters, ((-reach, reach),))


BENDS = {
    bend.kind.name: bend
    for bend in (
        _bend("line", _line, "", (), 1.0),
        _bend("segment", _segment, "length", (1.6,), 0.5),
        _bend("circle", _circle, "radius", (0.7,), 3.0),
        _bend("ellipse_curve", _ellipse, "a b", (0.9, 0.5), 3.0),
        _bend("helix", _helix, "radius pitch", (0.5, 0.15), 3.0),
        _bend("wave", _wave, "k", (0.4,), 1.0),
        _bend("edge", _edge, "k", (0.5,), 0.7),
        _bend("rod", _rod, "length", (1.8,), 0.9),
        _bend("bezier_curve", _bezier, " ".join(f"p{k}" for k in range(12)), CONTROLS, 0.9),
    )
}
STRAIGHT = ("line", "segment", "edge", "rod")
ALL: dict[str, Specimen | Bend] = {**SPECIMENS, **BENDS}

ON_SURFACES = [
    ("plane", "circle"), ("plane", "helix"), ("plane_cavity", "ellipse_curve"), ("sphere", "circle"),
    ("sphere", "line"), ("ellipsoid", "ellipse_curve"), ("ellipsoid", "segment"), ("ellipsoid", "helix"),
    ("ellipsoid_cavity", "circle"), ("sphere_cavity", "ellipse_curve"), ("sphere", "rod"), ("torus", "wave"),
    ("torus", "edge"), ("cylinder", "helix"),
    ("paraboloid", "circle"), ("superellipsoid", "ellipse_curve"), ("patch", "wave"), ("patch", "line"),
    ("cone", "circle"), ("ellipsoid", "bezier_curve"),
]  # fmt: skip
EDGES = [
    ("line", "line"), ("line", "segment"), ("line", "rod"), ("segment", "segment"), ("segment", "rod"),
    ("rod", "rod"),
]  # fmt: skip
ON_CURVES = [
    *EDGES, ("line", "edge"), ("line", "circle"), ("segment", "helix"), ("circle", "circle"),
    ("circle", "ellipse_curve"), ("ellipse_curve", "helix"), ("helix", "helix"), ("circle", "wave"),
    ("wave", "edge"), ("wave", "wave"), ("rod", "circle"),
    ("circle", "bezier_curve"),
]  # fmt: skip
PAIRS = [*ON_SURFACES, *ON_CURVES]
CASES = [
    (o, f, form.name) for o, f in PAIRS for form in FORMS.values() if form.applies(ALL[o].kind, ALL[f].kind)
]


def kind_of(o: str, f: str, form: str) -> ContactKind:
    """A contact kind of two free bodies."""
    return ContactKind("law", form, Side(ALL[o].kind, "free"), Side(ALL[f].kind, "free"))
