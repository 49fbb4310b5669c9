"""Store of measurements: one line of JSON each, in the folder in which the scene is built."""

from __future__ import annotations

import json
from errno import EINVAL
from pathlib import Path
from typing import Any

from modelgen.codegen.built_files import signature
from modelgen.file_writing import unwritable

NAME = "measured.jsonl"


class Store:
    """Measurements by key; each is on disk as soon as it is made, so that nothing of them is lost."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        self.known: dict[str, Any] = {}
        text = self.path.read_text(encoding="utf-8", errors="replace") if self.path.is_file() else ""
        self._start = "" if text.endswith("\n") or not text else "\n"  # after a line that was cut
        for line in text.splitlines():
            entry = _entry(line)
            if entry:
                self.known[entry["key"]] = entry["value"]

    def get(self, key: str) -> Any:
        return self.known.get(key)

    def put(self, key: str, value: Any) -> None:
        self.known[key] = value
        if self.path.exists() and not self.path.is_file():
            raise unwritable(self.path, OSError(EINVAL, "it is no file"))
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                entry = {"key": key, "value": value, "seal": _seal(key, value)}
                file.write(self._start + json.dumps(entry) + "\n")
        except OSError as cause:
            raise unwritable(self.path, cause) from cause
        self._start = ""


def _entry(line: str) -> dict[str, Any] | None:
    """A line that this user's program wrote to its end; none that came with a scene."""
    try:
        entry = json.loads(line)
    except (ValueError, RecursionError):
        return None
    if not (isinstance(entry, dict) and entry.keys() == {"key", "value", "seal"}):
        return None
    return entry if entry["seal"] == _seal(entry["key"], entry["value"]) else None


def _seal(key: str, value: Any) -> str:
    return signature(json.dumps([key, value]).encode()).decode()
