"""What a run tells of itself is written in one file, and read where it is known why."""

from __future__ import annotations

import re
from pathlib import Path

from modelgen.runtime.tables.ctypes_structures import REPORT_COUNTS, REPORT_INTEGERS, REPORT_REALS

CORE = Path(__file__).parents[2] / "modelgen" / "core"
WRITE = re.compile(
    r"\breport\.\w+(?:\[[^\]]*\])?\s*(?:[-+*/|&]?=(?!=)|\+\+|--)|(?:\+\+|--)[\w>.-]*\breport\.\w"
)
USE = re.compile(r"(?:->|\.)report\b")
ALIAS = re.compile(r"&(?:\w+(?:->|\.))+report\b|mg_run_report")
FIELDS = {*REPORT_COUNTS, *REPORT_REALS, *REPORT_INTEGERS, "exceeded", "exceeded_t"}
WRITER = "model/run_report.c"
READERS = {  # beside the writer, and why
    "run/doubts.c": "judges the run",
    "timestep/fallback.c": "asks whether a contact follows the points at which the run ended",
    "sensitivity/advance_tangent.c": "derivatives end where a step has fallen back or passed a singularity",
    "forces/diagnostics.c": "asks whether a margin is the least so far before it asks whether it counts",
    "forces/joint_rank.c": "compares with the joints of the step before, if there was one",
    "forces/motion_uniqueness_monitor.c": "seeks no other motion once one was found",
    "patch/flush_blow.c": "seeks no further blow once there was one",
}


def code(path: Path) -> str:
    return re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)


def texts() -> dict[str, str]:
    return {path.relative_to(CORE).as_posix(): code(path) for path in sorted(CORE.rglob("*.c"))}


def test_one_file_writes_the_report_of_a_run() -> None:
    found = {name for name, text in texts().items() if USE.search(text) and WRITE.search(text)}
    assert found == {WRITER}


def test_the_report_is_read_where_it_is_known_why() -> None:
    assert {name for name, text in texts().items() if USE.search(text)} == {WRITER, *READERS}
    aliases = {name for name, text in texts().items() if ALIAS.search(text)}
    assert aliases == {WRITER}


def test_each_field_of_the_report_is_written() -> None:
    text = texts()[WRITER]
    assert {name for name in FIELDS if not re.search(rf"(?:report\.|report->){name}\b", text)} == set()


def test_writes_are_found() -> None:
    for text in ("c->run->report.gap_max = d;", "run->report.steps++;", "++run->report.steps;"):
        assert WRITE.search(text), text
    for text in ("run->report.exceeded[k] += 1;", "run->report.a |= 1;"):
        assert WRITE.search(text), text
    for text in ("if (run->report.gap_max == 1)", "x = run->report.gap_max;", "run->report.a <= 1"):
        assert not WRITE.search(text), text
