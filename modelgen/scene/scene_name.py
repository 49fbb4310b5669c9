"""The name of a scene."""

from __future__ import annotations

import re
from pathlib import Path


def scene_name(source: str) -> str:
    """The name of the scene in a file: the stem of the file's name, in letters that suit any file system."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", Path(source).stem).strip("_")[:64] or "scene"
