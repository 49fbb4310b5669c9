"""How far a shape reaches, surface or curve."""

from __future__ import annotations

from modelgen.geometry.catalogue import surface_of
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.scene.types import Shape


def bounding_radius(shape: Shape) -> float:
    """Radius (m) about the shape's origin; infinite for what has no bound."""
    numbers = [value for _, value in shape.parameters]
    return (curve_of(shape) if is_curve(shape) else surface_of(shape)).bounding(numbers)
