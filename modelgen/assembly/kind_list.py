"""A list of distinct kinds, each with a C identifier of its own."""

from __future__ import annotations

from dataclasses import replace
from typing import Generic, TypeVar

from modelgen.model import BodyKind, ContactKind, JointKind, LimitKind, LoadKind, ShapeKind

Kind = TypeVar("Kind", BodyKind, ContactKind, JointKind, LimitKind, LoadKind, ShapeKind)


class KindList(Generic[Kind]):
    """Kinds in the order of first use; the second with the same name is called `name_2`."""

    def __init__(self) -> None:
        self._indices: dict[Kind, int] = {}
        self._kinds: list[Kind] = []

    @property
    def kinds(self) -> tuple[Kind, ...]:
        return tuple(self._kinds)

    def named(self, kind: Kind) -> Kind:
        """The kind with the name that it goes by here; added if new."""
        return self._kinds[self.index(kind)]

    def index(self, kind: Kind) -> int:
        """The index of the kind, which is added if new; its name is a proposal."""
        if kind not in self._indices:
            taken = {other.name for other in self._kinds}
            count = 1 + sum(proposed.name == kind.name for proposed in self._indices)
            name = kind.name if count == 1 else f"{kind.name}_{count}"
            while name in taken:
                count += 1
                name = f"{kind.name}_{count}"
            self._indices[kind] = len(self._kinds)
            self._kinds.append(replace(kind, name=name))
        return self._indices[kind]
