"""The options of commands that run a scene, as keywords of `simulate`."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import modelgen
from modelgen.cli.option_reading import read_option, read_values
from modelgen.cli.options import (
    Estimated,
    Fallback,
    InputValues,
    Method,
    Quality,
    Scheme,
    Solver,
    Step,
    Tolerance,
    Until,
    Values,
)


@dataclass(frozen=True)
class CommonRunOptions:
    """What every command that runs a scene lets one choose: the end, the accuracy, numbers of the scene."""

    until: Until = None
    accuracy: Quality = None
    values: Values = None
    inputs: InputValues = None

    def settings(self) -> dict[str, Any]:
        """What is given, as keywords of `simulate`. Raises ModelgenError where an option cannot be read."""
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        found = {
            "parameters": read_values(given.pop("values"), "--set"),
            "inputs": read_values(given.pop("inputs"), "--input"),
            "accuracy": accuracy_of(given.pop("accuracy"), given.pop("tolerance", None)),
        }
        for name, value in given.items():
            found[name] = read_option(name, value) if isinstance(value, str) else value
        return {name: value for name, value in found.items() if value not in (None, {})}


@dataclass(frozen=True)
class RunOptions(CommonRunOptions):
    """And the method, the step, what follows a failure, whether the error is told."""

    tolerance: Tolerance = None
    method: Method = None
    step: Step = None
    scheme: Scheme = None
    solver: Solver = None
    fallback: Fallback = None
    estimate: Estimated = None


def accuracy_of(name: str | None, tolerance: str | None) -> str | modelgen.Accuracy | None:
    """The accuracy of `--accuracy`, or that of `--tolerance` where it is given."""
    own, read = read_option("tolerance", tolerance), read_option("accuracy", name)
    return read if own is None else modelgen.Accuracy.of(own)
