"""The [run] table of a scene file, changed in place: every other character stays as it is."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from modelgen.benchmark.knobs import KNOBS, Settings
from modelgen.benchmark.scene_under_measurement import BUILD
from modelgen.errors import ModelgenError
from modelgen.scene.scene_types import RunSettings

HEADER = re.compile(r"^\s*\[")
RUN_HEADER = re.compile(r"^\s*\[\s*run\s*\]\s*(#.*)?$")
KEYS = [entry.name for entry in fields(RunSettings)]


def with_run_table(text: str, settings: Settings, source: str) -> str:
    """The TOML text with these settings, and no others of the knobs, in its [run] table.

    Raises ModelgenError where [run] is written in a way that this cannot change, such as `run = {...}`.
    """
    wanted = {name: value for name, value in settings.items() if BUILD.get(name) != value}
    lines = text.splitlines(keepends=True)
    start = next((k for k, line in enumerate(lines) if RUN_HEADER.match(line)), None)
    if start is None:
        changed = f"{text.rstrip()}\n\n[run]\n{_written(wanted)}" if wanted else text
    else:
        end = next((k for k in range(start + 1, len(lines)) if HEADER.match(lines[k])), len(lines))
        changed = "".join([*lines[: start + 1], *_table(lines[start + 1 : end], wanted), *lines[end:]])
    _check(text, changed, wanted, source)
    return changed


def _table(lines: list[str], wanted: Mapping[str, Any]) -> list[str]:
    """The lines of the table: known keys rewritten, knobs that are not wanted removed, new ones added."""
    knobs = {knob.name for knob in KNOBS}
    kept, left = [], dict(wanted)
    for line in lines:
        key = re.match(r"\s*([A-Za-z_]+)\s*=", line)
        if key is None or key[1] not in knobs:
            kept.append(line)
        elif key[1] in left:
            comment = re.search(r"\s+#.*$", line.rstrip("\n"))
            value = json.dumps(left.pop(key[1]))
            kept.append(f"{key[1]} = {value}{comment[0] if comment else ''}\n")
    last = max((k for k, line in enumerate(kept) if "=" in line.partition("#")[0]), default=-1)
    if last >= 0 and not kept[last].endswith("\n"):
        kept[last] += "\n"
    return [*kept[: last + 1], _written(left), *kept[last + 1 :]]


def _written(values: Mapping[str, Any]) -> str:
    return "".join(f"{key} = {json.dumps(value)}\n" for key, value in values.items())


def _check(before: str, after: str, wanted: Mapping[str, Any], source: str) -> None:
    """The change must be what it was meant to be, and nothing else."""
    knobs = {knob.name for knob in KNOBS}
    expected: dict[str, Any] = tomllib.loads(before)
    run = {key: value for key, value in expected.get("run", {}).items() if key not in knobs}
    expected["run"] = run | dict(wanted)
    try:
        found: Any = tomllib.loads(after)
    except tomllib.TOMLDecodeError:
        found = None
    if found is None or found | {"run": found.get("run", {})} != expected:
        raise ModelgenError(
            f"{source}: run", "it is written in a way that is not changed here", "", "write a [run] table"
        )
