"""Runs that their caller drives: inputs take effect when they are set, and sensors show the state."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from modelgen import ModelgenError, simulate, start
from modelgen.codegen.library import Library
from modelgen.errors import SceneError
from modelgen.runtime.core_session import Session
from modelgen.runtime.stepped_simulation import Simulation
from modelgen.scene.read import read_text
from tests.c_compiler import CC
from tests.running import library_of, scene_of

PUCK = """
gravity = [0, 0, -10]
[[input]]
name = "push"
minimum = -50
maximum = 50
[[sensor]]
name = "place"
of = "puck.position"
[[sensor]]
name = "speed"
of = "puck.velocity"
[[sensor]]
name = "load"
of = "table-puck.force"
[[sensor]]
name = "gap"
of = "table-puck.gap"
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "puck"
mass = 2.0
inertia = [0.2, 0.2, 0.2]
position = [0, 0, 0.5]
shape = { kind = "sphere", radius = 0.5 }
[[force]]
body = "puck"
force = ["push", "0", "0"]
[[contact]]
between = ["table", "puck"]
"""

LIFT = """
gravity = [0, 0, -10]
[[input]]
name = "height"
hold = "linear"
[[body]]
name = "table"
motion = "driven"
path = { position = ["0", "0", "HEIGHT"] }
shape = { kind = "plane" }
[[body]]
name = "ball"
mass = 2.0
inertia = [0.2, 0.2, 0.2]
position = [0, 0, 0.5]
shape = { kind = "sphere", radius = 0.5 }
[[contact]]
between = ["table", "ball"]
restitution = 0.5
"""

ARM = """
gravity = [0, 0, 0]
[[input]]
name = "angle"
hold = "linear"
[[sensor]]
name = "turn"
of = "hinge.coordinate"
[[sensor]]
name = "rate"
of = "hinge.rate"
[[body]]
name = "arm"
mass = 1.0
inertia = [0.1, 0.2, 0.3]
position = [1, 0, 0]
[[body]]
name = "ball"
mass = 1.0
inertia = [0.1, 0.1, 0.1]
position = [1.0, 1.5, 0]
[[joint]]
kind = "revolute"
name = "hinge"
between = ["world", "arm"]
position = [0, 0, 0]
motion = "2*angle + 0.3*sin(t)"
[[spring]]
between = ["arm", "ball"]
stiffness = 3.0
"""


@cache
def library(text: str) -> Library:
    return library_of(read_text(text, "driven.toml"))


def times(n: int) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(0.01, 0.5), min_size=n, max_size=n)


READ = """
[[input]]
name = "push"
[[sensor]]
name = "twice"
value = "2*push"
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.005 }
density = 7800.0
position = [0.0, 0.0, 0.01]
[[contact]]
between = ["ball", "table"]
"""


def test_an_input_that_moves_nothing_can_be_read() -> None:
    sim = start(library(READ))
    sim.inputs["push"] = 3.0
    sim.step(until=0.01)
    assert sim.sensors["twice"] == 6.0


@settings(max_examples=12)
@given(times(4), st.lists(st.floats(-50.0, 50.0), min_size=4, max_size=4))
def test_a_force_that_is_set_acts_from_then_on(spans: list[float], pushes: list[float]) -> None:
    sim = start(library(PUCK), accuracy="tight")
    x = v = 0.0
    for span, push in zip(spans, pushes, strict=True):
        sim.inputs["push"] = push
        assert sim.step(until=sim.t + span) == ()
        x, v = x + v * span + push / 4 * span**2, v + push / 2 * span
    assert sim.sensors["place"] == pytest.approx([x, 0.0, 0.5], abs=1e-12 * (1 + abs(x)))
    assert sim.sensors["speed"] == pytest.approx([v, 0.0, 0.0], abs=1e-12 * (1 + abs(v)))
    assert sim.sensors["load"] == pytest.approx(20.0, rel=1e-12)
    assert abs(sim.sensors["gap"]) < 1e-12  # type: ignore[arg-type]


def test_an_input_that_is_not_set_leaves_the_run_as_it_is() -> None:
    sim, alone = start(library(PUCK), inputs={"push": 3.0}), start(library(PUCK), inputs={"push": 3.0})
    for k in range(10):
        sim.inputs["push"] = 3.0
        sim.step(until=0.1 * (k + 1))
        alone.step(until=0.1 * (k + 1))
    assert np.array_equal(sim.state, alone.state)


def test_a_driven_body_whose_rate_is_set_strikes_what_lies_on_it() -> None:
    """As one whose path has these kinks as an expression of time."""
    sim = start(library(LIFT.replace("HEIGHT", "height")), accuracy="tight")
    events = []
    for t, rate in ((0.1, 1.0), (0.17, -2.0), (0.6, 0.0)):
        events += sim.step(until=t)
        sim.inputs.ramp("height", rate)
    events += sim.step(until=1.0)
    path = "max(0, t - 0.1) - 3*max(0, t - 0.17) + 2*max(0, t - 0.6)"
    text = LIFT.replace("HEIGHT", path).replace('[[input]]\nname = "height"\nhold = "linear"\n', "")
    whole = simulate(library(text), until=1.0, accuracy="tight", estimate=False)
    assert [event.kind for event in events] == [event.kind for event in whole.events]
    assert [event.t for event in events] == pytest.approx([event.t for event in whole.events], abs=1e-8)
    assert sim.state[:3] == pytest.approx(whole.p[-1, 1], abs=1e-8)


def test_a_jump_of_a_joint_that_is_driven_moves_what_hangs_on_it_and_is_booked() -> None:
    sim = start(library(ARM), accuracy="tight")
    sim.step(until=0.5)
    sim.inputs.ramp("angle", 1.0)
    sim.step(until=1.0)
    assert sim.sensors["turn"] == pytest.approx(1.0 + 0.3 * np.sin(1.0), abs=1e-11)
    assert sim.sensors["rate"] == pytest.approx(2.0 + 0.3 * np.cos(1.0), abs=1e-11)
    ledger = sim.session.run
    assert ledger.report.energy_error_max < 1e-10 * ledger.report.kinetic_max


def lagrange(
    control: Callable[[np.ndarray[Any, Any]], float], until: float, every: float
) -> np.ndarray[Any, Any]:
    """Second route for `balancing_wheel`: Lagrange's equations of the rolling wheel and pole in (x, lean)."""
    R, h, m, M = 0.15, 0.4, 2.0, 1.5
    of_wheel, of_pole = 0.02, 0.06  # moments of inertia about y, kg m^2

    def rates(_: float, y: np.ndarray[Any, Any], torque: float) -> list[float]:
        _, lean, v, w = y
        mass = np.array(
            [[M + of_wheel / R**2 + m, m * h * np.cos(lean)], [m * h * np.cos(lean), of_pole + m * h**2]]
        )
        push = [torque / R + m * h * w**2 * np.sin(lean), m * 9.81 * h * np.sin(lean) - torque]
        return [v, w, *np.linalg.solve(mass, push)]

    y = np.array([0.0, 0.15, 0.0, 0.0])
    for k in range(round(until / every)):
        span = (k * every, (k + 1) * every)
        y = solve_ivp(rates, span, y, args=(control(y),), rtol=1e-11, atol=1e-13).y[:, -1]
    return y


GAINS = (40.0, 8.0, 2.0, 3.0)
FEEDBACK = {"torque": "40*lean + 8*turning_y + 2*axle_x + 3*speed_x"}


def python_feedback(_: float, shown: Any) -> dict[str, float]:
    state = (shown["lean"], shown["turning"][1], shown["axle"][0], shown["speed"][0])
    return {"torque": sum(gain * value for gain, value in zip(GAINS, state, strict=True))}


def casadi_feedback() -> ca.Function:
    named = {
        name: ca.SX.sym(name, size) for name, size in (("axle", 3), ("speed", 3), ("turning", 3), ("lean", 1))
    }
    state = (named["lean"], named["turning"][1], named["axle"][0], named["speed"][0])
    torque = sum(gain * value for gain, value in zip(GAINS, state, strict=True))
    return ca.Function("feedback", list(named.values()), [torque], list(named), ["torque"])


def c_feedback(folder: Path) -> ctypes.CDLL:
    """The same in C: sensors are axle 0..2, speed 3..5, up 6..9, turning 10..12, lean 13."""
    source = folder / "feedback.c"
    source.write_text(
        "void feedback(void *data, double t, const double *s, double *command) {\n"
        "  (void)data, (void)t;\n"
        "  command[0] = 40 * s[13] + 8 * s[11] + 2 * s[0] + 3 * s[3];\n}\n",
        encoding="utf-8",
    )
    words = [
        *CC,
        "-O1",
        "-shared",
        "-fPIC",
        "-ffp-contract=off",
        "-o",
        "feedback.so",
        source.name,
    ]
    subprocess.run(words, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "feedback.so"))


def controlled(feedback: Any, until: float) -> Simulation:
    sim = start(scene_of("balancing_wheel"), accuracy="tight")
    sim.controller(feedback, every=1e-2)
    sim.step(until=until)
    return sim


def test_a_balancing_wheel_under_sampled_feedback_follows_lagranges_equations(tmp_path: Path) -> None:
    """Whatever the feedback is written in."""
    library_in_c = c_feedback(tmp_path)
    ends = [
        controlled(feedback, 1.0)
        for feedback in (FEEDBACK, python_feedback, casadi_feedback(), library_in_c.feedback)
    ]
    for sim in ends[1:]:
        assert sim.state == pytest.approx(ends[0].state, abs=1e-10)
    x, lean, v, _ = lagrange(
        lambda y: GAINS[0] * y[1] + GAINS[1] * y[3] + GAINS[2] * y[0] + GAINS[3] * y[2], 1.0, 1e-2
    )
    shown = ends[0].sensors
    assert [shown["axle"][0], shown["lean"], shown["speed"][0]] == pytest.approx([x, lean, v], abs=1e-8)  # type: ignore[index]


def test_a_wheel_that_is_driven_too_hard_slips_when_the_input_is_set() -> None:
    sim = start(scene_of("balancing_wheel"), accuracy="tight")
    assert sim.step(until=0.05) == ()
    sim.inputs["torque"] = 19.0
    events = sim.step(until=0.06)
    assert [(event.kind, event.t) for event in events] == [("slip-start", 0.05)]


def test_a_controller_is_called_at_its_instants_alone_however_the_run_is_cut() -> None:
    def run(cuts: int) -> tuple[list[float], Simulation]:
        called: list[float] = []
        sim = start(library(PUCK))
        sim.controller(
            lambda t, shown: called.append(t) or {"push": float(np.sin(t)) - shown["place"][0]}, every=0.05
        )  # type: ignore[func-returns-value]
        for k in range(cuts):
            sim.step(until=1.0 * (k + 1) / cuts)
        return called, sim

    called, sim = run(1)
    assert called == pytest.approx(0.05 * np.arange(20), abs=1e-12)
    for cuts in (7, 20):
        again, cut = run(cuts)
        assert again == called
        assert cut.state == pytest.approx(sim.state, abs=1e-9)


def test_a_command_is_kept_within_the_range_of_its_input() -> None:
    sim = start(library(PUCK))
    sim.controller({"push": "1000*t + 1000"}, every=0.1)
    sim.step(until=0.1)
    assert sim.inputs["push"] == 50.0


def test_an_error_in_a_controller_is_told_where_it_arose_and_the_run_can_go_on() -> None:
    sim = start(library(PUCK))
    sim.controller(lambda t, shown: {"push": 1 / 0}, every=0.1)
    with pytest.raises(ZeroDivisionError):
        sim.step(until=0.5)
    assert sim.t == 0.0
    sim.controller(lambda t, shown: float("nan"), every=0.1)
    with pytest.raises(ModelgenError, match="a command for 'push' that is not finite, at t = 0 s"):
        sim.step(until=0.5)
    sim.controller({"push": "1"}, every=0.1)
    sim.step(until=0.5)
    assert sim.sensors["place"][0] == pytest.approx(1 / 4 * 0.25, rel=1e-9)  # type: ignore[index]


@pytest.mark.parametrize(
    ("action", "words"),
    [
        (lambda sim: sim.inputs.__setitem__("pusch", 1.0), "did you mean 'push'"),
        (lambda sim: sim.inputs.__setitem__("push", 51.0), "a number from -50 to 50"),
        (lambda sim: sim.inputs.__setitem__("push", float("nan")), "a number from -50 to 50"),
        (lambda sim: sim.inputs.__setitem__("push", "1"), "a number from -50 to 50"),
        (lambda sim: sim.inputs.__setitem__("push", abs), r"sim\.controller\(f, every=0\.01\)"),
        (lambda sim: sim.inputs.ramp("push", 1.0), "set its value instead"),
        (lambda sim: sim.inputs.pop("push"), "it cannot be removed"),
        (lambda sim: sim.sensors["plase"], "did you mean 'place'"),
        (lambda sim: sim.step(until=-1.0), "a time from the present one"),
        (lambda sim: sim.step(until=float("nan")), "a time from the present one"),
        (lambda sim: sim.controller({"pusch": "1"}, every=0.1), "did you mean 'push'"),
        (lambda sim: sim.controller({"push": "plase_x"}, every=0.1), "unknown name 'plase_x'"),
        (lambda sim: sim.controller({"push": "1"}, every=0.0), "a positive time"),
        (lambda sim: sim.controller("push", every=0.1), "give one of these"),
        (
            lambda sim: sim.controller(ca.Function("f", [ca.SX.sym("z")], [1], ["z"], ["push"]), 0.1),
            "no sensor",
        ),
    ],
)
def test_mistakes_of_a_caller(action: Callable[[Simulation], object], words: str) -> None:
    with pytest.raises(ModelgenError, match=words):
        action(start(library(PUCK)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('name = "push"', 'name = "x"', "the text 'x'; a letter, then"),
        ("minimum = -50", "minimum = 60", "60 above the maximum 50"),
        ("minimum = -50", "minimum = -50\ndefault = 70", "the default 70"),
        ("minimum = -50", 'minimum = -50\nhold = "cubic"', "allowed are zero, linear"),
        ('"push", "0", "0"', '"pusch", "0", "0"', "unknown name 'pusch'"),
        ('of = "puck.velocity"', 'of = "puk.velocity"', "did you mean 'puck'"),
        ('of = "puck.velocity"', 'of = "puck.speed"', "no quantity 'speed'"),
        ('of = "puck.velocity"', "", "neither `of` nor `value`"),
        ('of = "puck.velocity"', 'value = "place_q"', "unknown name 'place_q'"),
        ('of = "puck.velocity"', 'of = "puck.velocity"\nvalue = "1"', "of, value"),
        ('of = "table-puck.gap"', 'of = "table-puck.gap"\npoint = [0, 0, 0]', "it goes with a body"),
        ('name = "speed"', 'name = "place"', "the name 'place' a second time"),
        ('name = "speed"', 'name = "push"', "the name 'push' a second time"),
    ],
)
def test_mistakes_in_a_scene(old: str, new: str, words: str) -> None:
    assert old in PUCK
    with pytest.raises(SceneError, match=words):
        read_text(PUCK.replace(old, new, 1), "driven.toml")


def test_a_motion_may_not_depend_on_an_input_that_jumps() -> None:
    with pytest.raises(SceneError, match="hold = 'linear'"):
        read_text(LIFT.replace("HEIGHT", "height").replace('hold = "linear"', 'hold = "zero"'), "driven.toml")


def test_an_input_that_nothing_uses_is_remarked_upon() -> None:
    scene = read_text(PUCK.replace('"push", "0", "0"', '"0", "0", "0"'), "driven.toml")
    assert any("no expression uses the input 'push'" in remark for remark in scene.remarks)


def test_sensors_show_what_the_samples_of_a_run_hold() -> None:
    sim = start(scene_of("balancing_wheel"), accuracy="tight")
    path = simulate(scene_of("balancing_wheel"), until=0.2, samples=2, accuracy="tight", estimate=False)
    for k in (1, 2):
        sim.step(until=0.1 * k)
        wheel, pole = path.body_names.index("wheel"), path.body_names.index("pole")
        assert sim.sensors["axle"] == pytest.approx(path.p[k, wheel], abs=1e-10)
        assert sim.sensors["speed"] == pytest.approx(path.v[k, wheel], abs=1e-10)
        assert sim.sensors["turning"] == pytest.approx(path.w[k, pole], abs=1e-10)
        assert sim.sensors["up"] == pytest.approx(path.quaternion[k, pole], abs=1e-10)
        shown = np.concatenate([np.atleast_1d(value) for value in sim.sensors.values()])
        assert path.sensors[k] == pytest.approx(shown, abs=1e-10)
    assert path.sensor_names[:4] == ("axle_x", "axle_y", "axle_z", "speed_x")
    assert path.summary()["sensors"]["lean"] == path.sensors[-1, -1]


def test_the_state_is_sensed_once_and_anew_after_each_change(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    sense = Session.sense
    monkeypatch.setattr(Session, "sense", lambda session: (calls.append(1), sense(session))[1])
    sim, other = start(library(PUCK)), start(library(PUCK), inputs={"push": 3.0})
    mark = other.save()
    for change in (
        lambda: None,
        lambda: sim.inputs.update(push=3.0),
        lambda: sim.step(until=0.1),
        lambda: sim.load(mark),
    ):
        change()
        calls.clear()
        shown = dict(sim.sensors)
        assert len(calls) == 1
        fresh = start(library(PUCK))
        fresh.load(sim.save())
        assert str(dict(fresh.sensors)) == str(shown)


def test_samples_of_a_run_hold_the_forces_and_gaps_that_sensors_show() -> None:
    sim = start(library(PUCK), inputs={"push": 3.0})
    path = simulate(library(PUCK), until=0.4, samples=4, inputs={"push": 3.0})
    sim.step(until=0.4)
    columns = dict(zip(path.sensor_names, path.sensors[-1], strict=True))
    assert path.inputs == {"push": 3.0}
    assert path.p[-1, 1] == pytest.approx(sim.sensors["place"], abs=1e-10)
    assert path.estimate is not None
    assert path.estimate.position[-1] < 1e-9
    assert columns["load"] == pytest.approx(20.0)
    assert columns["load"] == pytest.approx(sim.sensors["load"])
    assert columns["gap"] == pytest.approx(path.gap[-1, 0], abs=1e-15)


def test_the_estimate_of_a_driven_run_bounds_its_error_and_that_of_simulate() -> None:
    """Against a run at `tight` under the same inputs; and with one input for the whole run, as `simulate`."""
    model = scene_of("balancing_wheel")
    runs = [start(model, accuracy=name, estimate=name == "fast") for name in ("fast", "tight")]
    for k in range(5):
        for sim in runs:
            sim.inputs["torque"] = (-1) ** k * 0.5
            sim.step(until=0.02 * (k + 1))
    found = runs[0].estimate()
    n_q = model.manifest.instance["n_q"]
    places = [body["q"] for body in model.manifest.instance["bodies"] if body["motion"] == "free"]
    apart = max(np.linalg.norm((runs[0].state - runs[1].state)[q : q + 3]) for q in places)
    assert n_q
    assert 0 < apart < found.position[-1] < 1e-2
    assert len(found.position) == 6
    whole = start(model, inputs={"torque": 0.5}, accuracy="fast", estimate=True)
    whole.step(until=0.1)
    path = simulate(model, inputs={"torque": 0.5}, accuracy="fast", until=0.1, samples=1)
    assert path.estimate is not None
    assert whole.estimate().position[-1] == path.estimate.position[-1]


def test_the_estimate_of_a_controlled_run_is_that_under_the_inputs_that_were_set() -> None:
    model = scene_of("balancing_wheel")
    controlled, set_by_hand = (start(model, accuracy="fast", estimate=True) for _ in "ab")
    controlled.controller(lambda t, shown: {"torque": 40 * shown["lean"]}, every=0.01)
    controlled.step(until=0.045)
    for k in range(5):
        set_by_hand.inputs["torque"] = 40 * set_by_hand.sensors["lean"]  # type: ignore[operator]
        set_by_hand.step(until=min(0.01 * (k + 1), 0.045))
    assert np.array_equal(controlled.state, set_by_hand.state)
    assert np.array_equal(controlled.estimate().position, set_by_hand.estimate().position)
    with pytest.raises(ModelgenError, match=r"estimate: the inputs of the run are not known"):
        start(model).estimate()
    controlled.load(controlled.save())
    controlled.step(until=0.05)
    with pytest.raises(ModelgenError, match="those since the start are needed"):
        controlled.estimate()
