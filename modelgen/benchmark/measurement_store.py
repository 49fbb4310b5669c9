"""Store of measurements: one line of JSON each, in the folder in which the scene is built."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

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
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                file.write(self._start + json.dumps({"key": key, "value": value}) + "\n")
        except OSError as cause:
            raise unwritable(self.path, cause) from cause
        self._start = ""


def _entry(line: str) -> dict[str, Any] | None:
    """A line that was written to its end."""
    try:
        entry = json.loads(line)
    except ValueError:
        return None
    return entry if isinstance(entry, dict) and entry.keys() == {"key", "value"} else None
