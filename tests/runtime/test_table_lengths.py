"""The arrays that Python gives to the core are at least as long as the header says."""

from __future__ import annotations

import re

import pytest

from modelgen import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.ctypes_structures import address
from tests.core.compiling import CORE
from tests.running import NAMES, scene_of

FIELD = re.compile(r"\*\s*(\w+);\s*/\* \[([^\]]*)\]")
ENDS = {
    "per slot of the pools": (
        "pool_slot",
        "n_pool",
    ),  # lengths that a range array gives, by what the header calls them
    "all terms": ("solid_term", "n_solid"),
    "all conditions": ("feature_pair_condition", "n_feature_pair"),
    "all covered": ("patch_covered", "n_patch"),
    "all arcs": ("patch_arc", "n_patch"),
    "all partners": ("ball_partner_begin", "n_ball"),
    "all shares": ("patch_share", "n_patch"),
}


def lengths(structure: str) -> dict[str, str]:
    """What the header says of the length of each array of a structure."""
    text = (CORE / "modelgen.h").read_text()
    (body,) = re.findall(r"typedef struct \{([^{}]*)\} " + structure + ";", text)
    return dict(FIELD.findall(body))


@pytest.mark.cases(12)
@pytest.mark.parametrize("name", NAMES)
def test_arrays_are_as_long_as_the_header_says(name: str) -> None:
    session = Session(scene_of(name), Accuracy.fast())
    arrays, system = session.arrays(), session.system
    sizes = {field: getattr(system, field) for field, _ in system._fields_ if field.startswith("n_")}
    sizes["x"] = sizes["n_q"] + sizes["n_u"] + sizes["n_eta"] + 1
    declared = lengths("mg_system") | lengths("mg_run")
    assert len(declared) > 70
    for field, said in declared.items():
        owner = system if hasattr(system, field) else session.run
        array = arrays[getattr(owner, field)]
        times, counted = re.fullmatch(r"(?:(\d+) )?(.*)", said).groups()  # type: ignore[union-attr]
        if counted in ENDS:
            table, last = ENDS[counted]
            ends = arrays[getattr(system, table)]
            length = int(times or 1) * int(ends[sizes[last]]) if sizes[last] else 0
        else:
            text = said.replace("length of x", "x")
            length = eval(re.sub(r"(\d) (\w)", r"\1 * \2", text), {}, sizes)
        assert address(array) == getattr(owner, field)
        assert array.size >= length, f"{field} has {array.size} of {said} = {length}"
