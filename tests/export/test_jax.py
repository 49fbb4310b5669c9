"""`--to jax`: runs and gradients in a process that cannot import modelgen, against modelgen's own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen import ModelgenError, build, derive, emit, gradient, read, require
from modelgen.codegen.library import Library
from modelgen.runtime.sensitivity_directions import turned
from tests.c_compiler import needs_c
from tests.docs.pages import MANUAL, blocks
from tests.export.folders import exported
from tests.export.test_casadi import BARRED
from tests.running import SCENES, folder

needs_jax = pytest.mark.skipif(find_spec("jax") is None, reason="needs jax (extra `jax`)")

LOADED = (
    BARRED
    + """
import json
import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)
from load import load

scene = load()
"""
)

ALONE = (
    LOADED
    + """
times = json.loads(sys.argv[2])
n, run = len(times), scene.run(times)
q, u, inputs = map(jnp.asarray, (scene.q, scene.u, scene.inputs(n)))
random = np.random.default_rng(3)
sizes = (n, len(scene.sensors)), (n, q.size), (n, u.size)
weights = [jnp.asarray(random.uniform(0.5, 1.0, size)) for size in sizes]

def loss(q, u, inputs):
    out = run(q, u, inputs)
    return sum(jnp.vdot(w, x) for w, x in zip(weights, (out.sensors, out.q, out.u)))

value, bars = jax.value_and_grad(loss, argnums=(0, 1, 2))(q, u, inputs)
slope = jax.grad(loss, argnums=(0, 1, 2))
jitted = jax.jit(slope)(q, u, inputs), jax.jit(run)(q, u, inputs)
changes = np.linspace(-0.05, 0.05, 5)[:, None] * np.ones(u.size)
lanes = jax.vmap(lambda du: slope(q, u + du, inputs))(changes)
alone = [slope(q, u + du, inputs) for du in changes]
same = all(
    np.array_equal(np.asarray(many)[k], one)
    for k in range(len(changes))
    for many, one in zip(jax.tree.leaves(lanes), jax.tree.leaves(alone[k]))
)
runs = jax.vmap(lambda du: run(q, u + du, inputs))(changes)
each = [run(q, u + du, inputs) for du in changes]
same_runs = all(np.array_equal(np.asarray(a)[k], b) for k in range(5) for a, b in zip(runs, each[k]))
if len(sys.argv) > 3:
    exec(sys.argv[3])
    scene, run = load(), scene.run(times)
step = random.uniform(-1, 1, inputs.shape)
bumped = [float(loss(q, u, inputs + h * step)) for h in (2e-3, 1e-3, -1e-3, -2e-3)]
told = scene.verdict(times)(q, u, inputs)
out = run(q, u, inputs)
print(json.dumps({
    "value": float(value), "q": bars[0].tolist(), "u": bars[1].tolist(), "inputs": bars[2].tolist(),
    "jitted": jax.tree.all(jax.tree.map(np.array_equal, jitted, (bars, run(q, u, inputs)))),
    "same": same, "same_runs": same_runs, "weights": [w.tolist() for w in weights], "step": step.tolist(),
    "bumped": bumped, "verdict": [int(told.outcome), int(told.verdict)], "states": out.q.tolist(),
    "outcome": int(out.outcome), "late": int(run(q * jnp.nan, u, inputs).outcome),
}))
"""
)
CASES = {"bouncing_ellipsoid": [0.1, 0.3], "balancing_wheel": [0.1, 0.2, 0.35]}
NAMED = ["bouncing_ellipsoid", pytest.param("balancing_wheel", marks=pytest.mark.slow)]


@cache
def told(name: str) -> dict[str, Any]:
    """What JAX says of a scene."""
    made = exported(name, "jax", folder() / f"jax-{name}")
    shown = blocks(MANUAL / "export.md", "py") if name == "balancing_wheel" else []
    command = [sys.executable, "-c", ALONE, str(made), json.dumps(CASES[name]), *shown]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=dict(os.environ))
    assert done.returncode == 0, done.stderr[-3000:]
    return dict(json.loads(done.stdout.splitlines()[-1]))


@cache
def library(name: str) -> Library:
    scene = read(SCENES / f"{name}.toml")
    return build(emit(derive(require(scene)), derivatives=True), folder=folder() / f"derivatives-{name}")


def own_gradient(name: str, found: dict[str, Any]) -> tuple[float, np.ndarray, np.ndarray]:
    """Value, gradient, and the same of what JAX has found, by all starts and inputs."""
    own = library(name)
    instance = own.manifest.instance
    inputs = [each["name"] for each in instance["inputs"]]
    bodies = [body for body in instance["bodies"] if body["motion"] == "free"]
    shown, q, u = (np.array(each) for each in found["weights"])
    columns = [shown, *(part for b in bodies for part in (q[:, b["q"] :][:, :7], u[:, b["u"] :][:, :6]))]
    quantities = ("position", "orientation", "velocity", "angular_velocity")
    every = [f"{body['name']}.{quantity}" for body in bodies for quantity in quantities]
    weights = np.hstack(columns)
    values = ca.SX.sym("values", *weights.shape)
    loss = ca.Function("loss", [values], [ca.sum1(ca.sum2(ca.DM(weights) * values))])
    of = [*(each for each, _ in instance["sensors"]["names"]), *every]
    mine = gradient(own, CASES[name], loss, of=of, by=[*inputs, *every])
    theirs = list(np.sum(np.array(found["inputs"]), axis=0))
    for body in bodies:
        q_bar, u_bar = np.array(found["q"][body["q"] :][:7]), np.array(found["u"][body["u"] :][:6])
        start = np.array(instance["initial_q"][body["q"] + 3 :][:4])
        theirs += [*q_bar[:3], *(turned(start, axis) @ q_bar[3:] for axis in range(3)), *u_bar]
    return mine.value, mine.gradient, np.array(theirs)


@needs_c
@needs_jax
@pytest.mark.parametrize("name", NAMED)
def test_gradients_are_those_of_modelgen(name: str) -> None:
    """To the error of a step, as only runs of JAX end steps at the given times."""
    found = told(name)
    value, mine, theirs = own_gradient(name, found)
    assert found["value"] == pytest.approx(value, rel=1e-10)
    assert np.abs(theirs - mine).max() < 1e-10 * np.abs(mine).max()
    assert found["verdict"] == [0, 0]
    assert found["outcome"] == 0


@needs_c
@needs_jax
@pytest.mark.parametrize("name", NAMED)
def test_lanes_and_compiled_functions_have_the_same_bits(name: str) -> None:
    found = told(name)
    assert found["same"]
    assert found["same_runs"]
    assert found["jitted"]


@needs_c
@needs_jax
@pytest.mark.slow
def test_inputs_of_each_interval_are_differentiated() -> None:
    """Against differences along a change of all of them, to fourth order."""
    found = told("balancing_wheel")
    far, near, back, far_back = found["bumped"]
    difference = (8 * (near - back) - (far - far_back)) / 12e-3
    along = float(np.vdot(found["step"], found["inputs"]))
    assert along == pytest.approx(difference, rel=1e-8)


@needs_c
@needs_jax
def test_a_start_that_is_refused_has_an_outcome() -> None:
    assert told("bouncing_ellipsoid")["late"] != 0


INPUTS = (
    LOADED
    + """
n = 3
run, verdict = scene.run([0.1, 0.2, 0.3]), scene.verdict([0.1, 0.2, 0.3])
name, (low, high) = scene.input_names[0], scene.input_ranges[0]
random, told = np.random.default_rng(1), []
whole = run(scene.q, scene.u, scene.inputs(n)).q

def end(inputs):
    return run(scene.q, scene.u, inputs).q[-1].sum()

for wrong in (np.nan, np.inf, -np.inf, np.nextafter(high, np.inf), np.nextafter(low, -np.inf), 2 * high):
    row, given = int(random.integers(n)), scene.inputs(n)
    given[row, 0] = wrong
    messages = []
    for function in (run, verdict):
        try:
            function(scene.q, scene.u, given)
        except ValueError as error:
            messages.append(str(error))
    lanes = jax.vmap(lambda inputs: run(scene.q, scene.u, inputs))(np.stack([given, scene.inputs(n)]))
    value, slope = jax.value_and_grad(end)(given)
    doubt = jax.jit(verdict)(scene.q, scene.u, given)
    shown = [lanes.sensors[0], lanes.q[0], lanes.u[0], jax.jit(run)(scene.q, scene.u, given).q, value, slope]
    told.append({
        "messages": messages, "named": f"inputs[{row}]: {name!r} is {wrong:g}",
        "outcomes": lanes.outcome.tolist(), "nan": all(bool(np.isnan(each).all()) for each in shown),
        "other": bool(np.array_equal(lanes.q[1], whole)), "verdict": [int(doubt.outcome), int(doubt.verdict)],
    })
allowed = [int(run(scene.q, scene.u, np.full((n, 1), end)).outcome) for end in (low, high)]
print(json.dumps({"told": told, "allowed": allowed, "text": scene.outcomes["-2"]}))
"""
)


@needs_c
@needs_jax
def test_inputs_out_of_range_are_refused_by_name_and_in_transformed_functions_by_nan() -> None:
    """And other lanes have the bits of a run alone."""
    made = exported("balancing_wheel", "jax", folder() / "jax-inputs")
    done = subprocess.run(
        [sys.executable, "-c", INPUTS, str(made)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["allowed"] == [0, 0]
    assert "beyond its range" in found["text"]
    for each in found["told"]:
        assert len(each["messages"]) == 2
        assert all(message.startswith(each["named"]) for message in each["messages"])
        assert each["outcomes"] == [-2, 0]
        assert each["nan"]
        assert each["other"]
        assert each["verdict"] == [-2, 2]


@pytest.mark.skipif(find_spec("jax") is not None, reason="JAX is there")
def test_without_jax_the_export_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match=r"no package 'jax'.*modelgen-contact\[jax\]"):
        exported("bouncing_ball", "jax", tmp_path)
