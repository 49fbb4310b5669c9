"""A run is the same wherever its calls end: its state is its mg_run alone, and no scratch outlasts a step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from modelgen import read
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.settings import accuracy_of
from tests.running import NAMES, library_of, scene_of

SCENES = Path(__file__).parent / "scenes"
QUICK = (
    *("light_rim", "spin_box", "stool_on_floor", "grip_fast_ratio", "a_box", "heavy_on_light"),
    "frustum_in_ring",
)
SHIPPED = ("sliding_puck", "glass_on_table", "painleve_rod", "cube_toss")
SEED, STEPS_MAX = 1, 600


def ended(
    library: Library, chunks: np.random.Generator | int, accuracy: str | None, stepping: dict[str, object]
) -> tuple[int, bytes]:
    """The outcome of a run and the bytes of its last state, where each call takes so many steps, or a random
    number of them."""
    session = Session(library, accuracy_of(library.manifest.instance, accuracy, stepping))
    until = library.manifest.instance["run"]["until"]
    code = session.begin()
    recording = Recording(session, np.array([2 * until]))
    while code in (0, CONTINUE, FULL) and session.run.t < until and session.run.steps < STEPS_MAX:
        session.events.count = 0
        steps = chunks if isinstance(chunks, int) else int(chunks.geometric(0.1))
        code = session.advance(until, min(steps, STEPS_MAX - session.run.steps), recording.record)
    return code, session.save()


def is_same_in_all_calls(library: Library, accuracy: str | None = None, **stepping: object) -> bool:
    """Whether a run of one call, of a call a step and of random calls are one run."""
    chunks = (STEPS_MAX, 1, np.random.default_rng(SEED))
    return len({ended(library, chunk, accuracy, stepping) for chunk in chunks}) == 1


@pytest.mark.parametrize("name", QUICK)
def test_a_run_does_not_depend_on_where_its_calls_end(name: str) -> None:
    assert is_same_in_all_calls(library_of(read(SCENES / f"{name}.toml")))


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("accuracy", ["fast", "balanced"])
def test_nor_does_a_shipped_one(name: str, accuracy: str) -> None:
    assert is_same_in_all_calls(scene_of(name), accuracy=accuracy)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_nor_does_any_shipped_one(name: str) -> None:
    assert is_same_in_all_calls(scene_of(name))


@pytest.mark.cases(3)
@pytest.mark.parametrize("scheme", ["stewart-trinkle", "anitescu-potra", "moreau"])
@pytest.mark.parametrize("name", ["stool_on_floor", "car_slow", "dominoes", "hinge_pi", "spin_box"])
def test_nor_do_steps_of_time_stepping(name: str, scheme: str) -> None:
    library = library_of(read(SCENES / f"{name}.toml"))
    assert is_same_in_all_calls(library, method="time-stepping", step=0.002, scheme=scheme)
