"""Files that prose names exist: in the manual, docstrings (of benchmarks too) and comments of the core."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CORE = ROOT / "modelgen" / "core"
NAMED = re.compile(r"(?<![\w./<-])(?!exported/)((?:[a-z_]\w*/)+\w+\.(?:py|c|h))\b")
PLACES = (ROOT, ROOT / "modelgen", CORE)
TEXTS = sorted(
    path
    for folder, pattern in (
        *(("modelgen", "**/*.py"), ("modelgen", "**/*.md"), ("modelgen/core", "**/*.[ch]")),
        ("tests/benchmarks", "*.py"),
    )
    for path in (ROOT / folder).glob(pattern)
)


def named_files(path: Path) -> set[str]:
    return set(NAMED.findall(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("suffix", [".py", ".md", ".c", ".h"])
def test_files_that_are_named_exist(suffix: str) -> None:
    texts = [path for path in TEXTS if path.suffix == suffix]
    found = {(path, name) for path in texts for name in named_files(path)}
    assert found
    lost = {
        f"{path.relative_to(ROOT)}: {name}"
        for path, name in found
        if not any((place / name).exists() for place in (*PLACES, path.parent))
    }
    assert not lost
