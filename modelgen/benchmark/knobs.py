"""Table of knobs: settings that trade speed for accuracy, their values, and the scenes on which they have an
effect.

A further choice is a further row, or a further value of one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from modelgen.scene.run_choices import COMPILED_SOLVERS, SCHEMES

Value = str | int | float | bool
Settings = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Facts:
    """Properties of a scene that decide which knobs have an effect."""

    until: float  # s
    time: float  # s, the characteristic time
    forms: Mapping[str, int]  # entries of eta under each form of the contacts; the first is "auto"
    contacts: bool
    joints: bool
    friction: bool = False


@dataclass(frozen=True, slots=True)
class Knob:
    """A choice with its values; the first is where a sweep starts.

    A ladder has the values from coarse to fine, and all of them are tried; others are tried where they help.
    """

    name: str
    trades: str
    values: Callable[[Facts], Sequence[Value]]
    matters: Callable[[Facts, Settings], bool]  # whether it can differ, given the knobs above it
    ladder: bool = False


def _always(facts: Facts, settings: Settings) -> bool:
    return True


def _accelerates(facts: Facts, settings: Settings) -> bool:
    """Contacts act by forces, not by impulses."""
    return settings["method"] != "time-stepping"


def _steps(facts: Facts) -> list[float]:
    """1, 2, 5 times powers of ten, s: from a tenth of the run, or of T, down by five decades."""
    top = min(facts.time, facts.until) / 10
    rungs = (digit * 10.0**power for power in range(9, -16, -1) for digit in (5, 2, 1))
    return [float(f"{rung:.0e}") for rung in islice((r for r in rungs if r <= top), 15)]


KNOBS: tuple[Knob, ...] = (
    Knob(
        "method",
        "event-driven: adaptive order 8, or order 4 with a fixed step; or time-stepping",
        lambda f: ("dop853", "rk4", "time-stepping") if f.contacts else ("dop853", "rk4"),
        _always,
    ),
    Knob(
        "tolerance",
        "local error of a step",
        lambda f: [float(f"1e-{k}") for k in range(2, 18)],
        lambda f, s: s["method"] == "dop853",
        ladder=True,
    ),
    Knob("step", "s, the fixed step", _steps, lambda f, s: s["method"] != "dop853", ladder=True),
    Knob("scheme", "of time-stepping", lambda f: SCHEMES, lambda f, s: s["method"] == "time-stepping"),
    Knob(
        "solver",
        "of time-stepping: Coulomb's law or its convex relaxation, which the core solves",
        lambda f: COMPILED_SOLVERS,
        lambda f, s: s["method"] == "time-stepping" and f.friction,
    ),
    Knob("form", "form of the contact equations", lambda f: tuple(f.forms), lambda f, s: len(f.forms) > 1),
    Knob(
        "newton",
        "corrections of contact points: none, once a step, at every stage",
        lambda f: (1, 0, 2),
        lambda f, s: f.forms[str(s.get("form", "auto"))] > 0 and _accelerates(f, s),
    ),
    Knob(
        "project",
        "steps between two projections of drift, 0: none",
        lambda f: (1, 0, 10),
        lambda f, s: f.contacts or f.joints,
    ),
    Knob(
        "use_gamma",
        "Gamma2 kept or dropped",
        lambda f: (True, False),
        lambda f, s: f.contacts and _accelerates(f, s),
    ),
    Knob("real", "digits of the arithmetic", lambda f: ("double", "float", "long double"), _always),
    Knob("level", "optimisation by the compiler", lambda f: ("O2", "O3", "O1"), _always),
)


@dataclass(frozen=True, slots=True)
class Space:
    """The settings that a sweep may take: knobs, the first of which is the method, for one subject.

    Where `free` names knobs, these and the ladders are turned, and all others stay as they are in `own`, what
    the scene says of itself, or else at their first value.
    """

    knobs: tuple[Knob, ...]
    facts: Facts
    free: tuple[str, ...] | None = None
    own: Settings = field(default_factory=dict)

    def values(self, knob: Knob) -> Sequence[Value]:
        """The values that the knob may take here."""
        values = knob.values(self.facts)
        if not self._is_fixed(knob):
            return values
        return [self.own[knob.name]] if knob.name in self.own else values[:1]

    def matters(self, knob: Knob, settings: Settings) -> bool:
        said = self._is_fixed(knob) and knob.name in self.own
        turns = said or knob is self.knobs[0] or len(self.values(knob)) > 1
        return turns and knob.matters(self.facts, settings)

    def _is_fixed(self, knob: Knob) -> bool:
        return self.free is not None and knob.name not in self.free and not knob.ladder

    def settled(self, chosen: Settings) -> dict[str, Value]:
        """All knobs that matter, in their order; those left open at their first value, the others dropped."""
        settings: dict[str, Value] = {}
        for knob in self.knobs:
            if self.matters(knob, settings):
                settings[knob.name] = chosen.get(knob.name, self.values(knob)[0])
        return settings

    def ladders(self) -> Iterator[list[dict[str, Value]]]:
        """For each method its settings from coarse to fine, all else at its first value."""
        for method in self.values(self.knobs[0]):
            start = self.settled({self.knobs[0].name: method})
            for knob in self.knobs:
                if knob.ladder and knob.name in start:
                    yield [self.settled(start | {knob.name: value}) for value in knob.values(self.facts)]

    def below(self, settings: Settings) -> list[dict[str, Value]]:
        """The settings that are finer on their ladder and the same otherwise, from coarse to fine."""
        (ladder,) = (knob for knob in self.knobs if knob.ladder and knob.name in settings)
        rungs = list(self.values(ladder))
        here = settings[ladder.name]
        finer = rungs[rungs.index(here) + 1 :] if here in rungs else []
        return [{**settings, ladder.name: value} for value in finer]

    def alternatives(self) -> Iterator[tuple[str, Value]]:
        """All values but the first of each knob that is neither a ladder nor the method."""
        for knob in self.knobs[1:]:
            if not knob.ladder:
                yield from ((knob.name, value) for value in self.values(knob)[1:])

    def with_value(self, settings: Settings, name: str, value: Value) -> dict[str, Value] | None:
        """The settings with one knob turned; None where it makes no difference."""
        if name not in settings:
            return None
        turned = self.settled({**settings, name: value})
        return turned if turned != settings else None

    def between(self, a: Settings, b: Settings) -> dict[str, Value] | None:
        """Half-way on the ladder between two settings that differ there alone; None if there is nothing."""
        differing = [name for name in a if a.get(name) != b.get(name)]
        ladders = {knob.name for knob in self.knobs if knob.ladder}
        if a.keys() != b.keys() or len(differing) != 1 or differing[0] not in ladders:
            return None
        name = differing[0]
        middle = float(f"{(float(a[name]) * float(b[name])) ** 0.5:.2g}")
        return None if middle in (a[name], b[name]) else {**a, name: middle}
