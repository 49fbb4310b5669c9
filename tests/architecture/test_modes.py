"""The modes of a run are written in one file."""

from __future__ import annotations

import re
from pathlib import Path

CORE = Path(__file__).parents[2] / "modelgen" / "core"
MODES = "closed|active|friction_mode|patch_mode|rolling_start|branch|switch_mode|switch_leader"
WRITES = re.compile(rf"run->(?:{MODES})\[[^\]]*\]\s*(?:[-+*/|&]?=(?!=)|\+\+|--)")
ALIASES = re.compile(rf"(?<!const )(?:int|mg_real) \*\w+ = (?:c->)?run->(?:{MODES})\b")
WRITER = "model/modes.c"


def texts() -> dict[str, str]:
    return {
        path.relative_to(CORE).as_posix(): re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
        for path in sorted(CORE.rglob("*.c"))
    }


def test_one_file_writes_the_modes_of_a_run() -> None:
    found = {name for name, text in texts().items() if WRITES.search(text) or ALIASES.search(text)}
    assert found == {WRITER}


def test_writes_and_aliases_are_found() -> None:
    for text in ("c->run->closed[i] = 1;", "run->branch[k] |= 1;", "int *mode = c->run->patch_mode + slot;"):
        assert WRITES.search(text) or ALIASES.search(text), text
    for text in ("if (c->run->closed[i] == 1)", "const int *mode = c->run->patch_mode;"):
        assert not WRITES.search(text)
        assert not ALIASES.search(text)
