"""The Accuracy of a run, from the scene's [run] and the arguments of the call."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any, TypedDict, get_args

from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import Accuracy, Solver
from modelgen.runtime.arguments import check_name, check_step
from modelgen.runtime.solver_choice import DEFAULT, check_solver, solvers_of
from modelgen.runtime.tables.ctypes_structures import METHODS, SCHEMES


class Stepping(TypedDict, total=False):
    """Arguments of `simulate` that choose the method; None leaves the choice to the scene."""

    method: str | None
    step: float | None
    scheme: str | None
    solver: str | None
    fallback: bool | None


STEPPING = (
    "method",
    "step",
    "scheme",
    "solver",
    "fallback",
)  # keys of [run] for the time integration
NAMES: Mapping[str, Collection[str]] = {"method": METHODS, "scheme": SCHEMES, "solver": get_args(Solver)}


def accuracy_of(
    instance: Mapping[str, Any], accuracy: Accuracy | str | None, own: Mapping[str, Any]
) -> Accuracy:
    """The record of a run: the caller's or the scene's, with the keys STEPPING replaced by those in `own`.

    A whole Accuracy stands for itself; the scene's other settings go with named ones.
    """
    source, run = instance["source"], {} if isinstance(accuracy, Accuracy) else instance["run"]
    said = {key: run[key] for key in STEPPING if run.get(key) is not None}
    given = {key: value for key, value in own.items() if value is not None}
    for key, value in given.items():
        _check(key, value, "")
    record = _of_scene(run, source) if accuracy is None else Accuracy.taken(accuracy)
    method = given.get("method")
    if method is None and accuracy is not None and record.method != "dop853" and "method" in said:
        method = record.method  # that of `coarse`
    if method is None and accuracy is not None and "method" not in said and run.get("accuracy") == "coarse":
        method = record.method  # not that of `coarse`
    if method is not None and method != said.get("method"):  # what goes with another one is not meant
        fitting = (DEFAULT, *solvers_of(instance, method))
        said = {k: v for k, v in said.items() if k == "fallback" or (k == "solver" and v in fitting)}
    places = dict.fromkeys(said.keys() - given.keys(), f"{source}: run.")
    return _stepping(record, said | given, places, instance).choosing(run)


def accuracy_without_scene(instance: Mapping[str, Any], accuracy: Accuracy | str | None) -> Accuracy:
    """The record of runs that leave out what the scene says: `balanced` when None."""
    record = Accuracy.balanced() if accuracy is None else Accuracy.taken(accuracy)
    return _stepping(record, {}, {}, instance)


def _of_scene(run: Mapping[str, Any], source: str) -> Accuracy:
    try:
        return Accuracy.of_run(run)
    except SimulationError as error:
        where = f"{source}: run.{error.where}"
        raise SimulationError(where, error.found, error.allowed, error.remedy) from None


def _stepping(
    record: Accuracy, said: Mapping[str, Any], places: Mapping[str, str], instance: Mapping[str, Any]
) -> Accuracy:
    for key, value in said.items():
        _check(key, value, places.get(key, ""))
    stepped = _stepped(record.solved_by("coulomb"), said, places, instance)
    return stepped.solved_by(said.get("solver", record.solver))


def _stepped(
    record: Accuracy, said: Mapping[str, Any], places: Mapping[str, str], instance: Mapping[str, Any]
) -> Accuracy:
    """The record without a choice of solver."""
    if "fallback" in said:
        record = replace(record, fallback=said["fallback"])
    method, step = said.get("method", record.method), said.get("step", record.step)
    known = method == record.method
    if "scheme" in said and method != "time-stepping":
        raise _unfit(places, "scheme", said["scheme"], 'method = "time-stepping" with it')
    if "solver" in said:
        check_solver(said["solver"], method, instance, f"{places.get('solver', '')}solver")
    if method == "dop853":
        if "step" in said:
            raise _unfit(places, "step", step, 'method = "rk4" or "time-stepping" with it')
        return record if known else replace(record, method="dop853", step=None)
    if step is None and known and method == "time-stepping":
        step = record.thresholds.stepping_step * instance["scales"]["time"]
    if step is None:
        raise _unfit(places, "method", method, "a fixed step with it: step = 0.001, in s, or --step 0.001")
    if method == "rk4":
        return record if known and step == record.step else record.fixed_step(step)
    stepped = record.time_stepping(step, said.get("scheme", record.scheme), record.solver)
    return (
        replace(stepped, name=f"{record.name}, {stepped.name}") if record.step is None and known else stepped
    )


def _unfit(places: Mapping[str, str], key: str, found: Any, allowed: str) -> SimulationError:
    return SimulationError(f"{places.get(key, '')}{key}", repr(found), allowed, "give both, or neither")


def _check(key: str, value: Any, place: str) -> None:
    if key in NAMES:
        check_name(f"{place}{key}", value, NAMES[key])
    if key == "step":
        check_step(value, f"{place}{key}")
    if key == "fallback" and not isinstance(value, bool):
        raise SimulationError(f"{place}{key}", repr(value), "True or False", "say whether it may")
