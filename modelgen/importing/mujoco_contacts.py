"""Which geoms of a MuJoCo model touch, and how: by filters, exclusions and listed pairs, as in MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from math import exp, pi, sqrt
from typing import Any

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Array, Compiled
from modelgen.importing.scene_writing import rounded

LISTED = 16  # bits of a body's number in the signature of an exclusion


@dataclass(frozen=True)
class Touch:
    """How two geoms touch; keys as scene files have them."""

    friction: float
    spinning: float  # m
    rolling: float  # m
    restitution: float

    def keys(self) -> dict[str, Any]:
        keys: dict[str, Any] = {}
        if self.restitution:
            keys["restitution"] = self.restitution
        if self.friction:
            keys["friction"] = self.friction
            if self.rolling:
                keys["rolling_resistance"] = self.rolling
            if self.spinning:
                keys["spinning_resistance"] = self.spinning
        return keys


Touches = dict[tuple[int, int], Touch]


def touches(source: Compiled, notes: Notes) -> Touches:
    """By pairs of geoms, the first number less than the second."""
    model = source.model
    if source.is_disabled("CONTACT"):
        return {}
    found = {pair: _mixed(source, *pair) for pair in _filtered(source)}
    for k in range(model.npair):
        one, other = sorted((int(model.pair_geom1[k]), int(model.pair_geom2[k])))
        found[one, other] = _touch(int(model.pair_dim[k]), model.pair_friction[k], model.pair_solref[k])
    if found:
        notes.approximate("contacts are rigid; in MuJoCo they give way")
    for values, what in ((model.geom_margin, "margins"), (model.geom_gap, "gaps")):
        if any(values[geom] for pair in found for geom in pair):
            notes.omit(f"{what} of contacts")
    for name in ("geom_adhesion", "geom_surfacevel"):
        values = getattr(model, name, None)
        if values is not None and any(np.any(values[geom]) for pair in found for geom in pair):
            notes.omit(f"{name.removeprefix('geom_')} of geoms")
    return found


def _filtered(source: Compiled) -> Iterator[tuple[int, int]]:
    """Pairs that bits, welds, parents and exclusions let touch."""
    model = source.model
    weld = [int(each) for each in model.body_weldid]
    above = [weld[int(model.body_parentid[each])] for each in weld]
    excluded = {frozenset((int(s) >> LISTED, int(s) & ((1 << LISTED) - 1))) for s in model.exclude_signature}
    by_parent = not source.is_disabled("FILTERPARENT")
    kinds = [(int(model.geom_contype[g]), int(model.geom_conaffinity[g])) for g in range(model.ngeom)]
    silent = [kind == (0, 0) for kind in kinds]
    for a, b in combinations((g for g in range(model.ngeom) if not silent[g]), 2):
        if not (kinds[a][0] & kinds[b][1] or kinds[b][0] & kinds[a][1]):
            continue
        one, other = int(model.geom_bodyid[a]), int(model.geom_bodyid[b])
        if weld[one] == weld[other] or frozenset((one, other)) in excluded:
            continue
        moving = weld[one] != 0 and weld[other] != 0
        if by_parent and moving and (weld[one] == above[other] or weld[other] == above[one]):
            continue
        yield a, b


def _mixed(source: Compiled, a: int, b: int) -> Touch:
    """The properties of two geoms together: those of higher priority, else the larger friction."""
    model = source.model
    rank = int(model.geom_priority[a]) - int(model.geom_priority[b])
    if rank:
        own = a if rank > 0 else b
        return _touch(int(model.geom_condim[own]), model.geom_friction[own], model.geom_solref[own])
    slide, spin, roll = np.maximum(model.geom_friction[a], model.geom_friction[b])
    dimension = max(int(model.geom_condim[a]), int(model.geom_condim[b]))
    weights = np.array([model.geom_solmix[a], model.geom_solmix[b]], dtype=float)
    share = weights / weights.sum() if weights.sum() else np.array([0.5, 0.5])
    one, other = model.geom_solref[a], model.geom_solref[b]
    stiff = one[0] > 0 and other[0] > 0
    solref = share[0] * one + share[1] * other if stiff else np.minimum(one, other)
    return _touch(dimension, [slide, spin, roll], solref)


def _touch(dimension: int, friction: Any, solref: Array) -> Touch:
    """Of a contact of 1 (frictionless), 3 (slip), 4 (spin as well) or 6 (rolling as well) dimensions."""
    values = [float(each) for each in friction]
    if len(values) == 5:  # of a listed pair: two of slip, one of spin, two of rolling
        values = [max(values[:2]), values[2], max(values[3:])]
    slide, spin, roll = values
    slide = slide if dimension >= 3 else 0.0
    return Touch(
        rounded(slide),
        rounded(spin) if slide and dimension >= 4 else 0.0,
        rounded(roll) if slide and dimension == 6 else 0.0,
        _restitution(solref),
    )


def _restitution(solref: Array) -> float:
    """The coefficient of restitution of a contact's spring and damper.

    Args:
        solref: time constant, s, and damping ratio; or, negative, stiffness and damping.
    """
    first, second = (float(each) for each in solref)
    ratio = second if first > 0 else -second / (2 * sqrt(-first)) if first < 0 else 1.0
    if ratio >= 1:
        return 0.0
    ratio = max(ratio, 0.0)
    return float(f"{exp(-pi * ratio / sqrt(1 - ratio * ratio)):.9g}")
