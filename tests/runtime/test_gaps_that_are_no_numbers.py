"""A contact whose gap, or whose velocity term, is no number ends the run; it does not count as open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import casadi as ca
import pytest

from modelgen import simulate
from modelgen.contact.form_table import choose_form, contact_kernels
from modelgen.geometry.support_maps import Support
from modelgen.geometry.surface_catalogue import SURFACES
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from tests.running import library_of

TURN = 5.0  # rad/s
BREAKS = 0.5  # component of the normal along x beyond which a square root has no value


def gap(good: Support, nothing: ca.SX) -> Support:
    return replace(good, height=good.height + nothing)


def velocity_term(good: Support, nothing: ca.SX) -> Support:
    return replace(good, form=lambda m: good.form(m) + nothing)


@pytest.fixture(params=[gap, velocity_term])
def broken(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Ellipsoids of which one part of the support map has no value where they are turned too far."""
    whole = SURFACES["ellipsoid"]
    spoil: Callable[[Support, ca.SX], Support] = request.param

    def support(n: ca.SX, p: ca.SX) -> Support:
        assert whole.support is not None
        return spoil(whole.support(n, p), 1e-30 * ca.sqrt(BREAKS - ca.fabs(n[0])))

    monkeypatch.setitem(SURFACES, "ellipsoid", replace(whole, support=support))  # type: ignore[arg-type]
    contact_kernels.cache_clear(), choose_form.cache_clear()
    yield request.param.__name__
    contact_kernels.cache_clear(), choose_form.cache_clear()


@pytest.mark.parametrize("method", ["dop853", "time-stepping"])
@pytest.mark.parametrize("height", [0.1, 0.5])
def test_a_run_ends_where_a_gap_is_no_number(height: float, method: str, broken: str) -> None:
    """Time-stepping has no use for the velocity term."""
    egg = make.dynamic(
        "egg", make.ellipsoid(0.1, 0.1, 0.1), density=1000.0,
        position=[0, 0, height], angular_velocity=[0, TURN, 0],
    )  # fmt: skip
    contact = [{"between": ["egg", "floor"], "form": "support"}]
    scene = make.scene("egg", [make.fixed("floor", make.plane()), egg], contact=contact)
    stepping = {"method": method, "step": 1e-3} if method == "time-stepping" else {}
    path = simulate(library_of(scene), until=0.4, samples=5, **stepping)
    assert not path.is_trusted
    assert path.p[:, 1, 2].min() > 0.1 - 1e-6
    if broken == "gap" or not stepping:
        assert path.outcome is Outcome.NOT_FINITE
    if broken == "gap":
        assert path.outcome_contact == "egg-floor"
        assert path.t_end < 0.2
