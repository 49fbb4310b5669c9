"""Each solver of a run obeys the law that it stands for; what a scene cannot have is refused by name."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, simulate, simulate_batch, start, start_many
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.export.scene_header_and_tables import scene_files
from modelgen.runtime.core_session import Session
from modelgen.runtime.friction import FrictionProblem, FrictionSolution, Motion, Outcome, polyhedral
from modelgen.runtime.friction.outer_solver import OuterSolver
from modelgen.runtime.session_group import SessionGroup
from modelgen.runtime.settings import Stepping
from modelgen.runtime.solver_choice import FRICTIONAL, FRICTIONLESS
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import G
from tests.running import library_of, scene_of

STEP = 0.004  # s
MU = 0.4
FINE = {"qp": 0.0, "lcp": 1e-10, "mpcc": 1e-10}  # m; what each may differ by from the core's, in 0.2 s


def pile(seed: int, friction: float) -> Library:
    """A box and balls that fall on each other and on a plane."""
    random = np.random.default_rng(seed)
    balls = [
        make.dynamic(
            f"ball{i}",
            make.sphere(0.05),
            density=1000.0,
            position=[*random.uniform(-0.03, 0.03, 2), 0.17 + 0.11 * i],
            velocity=[*random.uniform(-0.5, 0.5, 2), -0.5],
        )
        for i in range(2)
    ]
    box = make.dynamic("box", make.box(0.2, 0.2, 0.1), density=1000.0, position=[0.0, 0.0, 0.06])
    bodies = [make.fixed("floor", make.plane()), box, *balls]
    contacts: dict[str, object] = {"between": "all"} | ({"friction": friction} if friction else {})
    return library_of(make.scene("pile", bodies, contacts=contacts))


def stepped(library: Library, solver: str, until: float = 0.2, step: float = STEP) -> Trajectory:
    how = Stepping(method="time-stepping", step=step, solver=solver)
    run = simulate(library, until=until, samples=1, estimate=False, **how)
    assert run.outcome.name == "DONE"
    return run


@pytest.mark.parametrize(
    ("method", "solver"),
    [*(("time-stepping", name) for name in FRICTIONLESS), ("dop853", "qp"), ("dop853", "lcp")],
)
def test_without_friction_all_solvers_lead_to_one_motion(method: str, solver: str) -> None:
    how = Stepping(method=method, step=STEP if method == "time-stepping" else None)
    for seed in range(3):
        library = pile(seed, 0.0)
        own = simulate(library, until=0.2, samples=1, estimate=False, **how)
        other = simulate(library, until=0.2, samples=1, estimate=False, solver=solver, **how)
        assert (own.solver, other.solver) == ("qp", solver)
        assert other.solves[solver] > 0
        assert np.abs(other.p[-1] - own.p[-1]).max() <= FINE[solver]


@pytest.mark.parametrize("seed", range(2))
def test_ipopt_finds_the_impulses_of_coulombs_law_that_the_core_finds(seed: int) -> None:
    library = pile(seed, MU)
    own, other = (stepped(library, name, until=0.1) for name in ("coulomb", "mpcc"))
    assert other.solves["mpcc"] > 0
    assert np.abs(other.p[-1] - own.p[-1]).max() < 1e-5


@pytest.mark.parametrize("angle", np.linspace(0.0, np.pi / 8, 4))
def test_friction_of_eight_sides_is_as_strong_as_its_polygon(angle: float) -> None:
    """A box that slides is stopped by mu g cos(pi/8) to mu g, at most pi/8 off its velocity."""
    speed, until = 1.0, 0.1
    box = make.dynamic(
        "box", make.box(0.2, 0.2, 0.02), density=1000.0, position=[0.0, 0.0, 0.01],
        velocity=[speed * np.cos(angle), speed * np.sin(angle), 0.0],
    )  # fmt: skip
    scene = make.scene(
        "slide", [make.fixed("floor", make.plane()), box], contacts={"between": "all", "friction": MU}
    )
    run = stepped(library_of(scene), "polyhedral", until)
    slowed = (np.array([np.cos(angle), np.sin(angle), 0.0]) * speed - run.v[-1, 1]) / (MU * G * until)
    along = slowed @ [np.cos(angle), np.sin(angle), 0.0]
    across = slowed @ [-np.sin(angle), np.cos(angle), 0.0]
    assert np.cos(np.pi / 8) ** 2 - 1e-3 < along < 1.0 + 1e-3
    assert np.hypot(along, across) < 1.0 + 1e-3


def test_what_the_scene_cannot_have_is_refused() -> None:
    frictionless, frictional = pile(0, 0.0), pile(0, MU)
    cases = [
        (frictionless, "time-stepping", {*FRICTIONAL} - {*FRICTIONLESS, "coulomb"}),
        (frictionless, "dop853", {*FRICTIONAL, "mpcc"} - {"coulomb"}),
        (frictional, "time-stepping", {*FRICTIONLESS} - {*FRICTIONAL}),
        (frictional, "dop853", {*FRICTIONLESS, *FRICTIONAL} - {"coulomb"}),
    ]
    for library, method, names in cases:
        for name in names:
            how = Stepping(method=method, step=STEP if method == "time-stepping" else None, solver=name)
            with pytest.raises(SimulationError, match=rf"^solver: '{name}'; .*(qp, lcp|coulomb)"):
                simulate(library, until=0.1, **how)
            with pytest.raises(SimulationError, match=rf"^solver: '{name}'; "):
                Session(library, accuracy(method, name))


def accuracy(method: str, solver: str) -> Accuracy:
    own = Accuracy.balanced()
    own = own.time_stepping(STEP) if method == "time-stepping" else own
    return own.solved_by(solver)  # type: ignore[arg-type]


def test_runs_in_threads_are_those_alone() -> None:
    library = pile(1, 0.0)
    lanes = SessionGroup(library, n=3, accuracies=[accuracy("time-stepping", "lcp")] * 3)
    assert not lanes.begin()
    lanes.advance(0.1, threads=2)
    alone = Session(library, accuracy("time-stepping", "lcp"))
    alone.begin()
    record = alone.tables.Record()
    while alone.advance(0.1, 10**6, record):
        alone.drain_events()
    assert (lanes.x == alone.x).all()


def test_an_exception_in_a_solver_is_that_of_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    library = pile(2, MU)
    session = Session(library, accuracy("time-stepping", "polyhedral"))
    chosen = session.settings.chosen
    assert isinstance(chosen, OuterSolver)
    assert chosen._solver is polyhedral
    monkeypatch.setattr(chosen, "_solver", fails)
    session.begin()
    with pytest.raises(ZeroDivisionError, match="of a solver"):
        session.advance(0.1, 100, session.tables.Record())
    monkeypatch.undo()
    again = Session(library, accuracy("time-stepping", "polyhedral"))
    again.begin()
    assert again.advance(STEP, 100, again.tables.Record()) == 0


def test_a_saved_state_is_of_its_solver() -> None:
    library = pile(0, 0.0)
    sessions = [Session(library, accuracy("time-stepping", name)) for name in ("coulomb", "lcp", "mpcc")]
    for session in sessions:
        session.begin()
    for saved in sessions:
        for other in sessions:
            if other is saved:
                other.load(saved.save())
                continue
            with pytest.raises(SimulationError, match="other settings"):
                other.load(saved.save())


def test_an_export_has_the_solvers_of_the_core_alone() -> None:
    session = Session(scene_of("bouncing_ball"), accuracy("dop853", "lcp"))
    with pytest.raises(SimulationError, match=r"run\.solver: 'lcp'; coulomb, qp or relaxation"):
        scene_files(session)


def fails(*_: object) -> None:
    raise ZeroDivisionError("of a solver")


def gives_up(problem: FrictionProblem, _: object) -> FrictionSolution:
    none = np.zeros(problem.n)
    opens = (Motion.OPEN,) * len(problem.first)
    return FrictionSolution(none, none, Outcome.NOT_FOUND, 1.0, 1.0, "", 0, opens)


def test_every_way_to_run_raises_what_a_solver_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("modelgen.runtime.friction.outer_solver.solver", lambda _: fails)
    library, own = pile(0, 0.0), accuracy("dop853", "lcp")
    q, u = (np.array([library.manifest.instance[f"initial_{key}"]]) for key in "qu")
    with pytest.raises(ZeroDivisionError):
        simulate_batch(library, q, u, until=0.2, accuracy=own)
    with pytest.raises(ZeroDivisionError):
        start(library, accuracy=own).step(0.2)
    with pytest.raises(ZeroDivisionError):
        start_many(library, 2, accuracy=own).step(0.2)
    monkeypatch.undo()
    assert simulate(library, until=0.2, accuracy=own, samples=1, estimate=False).outcome.name == "DONE"


@pytest.mark.parametrize(
    ("friction", "solver", "other"), [(0.0, "lcp", "qp"), (MU, "polyhedral", "relaxation")]
)
def test_what_a_solver_does_not_solve_the_core_does(
    friction: float, solver: str, other: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = pile(1, friction)
    known = stepped(library, "coulomb")
    monkeypatch.setattr("modelgen.runtime.friction.outer_solver.solver", lambda _: gives_up)
    run = stepped(library, solver)
    assert run.solves[solver] > 0
    assert run.solves[other] >= run.solves[solver]
    if friction:
        assert any("convex relaxation was taken" in each for each in run.warnings)
    else:
        assert np.abs(run.p[-1] - known.p[-1]).max() < 1e-9


def test_resistances_and_long_double_are_refused_where_a_solver_has_none() -> None:
    ball = make.dynamic("ball", make.sphere(0.05), density=1000.0, position=[0.0, 0.0, 0.05])
    terms: dict[str, object] = {"between": "all", "friction": MU, "rolling_resistance": 1e-3}
    scene = make.scene("resisted", [make.fixed("floor", make.plane()), ball], contacts=terms)
    with pytest.raises(SimulationError, match=r"^solver: 'mpcc'; coulomb, relaxation, polyhedral "):
        stepped(library_of(scene), "mpcc")
    with pytest.raises(SimulationError, match=r"^solver: 'lcp'; coulomb, which the core has, over"):
        Session(scene_of("bouncing_ball", real="long double"), accuracy("dop853", "lcp"))


def test_the_companion_has_the_solver_of_the_run() -> None:
    how = Stepping(method="time-stepping", step=STEP, solver="polyhedral")
    run = simulate(pile(1, MU), until=0.1, samples=2, **how)
    assert run.estimate is not None
    assert any("cones of eight sides" in each for each in run.warnings)
    assert run.accuracy.count("polyhedral") == 1


def test_a_solver_of_the_scene_stays_with_another_method_that_has_it() -> None:
    library = scene_of("bouncing_ball")
    instance = library.manifest.instance
    chosen = library.with_instance(instance | {"run": instance["run"] | {"solver": "lcp"}})
    for how in (Stepping(method="dop853"), Stepping(method="time-stepping", step=STEP), Stepping()):
        assert simulate(chosen, until=0.1, samples=1, estimate=False, **how).solver == "lcp"
