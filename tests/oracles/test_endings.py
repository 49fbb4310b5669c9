"""Runs that cannot go on say why, and keep what they computed."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, ball, ran, solid
from tests.running import library_of


def test_bodies_that_start_inside_each_other_are_refused_by_name() -> None:
    with pytest.raises(SimulationError, match=r"'b-table'.*interpenetrate.*0.01"):
        ran([TABLE, ball("b", [0, 0, 0.09])], 1.0, [{"between": ["b", "table"]}])


@pytest.mark.parametrize(("first", "second"), [("b", "table"), ("table", "b")])
def test_moved_as_the_refusal_says_the_bodies_touch(first: str, second: str) -> None:
    with pytest.raises(SimulationError) as refused:
        ran([TABLE, ball("b", [0, 0, 0.09])], 1.0, [{"between": [first, second]}])
    found = re.search(r"move 'b' by (\S+) m along \((.*?)\)", str(refused.value))
    assert found is not None
    way = float(found[1]) * np.array([float(x) for x in found[2].split(",")])
    start = ball("b", list(np.array([0, 0, 0.09]) + way))
    assert ran([TABLE, start], 0.01, [{"between": [first, second]}]).outcome is Outcome.DONE


def test_a_ball_squeezed_between_rigid_walls_ends_the_run_at_that_moment() -> None:
    press = make.driven(
        "press",
        make.plane(),
        path={"position": ["0.0", "0.0", "0.5-t"], "rotation_vector": ["pi", "0.0", "0.0"]},
    )
    contact = [{"between": ["b", side]} for side in ("table", "press")]
    path = ran([TABLE, press, ball("b", [0, 0, 0.1])], 1.0, contact)
    assert path.outcome is Outcome.COMPLEMENTARITY
    assert path.t_end == pytest.approx(0.3, abs=1e-9)
    assert path.t[-1] == path.t_end
    assert np.abs(path.p[:, 2] - [0, 0, 0.1]).max() < 1e-12


@pytest.mark.slow
def test_an_almost_conforming_pair_is_refused_by_the_name_of_its_contact() -> None:
    bed = make.fixed("bed", make.ellipsoid(0.1200001, 0.0900001, 0.0700001, cavity=True))
    egg = solid("egg", (0.12, 0.09, 0.07), position=[0, 0, -1e-7], velocity=[0.01, 0, 0])
    path = ran([bed, egg], 1.0, [{"between": ["egg", "bed"]}])
    assert path.outcome is Outcome.MARGIN
    assert path.outcome_contact == "egg-bed#1"
    assert path.margin_min < 1e-5


@pytest.mark.slow
def test_an_egg_sliding_along_a_trough_that_comes_to_fit_it_stops_at_the_margin() -> None:
    # curvatures across the trough: 10 / m of the egg, 10 - 2 exp(-8 u) of the trough; margin exp(-8 u) / 10
    trough = make.chart("u", "v", "v**2*(5-exp(-8*u))", domain=[(-0.3, 2), (-0.5, 0.5)])
    egg = solid("egg", (0.2, 0.1, 0.1), position=[0, 0, 0.1], velocity=[1.0, 0, 0])
    path = ran([make.fixed("trough", trough), egg], 2.0, [{"between": ["egg", "trough"]}])
    assert path.outcome is Outcome.MARGIN
    assert path.outcome_contact == "egg-trough#1"
    (singular,) = (event.t for event in path.events if event.kind == "near-singular")
    assert singular == pytest.approx(np.log(1e4) / 8, abs=1e-4)
    assert singular < path.t_end < singular + 1e-3  # time-stepping does not lead past it
    assert path.margin_min <= 1.00001e-5
    assert path.t[-1] == path.t_end
    assert path.penetration_max < 1e-6


@pytest.mark.slow
def test_an_egg_sliding_to_where_a_trough_is_narrower_than_itself_slides_on_on_two_points() -> None:
    # radii of curvature across the trough: 0.1 m of the egg, 1 / (8 + 4 u) of the trough
    trough = make.chart("u", "v", "v**2*(4+2*u)", domain=[(-2, 2), (-0.5, 0.5)])
    egg = solid("egg", (0.2, 0.1, 0.1), position=[0, 0, 0.1], velocity=[1.0, 0, 0])
    path = ran([make.fixed("trough", trough), egg], 2.0, [{"between": ["egg", "trough"]}])
    assert path.outcome is Outcome.DONE
    # the curvatures agree at u = 0.5, which the egg reaches at t = 0.5
    assert path.events[0].t == pytest.approx(0.5, abs=1e-4)
    assert path.force[-1, 0] == pytest.approx(path.force[-1, 1], rel=1e-9)
    assert path.energy_drift < 1e-11
    u, v = np.meshgrid(np.linspace(-2, 2, 1601), np.linspace(-0.1, 0.1, 201))
    x = np.stack([u, v, v**2 * (4 + 2 * u)], axis=-1) - path.p[-1, 1]
    w, a, b, c = path.quaternion[-1, 1]
    turn = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    own = x @ (np.eye(3) + 2 * w * turn + 2 * turn @ turn)
    depth = np.sqrt(np.sum((own / [0.2, 0.1, 0.1]) ** 2, axis=-1)).min() - 1
    assert 0 < depth < 1e-4


def test_an_interrupt_keeps_what_was_computed() -> None:
    scene = make.scene(
        "interrupted", [TABLE, solid("egg", (0.12, 0.09, 0.07), position=[0, 0, 0.08], rpy=[0.3, 0, 0])],
        contact=[{"between": ["egg", "table"], "restitution": 0.9}],
    )  # fmt: skip
    library = library_of(scene)
    whole = simulate(library, until=50.0, accuracy=Accuracy.balanced(), samples=500)

    def stop(share: float) -> None:
        if share > 0.02:
            raise KeyboardInterrupt

    part = simulate(library, until=50.0, accuracy=Accuracy.balanced(), samples=500, on_progress=stop)
    assert part.outcome is Outcome.INTERRUPTED
    assert 1 < len(part.t) < len(whole.t)
    assert np.array_equal(part.p[:-1], whole.p[: len(part.t) - 1])
    assert part.events == whole.events[: len(part.events)]
    assert part.t[-1] == part.t_end < 50.0
    near = np.searchsorted(whole.t, part.t_end)
    assert np.linalg.norm(part.p[-1] - whole.p[near]) < 0.2 * np.linalg.norm(whole.v[near])


@pytest.mark.cases(2)
@pytest.mark.parametrize(
    ("torque", "end", "joined"),
    [("sqrt(-1 - t)", 0.0, True), ("sqrt(0.3 - t)", 0.3, False), ("1/(t - 0.2)", 0.2, False)],
)
def test_a_load_that_is_not_finite_ends_the_run_by_its_name(torque: str, end: float, joined: bool) -> None:
    """Not as friction that jams, though nothing obeys Coulomb's law under it; a pole is not stepped over."""
    upright: dict[str, Any] = {"name": "upright", "kind": "planar", "between": ["world", "ball"]}
    upright |= {"position": [0, 0, 0.1], "axis_angle": {"axis": [1, 0, 0], "angle": "-pi/2"}}
    scene = make.scene(
        "torn", [TABLE, solid("ball", (0.1, 0.1, 0.1), position=[0, 0, 0.1])],
        contact=[{"between": ["ball", "table"], "friction": 0.6}], joint=[upright] if joined else [],
        torque=[{"body": "ball", "torque": [0, 0, 0]}, {"body": "ball", "torque": [0, torque, 0]}],
    )  # fmt: skip
    library = library_of(scene)
    for method in ({}, {"method": "time-stepping", "step": 1e-3}):
        path = simulate(library, until=0.5, estimate=False, **method)  # type: ignore[arg-type]
        assert path.outcome is Outcome.NOT_FINITE
        assert path.outcome_function == "torque[1] on 'ball'"
        assert path.t_end == pytest.approx(end, abs=1e-6 if not method else 2e-3)
        assert not any("Painleve" in warning for warning in path.warnings)
        assert np.isfinite(path.p).all()


@pytest.mark.cases(2)
@pytest.mark.parametrize("gap", [0.0, 10.0])
@pytest.mark.parametrize("height", ["0.01*sqrt(0.3 - t)", "0.01*log(0.3 - t)"])
def test_a_path_that_is_not_finite_ends_the_run_by_its_name(height: str, gap: float) -> None:
    """Whether or not anything touches the body that is nowhere."""
    moved = make.driven("table", make.plane(), path={"position": ["0", "0", f"{height} - {gap}"]})
    scene = make.scene(
        "nowhere", [moved, solid("ball", (0.1, 0.1, 0.1), position=[0, 0, 0.2])],
        contact=[{"between": ["ball", "table"]}],
    )  # fmt: skip
    library = library_of(scene)
    for method in ({}, {"method": "rk4", "step": 1e-3}, {"method": "time-stepping", "step": 1e-3}):
        path = simulate(library, until=0.5, estimate=False, **method)  # type: ignore[arg-type]
        assert (path.outcome, path.outcome_function) == (Outcome.NOT_FINITE, "path of 'table'")
        assert path.t_end == pytest.approx(0.3, abs=2e-3 if method else 1e-6)
        assert np.isfinite(path.p[:, 1]).all()


def cranked(motion: str) -> Library:
    crank = {"name": "crank", "kind": "revolute", "between": ["world", "ball"], "motion": motion}
    scene = make.scene("cranked", [solid("ball", (0.1, 0.1, 0.1), position=[0, 0, 0])], joint=[crank])
    return library_of(scene)


def test_a_scene_without_contacts_goes_on_by_time_stepping() -> None:
    path = simulate(cranked("t**2/(0.3 - t)"), until=0.5, estimate=False)
    assert path.outcome is Outcome.DONE
    assert [(each.kind, each.contact) for each in path.events[:2]] == [
        ("fallback-start", ""), ("fallback-end", "")
    ]  # fmt: skip


def test_a_motion_that_is_not_finite_ends_the_run_by_its_name() -> None:
    path = simulate(cranked("t**2*sqrt(0.3 - t)"), until=0.5, estimate=False)
    assert (path.outcome, path.outcome_function) == (Outcome.NOT_FINITE, "motion of joint 'crank'")
    assert path.t_end == pytest.approx(0.3, abs=1e-6)


@pytest.mark.parametrize("instant", [0.3, 0.25, 0.123456789])
def test_loads_that_jump_or_have_an_impulse_do_not_end_the_run(instant: float) -> None:
    force = ["sign(t - 0.2)", "exp(-((t - 0.25)/1e-3)**2)", f"1/sqrt(abs(t - {instant}))"]
    scene = make.scene(
        "pushed", [TABLE, solid("ball", (0.1, 0.1, 0.1), position=[0, 0, 0.1])],
        contact=[{"between": ["ball", "table"], "friction": 0.6}], force=[{"body": "ball", "force": force}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.5, estimate=False)
    assert path.outcome is Outcome.DONE
    assert "fallback-start" not in {event.kind for event in path.events}


@pytest.mark.cases(6)
@pytest.mark.parametrize("power", [0.3, 0.5, 0.6])
@pytest.mark.parametrize("instant", [0.3, 0.25, 0.123456789])
@pytest.mark.parametrize(
    ("side", "parts"),
    [("1", (1, 1)), ("max(0, t - {0})/abs(t - {0})", (0, 1)), ("max(0, {0} - t)/abs(t - {0})", (1, 0))],
)
def test_an_infinite_load_that_is_integrable_gives_its_impulse(
    power: float, instant: float, side: str, parts: tuple[int, int]
) -> None:
    """Against the integral of |t - t0|^-p on both sides, or on one.

    The instant is known to half an ulp, e: the impulse is known to some e^(1 - p).
    """
    load = f"{side.format(instant)}*abs(t - {instant})**(-{power})"
    push = [{"body": "ball", "force": [load, "0", "0"]}]
    scene = make.scene("pushed", [TABLE, solid("ball", (0.1, 0.1, 0.1), position=[0, 0, 0.5])], force=push)
    library = library_of(replace(scene, gravity=(0.0, 0.0, 0.0)))
    path = simulate(library, until=0.5, samples=2, estimate=False)
    impulse = sum(
        part * span ** (1 - power) / (1 - power)
        for part, span in zip(parts, (instant, 0.5 - instant), strict=True)
    )
    mass = 1 / library.manifest.instance["bodies"][1]["mass_inverse"][0]
    assert path.outcome is Outcome.DONE
    assert not path.events
    known = 100 * np.finfo(float).eps ** (1 - power) / mass
    assert path.v[-1, 1, 0] == pytest.approx(impulse / mass, abs=known + 1e-8)


@pytest.mark.parametrize("instant", [0.3, 0.25])
def test_a_body_is_lifted_at_once_by_an_infinite_load_that_is_integrable(instant: float) -> None:
    load = f"max(0, t - {instant})/abs(t - {instant})**1.5"
    scene = make.scene(
        "lifted", [TABLE, solid("ball", (0.1, 0.1, 0.1), position=[0, 0, 0.1])],
        contact=[{"between": ["ball", "table"]}],
        force=[{"body": "ball", "force": ["0", "0", f"300*{load}"]}],
    )  # fmt: skip
    library = library_of(scene)
    path = simulate(library, until=0.5, samples=2, estimate=False)
    mass, span = 1 / library.manifest.instance["bodies"][1]["mass_inverse"][0], 0.5 - instant
    assert [event.kind for event in path.events] == ["lift-off"]
    assert path.events[0].t == pytest.approx(instant, abs=1e-12)
    late = 600 / mass * 1e-7  # what the load gives within the tolerance of the time of an event, 1e-14 s
    assert path.v[-1, 1, 2] == pytest.approx(600 / mass * span**0.5 - 9.81 * span, abs=4 * late)
