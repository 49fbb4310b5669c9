"""Every extreme with what became of it: `modelgen measure --extremes`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from modelgen.benchmark.extreme_contacts import CONTACTS
from modelgen.benchmark.extreme_runs import RUNS
from modelgen.benchmark.extreme_scales_and_spins import SCALES_AND_SPINS
from modelgen.benchmark.extreme_shapes import SHAPES
from modelgen.benchmark.extreme_trials import Extreme, Found, tried
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest

EXTREMES: tuple[Extreme, ...] = (*SHAPES, *SCALES_AND_SPINS, *CONTACTS, *RUNS)


@dataclass(frozen=True, slots=True)
class Survey:
    """Results in the order of the list. `interrupted`: the survey is not complete."""

    found: tuple[Found, ...]
    interrupted: bool

    @property
    def holds(self) -> bool:
        return all(each.holds for each in self.found)

    def as_json(self) -> dict[str, Any]:
        """The object that `measure --extremes --json` prints."""
        return {
            "extremes": [_facts(each, self.of(each)) for each in EXTREMES if self.of(each)],
            "holds": self.holds,
            "interrupted": self.interrupted,
        }

    def of(self, extreme: Extreme) -> list[Found]:
        return [each for each in self.found if each.extreme is extreme]


def survey(
    names: Sequence[str] | None = None,
    *,
    quick: bool = False,
    root: str | Path = "generated",
    on_progress: Callable[[str], None] | None = None,
) -> Survey:
    """Try the extremes of these names, or all, at all of their values, or at a few.

    Libraries lie in folders under `root`. Ctrl-C keeps what was found.
    Raises ModelgenError for an unknown name.
    """
    chosen = [_named(name) for name in names] if names else list(EXTREMES)
    found: list[Found] = []
    try:
        tried(chosen, LibrariesByKinds(Path(root)), quick, on_progress or (lambda text: None), found)
    except KeyboardInterrupt:
        return Survey(tuple(found), True)
    return Survey(tuple(found), False)


def _named(name: str) -> Extreme:
    known = {extreme.name: extreme for extreme in EXTREMES}
    if name not in known:
        remedy = nearest(name, known) or "use one of these names"
        raise ModelgenError("--only", f"no {name!r}", f"allowed: {', '.join(known)}", remedy)
    return known[name]


def _facts(extreme: Extreme, found: Sequence[Found]) -> dict[str, Any]:
    return {
        "name": extreme.name,
        "of": extreme.of,
        "law": extreme.law,
        "measured": extreme.measured,
        "warned": extreme.warned,
        "refused": extreme.refused,
        "switched": extreme.switched,
        "switch": extreme.switch,
        "values": [each.as_json() for each in found],
    }
