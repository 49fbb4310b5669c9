"""The entries of all feature pairs, pair by pair; of a pair that repeats another, made when asked for.

A heap of 200 boxes has five million of them, and most are never looked at.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate, chain
from typing import Generic, TypeVar, overload

Entry = TypeVar("Entry")
Bodies = tuple[int, int]  # of a pair, as the user named them


class RepeatedEntries(Sequence[Entry], Generic[Entry]):
    """A read-only sequence; equal to one of the same entries."""

    def __init__(
        self,
        sources: Sequence[Sequence[Entry]],
        bodies: Sequence[Bodies | None],
        made: Callable[[Entry, int, Bodies], Entry],
    ) -> None:
        """`sources`: the entries of each pair, or of the pair that it repeats; `bodies`: its own where it
        repeats one, else None; `made`: an entry for the pair of a number with these bodies."""
        self._sources, self._bodies, self._made = sources, bodies, made
        self._starts = [*accumulate(map(len, sources), initial=0)]

    def __len__(self) -> int:
        return self._starts[-1]

    @overload
    def __getitem__(self, index: int) -> Entry: ...
    @overload
    def __getitem__(self, index: slice) -> list[Entry]: ...
    def __getitem__(self, index: int | slice) -> Entry | list[Entry]:
        if isinstance(index, slice):
            first, end, step = index.indices(len(self))
            return self._between(first, end) if step == 1 else [self[k] for k in range(first, end, step)]
        at = index + len(self) if index < 0 else index
        if not 0 <= at < len(self):
            raise IndexError(index)
        return self._between(at, at + 1)[0]

    def __iter__(self) -> Iterator[Entry]:
        return chain.from_iterable(
            self._of(pair, source, 0, len(source)) for pair, source in enumerate(self._sources)
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return len(self) == len(other) and all(a == b for a, b in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]

    def _between(self, first: int, end: int) -> list[Entry]:
        found: list[Entry] = []
        pair = bisect_right(self._starts, first) - 1
        while first < end:
            start, source = self._starts[pair], self._sources[pair]
            found += self._of(pair, source, first - start, min(end - start, len(source)))
            first, pair = start + len(source), pair + 1
        return found

    def _of(self, pair: int, source: Sequence[Entry], first: int, end: int) -> Sequence[Entry]:
        bodies, entries = self._bodies[pair], source[first:end]
        return entries if bodies is None else [self._made(each, pair, bodies) for each in entries]
