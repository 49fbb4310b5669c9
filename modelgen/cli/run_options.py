"""The options of commands that run a scene, as keywords of `simulate`."""

from __future__ import annotations

from dataclasses import dataclass
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
        return _given(
            until=read_option("until", self.until),
            accuracy=read_option("accuracy", self.accuracy),
            parameters=read_values(self.values, "--set"),
            inputs=read_values(self.inputs, "--input"),
        )


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

    def settings(self) -> dict[str, Any]:
        """What is given, as keywords of `simulate`. Raises ModelgenError where an option cannot be read."""
        return super().settings() | _given(
            accuracy=accuracy_of(self.accuracy, self.tolerance),
            method=read_option("method", self.method),
            step=read_option("step", self.step),
            scheme=read_option("scheme", self.scheme),
            solver=read_option("solver", self.solver),
            fallback=self.fallback,
            estimate=self.estimate,
        )


def _given(**settings: Any) -> dict[str, Any]:
    return {name: value for name, value in settings.items() if value not in (None, {})}


def accuracy_of(name: str | None, tolerance: str | None) -> str | modelgen.Accuracy | None:
    """The accuracy of `--accuracy`, or that of `--tolerance` where it is given."""
    own, read = read_option("tolerance", tolerance), read_option("accuracy", name)
    return read if own is None else modelgen.Accuracy.of(own)
