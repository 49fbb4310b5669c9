"""What is remarkable about the shapes that touch: where they are singular, or have no curvature."""

from __future__ import annotations

from modelgen.geometry.declared import declared_limits
from modelgen.geometry.regular import check_regular
from modelgen.scene.types import Scene


def soundness(scene: Scene) -> tuple[str, ...]:
    """Warnings on the shapes that may touch, each named `body/shape`; SceneError where none could run."""
    touching = {partner for pair in scene.contacts for partner in pair.between}
    return tuple(
        f"{body.name}/{shape.name}: {text}"
        for body in scene.bodies
        for shape in body.shapes
        if (body.name, shape.name) in touching
        for text in (*check_regular(shape), *declared_limits(shape))
    )
