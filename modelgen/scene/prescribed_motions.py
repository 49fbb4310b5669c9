"""Prescribed motions: expressions of time and of inputs that are continuous in time."""

from __future__ import annotations

from modelgen.scene.expression import Expression
from modelgen.scene.source_location import Place

TIME = "t"


def motion_names(place: Place) -> tuple[str, ...]:
    """The names that a prescribed motion may use: time and inputs."""
    return (TIME, *(each.name for each in place.inputs))


def motion_start(place: Place) -> dict[str, float]:
    """Values of these names at the start: t = 0 and the defaults of the inputs."""
    return {TIME: 0.0} | {each.name: each.default for each in place.inputs}


def check_motion(expression: Expression, place: Place) -> None:
    """Raises SceneError where a motion depends on an input that jumps."""
    for each in place.inputs:
        if each.name in expression.names and each.hold != "linear":
            raise place.error(
                f"the input {each.name!r}, which jumps from value to value (hold = {each.hold!r})",
                "a motion is continuous: it may use t and inputs with hold = 'linear'",
                f"give the input {each.name!r} hold = 'linear', or use it in a force",
            )
