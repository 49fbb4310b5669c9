"""The inputs that the kernel of an expression takes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from modelgen.model import InputKind
from modelgen.scene.expression import Expression
from modelgen.scene.scene_types import Input


def inputs_of_expressions(
    inputs: Sequence[Input], expressions: Iterable[Expression]
) -> tuple[InputKind, ...]:
    """All inputs of the scene, in order, if an expression uses one of them; else none."""
    if any(each.name in expression.names for expression in expressions for each in inputs):
        return tuple(InputKind(each.name, each.hold) for each in inputs)
    return ()
