"""What a measurement says of itself: what it read, what it remembered, how it ended."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from modelgen import derive, emit, require
from modelgen.benchmark import setting_evaluation as program
from modelgen.benchmark.knobs import Settings
from modelgen.benchmark.measurement import SHOWN, Measurement, measure
from modelgen.benchmark.measurement_store import NAME
from modelgen.benchmark.measurement_table import print_measurement, print_tuned
from modelgen.benchmark.peers import PeerPoints
from modelgen.benchmark.peers.scene_description import _solid
from modelgen.benchmark.run_table_rewriting import with_run_table
from modelgen.benchmark.sampled_motion import Bodies
from modelgen.benchmark.scene_under_measurement import Subject
from modelgen.benchmark.tuning import BAND, tune
from modelgen.benchmark.work_precision_front import Point, spaced
from modelgen.errors import ModelgenError
from modelgen.scene.scene_types import Scene
from tests.benchmark.thrown import TEXT, thrown

SHORT = 0.02  # s, wall time: for one setting
FOLDED = f"fold = true\n{TEXT}"
pytestmark = pytest.mark.usefixtures("hasty")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("measured")


@pytest.fixture
def root(built: Path) -> Path:
    """A folder of built libraries in which nothing is remembered."""
    (built / "thrown" / NAME).unlink(missing_ok=True)
    return built


def test_folded_bodies_have_the_masses_that_they_have_otherwise() -> None:
    def told(scene: Scene) -> tuple[Bodies, np.ndarray]:
        instance = emit(derive(require(scene))).manifest.instance
        solid = _solid((), instance["bodies"][0], [np.zeros(3), np.zeros(4), np.zeros(3), np.zeros(3)])
        return Bodies.of(instance), np.array([solid.mass, *np.ravel(solid.inertia)])

    (plain, numbers), (folded, other) = told(thrown()), told(thrown(FOLDED))
    assert plain.mass == pytest.approx([0.7], rel=1e-15)
    assert folded == plain
    assert numbers[1::4] == pytest.approx([0.0028, 0.003, 0.0031], rel=1e-15)
    assert (numbers == other).all()


def test_a_folded_scene_is_measured_and_tuned(root: Path) -> None:
    scene = thrown(FOLDED, "folded")
    assert tune(scene, error=1e-6, knobs=["tolerance"], root=root).point.error <= 1e-6  # type: ignore[operator]


def test_a_measurement_that_was_cut_short_says_how_to_go_on(root: Path) -> None:
    found = measure(thrown(), knobs=["tolerance"], limit=SHORT, root=root)
    assert found.interrupted == (
        "the time was up: what was measured is kept, the same command goes on from there"
    )
    again = measure(thrown(), knobs=["tolerance"], limit=SHORT, fresh=True, root=root)
    assert "the same command without --fresh goes on" in again.interrupted


@pytest.mark.parametrize(
    ("demand", "words"),
    [({"error": 1e-15}, "an error of 1e-15 was reached"), ({"budget": 1.0}, "0.001 us per")],
)
def test_a_demand_that_more_time_may_meet_is_not_called_out_of_reach(
    demand: dict[str, float], words: str, root: Path
) -> None:
    with pytest.raises(ModelgenError) as refused:
        tune(thrown(), knobs=["tolerance"], limit=SHORT, root=root, **demand)  # type: ignore[arg-type]
    said = str(refused.value)
    assert said.startswith(f"--limit: the time was up before {words}")
    assert said.endswith("the same command goes on from there, or give it more")


def test_a_demand_met_before_all_was_tried_says_so(root: Path) -> None:
    tuned = tune(thrown(), error=0.5, knobs=["tolerance"], limit=SHORT, root=root)
    assert tuned.as_json()["interrupted"].startswith("the time was up")
    text = StringIO()
    print_tuned(tuned, Console(file=text))
    assert "not all settings were tried; the time was up" in text.getvalue()


@pytest.mark.parametrize(("part", "words"), [(1.1, "µs over the budget, within the 20% band"), (0.9, "")])
def test_a_setting_over_the_budget_says_so(part: float, words: str, root: Path) -> None:
    tuned = tune(thrown(), error=0.5, knobs=["tolerance"], limit=5.0, root=root)
    text = StringIO()
    print_tuned(replace(tuned, budget=(tuned.point.cost_ns_per_s or 0.0) / part), Console(file=text))
    assert ("over the budget" in text.getvalue()) == bool(words)
    assert words in text.getvalue()


def test_ctrl_c_ends_tuning(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopping(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(program, "_measured", stopping)
    with pytest.raises(KeyboardInterrupt):
        tune(thrown(), error=0.5, knobs=["tolerance"], root=root)


def test_only_what_was_compiled_has_a_time_of_the_compiler(
    built: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(built)
    first, again = (Subject(thrown(name="compiled"), 0.1, 2, Path(".")).built({}) for _ in range(2))
    assert first.compile_s is not None
    assert again.compile_s is None


def test_what_is_counted_is_what_the_table_shows(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that was half as fast for every other point: once that is told, the rows are known."""
    made: list[Point] = []

    def uneven(bench: program.Bench, settings: Settings) -> Point:
        slow, n = 1 + len(made) % 2, len(made)
        costs = {"yard_s": 1e-3 * slow}
        made.append(Point(settings, 0.1 * 0.5**n, 10 * 1.1**n * slow, costs=costs))
        return made[-1]

    monkeypatch.setattr(program, "_measured", uneven)
    monkeypatch.setattr(program, "instructions", lambda *arguments: 1000)
    found = measure(thrown(), knobs=["tolerance"], root=root)
    shown = spaced(found.front, SHOWN)
    assert len(shown) > 3
    assert all(point.costs.get("instructions_per_s") for point in shown)


def test_a_budget_that_is_refused_is_below_what_is_said_to_be_needed(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At once, and where the setting that met it does not meet it again."""

    def made(bench: program.Bench, settings: Settings) -> Point:
        cheap = 30001.0 if bench.fresh else 19651.0
        return Point(settings, 1e-3, cheap if settings["tolerance"] == 1e-3 else 1e9)

    monkeypatch.setattr(program, "_measured", made)
    for budget, words in ((16370.0, "16.37 us"), (19652.0, "19.652 us")):
        with pytest.raises(ModelgenError) as refused:
            tune(thrown(), budget=budget, knobs=["tolerance"], root=root)
        needed = "19.7" if budget < 19651.0 / (1 + BAND) else "30.1"
        assert refused.value.found == f"{words} per simulated second is not enough"
        assert refused.value.allowed.startswith(f"the cheapest setting takes {needed} us")


def test_a_budget_just_below_the_cheapest_is_kept_within_its_band(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    costs = {1e-2: 19651.0, 1e-3: 19700.0}

    def made(bench: program.Bench, settings: Settings) -> Point:
        tolerance = float(settings["tolerance"])
        return Point(settings, tolerance, costs.get(tolerance, 1e9))

    monkeypatch.setattr(program, "_measured", made)
    tuned = tune(thrown(), budget=19650.0, knobs=["tolerance"], root=root)
    assert tuned.point.settings["tolerance"] == 1e-2
    assert tuned.over == 1.0


def test_tuning_some_knobs_keeps_what_the_scene_says_of_the_others(root: Path) -> None:
    text = TEXT.replace("samples = 4", 'samples = 4\nlevel = "O1"')
    tuned = tune(thrown(text), error=1e-3, knobs=["tolerance"], root=root)
    assert tuned.point.settings["level"] == tuned.run.level == "O1"
    assert 'level = "O1"' in with_run_table(text, tuned.point.settings, "thrown.toml")
    out = StringIO()
    print_measurement(tuned.measurement, Console(file=out, width=200))
    assert "knobs: method dop853 (not turned), tolerance, level O1 (not turned);" in out.getvalue()


THEIRS = [  # of a simulator; the most accurate within 1 s a second errs nearly as much as the one before
    Point({"timestep": step}, error, cost)
    for step, error, cost in ((1e-2, 1e-2, 1e6), (1e-3, 1e-4, 1e7), (1e-4, 9e-5, 1e8), (1e-5, 1e-8, 1e10))
]


def table(found: Measurement, peer: PeerPoints) -> list[str]:
    out = StringIO()
    print_measurement(replace(found, peers=[peer]), Console(file=out, width=200))
    return out.getvalue().splitlines()


def test_the_rows_that_a_closing_line_is_about_stand_in_the_tables(root: Path) -> None:
    found = measure(thrown(), knobs=["tolerance"], root=root)
    lines = table(found, PeerPoints("other", [], THEIRS, turned=["timestep"]))
    (closing,) = (line for line in lines if line.startswith("at the best error of other"))
    assert "9.0e-05 at 1e+05 µs" in closing
    assert any(line.startswith("9.0e-05") and "timestep 0.0001" in line for line in lines)
    cost = closing.split("cheaper here (")[1].split(" µs")[0]
    assert any(cost in line.split() for line in lines[: lines.index("other")])


def test_a_simulator_whose_knobs_are_left_alone_is_compared_by_no_ratio(root: Path) -> None:
    found = measure(thrown(), knobs=["tolerance"], root=root)
    peer = PeerPoints("other", [], THEIRS, turned=["timestep"], left=["timestep", "contact"])
    lines = table(found, peer)
    assert not [line for line in lines if "times cheaper" in line]
    (closing,) = (line for line in lines if line.startswith("--knobs names none of the settings of other"))
    assert "timestep alone is varied" in closing
    assert "add some of contact to --knobs" in closing
    assert peer.as_json(found.points)["advantage"] is None
    assert peer.as_json(found.points)["knobs"] == ["timestep"]
