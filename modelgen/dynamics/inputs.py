"""Inputs as expressions of time: each is held, or follows a line, from its last setting on."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from modelgen.model import InputKind
from modelgen.notation import SETTING_SIZE


def input_argument(inputs: Sequence[InputKind]) -> dict[str, ca.SX]:
    """The argument `inputs` (3 n) of a kernel, the settings of n inputs; empty where there are none."""
    return {"inputs": ca.SX.sym("inputs", SETTING_SIZE * len(inputs))} if inputs else {}


def input_values(inputs: Sequence[InputKind], t: ca.SX, argument: dict[str, ca.SX]) -> dict[str, ca.SX]:
    """The value of each input at time t, by name."""
    values = {}
    for k, kind in enumerate(inputs):
        value, rate, since = ca.vertsplit(argument["inputs"][SETTING_SIZE * k : SETTING_SIZE * (k + 1)])
        values[kind.name] = value if kind.hold == "zero" else value + rate * (t - since)
    return values
