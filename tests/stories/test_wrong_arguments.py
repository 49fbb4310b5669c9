"""Arguments of every public function that are none: all are refused in words, with place and remedy.

Each argument of a call that is sound is replaced by each of many values: of a wrong type or shape, not
finite, negative, empty, or with unknown names. A call may take such a value, as `until=3` is a time; it may
not end with an error of Python or numpy.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sized
from math import inf, nan
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

import modelgen
from modelgen import Accuracy, ModelgenError, require, start, start_many
from modelgen.codegen.library import Library
from modelgen.runtime.stepped_simulation import Simulation
from modelgen.runtime.stepped_simulations import Simulations
from modelgen.scene.read import read_text
from tests.stories.public_calls import BALL, TURN, derivation, library, record, trajectory

WRONG: tuple[Any, ...] = (
    *(None, True, 0, 3, -1, 2.5, -2.0, nan, inf, -inf, 1j, "", "x", b"", b"x", object(), lambda *_: 0),
    *([], [1, 2], [[1.0], [2.0, 3.0]], ["x"], [None], [nan], [[nan] * 3], ("a",), {}, {3: 4}, {"nope": 1}),
    *({"push": each} for each in (nan, [1, 2], "x", None, 1e9)),
    *({"height": each} for each in (nan, [1, 2], "x", None, -1.0)),
    *(np.zeros(0), np.zeros(3), np.zeros((1, 3)), np.full((1, 7), nan), np.zeros((2, 2, 2)), np.array(["a"])),
)
HUGE = 10**400  # no float
STEPPING: Mapping[str, Any] = dict.fromkeys(("method", "step", "scheme", "solver", "fallback"))
NUMBERS: Mapping[str, Any] = {"parameters": None, "inputs": None, "accuracy": None}
POSES = {"pose_o": [0.0, 0.0, 0.05, *TURN], "pose_f": [0.0, 0.0, 0.05, *TURN]}
RECORDED = {"t": [0.0, 0.02, 0.04], "place_x": [0.0, 4e-4, 16e-4]}
Call = tuple[Callable[..., Any], Mapping[str, Any]]  # with sound arguments


def alone(method: str) -> Callable[..., Any]:
    """A method of a run that has just begun."""
    return lambda **given: getattr(start(library()), method)(**given)


def together(method: str) -> Callable[..., Any]:
    return lambda **given: getattr(start_many(library(), 2), method)(**given)


def calls() -> dict[str, Call]:
    """Every public function, and the methods of what they return, by name."""
    whole = library()
    scene = read_text(BALL, "ball.toml")
    starts = {key: np.array([whole.manifest.instance[f"initial_{key}"]]) for key in ("q", "u")}
    shown = {"library": whole, "t": [0.01], "of": ["place"], "by": ["push"], **NUMBERS, **STEPPING}
    measured = {"scene": scene, "until": 0.01, "knobs": ["nope"], "limit": None, "parameters": None}
    measured |= {"root": "generated", "on_progress": None}
    table = modelgen.sweep(whole, {"push": [0.0]}, until=0.01, threads=1)
    profile = {"path": "profile.csv", "format": None, "until": 1.0, "floating": False, "corners": 20}
    profile |= {"without": (), "kind": None, "columns": None, "unit": "m", "tolerance": None, "length": None}
    return {
        "read": (modelgen.read, {"path": "nowhere.toml"}),
        "require": (modelgen.require, {"scene": scene}),
        "derive": (modelgen.derive, {"model": require(scene)}),
        "emit": (modelgen.emit, {"derivation": derivation()}),
        "build": (modelgen.build, {"package": None, "real": None, "folder": None, "level": None}),
        "simulate": (
            modelgen.simulate,
            {"library": whole, "until": 0.01, "samples": 2, "estimate": False, "on_progress": None}
            | {**NUMBERS, **STEPPING},
        ),
        "simulate_batch": (modelgen.simulate_batch, {"library": whole, "until": 0.01, **starts}),
        "start": (modelgen.start, {"library": whole, "estimate": False, **NUMBERS, **STEPPING}),
        "Simulation.step": (alone("step"), {"until": 0.01}),
        "Simulation.load": (alone("load"), {"mark": b""}),
        "Simulation.controller": (alone("controller"), {"function": {"push": "1"}, "every": 0.01}),
        "Simulation.inputs": (
            lambda name, value: start(whole).inputs.__setitem__(name, value),
            {"name": "push", "value": 1.0},
        ),
        "Simulation.inputs.ramp": (
            lambda name, rate: start(whole).inputs.ramp(name, rate),
            {"name": "push", "rate": 1.0},
        ),
        "start_many": (
            modelgen.start_many,
            {"library": whole, "n": 2, "q": None, "u": None, "threads": 1, **NUMBERS, **STEPPING},
        ),
        "Simulations.step": (together("step"), {"duration": 0.01, "lanes": None}),
        "Simulations.events": (together("events"), {"lane": 0}),
        "Simulations.reset": (together("reset"), {"lanes": [0], "q": None, "u": None}),
        "Simulations.load": (together("load"), {"mark": b""}),
        "Simulations.inputs": (
            lambda name, values: start_many(whole, 2).inputs.__setitem__(name, values),
            {"name": "push", "values": 1.0},
        ),
        "Simulations.inputs.ramp": (
            lambda name, rates, lanes: start_many(whole, 2).inputs.ramp(name, rates, lanes),
            {"name": "push", "rates": 1.0, "lanes": None},
        ),
        "closest_points": (
            modelgen.closest_points,
            {"library": whole, "contact": "ball-floor", "eta": None, "parameters": None, **POSES},
        ),
        "distance_minima": (
            modelgen.distance_minima,
            {"library": whole, "contact": "ball-floor", "gap": inf, "depth": inf, **POSES},
        ),
        "sensitivity": (modelgen.sensitivity, {**shown, "estimate": False}),
        "gradient": (
            modelgen.gradient,
            {**shown, "loss": ca.Function("loss", [ca.MX.sym("shown", 1, 3)], [1.0])},
        ),
        "fit": (
            modelgen.fit,
            {"library": whole, "data": RECORDED, "by": ["push"], "of": None, "start": (), "noise": None}
            | {"loss": "linear", "starts": 1, "seed": 0, "evaluations": 1, "on_progress": None}
            | {**NUMBERS, **STEPPING},
        ),
        "linearise": (
            modelgen.linearise,
            {"derivation": derivation(), "library": whole, "parameters": None},
        ),
        "linearise_steady": (
            modelgen.linearise_steady,
            {"derivation": derivation(), "library": whole, "parameters": None},
        ),
        "stability": (
            modelgen.stability,
            {"derivation": derivation(), "library": whole, "parameter": "height", "values": [0.05, 0.06]}
            | {"parameters": None, "on_progress": None},
        ),
        "sweep": (
            modelgen.sweep,
            {"library": whole, "vary": {"push": [0.0]}, "samples": None, "design": None, "seed": 0}
            | {"until": 0.01, "estimate": False, "threads": 1, "scheduler": None, "out": None, "keep": ()}
            | {"scene": None, "on_progress": None, **NUMBERS, **STEPPING},
        ),
        "load_sweep": (modelgen.load_sweep, {"folder": "nowhere"}),
        "Sweep": (lambda name: table[name], {"name": "run"}),
        "record_of": (modelgen.record_of, {"trajectory": trajectory(), "library": whole, "scene": None}),
        "save": (modelgen.save, {"record": record(), "path": "run.npz"}),
        "load": (modelgen.load, {"path": "nowhere.npz"}),
        "draw": (modelgen.draw, {"record": record(), "path": "run.png"}),
        "normal_rates": (modelgen.normal_rates, {"derivation": derivation(), "path": trajectory()}),
        "as_casadi": (
            modelgen.as_casadi,
            {"source": derivation(), "what": "rhs", "mode": None, "feature_pairs": None, "h": None}
            | {"method": "rk4", "settle": True},
        ),
        "import_scene": (modelgen.import_scene, profile),
        "measure": (
            modelgen.measure,
            {**measured, "samples": 2, "against": (), "count": False, "fresh": False},
        ),
        "tune": (modelgen.tune, {**measured, "error": 1e-3, "budget": None}),
        "Accuracy": (
            Accuracy,
            {"name": "mine", "tolerance": 1e-9, "method": "dop853", "step": None, "use_gamma": True}
            | {"project": 1, "impacts": "simultaneous", "newton": 1, "scheme": "moreau", "solver": "coulomb"},
        ),
        "Accuracy.of": (Accuracy.of, {"tolerance": 1e-9}),
        "Library.load": (Library.load, {"folder": "nowhere", "real": "double"}),
        "Library.kernel": (whole.kernel, {"name": "nothing"}),
    }


NAMES = (
    *("read", "require", "derive", "emit", "build", "simulate", "simulate_batch", "start", "start_many"),
    *("Simulation.step", "Simulation.load", "Simulation.controller", "Simulation.inputs"),
    *("Simulation.inputs.ramp", "Simulations.step", "Simulations.events", "Simulations.reset"),
    *("Simulations.load", "Simulations.inputs", "Simulations.inputs.ramp", "closest_points"),
    *("distance_minima", "sensitivity", "gradient", "fit", "linearise", "linearise_steady", "stability"),
    *("sweep", "load_sweep", "Sweep", "record_of", "save", "load", "draw", "normal_rates", "as_casadi"),
    *("import_scene", "measure", "tune", "Accuracy", "Accuracy.of", "Library.load", "Library.kernel"),
)


def takes_long(name: str, key: str, value: object) -> bool:
    """Whether the value is sound, and the call takes long with it: a measurement of all knobs."""
    nothing = value is None or (isinstance(value, Sized) and len(value) == 0)
    return name in ("measure", "tune") and key == "knobs" and nothing


def test_the_table_has_every_public_function_and_method() -> None:
    assert set(NAMES) == set(calls())
    assert {*modelgen.__all__} - {"ModelgenError"} <= set(NAMES)
    for made in (Simulation, Simulations):
        taking = {
            name
            for name, each in inspect.getmembers(made, inspect.isfunction)
            if not name.startswith("_") and len(inspect.signature(each).parameters) > 1
        }
        assert {f"{made.__name__}.{name}" for name in taking} <= set(NAMES)


def failure(call: Callable[..., Any], given: Mapping[str, Any]) -> str:
    """What is wrong with the answer to a call; empty where it is taken, or refused in words."""
    try:
        call(**given)
    except ModelgenError as error:
        told = error.where and error.found and (error.allowed or error.remedy)
        return "" if told else f"no place, finding or remedy: {error}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""


@pytest.mark.parametrize("name", NAMES)
def test_what_is_no_argument_is_refused_in_words(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("profile.csv").write_text("r,z\n0.1,0\n0.1,1\n0.2,2\n")
    call, sound = calls()[name]
    failed = {
        f"{key} = {value!r}": found
        for key in sound
        for value in WRONG
        if not takes_long(name, key, value) and (found := failure(call, {**sound, key: value}))
    }
    assert not failed


@pytest.mark.parametrize(
    ("name", "key"),
    [
        *[("simulate", key) for key in ("until", "samples", "step")],
        *[("start_many", key) for key in ("n", "threads", "q")],
        *[("Simulation.step", "until"), ("Simulations.step", "duration"), ("Simulation.inputs", "value")],
        *[("Simulations.inputs", "values"), ("Accuracy", "tolerance"), ("sensitivity", "t")],
        *[("distance_minima", "gap"), ("closest_points", "pose_o"), ("fit", "data"), ("tune", "error")],
    ],
)
def test_a_number_that_is_no_float_is_refused(name: str, key: str) -> None:
    call, sound = calls()[name]
    with pytest.raises(ModelgenError, match="push" if key == "values" else key):
        call(**{**sound, key: HUGE})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: start_many(library(), 2.5), r"n: 2\.5; a whole number, at least 1; give the number of runs"),
        (
            lambda: start_many(library(), 3, inputs={"push": [1, 2]}),
            r"input 'push': an array of shape \(2,\); one number or \(3,\); give one for each lane",
        ),
        (
            lambda: start(library()).step(until="x"),
            r"step: until = 'x'; a time from the present one, 0\.0 s, on, not infinite; write until=sim\.t",
        ),
        (lambda: start(library()).step(until=inf), "step: until = inf; a time from"),
        (lambda: start(library(), inputs=[1.0]), r"inputs: a list; names with their values.*inputs=\{"),
        (lambda: start_many(library(), 2).events(2), "events: the lane 2; a whole number from 0 to 1"),
        (
            lambda: start_many(library(), 2).step(0.1, [1, 2]),
            r"step: lanes: \[1, 2\]; \(2,\) of True and False, or indices from 0 to 1",
        ),
    ],
)
def test_what_is_said(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ModelgenError, match=message):
        call()


def test_inputs_of_many_runs_are_set_as_a_whole() -> None:
    many = start_many(library(), 3)
    many.inputs["push"] = [0.0, 1.0, 2.0]
    assert many.inputs["push"].tolist() == [0.0, 1.0, 2.0]
    many.inputs["push"] = 4
    many.step(0.01, [0, 2])
    assert many.inputs["push"].tolist() == [4.0, 4.0, 4.0]
    assert many.t == pytest.approx([0.01, 0.0, 0.01])


def test_stability_is_found_where_other_contacts_touch() -> None:
    """Where another value of the parameter opens a contact there is no such motion, and the others stay."""
    found = modelgen.stability(derivation(), library(), "height", [0.05, 0.06])
    assert [value for value, _ in found.refused] == [0.06]
    assert [len(each) for each in found.eigenvalues] == [3, 0]
