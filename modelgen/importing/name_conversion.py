"""Names of a scene from names of a file, which may be any text."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from modelgen.scene.actuators import COORDINATE, RATE
from modelgen.scene.constants import RESERVED

LONGEST = 64  # of a body, shape or joint
LONGEST_IN_EXPRESSIONS = 32


@dataclass
class Names:
    """Names of one kind, each once."""

    longest: int = LONGEST
    taken: set[str] = field(default_factory=set)

    def of(self, written: str, otherwise: str) -> str:
        """A name near to what is written, that has no other owner; near to `otherwise` where none is."""
        plain = re.sub(r"\W", "_", written or otherwise, flags=re.ASCII)
        plain = plain if plain[0].isalpha() else f"n_{plain.lstrip('_')}"
        name, number = plain[: self.longest], 1
        while name in self.taken:
            number += 1
            tail = f"_{number}"
            name = plain[: self.longest - len(tail)] + tail
        self.taken.add(name)
        return name


def expression_names() -> Names:
    """Names that expressions may use: short, without two underlines in a row, and none that they have."""
    return _ExpressionNames(LONGEST_IN_EXPRESSIONS, {*RESERVED, COORDINATE, RATE})


class _ExpressionNames(Names):
    def of(self, written: str, otherwise: str) -> str:
        joined = re.sub(r"[\W_]+", "_", written or otherwise, flags=re.ASCII).strip("_") or otherwise
        return super().of(joined, otherwise)
