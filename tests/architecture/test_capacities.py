"""No capacity of the core is exceeded without a word: it is known why each array of fixed length suffices."""

from __future__ import annotations

import re
from pathlib import Path

from modelgen.runtime.tables.ctypes_structures import CAPACITIES
from modelgen.runtime.trajectory import DOUBT_KINDS
from modelgen.runtime.warnings.capacities import EXCEEDED

CORE = Path(__file__).parents[2] / "modelgen" / "core"
SOURCES = {path: path.read_text(encoding="utf-8") for path in sorted(CORE.rglob("*.[ch]"))}
TEXT = "\n".join(re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL) for text in SOURCES.values())

COUNTED = {  # where more come, the run counts it (mg_report_exceeded) or reports it otherwise
    "MG_STATIONARY": "MG_CAPACITY_STATIONARY",
    "MG_SEGMENT_STACK": "MG_CAPACITY_SEGMENT",
    "MG_PENDING_SPAN_PAIRS": "overflow",
    "MG_CROSSINGS": "MG_BY_SEVERAL_EVENTS",
    "MG_MINIMA": "mg_report_unfollowed_minimum",
    "MG_SLIDING_MAX": "is_unresolved",
}
SUFFICIENT = {  # by the method: orders, stages, blocks, rows of one kind, bounded proofs
    *("MG_ARCS", "MG_ARC_LEVELS", "MG_ASCENT_RESTARTS", "MG_BERNSTEIN_DEGREE", "MG_BERNSTEIN_OPEN"),
    "MG_COLUMNS",
    "MG_CRITICAL",  # a point that is not kept is found again: effort alone, which is counted
    "MG_COMMON_CELLS",  # a bounded search for a point in both bodies, beside that for closest points
    "MG_CURVE_SAMPLES",
    *("MG_BERNSTEIN_ROOTS", "MG_BLOCK", "MG_BLOCK_SIZE", "MG_BLOW_ROWS"),
    *("MG_DEFINITE_MAX", "MG_DOP_FIFTH", "MG_DOP_THIRD", "MG_FLUSH_SAMPLES", "MG_FRICTION_ROWS_MAX"),
    "MG_FRICTION_SLIP",
    *("MG_JOINT_ROWS_MAX", "MG_LCP_BLOCK", "MG_LEMKE_COVERS"),
    *("MG_LINE_SEARCH_MEMORY", "MG_LORENTZ_SIZE", "MG_MARGIN_SAMPLES", "MG_MAX_ETA"),
    *("MG_NODES", "MG_PATCH_ROWS", "MG_POINT_PARAMETERS", "MG_PRODUCT", "MG_SCATTERED_STARTS"),
    *(
        "MG_RADAU_STAGES",
        "MG_ROWS",
        "MG_ROWS_OF_ONE",
        "MG_SAMPLE_SIZE",
        "MG_SENSOR_GROUPS",
        "MG_SLIP_UNKNOWNS",
        "MG_SURFACE_BOUNDS",
    ),
    *("MG_SWITCH_COLUMNS", "MG_TIME_PARTS", "MG_UNKNOWNS"),
    *("MG_VALID_KINDS", "MG_VALID_TANGENT_KINDS"),
}
LENGTH = re.compile(
    r"^\s*(?:static |const )*(?:mg_\w+|int|long|unsigned)\b[^;\n(]*?\w+\[[^\]]*?(MG_[A-Z_]+)[^\]]*\]",
    re.MULTILINE,
)


def test_each_array_of_fixed_length_is_classified() -> None:
    found = set(LENGTH.findall(TEXT))
    assert found <= SUFFICIENT | set(COUNTED), found - SUFFICIENT - set(COUNTED)
    assert set(COUNTED) <= found


def test_each_counted_capacity_is_looked_at_where_it_is_compared() -> None:
    for length, word in COUNTED.items():
        users = [text for text in SOURCES.values() if length in text]
        assert any(word in text for text in users), length


def test_each_capacity_is_noted_told_and_doubted() -> None:
    names = re.findall(r"(MG_CAPACITY_[A-Z]+) = (\d)", TEXT)
    assert [name.removeprefix("MG_CAPACITY_").lower() for name, _ in names] == list(CAPACITIES)
    assert [int(number) for _, number in names] == list(range(len(CAPACITIES)))
    for name, _ in names:
        assert re.search(rf"mg_report_exceeded\([^;]*{name}\)", TEXT), name
    assert set(EXCEEDED) == set(CAPACITIES)
    assert f"long exceeded[{len(CAPACITIES)}];" in TEXT
    assert f"mg_real exceeded_t[{len(CAPACITIES)}];" in TEXT
    assert "capacity" in DOUBT_KINDS
