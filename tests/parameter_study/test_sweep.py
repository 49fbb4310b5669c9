"""Sweeps: rows are runs, whatever ran them; an interruption loses nothing; what differs is refused."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelgen import load, load_sweep, simulate, sweep
from modelgen.codegen.library_with_parameters import library_with
from modelgen.errors import ModelgenError
from modelgen.file_writing import SCRATCH
from modelgen.parameter_study import chunk_runs, run_queue, sweep_folder
from modelgen.parameter_study.outcome_plot import draw_sweep
from modelgen.parameter_study.outcome_table import Sweep
from modelgen.parameter_study.run_queue import RunQueue, Span
from modelgen.runtime import simulate_lanes
from modelgen.runtime.session_group import SessionGroup
from tests.mutants import mutants
from tests.parameter_study.scenes import ball

pytest.importorskip("pyarrow")

VARY = {"height": "0.02:0.3:4", "push": "0,1", "ball.velocity_x": "1,2"}  # some are refused, some fail


def swept(out: Path | None, **options: Any) -> Sweep:
    return sweep(ball(), VARY, out=out, **{"threads": 2, "estimate": False, **options})


def table(out: Path) -> bytes:
    return (out / "runs.parquet").read_bytes()


def test_a_row_is_a_run(tmp_path: Path) -> None:
    found = sweep(ball(), VARY, out=tmp_path / "a")
    assert len(found) == 16
    assert set(found.outcomes) == {"done", "refused", "not_finite"}
    for k in (4, 7, 13, 15):
        (row,) = found.rows([k])
        assert (row["run"], row["seed"]) == (k, 0)
        library = library_with(ball(), {"height": row["height"]})
        instance = library.manifest.instance
        start = [row["ball.velocity_x"], *instance["initial_u"][1:]]
        own = library.with_instance(instance | {"initial_u": start})
        path = simulate(own, samples=1, inputs={"push": row["push"]})
        assert row["outcome"] == path.outcome.name.lower()
        assert row["t_end"] == path.t_end
        assert row["place_x"] == pytest.approx(path.sensors[-1, 0], rel=1e-9)
        assert row["ball.v_z"] == pytest.approx(path.v[-1, 1, 2], rel=1e-9, abs=1e-12)
        assert (row["events"], row["events.impact"]) == (len(path.events), _impacts(path))
        assert row["trusted"] == path.is_trusted
        assert (row["steps"], row["energy_drift"]) == (
            path.steps,
            pytest.approx(path.energy_drift, abs=1e-12),
        )
        assert row["message"] == "" if row["outcome"] == "done" else path.outcome.value in row["message"]
    low = found.rows([0])[0]
    assert low["outcome"] == "refused"
    assert "interpenetrate" in low["message"]
    assert (low["height"], low["steps"], low["place_x"]) == (0.02, None, None)
    assert np.isnan(found["place_x"][0])


def _impacts(path: Any) -> int:
    return sum(event.kind == "impact" for event in path.events)


def test_tables_are_equal_whatever_the_threads_and_chunks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    swept(tmp_path / "a", threads=1)
    monkeypatch.setattr(run_queue, "FIRST", 1)
    monkeypatch.setattr(run_queue, "MOST", 1)
    swept(tmp_path / "b", threads=3)
    assert table(tmp_path / "a") == table(tmp_path / "b")
    here = swept(None)
    assert dict(here.columns) == dict(load_sweep(tmp_path / "a").columns)


class StopError(Exception):
    pass


def stopped_after(count: int) -> Callable[[float], None]:
    def report(share: float) -> None:
        if share * 16 >= count:
            raise StopError

    return report


def test_an_interrupted_sweep_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_queue, "FIRST", 2)
    monkeypatch.setattr(run_queue, "MOST", 2)
    swept(tmp_path / "a")
    for count in (4, 10):
        with pytest.raises(StopError):
            swept(tmp_path / "b", on_progress=stopped_after(count))
    partial = load_sweep(tmp_path / "b")
    assert 10 <= len(partial) < 16
    (tmp_path / "b" / "parts" / f"{SCRATCH}7-0.parquet").write_bytes(b"half of a par")
    runs: list[int] = []
    monkeypatch.setattr("modelgen.parameter_study.sweep.run_chunk", _noting(runs))
    found = swept(tmp_path / "b")
    assert sorted(runs) == sorted(set(range(16)) - set(partial.columns["run"]))
    assert found.known == len(partial)
    assert table(tmp_path / "a") == table(tmp_path / "b")
    assert {path.name for path in (tmp_path / "b").iterdir()} == {"runs.parquet", "sweep.json"}
    runs.clear()
    assert swept(tmp_path / "b").known == 16
    assert not runs


def _noting(runs: list[int]) -> Callable[..., Any]:
    from modelgen.parameter_study.chunk_runs import run_chunk

    def noted(library: Any, study: Any, first: int, values: Any) -> Any:
        runs.extend(range(first, first + len(values)))
        return run_chunk(library, study, first, values)

    return noted


KILLED = """
import os, signal, sys
from modelgen import sweep
from modelgen.codegen.library import Library
from modelgen.parameter_study import run_queue
run_queue.FIRST = run_queue.MOST = 2
library, out, vary, count = Library.load(sys.argv[1]), sys.argv[2], eval(sys.argv[3]), int(sys.argv[4])
def report(share):
    if share * 16 >= count:
        os.kill(os.getpid(), signal.SIGKILL)
sweep(library, vary, out=out, threads=2, estimate=False, on_progress=report)
"""


def test_a_killed_sweep_goes_on(tmp_path: Path) -> None:
    arguments = [str(ball().path.parent), str(tmp_path / "b"), repr(VARY), "6"]
    killed = subprocess.run([sys.executable, "-c", KILLED, *arguments], capture_output=True, check=False)
    assert killed.returncode == -9, killed.stderr
    assert 6 <= len(load_sweep(tmp_path / "b")) < 16
    found = swept(tmp_path / "b")
    assert found.known >= 6
    swept(tmp_path / "a")
    assert table(tmp_path / "a") == table(tmp_path / "b")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"until": 0.4}, r"another settings \(until: 0.5, now 0.4\)"),
        ({"seed": 3}, "another design"),
        ({"accuracy": "fast"}, "another settings"),
        ({"keep": ["trajectories"]}, "another keep"),
    ],
)
def test_another_sweep_is_refused(tmp_path: Path, options: dict[str, Any], words: str) -> None:
    with pytest.raises(StopError):
        swept(tmp_path / "a", on_progress=stopped_after(1))
    before = sorted(path.name for path in (tmp_path / "a").rglob("*"))
    with pytest.raises(ModelgenError, match=words):
        swept(tmp_path / "a", **options)
    assert sorted(path.name for path in (tmp_path / "a").rglob("*")) == before


def test_another_scene_or_a_foreign_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StopError):
        swept(tmp_path / "a", on_progress=stopped_after(1))
    instance = ball().manifest.instance
    other = ball().with_instance(instance | {"gravity": [0.0, 0.0, -1.6]})
    with pytest.raises(ModelgenError, match="another scene content"):
        sweep(other, VARY, out=tmp_path / "a", estimate=False)
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "letter.txt").write_text("dear all")
    with pytest.raises(ModelgenError, match="no sweep"):
        swept(tmp_path / "b")
    with pytest.raises(ModelgenError, match="no sweep is in it"):
        load_sweep(tmp_path / "b")


def test_a_folder_has_one_writer(tmp_path: Path) -> None:
    def again(share: float) -> None:
        with pytest.raises(ModelgenError, match="another process"):
            swept(tmp_path / "a")
        raise StopError

    with pytest.raises(StopError):
        swept(tmp_path / "a", on_progress=again)


def test_whole_runs_are_kept(tmp_path: Path) -> None:
    vary = {"height": "0.02,0.3", "ball.velocity_x": "0.5,1"}
    found = sweep(ball(), vary, out=tmp_path / "a", keep=["trajectories"], threads=1)
    kept = sorted((tmp_path / "a" / "runs").iterdir())
    assert [path.name for path in kept] == ["0000002.npz", "0000003.npz"]  # the others could not start
    run = load(kept[1])
    (row,) = found.rows([3])
    assert run.summary["parameters"]["height"] == row["height"]
    assert run.columns["v"][0, 1, 0] == row["ball.velocity_x"]
    assert run.columns["p"][-1, 1] == pytest.approx([row[f"ball.p_{axis}"] for axis in "xyz"], rel=1e-9)


@pytest.mark.parametrize(
    ("vary", "options", "words"),
    [
        ({"heigt": "1,2"}, {}, "did you mean 'height'?"),
        ({"ball.orientation_x": "1,2"}, {}, r"\[\[parameter\]\]"),
        ({"friction": "0.5,2"}, {}, "from 0 to 1"),
        ({"push": "-9,2"}, {}, "from -5 to 5"),
        ({"friction": "0.5,0.6"}, {"parameters": {"friction": 0.2}}, "leave one of the two out"),
        ({"friction": "0.5,0.6"}, {"parameters": {"height": -1}}, "height"),
        ({"friction": "0.5,0.6"}, {"inputs": {"push": 9}}, "push"),
        ({"friction": "0.5,0.6"}, {"threads": 0}, "threads"),
        ({"friction": "0.5,0.6"}, {"seed": -1}, "seed"),
        ({"friction": "0.5,0.6"}, {"until": 0}, "until"),
        ({"friction": "0.5,0.6"}, {"keep": ["trajectories"]}, "no folder"),
        ({"friction": "0.5,0.6"}, {"keep": ["trajectory"], "out": "x"}, "did you mean 'trajectories'?"),
        ({"friction": "0.5,0.6"}, {"out": "x", "thread": 1}, "unknown keyword"),
        ({"friction": "0.5,0.6"}, {"out": __file__}, "cannot be written"),
    ],
)
def test_bad_arguments_are_refused(
    vary: Any, options: Any, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ModelgenError, match=words.replace("?", r"\?")):
        sweep(ball(), vary, **options)
    assert list(tmp_path.iterdir()) == []


def test_without_pyarrow_the_remedy_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ModelgenError, match=r"modelgen-contact\[sweep\]"):
        swept(tmp_path / "a")
    assert not (tmp_path / "a").exists()
    assert len(swept(None)) == 16  # in memory, it is not needed


def test_a_number_may_have_the_name_of_a_column() -> None:
    from modelgen.parameter_study.rows import varied_columns

    assert varied_columns(["steps", "mass"]) == ["vary.steps", "mass"]


@pytest.mark.cases(1)
@pytest.mark.parametrize("numbers", [1, 2, 3])
def test_pictures_have_a_panel_for_each_pair_of_numbers(numbers: int, tmp_path: Path) -> None:
    vary = dict(list(VARY.items())[:numbers])
    found = sweep(ball(), vary, estimate=False, until=0.2)
    file = tmp_path / "map.svg"
    draw_sweep(found, file, ["place_x", "outcome"])
    panels = {1: 1, 2: 1, 3: 3}[numbers] * 2
    drawn = file.read_text(encoding="utf-8")
    bars = 0 if numbers == 1 else panels
    assert drawn.count('<g id="axes_') == panels + bars
    with pytest.raises(ModelgenError, match="did you mean 'place_z'"):
        draw_sweep(found, file, ["place_zz"])


def test_runs_that_are_not_trusted_are_counted_in_the_picture(tmp_path: Path) -> None:
    found = sweep(ball(), dict([*VARY.items()][:1]), until=0.2)
    done = np.flatnonzero(~found.failed)
    assert len(done) > 1
    for doubted in (0, 2):
        trusted = np.where(np.isin(np.arange(len(found)), done[:doubted]), 0.0, 1.0)
        columns = {**found.columns, "trusted": trusted}
        file = tmp_path / "curve.svg"
        draw_sweep(replace(found, columns=columns), file, ["place_x"])
        texts = "".join(file.read_text(encoding="utf-8").split("<!--"))
        assert f"{doubted} others not trusted" in texts


def test_queued_runs_are_each_handed_out_once() -> None:
    queue = RunQueue(1000, [Span(10, 5), Span(0, 3), Span(995, 5)], 2)
    taken: list[int] = []
    while (span := queue.take()) is not None:
        taken += range(span.first, span.first + span.size)
        queue.note(span.size, 0.01 * span.size)
    assert taken == sorted(set(range(1000)) - {0, 1, 2, *range(10, 15), *range(995, 1000)})


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_chunks_grow_from_one_run_and_are_short_at_the_end(workers: int) -> None:
    queue, sizes = RunQueue(1000, (), workers), list[int]()
    while (span := queue.take()) is not None:
        sizes.append(span.size)
        queue.note(span.size, 0.01 * span.size)
    assert sizes[0] == 1
    assert all(after <= 2 * max(sizes[: k + 1]) for k, after in enumerate(sizes[1:]))
    assert max(sizes) > 1000 / (8 * workers)
    assert all(size * 0.01 <= 0.05 for size in sizes[-workers:])


def test_threads_do_pythons_work_one_at_a_time_and_the_core_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: dict[str, set[bool]] = {}

    def watched(owner: Any, name: str) -> None:
        function = getattr(owner, name)

        def noted(*args: Any, **kwargs: Any) -> Any:
            held.setdefault(name, set()).add(chunk_runs.PYTHON_WORK.locked())
            return function(*args, **kwargs)

        monkeypatch.setattr(owner, name, noted)

    for function in ("with_parameters", "row_of", "simulate"):
        watched(chunk_runs, function)
    watched(simulate_lanes, "estimate_of")
    watched(SessionGroup, "advance")
    swept(tmp_path / "a", threads=1, estimate=True, keep=["trajectories"])
    of_python = {"with_parameters", "row_of", "estimate_of"}
    assert held == {name: {True} for name in of_python} | {"simulate": {False}, "advance": {False}}


def test_the_plan_says_what_was_done(tmp_path: Path) -> None:
    swept(tmp_path / "a", samples=8, seed=5)
    plan = json.loads((tmp_path / "a" / sweep_folder.PLAN).read_text(encoding="utf-8"))
    assert plan["design"] == {"design": "sobol", "samples": 8, "seed": 5}
    assert plan["vary"]["height"] == "0.02:0.3:4"
    assert plan["runs"] == 8
    assert load_sweep(tmp_path / "a")["seed"].tolist() == [5] * 8
    assert os.listdir(tmp_path / "a")


def test_a_damaged_plan_is_refused(tmp_path: Path) -> None:
    """One that is empty, cut, of other content, or of another encoding; 1E-06 for 1e-06 is no damage."""
    swept(tmp_path / "a")
    plan = tmp_path / "a" / sweep_folder.PLAN
    whole = plan.read_bytes()
    changed = [each for each in mutants(whole, 40) if each.lower() != whole.lower()]
    for damaged in (b"", b"{}", b"[]", b"[" * 10**5, *changed):
        plan.write_bytes(damaged)
        with pytest.raises(ModelgenError, match=r"sweep\.json: no (JSON|plan of a sweep)"):
            load_sweep(tmp_path / "a")


def test_a_damaged_table_of_a_sweep_is_refused_or_read_as_it_was(tmp_path: Path) -> None:
    swept(tmp_path / "a")
    columns = load_sweep(tmp_path / "a").columns
    path = tmp_path / "a" / sweep_folder.TABLE
    for damaged in mutants(path.read_bytes(), 60):
        path.write_bytes(damaged)
        try:
            found = load_sweep(tmp_path / "a").columns
        except ModelgenError as error:
            assert "its table cannot be read" in str(error)  # noqa: PT017
            continue
        assert str(dict(found)) == str(dict(columns))  # NaN too
