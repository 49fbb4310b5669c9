"""What an import leaves out, takes otherwise or refuses, in sentences, and what `--without` may name."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest

WITHOUT = {  # what `--without` may name
    "actuators": "actuators that are not motors or linear feedback on a joint, or forces at a site",
    "constraints": "equality constraints other than welds and points",
    "deformables": "flexes: bodies that bend",
    "fluid": "the drag of a medium",
    "meshes": "shapes whose mesh cannot be read, or spans no volume",
    "plugins": "parts that a plugin computes",
    "surfaces": "shapes other than those of the catalogue: signed distances",
    "tendons": "tendons other than straight ones between two sites",
}
SHOWN = 6  # refused parts that a message names


@dataclass(frozen=True)
class Notes:
    """Sentences about what is left out, what is approximated, and, by a key of WITHOUT, what is refused."""

    source: str
    without: Collection[str] = ()
    left_out: list[str] = field(default_factory=list)
    approximated: list[str] = field(default_factory=list)
    refused: list[tuple[str, str]] = field(default_factory=list)

    def omit(self, sentence: str) -> None:
        if sentence not in self.left_out:
            self.left_out.append(sentence)

    def approximate(self, sentence: str) -> None:
        if sentence not in self.approximated:
            self.approximated.append(sentence)

    def refuse(self, part: str, sentence: str) -> None:
        """Note what a scene cannot have; it is left out where the caller asked for that."""
        if part in self.without:
            self.omit(sentence)
        elif (part, sentence) not in self.refused:
            self.refused.append((part, sentence))

    def check(self) -> None:
        """Raises ModelgenError that names what was refused, with the options that leave it out."""
        if not self.refused:
            return
        told = [sentence for _, sentence in self.refused[:SHOWN]]
        if len(self.refused) > SHOWN:
            told.append(f"{len(self.refused) - SHOWN} more")
        parts = ",".join(sorted({part for part, _ in self.refused}))
        remedy = f"leave them out with --without {parts}, or change the file"
        raise ModelgenError(self.source, "; ".join(told), "a scene has no like of them", remedy)


def check_without(names: Collection[str]) -> None:
    """Raises ModelgenError for a name that is no key of WITHOUT."""
    for name in names:
        if name not in WITHOUT:
            allowed = "allowed: " + ", ".join(WITHOUT)
            raise ModelgenError("--without", repr(name), allowed, nearest(name, WITHOUT))
