"""Every error a user can meet: where, what was found, what is allowed, and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


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


def nearest(name: str, known: Iterable[str]) -> str:
    """`did you mean 'x'?` for the known name closest to `name`, or an empty text."""
    close = get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f"did you mean {close[0]!r}?" if close else ""
