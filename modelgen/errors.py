"""Every error a user can meet: where, what was found, what is allowed, and the remedy."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

PIPELINE = {  # each value of the pipeline, and the verb that takes it
    "path": "read",
    "Scene": "require",
    "Model": "derive",
    "Derivation": "emit",
    "Package": "build",
    "Library": "simulate",
}


DISTRIBUTION = "modelgen-contact"  # that pip installs; another project has the name of the package


def install(extra: str) -> str:
    """The remedy where a package is missing that an extra brings."""
    return f'run: pip install "{DISTRIBUTION}[{extra}]"'


class ModelgenError(Exception):
    """Base of all errors that a user can cause and mend.

    `str(error)` is one message: `<where>: <found>; <allowed>; <remedy>`, parts that are empty left out.
    """

    def __init__(self, where: str, found: str, allowed: str = "", remedy: str = "") -> None:
        super().__init__(where, found, allowed, remedy)
        self.where = where
        self.found = found
        self.allowed = allowed
        self.remedy = remedy

    def __str__(self) -> str:
        tail = "; ".join(part for part in (self.found, self.allowed, self.remedy) if part)
        return f"{self.where}: {tail}" if self.where else tail


class SceneError(ModelgenError):
    """The scene cannot be read or does not describe a system that can be simulated."""


class ExpressionError(ModelgenError):
    """An expression is not in the language of expressions, or has no finite value."""

    def __init__(
        self, where: str, found: str, allowed: str = "", remedy: str = "", position: int | None = None
    ) -> None:
        super().__init__(where, found, allowed, remedy)
        self.args = (where, found, allowed, remedy, position)
        self.position = position  # index of the first character that offends, or None


class CompilerMissing(ModelgenError):  # noqa: N818  the state of the machine, not a mistake
    """No C compiler was found."""


class LibraryError(ModelgenError):
    """A compiled library is stale, foreign, or called with wrong arguments."""


class SimulationError(ModelgenError):
    """A run cannot start or cannot go on."""


class UnknownNameError(SimulationError, KeyError):
    """A mapping has nothing of that name. It is a KeyError too, so that `in` and `get` work on mappings."""


def with_article(noun: str) -> str:
    """ "an ellipsoid"."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def expect(verb: str, value: object, kind: type) -> None:
    """Raise ModelgenError for a value of the wrong type; the remedy names the call that makes the right one.

    >>> expect("derive", 3, str)
    Traceback (most recent call last):
    modelgen.errors.ModelgenError: derive: the argument is of type int; it takes a str
    """
    if isinstance(value, kind):
        return
    given = "path" if isinstance(value, str | PathLike) else type(value).__name__
    found = f"the argument is of type {type(value).__name__}"
    raise ModelgenError(verb, found, f"it takes a {kind.__name__}", _call(verb, given, kind))


def path_of(verb: str, value: object) -> Path:
    """The path of an argument that is a path or text.

    >>> path_of("read", 3)
    Traceback (most recent call last):
    modelgen.errors.ModelgenError: read: the argument is of type int; it takes a path, as str or Path
    """
    if isinstance(value, str | PathLike):
        return Path(value)
    found = f"the argument is of type {type(value).__name__}"
    raise ModelgenError(verb, found, "it takes a path, as str or Path")


def _call(verb: str, given: str, kind: type) -> str:
    """`write build(emit(derivation))` for a Derivation that `build` was given; from a file if need be."""
    values = list(PIPELINE)
    if kind.__name__ == "Record":
        return f"write {verb}(record_of(trajectory, library), ...)"
    if kind.__name__ not in values:
        return ""
    end = values.index(kind.__name__)
    start = values.index(given) if given in values[:end] else 0
    call = values[start].lower()
    for value in values[start:end]:
        call = f"{PIPELINE[value]}({call})"
    return f"write {verb}({call}{'' if verb in PIPELINE.values() else ', ...'})"
