"""Many runs that their caller drives together: each lane is a run of its own, bit for bit."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from modelgen import ModelgenError, start, start_many
from modelgen.runtime.stepped_simulations import Simulations
from modelgen.runtime.trajectory import Outcome
from modelgen.scene.read import read_text
from tests.mutants import mutants
from tests.running import library_of, scene_of

from .test_driven_runs import LIFT, PUCK, library

HEAVY = (
    PUCK.replace("mass = 2.0", 'mass = "heft"')
    + '\n[[parameter]]\nname = "heft"\nvalue = 2.0\nminimum = 0.1\n'
)


@pytest.mark.parametrize("threads", [1, 2])
def test_lanes_do_what_a_run_with_their_numbers_does(threads: int) -> None:
    n, model = 5, library(HEAVY)
    masses, pushes = np.linspace(1.0, 3.0, n), np.linspace(-2.0, 7.0, n)
    many = start_many(model, n, parameters={"heft": masses}, inputs={"push": pushes}, threads=threads)
    alone = [
        start(model, parameters={"heft": m}, inputs={"push": p}) for m, p in zip(masses, pushes, strict=True)
    ]
    for k in range(4):
        many.inputs["push"][:] = pushes - k
        many.step(0.03)
        for lane, sim in enumerate(alone):
            sim.inputs["push"] = pushes[lane] - k
            sim.step(until=float(many.t[lane]))
    for lane, sim in enumerate(alone):
        assert np.array_equal(many.state[lane], sim.state)
        assert np.array_equal(many.sensors["speed"][lane], sim.sensors["speed"])
        assert many.sensors["load"][lane] == sim.sensors["load"]
    assert many.sensors["speed"].shape == (n, 3)


def test_lanes_of_a_driven_body_follow_their_own_rates() -> None:
    many = start_many(library(LIFT.replace("HEIGHT", "height")), 3)
    rates = np.array([-0.5, 0.0, 0.7])
    many.step(0.1)
    many.inputs.ramp("height", rates)
    many.step(0.1)
    for lane, rate in enumerate(rates):
        sim = start(library(LIFT.replace("HEIGHT", "height")))
        sim.step(until=0.1)
        if rate:
            sim.inputs.ramp("height", rate)
        events = sim.step(until=0.2)
        assert np.array_equal(many.state[lane], sim.state)
        assert tuple(many.events(lane)) == events
        assert {event.kind for event in events} == {-1: {"lift-off"}, 0: set(), 1: {"impact"}}[
            int(np.sign(rate))
        ]


def test_an_input_on_a_line_cannot_jump_in_a_run_alone_or_among_many() -> None:
    model = library(LIFT.replace("HEIGHT", "height"))
    many, sim = start_many(model, 3), start(model)
    many.inputs["height"][1] = 0.0  # its present value
    many.inputs.ramp("height", [0.1, 0.2, -0.1])
    many.step(0.5)
    sim.inputs.ramp("height", 0.2)
    sim.step(until=0.5)
    assert many.inputs["height"] == pytest.approx([0.05, 0.1, -0.05])
    assert sim.inputs["height"] == many.inputs["height"][1]
    before = many.state.copy()
    many.inputs["height"][2] = 0.3
    for setting in (lambda: many.step(0.1), lambda: sim.inputs.__setitem__("height", 0.3)):
        with pytest.raises(ModelgenError, match="a jump to another value; an input with hold = 'linear'"):
            setting()
    with pytest.raises(ModelgenError, match="input 'height' of lane 1: nan; a finite rate"):
        many.inputs.ramp("height", [0.0, np.nan, 0.0])
    assert np.array_equal(many.state, before)
    many.inputs["height"][2] = 0.02
    with pytest.raises(ModelgenError, match=r"interpenetrate at the start by 0\.02 m"):
        many.reset([2])
    many.inputs["height"][2] = -0.02
    many.reset([2])  # which starts from there
    sim.inputs["height"] = sim.inputs["height"]
    many.step(0.5)
    sim.step(until=1.0)
    assert many.inputs["height"] == pytest.approx([0.1, 0.2, -0.07])
    assert np.array_equal(many.state[1], sim.state)


def test_lanes_that_are_reset_begin_again_and_the_others_go_on() -> None:
    many = start_many(scene_of("balancing_wheel"), 3, inputs={"torque": [0.5, 1.0, 1.5]})
    many.step(0.2)
    first = many.state.copy()
    many.step(0.2)
    third = many.state[2].copy()
    many.reset(np.array([True, True, False]))
    assert many.t == pytest.approx([0.0, 0.0, 0.4])
    assert np.array_equal(many.state[2], third)
    many.step(0.2)
    assert np.array_equal(many.state[:2], first[:2])


def test_a_lane_that_cannot_start_is_left_out() -> None:
    model = library(PUCK)
    q = np.tile(model.manifest.instance["initial_q"], (3, 1))
    q[1, 2] -= 0.1
    many = start_many(model, 3, q=q, inputs={"push": 1.0})
    many.step(0.1)
    assert list(many.refused) == [1]
    assert "interpenetrate at the start by 0.1 m" in str(many.refused[1])
    assert many.outcomes == (Outcome.DONE, None, Outcome.DONE)
    assert many.ended.tolist() == [False, True, False]
    assert many.sensors["place"][[0, 2], 0] == pytest.approx(0.25 * 0.01)
    with pytest.raises(ModelgenError, match=r"run 0, contact 'table-puck'\): .* interpenetrate"):
        start_many(model, 2, q=q[[1, 1]])


def trace(many: Simulations, until: float) -> list[bytes]:
    """The states of a group that goes on, after each step, and its events."""
    states = []
    while many.t.max() < until:
        if "push" in many.inputs:
            many.inputs["push"][::2] += 0.5
        many.step(0.04)
        states.append(many.save())
    return [*states, repr([many.events(lane) for lane in range(many.n)]).encode()]


GROUPS = {
    "other parameters": (lambda: library(HEAVY), {"parameters": {"heft": [1.0, 2.0, 3.0]}}),
    "inputs on a line": (lambda: library(LIFT.replace("HEIGHT", "height")), {}),
    "faces that rest": (lambda: scene_of("cube_toss"), {}),
    "joints": (lambda: scene_of("four_bar"), {}),
    "time-stepping": (lambda: scene_of("cube_toss"), {"method": "time-stepping", "step": 2e-3}),
}


@pytest.mark.parametrize("which", GROUPS)
def test_a_saved_group_goes_on_bit_for_bit(which: str) -> None:
    """In the group that was saved, and in another one with other threads that began elsewhere."""
    model, numbers = GROUPS[which][0](), GROUPS[which][1]
    many, other = start_many(model, 3, **numbers), start_many(model, 3, threads=2, **numbers)
    if "height" in many.inputs:
        many.inputs.ramp("height", [-0.5, 0.0, 0.7])
    other.step(0.07)
    many.step(0.02)
    many.step(0.1, np.array([True, False, True]))
    for lane in range(3):
        many.events(lane)
    mark, inputs = many.save(), {name: values.copy() for name, values in many.inputs.items()}
    true = trace(many, 0.3)
    for group in (other, many):
        group.load(mark)
        assert group.save() == mark
        assert all(np.array_equal(group.inputs[name], inputs[name]) for name in inputs)
        assert trace(group, 0.3) == true


def test_a_saved_group_keeps_which_lanes_have_ended() -> None:
    model = library(PUCK)
    q = np.tile(model.manifest.instance["initial_q"], (3, 1))
    q[1, 2] -= 0.1
    many, other = start_many(model, 3, q=q), start_many(model, 3)
    many.step(0.1)
    other.load(many.save())
    assert other.outcomes == many.outcomes == (Outcome.DONE, None, Outcome.DONE)
    assert {lane: str(each) for lane, each in other.refused.items()} == {1: str(many.refused[1])}
    other.step(0.1)
    many.step(0.1)
    assert other.save() == many.save()
    assert other.t == pytest.approx([0.2, 0.0, 0.2])
    other.reset([1])  # to the start of the scene, which it can start from
    assert not other.refused
    with pytest.raises(ModelgenError, match="interpenetrate at the start"):
        many.reset([1])
    assert list(many.refused) == [1]


def test_a_state_that_does_not_fit_leaves_a_group_as_it_was() -> None:
    model, heft = library(HEAVY), [1.0, 2.0, 3.0]
    many = start_many(model, 3, parameters={"heft": heft})
    many.step(0.1)
    mark, alone = many.save(), start(model)
    foreign = {
        "a str; bytes": "text",
        "no saved state of runs of `start_many`": alone.save(),
        "a state of 2 runs; one of 3 runs; write start_many\\(library, 2": start_many(model, 2).save(),
        "load: run 1: it is of a scene with other tables": start_many(
            model, 3, parameters={"heft": [1.0, 2.5, 3.0]}
        ).save(),
        "load: run 0: it was saved with other settings": start_many(
            model, 3, parameters={"heft": heft}, accuracy="tight"
        ).save(),
        "load: run 0: it was saved by another library": start_many(scene_of("balancing_wheel"), 3).save(),
        "bytes are missing": mark[:-1],
        "load: bytes are missing or changed": mark[:-1] + bytes([mark[-1] ^ 1]),
    }
    many.step(0.1)
    before = many.save()
    for message, given in foreign.items():
        with pytest.raises(ModelgenError, match=message):
            many.load(given)
        assert many.save() == before
    for given in (mark, 3, None):
        with pytest.raises(ModelgenError, match=r"no saved state of a run|bytes; give what `save`"):
            alone.load(given)
    many.load(memoryview(mark))
    assert many.save() == mark


def test_mistakes_of_a_caller_of_many_runs() -> None:
    model = library(HEAVY)
    with pytest.raises(
        ModelgenError, match=r"parameter 'heft': an array of shape \(2,\); one number or \(3,\)"
    ):
        start_many(model, 3, parameters={"heft": [1.0, 2.0]})
    with pytest.raises(ModelgenError, match=r"q: shape \(2, 7\); finite numbers, \(3, 3\)"):
        start_many(model, 3, q=np.zeros((2, 7)))
    with pytest.raises(ModelgenError, match=r"u\[2\]: not finite; finite numbers, \(3, 3\)"):
        start_many(model, 3, u=[[0.0] * 3, [1.0] * 3, [np.nan] * 3])
    with pytest.raises(ModelgenError, match="n: 0; a whole number"):
        start_many(model, 0)
    many = start_many(model, 3)
    many.inputs["push"][2] = 60.0
    with pytest.raises(ModelgenError, match=r"input 'push' of lane 2: 60\.0; a number from -50 to 50"):
        many.step(0.1)
    with pytest.raises(ModelgenError, match="did you mean 'push'"):
        many.inputs["pusch"][0] = 1.0
    with pytest.raises(ModelgenError, match="a positive time"):
        many.step(-0.1)
    scene = library_of(read_text(LIFT.replace("HEIGHT", "height"), "driven.toml"))
    with pytest.raises(ModelgenError, match="ramp: 'heigth'; height"):
        start_many(scene, 2).inputs.ramp("heigth", 1.0)


def test_a_run_goes_on_from_where_it_was_saved() -> None:
    sim = start(scene_of("balancing_wheel"))
    sim.controller({"torque": "40*lean + 8*turning_y + 2*axle_x + 3*speed_x"}, every=0.02)
    sim.step(until=0.25)
    mark = sim.save()
    sim.step(until=0.5)
    end = sim.state.copy()
    other = start(scene_of("balancing_wheel"))
    other.controller({"torque": "40*lean + 8*turning_y + 2*axle_x + 3*speed_x"}, every=0.02)
    other.load(mark)
    assert other.t == 0.25
    other.step(until=0.5)
    assert np.array_equal(other.state, end)


def test_contacts_are_shown_at_the_present_state() -> None:
    sim = start(library(PUCK), inputs={"push": 4.0})
    sim.step(until=0.5)
    shown = sim.contacts["table-puck"]
    assert shown.force == pytest.approx(20.0)
    assert shown.gap == pytest.approx(0.0, abs=1e-12)
    assert shown.points[1] == pytest.approx([0.25, 0.0, 0.0], abs=1e-12)
    assert shown.normal == pytest.approx([0.0, 0.0, 1.0])


@pytest.mark.parametrize("kind", ["run", "group"])
def test_no_changed_state_is_loaded(kind: str) -> None:
    """Neither what the core saved nor what the instants of a controller and the outcomes of a group add."""
    model = library(HEAVY)
    sim = start(model) if kind == "run" else start_many(model, 3)
    sim.step(0.1)
    whole = sim.save()
    accepted = 0
    for mutant in mutants(whole, 400):
        with suppress(ModelgenError):
            sim.load(mutant)
            accepted += 1
    assert accepted == 0
    assert sim.save() == whole
