"""A run is the same with derivatives and without, and each derivative the same alone and among others."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.sensitivity import TangentRun
from modelgen.runtime.sensitivity_directions import direction_arrays, directions_of
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from tests.sensitivity.differences import MANY, shipped
from tests.sensitivity.test_differences import moving

SCENES = ("ellipsoid_on_plane", "bouncing_ellipsoid", "double_pendulum", "rolling_disc", "block_on_incline")


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", SCENES)
def test_derivatives_leave_the_run_as_it_is(name: str) -> None:
    library = shipped(name)
    until = 0.3 * float(library.manifest.instance["run"]["until"])
    directions = directions_of(library.manifest.instance, [f"{moving(library)[0]}.velocity"])

    def session() -> Session:
        return Session(library, accuracy_of(library.manifest.instance, None, {}))

    plain = session()
    begin(plain)
    while plain.advance(until, MANY, plain.tables.Record()) in (CONTINUE, FULL):
        plain.drain_events()
    runs = {
        n: TangentRun(session(), direction_arrays(library, directions[:n]), n).go_on(until) for n in (0, 1, 3)
    }
    for run in runs.values():
        assert np.array_equal(run.session.x, plain.x)
        assert run.session.run.rejected == plain.run.rejected
    assert np.array_equal(runs[1].state_derivatives()[0], runs[3].state_derivatives()[0])
