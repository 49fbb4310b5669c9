"""Scene files: TOML text to a Scene, or one clear SceneError."""

from __future__ import annotations

import tomllib
from difflib import get_close_matches
from os import strerror
from pathlib import Path

from modelgen.errors import SceneError, path_of
from modelgen.scene.scene_from_tables import scene_from_tables
from modelgen.scene.scene_name import scene_name
from modelgen.scene.scene_types import Scene
from modelgen.scene.source_location import Place
from modelgen.scene.toml_errors import syntax_fault

LARGEST = 4 * 2**20  # bytes
ALIKE = 0.7  # of two names of files, from 0 to 1, for one to be meant by the other


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
    if not tables:
        raise Place(source).error("an empty file", "a scene has one body or more", "add a [[body]]")
    return scene_from_tables(scene_name(source), tables, source)


def _text(path: Path) -> str:
    place = Place(str(path))
    try:
        if not path.exists():
            raise no_such_file(path)
        if not path.is_file():
            found = "it is a folder" if path.is_dir() else "not a file"
            raise place.error(found, "a scene is a TOML file", "give the path of a file")
        size = path.stat().st_size
        if size > LARGEST:
            raise place.error(f"{size} bytes", f"a scene file has at most {LARGEST}", "is it a scene?")
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        found = f"line {line} is not UTF-8 text"
        raise place.error(found, "a scene is a TOML file", "if it is one, save it as UTF-8") from None
    except (OSError, ValueError) as error:
        reason = strerror(error.errno) if isinstance(error, OSError) and error.errno else "not a path"
        raise place.error(f"cannot be read: {reason}", "", "check the path and its permissions") from None


def no_such_file(path: Path) -> SceneError:
    """The error of a path with no file, with the file of the folder that may have been meant."""
    return Place(str(path)).error("no such file", "", _near(path))


def _near(path: Path) -> str:
    folder = path.parent
    files = folder.glob(f"*{path.suffix or '.toml'}") if folder.is_dir() else ()
    names = {each.stem: each.name for each in files}
    close = get_close_matches(path.stem, names, n=1, cutoff=ALIKE)
    if close:
        return f"did you mean {names[close[0]]!r}?"
    return "check the path" if folder.is_dir() else f"there is no folder {str(folder)!r}"
