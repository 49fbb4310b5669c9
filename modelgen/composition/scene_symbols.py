"""The arguments of the functions of a whole scene."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any

import casadi as ca

from modelgen.composition.contact_mode import friction_of_contacts
from modelgen.model import Model
from modelgen.notation import SETTING_SIZE

BLOCKS = ("bodies", "feature_pairs", "loads", "joints", "limits")  # with parameters, in their order
Expression = Any  # ca.SX or ca.MX


@dataclass(frozen=True)
class SceneSymbols:
    """Arguments: time, state, and numbers.

    `parameters`: those of bodies, feature pairs, loads, joints and limits, then two kinetic coefficients for
    each friction constraint of each contact (`parameter_values`).
    """

    t: Expression
    q: Expression
    u: Expression
    eta: Expression
    gravity: Expression
    parameters: Expression
    inputs: Expression  # settings of the inputs of the scene, if it has any

    @property
    def arguments(self) -> dict[str, Expression]:
        """By name, without what is empty for all scenes of a kind."""
        return {name: symbol for name, symbol in vars(self).items() if name != "inputs" or symbol.numel()}


@dataclass(frozen=True)
class SplitParameters:
    """The parameters of each body, feature pair and so on."""

    bodies: list[Expression]
    feature_pairs: list[Expression]
    loads: list[Expression]
    joints: list[Expression]
    limits: list[Expression]
    friction: list[Expression]


def scene_symbols(model: Model, symbol: Any) -> SceneSymbols:
    """Symbols of ca.SX or ca.MX."""
    return SceneSymbols(
        symbol.sym("t"),
        symbol.sym("q", model.n_q),
        symbol.sym("u", model.n_u),
        symbol.sym("eta", model.n_eta),
        symbol.sym("gravity", 3),
        symbol.sym("parameters", len(parameter_values(model))),
        symbol.sym("inputs", SETTING_SIZE * len(model.scene.inputs)),
    )


def parameter_values(model: Model) -> list[float]:
    """The values of `parameters` in the scene."""
    of_blocks = [value for name in BLOCKS for entry in getattr(model, name) for value in entry.parameters]
    return of_blocks + [value for _, each in friction_of_contacts(model) for value in each.kinetic]


def split_parameters(model: Model, parameters: Expression) -> SplitParameters:
    """The parts of `parameters`."""
    blocks = [getattr(model, name) for name in BLOCKS]
    sizes = [len(entry.parameters) for block in blocks for entry in block]
    sizes += [2] * len(friction_of_contacts(model))
    parts = iter([parameters[a:b] for a, b in pairwise(accumulate(sizes, initial=0))])
    counts = [*(len(block) for block in blocks), len(friction_of_contacts(model))]
    return SplitParameters(*([next(parts) for _ in range(count)] for count in counts))


def fitted(function: ca.Function, arguments: list[Expression]) -> list[Expression]:
    """Arguments cut to the sizes that the function takes; size 0 where it takes none."""
    sizes = [int(function.numel_in(k)) for k in range(function.n_in())]
    return [argument[:size] if size else ca.DM(0, 1) for argument, size in zip(arguments, sizes, strict=True)]
