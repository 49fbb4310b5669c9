"""Centres for the laws, and every pair of one with a surface or a curve."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from modelgen.contact.form_table import FORMS
from modelgen.model import ContactKind, ShapeKind, Side
from tests.curves.specimens import ALL
from tests.laws.shapes import Specimen


@dataclass(frozen=True)
class Centred:
    """A point, a ball or a spherical cavity: the centre in its shape frame and the signed radius."""

    kind: ShapeKind
    parameters: tuple[float, ...]
    at: tuple[float, float, float]
    radius: float


CENTRES = {
    "vertex": Centred(ShapeKind("vertex", "point", ("x", "y", "z")), (0.3, -0.4, 0.5), (0.3, -0.4, 0.5), 0.0),
    "ball": Centred(ShapeKind("ball", "sphere", ("radius",)), (0.6,), (0.0, 0.0, 0.0), 0.6),
    "hollow": Centred(ShapeKind("hollow", "sphere", ("radius",), True), (1.9,), (0.0, 0.0, 0.0), -1.9),
}
SURFACES = (
    "plane", "plane_cavity", "sphere", "sphere_cavity", "ellipsoid", "ellipsoid_cavity", "torus", "cylinder",
    "paraboloid", "superellipsoid", "patch", "patch_cavity",
)  # fmt: skip
CURVES = ("line", "segment", "rod", "circle", "ellipse_curve", "helix", "wave", "edge")
_CONVEX = ("sphere", "ellipsoid", "patch")
PAIRS = [
    *product(SURFACES, ("vertex", "ball")), *product(_CONVEX, ("hollow",)), *product(CURVES, CENTRES)
]  # fmt: skip
CASES = [
    (o, f, form.name)
    for o, f in PAIRS
    for form in FORMS.values()
    if form.applies(ALL[o].kind, CENTRES[f].kind) and form.name.startswith(("explicit", "support", "centre"))
]


def is_surface(o: str) -> bool:
    return isinstance(ALL[o], Specimen)


def kind_of(o: str, f: str, form: str, swapped: bool = False) -> ContactKind:
    """A contact kind of two free bodies; swapped: with the centre on o."""
    one, two = Side(ALL[o].kind, "free"), Side(CENTRES[f].kind, "free")
    return ContactKind("law", form, *((two, one) if swapped else (one, two)))
