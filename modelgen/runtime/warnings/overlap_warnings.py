"""Warnings about bodies that pass through each other because no contact lists them."""

from __future__ import annotations

from collections.abc import Sequence

from modelgen.runtime.trajectory import Passage

TOLD = 20  # pairs that are named one by one


def passage_warnings(found: Sequence[Passage], start: float) -> tuple[str, ...]:
    """One warning for each pair, by time; pairs beyond the first TOLD are counted."""
    told = [_told(each, start) for each in found[:TOLD]]
    more = len(found) - TOLD
    if more > 0:
        told.append(f"{more} more pairs pass through each other; --json names all")
    return tuple(told)


def edge_warning(passage: Passage) -> str:
    """The warning that an open edge or end of the first of two shapes was in the second."""
    surface, other = passage.between
    return (
        f"an open edge or end of {surface} passes through {other}, first seen at "
        f"t = {passage.t:.6g} s: it touches nothing; continue the surface farther, or use a solid"
    )


def _told(passage: Passage, start: float) -> str:
    a, b = passage.between
    when = "at the start" if passage.t == start else f"at t = {passage.t:.6g} s"
    how = "overlap" if passage.t == start else "pass through each other"
    return (
        f"{a} and {b} {how}, first seen {when}: no [[contact]] lists them; "
        f'if they should touch, add one with between = ["{a}", "{b}"]'
    )
