"""From a scene file to a compiled model of rigid bodies in smooth contact, and its trajectory.

The street is read -> require -> derive -> emit -> build -> simulate: one value between two verbs.
`modelgen.require` and the other verbs are always the functions; their modules load on first use.
`measure` finds what accuracy of a scene costs, `tune` picks a setting from that.
`record_of` joins a trajectory and its library to what `save` writes, `load` reads and `draw` draws.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from modelgen.codegen.build import build as build
    from modelgen.codegen.emit import emit as emit
    from modelgen.derive import derive as derive
    from modelgen.errors import ModelgenError as ModelgenError
    from modelgen.measure import measure as measure
    from modelgen.measure import tune as tune
    from modelgen.report.export import load as load
    from modelgen.report.export import save as save
    from modelgen.report.linear import linearise as linearise
    from modelgen.report.plot import draw as draw
    from modelgen.report.record import record_of as record_of
    from modelgen.require import require as require
    from modelgen.runtime.accuracy import Accuracy as Accuracy
    from modelgen.runtime.batch import simulate_batch as simulate_batch
    from modelgen.runtime.nearest import closest_points as closest_points
    from modelgen.runtime.simulate import simulate as simulate
    from modelgen.scene.read import read as read

__version__ = "0.1.0"
__all__ = [
    "Accuracy",
    "ModelgenError",
    "build",
    "closest_points",
    "derive",
    "draw",
    "emit",
    "linearise",
    "load",
    "measure",
    "read",
    "record_of",
    "require",
    "save",
    "simulate",
    "simulate_batch",
    "tune",
]

_HOMES = {
    "read": "modelgen.scene.read",
    "require": "modelgen.require",
    "derive": "modelgen.derive",
    "emit": "modelgen.codegen.emit",
    "build": "modelgen.codegen.build",
    "simulate": "modelgen.runtime.simulate",
    "closest_points": "modelgen.runtime.nearest",
    "simulate_batch": "modelgen.runtime.batch",
    "linearise": "modelgen.report.linear",
    "measure": "modelgen.measure",
    "tune": "modelgen.measure",
    "record_of": "modelgen.report.record",
    "save": "modelgen.report.export",
    "load": "modelgen.report.export",
    "draw": "modelgen.report.plot",
    "Accuracy": "modelgen.runtime.accuracy",
    "ModelgenError": "modelgen.errors",
}


class _Street(ModuleType):
    """A package whose verbs load when they are first asked for."""

    def __getattr__(self, name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        value = getattr(import_module(_HOMES[name]), name)
        setattr(self, name, value)
        return value

    def __dir__(self) -> list[str]:
        return [*__all__, "__version__"]

    def __setattr__(self, name: str, value: object) -> None:
        """Importing modelgen/require.py must not put the module in the place of the function."""
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Street
