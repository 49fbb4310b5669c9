"""What the texts of options say. The rules of scene files, which read most, load when an option is given."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from modelgen.errors import ModelgenError


def read_option(name: str, text: str | None, option: str | None = None) -> Any:
    """The value of `--name`, or of `--option` of the type `name`; None if it was not given. Raises
    ModelgenError where it stands."""
    if text is None:
        return None
    from modelgen.cli.option_values import value_of  # needs the format of scenes

    return value_of(name, text, f"--{option or name}")


def read_values(texts: list[str] | None, option: str) -> dict[str, float]:
    """The values of an option that is written NAME=NUMBER. Raises ModelgenError where it is not, or a name
    comes twice."""
    given = named_values(texts, option, "mass=1.2")
    if not given:
        return {}
    from modelgen.cli.option_values import number_of

    return {name: number_of(text, f"{option} {name}") for name, text in given.items()}


def named_values(texts: list[str] | None, option: str, example: str) -> dict[str, str]:
    """The texts of an option that is written NAME=TEXT, by name. Raises ModelgenError where it is not, or a
    name comes twice."""
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name:
            form = f"NAME={'NUMBER' if ':' not in example else 'VALUES'}"
            raise ModelgenError(f"{option} {text}", f"no {form}", "", f"write {option} {example}")
        if name in found:
            raise ModelgenError(f"{option} {text}", f"a second value of {name!r}", "", "leave one out")
        found[name] = value
    return found


def refuse_main(name: str | None) -> None:
    """Raises ModelgenError for `--main`, whose place `export` has taken."""
    if name is not None:
        remedy = "write: modelgen export SCENE --to c --out FOLDER"
        raise ModelgenError("--main", repr(name), "C programs of a run are written by `export`", remedy)


def read_configuration(text: str | None) -> tuple[int, dict[str, Any]]:
    """Seed and given inputs of `--at`. Raises ModelgenError where it is neither a seed nor a JSON object."""
    if text is None or not text.endswith(".json"):
        return (0 if text is None else read_option("at", text)), {}
    try:
        given = json.loads(Path(text).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ModelgenError(f"--at: {text}", f"no JSON: {error}", "an object of inputs") from None
    except OSError as error:
        found, remedy = f"it cannot be read: {error.strerror}", "check the path, or give a seed such as 7"
        raise ModelgenError(f"--at: {text}", found, "a seed, or a JSON file of inputs", remedy) from None
    if not isinstance(given, dict):
        raise ModelgenError(f"--at: {text}", "no JSON object", 'an object such as {"eta": [0.1, 0.2]}')
    return 0, given
