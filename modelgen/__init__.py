"""From a scene file to a compiled model of rigid bodies in smooth contact, and its trajectory.

The verbs are read -> require -> derive -> emit -> build -> simulate, with one value between two of them.
Their modules load when a verb is first asked for.
`start` begins a run that its caller drives, step by step, in place of `simulate`.
`sensitivity` runs a scene and differentiates what it shows, `gradient` a number that depends on it.
`as_casadi` makes CasADi functions of a scene's right-hand side and of a step.
`fit` finds numbers of a scene from recorded motion.
`sweep` runs a scene many times with other numbers; `load_sweep` reads the table that it wrote.
`linearise` finds the small motions about an equilibrium, `linearise_steady` those about a steady motion,
`stability` where such a motion is stable.
`measure` finds what accuracy of a scene costs, `tune` picks a setting from that.
`normal_rates` gives the rates of the contact normals at the samples of a trajectory.
`import_scene` makes a scene of a file of another program.
`record_of` joins a trajectory and its library to what `save` writes, `load` reads and `draw` draws.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from modelgen.assembly import require as require
    from modelgen.benchmark import measure as measure
    from modelgen.benchmark import tune as tune
    from modelgen.casadi_functions.as_casadi import as_casadi as as_casadi
    from modelgen.codegen.build import build as build
    from modelgen.codegen.emit import emit as emit
    from modelgen.derivation import derive as derive
    from modelgen.errors import ModelgenError as ModelgenError
    from modelgen.identification.fit import fit as fit
    from modelgen.importing.import_formats import import_scene as import_scene
    from modelgen.linearisation.equilibrium_and_modes import linearise as linearise
    from modelgen.linearisation.stability import stability as stability
    from modelgen.linearisation.steady_modes import linearise_steady as linearise_steady
    from modelgen.parameter_study.outcome_table import load_sweep as load_sweep
    from modelgen.parameter_study.sweep import sweep as sweep
    from modelgen.report.normal_rates import normal_rates as normal_rates
    from modelgen.report.run_files import load as load
    from modelgen.report.run_files import save as save
    from modelgen.report.run_plot import draw as draw
    from modelgen.report.run_record import record_of as record_of
    from modelgen.runtime.accuracy import Accuracy as Accuracy
    from modelgen.runtime.batch import simulate_batch as simulate_batch
    from modelgen.runtime.closest_points import closest_points as closest_points
    from modelgen.runtime.distance_minima import distance_minima as distance_minima
    from modelgen.runtime.gradient import gradient as gradient
    from modelgen.runtime.sensitivity import sensitivity as sensitivity
    from modelgen.runtime.simulate import simulate as simulate
    from modelgen.runtime.stepped_simulation import start as start
    from modelgen.runtime.stepped_simulations import start_many as start_many
    from modelgen.scene.read import read as read

__version__ = "0.1.0"
__all__ = [
    "Accuracy",
    "ModelgenError",
    "as_casadi",
    "build",
    "closest_points",
    "derive",
    "distance_minima",
    "draw",
    "emit",
    "fit",
    "gradient",
    "import_scene",
    "linearise",
    "linearise_steady",
    "load",
    "load_sweep",
    "measure",
    "normal_rates",
    "read",
    "record_of",
    "require",
    "save",
    "sensitivity",
    "simulate",
    "simulate_batch",
    "stability",
    "start",
    "start_many",
    "sweep",
    "tune",
]

_HOMES = {
    "read": "modelgen.scene.read",
    "require": "modelgen.assembly",
    "derive": "modelgen.derivation",
    "emit": "modelgen.codegen.emit",
    "build": "modelgen.codegen.build",
    "simulate": "modelgen.runtime.simulate",
    "start": "modelgen.runtime.stepped_simulation",
    "start_many": "modelgen.runtime.stepped_simulations",
    "closest_points": "modelgen.runtime.closest_points",
    "distance_minima": "modelgen.runtime.distance_minima",
    "gradient": "modelgen.runtime.gradient",
    "sensitivity": "modelgen.runtime.sensitivity",
    "simulate_batch": "modelgen.runtime.batch",
    "as_casadi": "modelgen.casadi_functions.as_casadi",
    "fit": "modelgen.identification.fit",
    "import_scene": "modelgen.importing.import_formats",
    "linearise": "modelgen.linearisation.equilibrium_and_modes",
    "linearise_steady": "modelgen.linearisation.steady_modes",
    "stability": "modelgen.linearisation.stability",
    "measure": "modelgen.benchmark",
    "tune": "modelgen.benchmark",
    "sweep": "modelgen.parameter_study.sweep",
    "load_sweep": "modelgen.parameter_study.outcome_table",
    "record_of": "modelgen.report.run_record",
    "save": "modelgen.report.run_files",
    "load": "modelgen.report.run_files",
    "draw": "modelgen.report.run_plot",
    "normal_rates": "modelgen.report.normal_rates",
    "Accuracy": "modelgen.runtime.accuracy",
    "ModelgenError": "modelgen.errors",
}


def __getattr__(name: str) -> Any:
    """The public name, from the module that defines it (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
