"""Scene files: TOML text to a Scene, or one clear SceneError."""

from __future__ import annotations

import tomllib
from os import strerror
from pathlib import Path

from modelgen.errors import nearest, path_of
from modelgen.scene.assemble import scene_from_tables
from modelgen.scene.scene_name import scene_name
from modelgen.scene.scene_types import Scene
from modelgen.scene.source_location import Place
from modelgen.scene.toml_errors import syntax_fault

LARGEST = 4 * 2**20  # bytes


def read(path: str | Path) -> Scene:
    """The scene in a TOML file; raises SceneError (file, key path, what was found, what is allowed)."""
    path = path_of("read", path)
    return read_text(_text(path), path.name)


def read_text(text: str, source: str = "<text>") -> Scene:
    """The scene in a TOML text; `source` names it in messages, its stem names the scene."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        fault = syntax_fault(text, error)
        where = f"line {fault.line}" if fault.line else "end of the file"
        raise Place(source, where).error(f"not TOML: {fault.found}", "", fault.remedy) from None
    except (RecursionError, ValueError):
        found = "not TOML: a value is nested too deeply or has too many digits"
        raise Place(source).error(found, "", "simplify it") from None
    return scene_from_tables(scene_name(source), tables, source)


def _text(path: Path) -> str:
    place = Place(str(path))
    try:
        if not path.exists():
            raise place.error("no such file", "", _near(path))
        if not path.is_file():
            raise place.error("not a file", "a scene is a TOML file", "give the path of a file")
        size = path.stat().st_size
        if size > LARGEST:
            raise place.error(f"{size} bytes", f"a scene file has at most {LARGEST}", "is it a scene?")
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise place.error(
            f"byte {error.start} is not UTF-8 text", "a scene is a TOML file", "is it?"
        ) from None
    except (OSError, ValueError) as error:
        reason = strerror(error.errno) if isinstance(error, OSError) and error.errno else "not a path"
        raise place.error(f"cannot be read: {reason}", "", "check the path and its permissions") from None


def _near(path: Path) -> str:
    folder = path.parent
    names = [each.name for each in folder.glob("*.toml")] if folder.is_dir() else []
    return nearest(path.name, names) or "check the path"
