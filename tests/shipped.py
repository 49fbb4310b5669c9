"""What is expected of a shipped scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

CURVE_ON_SURFACE = ("curve_implicit", "curve_block", "curve_paper", "curve_differentiated")


@dataclass(frozen=True)
class Shipped:
    """What holds for one scene in every regular form.

    Attributes:
        kinds: what `check` prints for the scene as it stands: bodies, contacts in the chosen form, loads,
            joints, limits.
        forms: all that are regular for one of the scene's contacts; none without contacts.
        reference: the test that holds the scene against its reference, as `file::function` in tests.
        events: how often each kind of event happens at `balanced` and at `tight`, one number for both or
            two; None: many.
        drift: bounds on the energy drift at `fast`, `balanced` and `tight`.
        margin: every closed contact has more; less where a rim begins to roll from flat.
        loose: by what the bounds on gaps and complementarity are wider, where the run falls back.
        apart: bound on the difference of final positions between forms at `tight`, m.
        single: bound on the position error of half a second in float, m; more where friction is decided,
            which in float is known to a thousandth.
        reachable: the last decade, 1e-reachable of the length, that `tune` can promise over the run by its
            tolerance; 0: not even 1e-3. Less than 10 where bounds of rest or slip decide what happens.
    """

    kinds: tuple[str, ...]
    forms: tuple[str, ...]
    reference: str
    events: Mapping[str, int | tuple[int, int] | None] = field(default_factory=dict)
    drift: tuple[float, float, float] = (1e-4, 1e-9, 1e-11)
    margin: float = 1e-3
    loose: float = 1.0
    apart: float = 1e-12
    single: float = 2e-5
    reachable: int = 10
