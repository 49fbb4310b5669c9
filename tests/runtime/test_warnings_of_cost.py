"""A run whose steps are far shorter than its motion says so."""

from __future__ import annotations

import re

from modelgen import read, simulate
from modelgen.runtime.trajectory import Event
from modelgen.runtime.warnings.slip_changes import MANY, slip_change_warnings
from modelgen.scene import python_scenes as make
from tests.benchmarks.cliffs import SHIPPED, rocking_can, spinning_box
from tests.running import library_of


def test_a_run_of_very_short_steps_says_how_many_and_what_bounds_them() -> None:
    library = library_of(rocking_can())
    path = simulate(library, until=0.06, samples=2, accuracy="fast", estimate=False)
    (told,) = (warning for warning in path.warnings if "steps were short" in warning)
    tried = path.steps + path.rejected
    assert int(re.findall(r"\d+", told)[0]) == tried > 10_000
    bounded = simulate(library, until=0.06, samples=2, method="time-stepping", step=1e-4, estimate=False)
    assert bounded.outcome.succeeded
    assert bounded.steps + bounded.rejected < tried / 10


def test_a_run_of_usual_steps_does_not() -> None:
    path = simulate(library_of(spinning_box()), until=0.25, samples=2, estimate=False)
    assert not any("steps were short" in warning for warning in path.warnings)


def test_a_coin_that_sticks_and_slips_in_turn_says_how_often_and_what_bounds_the_steps() -> None:
    library = library_of(read(SHIPPED / "coin.toml"))
    path = simulate(library, until=4.05, samples=2, accuracy="fast", estimate=False)
    (told,) = (warning for warning in path.warnings if "between sticking and slipping" in warning)
    changes = [event.t for event in path.events if event.kind in ("slip-start", "slip-stop")]
    assert int(re.findall(r"\d+", told)[0]) == len(changes) > MANY
    assert re.findall(r"t = ([\d.]+) s", told) == [f"{changes[0]:.4g}"]
    bounded = simulate(library, until=4.05, samples=2, method="time-stepping", step=1e-3, estimate=False)
    assert bounded.outcome.succeeded
    assert bounded.rhs_evals < path.rhs_evals / 10


def test_changes_far_apart_and_at_different_contacts_are_not_told() -> None:
    changes = [
        Event(0.1 * k, "slip-start" if k % 2 else "slip-stop", f"ball-table#{k % 3}", "") for k in range(90)
    ]
    assert not slip_change_warnings(changes, 1.0)
    assert len(slip_change_warnings(changes, 10.0)) == 3


def test_of_many_contacts_that_change_those_that_change_most_are_told() -> None:
    changes = [
        Event(0.01 * k, "slip-start", f"ball-table#{contact}", "")
        for contact in range(9)
        for k in range(2 * MANY + contact)
    ]
    told = slip_change_warnings(changes, 10.0)
    assert [each.partition(" ")[0] for each in told] == [f"ball-table#{k}" for k in (8, 7, 6)]
    assert all(each.endswith("6 other contacts as well") for each in told)


def test_a_run_of_a_body_that_turns_fast_names_it() -> None:
    top = make.dynamic("top", make.cylinder(0.02, 0.1), density=7800.0, angular_velocity=[0.0, 0.0, 1e5])
    path = simulate(library_of(make.scene("top", [top])), until=0.1, samples=2, estimate=False)
    (told,) = (warning for warning in path.warnings if "steps were short" in warning)
    assert "because top turns at 1e+05 rad/s" in told
