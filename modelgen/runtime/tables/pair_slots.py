"""Slots for near pairs of equal bodies in the tables of the core (modelgen.h): entries of the pattern of each
pool, as often as the pool has slots, and the names of the pairs that slots stand for.

The tables of a manifest have one pair of each pool. Its entries are repeated after those of all pairs with
shapes, before those of limits; entries of support points after all others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np

from modelgen.runtime.tables.number_pool import Array
from modelgen.runtime.tables.planar_contacts import SUPPORT_POINTS
from modelgen.runtime.tables.shapes import BallTables

Columns = dict[str, Array]


@dataclass(frozen=True, slots=True)
class Block:
    """Consecutive entries of a pattern that each slot of its pool has."""

    first: int
    end: int
    slots: int

    @property
    def size(self) -> int:
        return self.end - self.first


class Axis:
    """Entries of one sort, with those of slots: which of the manifest's each one repeats."""

    def __init__(self, count: int, blocks: Sequence[Block], at: int | None = None) -> None:
        """`count`: entries of the manifest; `at`: before which one slots have theirs; None: at the end."""
        self.blocks, self.at, self.count = tuple(blocks), count if at is None else at, count
        sizes = [each.size * each.slots for each in blocks]
        self._starts = [*accumulate(sizes, initial=self.at)]
        self.repeats = sum(sizes)

    def __len__(self) -> int:
        return self.count + self.repeats

    @cached_property
    def order(self) -> Array:
        """Of each entry, which one of the manifest it repeats, or is."""
        return self.repeated(np.arange(self.count))

    @cached_property
    def moved(self) -> Array:
        """Where the entries of the manifest are."""
        own = np.arange(self.count)
        return np.where(own < self.at, own, own + self.repeats)

    def repeated(self, column: Array, width: int = 1) -> Array:
        """A column of `width` numbers an entry."""
        parts = (np.tile(column[width * b.first : width * b.end], b.slots) for b in self.blocks)
        return np.concatenate([column[: width * self.at], *parts, column[width * self.at :]])

    def ranges(self, column: Array) -> Array:
        """A column of the starts of ranges, with the end of the last one."""
        counts = self.repeated(np.diff(column))
        return np.concatenate([column[:1], column[0] + np.cumsum(counts)]).astype(column.dtype)

    def references(self, column: Array, to: Axis, width: int = 1) -> Array:
        """A column of numbers of entries of another axis, negative ones of none; those of slots are of the
        same slot."""
        moved = np.where(column < to.at, column, column + to.repeats).astype(column.dtype)
        parts = []
        for own, other, start in zip(self.blocks, to.blocks, to._starts, strict=False):
            held = column[width * own.first : width * own.end]
            slots = np.arange(own.slots, dtype=column.dtype)[:, None]
            parts.append(np.where(held < 0, held, held + (start - other.first) + other.size * slots).ravel())
        cut = width * self.at
        return np.concatenate([moved[:cut], *parts, moved[cut:]]).astype(column.dtype)


class PairSlots:
    """The slots of the pools of an instance, and what their numbers tell."""

    def __init__(self, instance: Mapping[str, Any]) -> None:
        self.instance = instance
        self.pools: Sequence[Mapping[str, Any]] = instance.get("pools", ())
        self.classes: Sequence[Sequence[Any]] = instance.get("classes", ())
        self.patterns = [instance["pairs"][pool["pattern"]] for pool in self.pools]
        n_pairs, n_contacts = len(instance["pairs"]), len(instance["contacts"])
        counts = [int(pool["slots"]) for pool in self.pools]
        patterns = [int(pool["pattern"]) for pool in self.pools]
        patches = instance["patches"]
        of_pair: dict[int, list[int]] = {}
        for number, patch in enumerate(patches):
            of_pair.setdefault(patch["pair"], []).append(number)
        within = [_span(of_pair.get(pattern, ())) for pattern in patterns]
        held = [
            _span([slot for k in range(*ends) for slot in range(*patches[k]["patch_slots"])])
            for ends in within
        ]
        all_held = int(patches[-1]["patch_slots"][1]) if patches else 0
        limits = len(instance["limits"])

        def blocks(ends: Sequence[tuple[int, int]], width: int = 1, at: int = 0) -> list[Block]:
            return [Block(at + width * a, at + width * b, n) for (a, b), n in zip(ends, counts, strict=True)]

        self.pair = Axis(n_pairs + limits, blocks([(k, k + 1) for k in patterns]), n_pairs)
        of_contacts = [tuple(pair["contacts"]) for pair in self.patterns]
        of_features = [tuple(pair["feature_pairs"]) for pair in self.patterns]
        shown = n_contacts + limits
        n_features = len(instance["feature_pairs"])
        self.contact = Axis(shown, blocks(of_contacts), n_contacts)
        self.support = Axis(SUPPORT_POINTS * all_held, blocks(held, SUPPORT_POINTS))
        self.feature_pair = Axis(n_features + limits, blocks(of_features), n_features)
        self.point = Axis(SUPPORT_POINTS * len(patches), blocks(within, SUPPORT_POINTS))  # of patches
        self.patch, self.patch_slot = Axis(len(patches), blocks(within)), Axis(all_held, blocks(held))
        self._counts = counts
        self.told_stride = 1 + max((b - a for a, b in of_contacts), default=0)

    def __bool__(self) -> bool:
        return bool(self.pools)

    @property
    def count(self) -> int:
        """Slots of all pools."""
        return sum(self._counts)

    @property
    def n_eta(self) -> int:
        """Entries of eta of all contacts, those of slots included."""
        entries = self.instance["contacts"]
        rooms = (
            sum(int(each["room"]) for each in entries[slice(*pair["contacts"])]) for pair in self.patterns
        )
        return int(self.instance["n_eta"]) + sum(
            n * room for n, room in zip(self._counts, rooms, strict=True)
        )

    @cached_property
    def widths(self) -> list[int]:
        """Of each pool, the members of the class of its f."""
        return [len(self.classes[self.sides(k)[1]]) for k in range(len(self.pools))]

    def sides(self, pool: int) -> tuple[int, int]:
        """The classes of o and f of the pairs of a pool."""
        first, second = self.pools[pool]["classes"]
        o = self._first_body(self.patterns[pool])
        return (first, second) if any(body == o for body, _ in self.classes[first]) else (second, first)

    @cached_property
    def told_pairs(self) -> list[int]:
        """The number told of the first pair of each pool, and that after the last one."""
        sizes = [len(self.classes[self.sides(k)[0]]) * width for k, width in enumerate(self.widths)]
        return [*accumulate(sizes, initial=len(self.pair))]

    @cached_property
    def ball_of(self) -> Mapping[Any, int]:
        """Numbers of balls by body and shape."""
        return BallTables(self.instance).index

    def index_tables(self, ball_of: Mapping[Any, int]) -> dict[str, list[int]]:
        """The arrays of mg_system about pools; `ball_of`: numbers of balls by body and shape."""
        count, slots = len(self.classes), [0, *accumulate(self._counts)]
        class_pool = [-1] * (count * count)
        for k, pool in enumerate(self.pools):
            a, b = pool["classes"]
            class_pool[a * count + b] = class_pool[b * count + a] = k
        ball_class, ball_rank = [-1] * len(ball_of), [0] * len(ball_of)
        for k, members in enumerate(self.classes):
            for rank, (body, shape) in enumerate(members):
                ball = ball_of[body, shape]
                ball_class[ball], ball_rank[ball] = k, rank
        return {
            "pool_slot": [self.pair.at + each for each in slots] if self.pools else [],
            "pool_pattern": [pool["pattern"] for pool in self.pools],
            "pool_width": self.widths if self.pools else [],
            "pool_told_pair": self.told_pairs[:-1] if self.pools else [],
            "ball_class": ball_class,
            "ball_rank": ball_rank,
            "class_pool": class_pool,
        }

    @cached_property
    def eta_of_contacts(self) -> int:
        """Entries of eta of the contacts of the instance, without limits."""
        last = self.instance["contacts"][-1:]
        return sum(int(each["eta"]) + int(each["room"]) for each in last)

    @cached_property
    def own_contacts(self) -> Array:
        """The contacts of the core that are in no slot, limits among them."""
        return self.contact.moved

    @cached_property
    def contacts_of_slots(self) -> Array:
        """The contacts of the core that are in slots, without support points."""
        first = self.contact.at
        return np.arange(first, first + self.contact.repeats)

    @cached_property
    def _slot_of_contact(self) -> tuple[Array, Array]:
        """Of each contact of `contacts_of_slots` its slot, and its number in it."""
        sizes = [block.size for block in self.contact.blocks for _ in range(block.slots)]
        slots = np.repeat(np.arange(len(sizes)), sizes)
        return slots, np.concatenate([np.zeros(0, dtype=int), *(np.arange(size) for size in sizes)])

    @cached_property
    def _of_balls(self) -> tuple[Array, Array, Array, Array]:
        """Of each slot its pool, told number and width; of each ball its rank."""
        tables = self.index_tables(self.ball_of)
        pools = np.repeat(np.arange(len(self.pools)), self._counts)
        widths, told = np.array(self.widths), np.array(self.told_pairs)
        return pools, told[pools], widths[pools], np.array(tables["ball_rank"])

    def pairs_told(self, slot_balls: Array) -> Array:
        """The number told of the pair in each slot, from those of its balls (mg_run.slot_balls)."""
        _, told, widths, ranks = self._of_balls
        o, f = np.maximum(slot_balls.reshape(-1, 2).astype(int) - 1, 0).T
        found: Array = told + ranks[o] * widths + ranks[f]
        return found

    def contacts_told(self, contacts: Array, pairs: Array) -> Array:
        """The numbers told of contacts in slots; `pairs`: of the pair in each slot."""
        slots, within = (each[contacts - self.contact.at] for each in self._slot_of_contact)
        first = len(self.contact) + len(self.support)
        found: Array = first + (pairs[slots] - len(self.pair)) * self.told_stride + within
        return found

    def pairs_of_patches(self, patches: Array, pairs: Array) -> Array:
        """The numbers told of the pairs of patches of slots; `pairs`: of the pair in each slot."""
        sizes = [block.size for block in self.patch.blocks for _ in range(block.slots)]
        found: Array = pairs[np.repeat(np.arange(len(sizes)), sizes)[patches - self.patch.at]]
        return found

    def entry_of(self, contact: int) -> Mapping[str, Any] | None:
        """The entry of a contact of the core in the instance, in a slot that of the pattern; None of a
        limit."""
        own, entries = int(self.contact.order[contact]), self.instance["contacts"]
        return entries[own] if own < len(entries) else None

    def eta_of(self, contact: int) -> int:
        """Where the eta of a contact of the core begin among those of all."""
        entry, first = self.entry_of(contact), self.contact.at
        if entry is None:
            limit = int(self.contact.order[contact]) - len(self.instance["contacts"])
            return int(self.instance["limits"][limit]["eta"]) + self.n_eta - int(self.instance["n_eta"])
        if contact < first:
            return int(entry["eta"])
        rooms = [int(self.instance["contacts"][k]["room"]) for k in self.contact.order[first:contact]]
        return self.eta_of_contacts + sum(rooms)

    def bodies_of(self, contact: int, feature_pair: int, slot_balls: Array) -> tuple[int, int]:
        """Bodies o and f of a feature pair that a contact of the core is on."""
        entry = self.instance["feature_pairs"][int(self.feature_pair.order[feature_pair])]
        o, f = int(entry["o"]), int(entry["f"])
        if contact < self.contact.at or self.entry_of(contact) is None:
            return o, f
        slot = int(self._slot_of_contact[0][contact - self.contact.at])
        bodies = [body for body, _ in self.ball_of]
        held = [bodies[ball - 1] for ball in slot_balls[2 * slot : 2 * slot + 2]]
        pattern = self.patterns[int(self._of_balls[0][slot])]
        return (held[0], held[1]) if o == self._first_body(pattern) else (held[1], held[0])

    def _first_body(self, pattern: Mapping[str, Any]) -> int:
        """Body o of a pattern."""
        source = self.instance["pairs"][pattern["repeats"]] if "repeats" in pattern else pattern
        is_swapped = self.instance["feature_pairs"][source["feature_pairs"][0]]["swapped"]
        return int(pattern["bodies"][1 if is_swapped else 0])

    def feature_pairs_of_patterns(self, feature_pairs: Array) -> Array:
        """Numbers of feature pairs, in slots those of their pattern; -1 of none."""
        held = self.feature_pair.order[np.maximum(feature_pairs, 0)]
        return np.where(feature_pairs < 0, -1, held).astype(feature_pairs.dtype)

    def pattern_of(self, told: int) -> int:
        """The pair of the instance by the number that the core tells, of a slot the pattern."""
        return told if told < len(self.pair) else self.pair_told(told)[0]

    def pair_name(self, told: int) -> str:
        """The name of a pair by the number that the core tells; of none, -1, empty."""
        if told < 0:
            return ""
        if told < len(self.pair):
            return str(self.instance["pairs"][told]["name"])
        return "-".join(str(self.instance["bodies"][body]["name"]) for body in self.pair_told(told)[1])

    def patch_name(self, pair: int, pattern: str) -> str:
        """The name of a patch of a pair by the number that the core tells, from that of its pattern."""
        return f"{self.pair_name(pair)}:{pattern.rpartition(':')[2]}"

    def pair_told(self, number: int) -> tuple[int, tuple[int, int]]:
        """The pattern of a pair that a number of a slot tells, and the bodies of the pair, as the scene has
        them."""
        pool = next(k for k, end in enumerate(self.told_pairs[1:]) if number < end)
        ranks = divmod(number - self.told_pairs[pool], self.widths[pool])
        bodies = sorted(
            int(self.classes[side][rank][0]) for side, rank in zip(self.sides(pool), ranks, strict=True)
        )
        return int(self.pools[pool]["pattern"]), (bodies[0], bodies[1])


class ContactNames:
    """The names of contacts by the numbers that the core tells (mg_told_contact): those of the instance, of
    slots by the pair that they stand for, and of limits."""

    def __init__(self, instance: Mapping[str, Any], slots: PairSlots) -> None:
        self._own = tuple(str(each["name"]) for each in (*instance["contacts"], *instance["limits"]))
        self._slots, self._bodies = slots, [str(body["name"]) for body in instance["bodies"]]
        self._all = len(slots.contact) + len(slots.support)  # contacts of the core

    def __len__(self) -> int:
        """How many contacts have names: those of the core but for support points."""
        return len(self._slots.contact)

    __iter__ = None  # the pairs that slots stand for are others at each time

    def __getitem__(self, index: int) -> str:
        if index >= self._all:
            return self._of_slot(index - self._all)
        return str(self._own[int(self._slots.contact.order[index])])

    def _of_slot(self, told: int) -> str:
        pair, k = divmod(told, self._slots.told_stride)
        pattern, bodies = self._slots.pair_told(pair + len(self._slots.pair))
        entry = self._slots.instance["pairs"][pattern]
        first, end = entry["contacts"]
        name = "-".join(self._bodies[body] for body in bodies)
        suffix = self._own[first + k][len(str(entry["name"])) :] if first + k < end else ""
        return f"{name}{suffix}"


def _span(numbers: Sequence[int]) -> tuple[int, int]:
    """The range of consecutive numbers."""
    return (numbers[0], numbers[-1] + 1) if numbers else (0, 0)


def with_slots(integers: Columns, reals: Columns, slots: PairSlots) -> tuple[Columns, Columns]:
    """The arrays of mg_system with entries for the slots of the pools."""
    pair, patch = slots.pair, slots.patch
    contacts, features = (slots.contact, slots.support), (slots.feature_pair, slots.point)
    condition = _within(slots.feature_pair, integers["feature_pair_condition"])
    constraint = _within(slots.contact, integers["contact_friction"])
    arc, covered = _within(patch, integers["patch_arc"]), _within(patch, integers["patch_covered"])
    rooms = np.diff(integers["contact_eta"], append=slots.instance["n_eta"])
    of_contacts = {
        "contact_pair": _joined(contacts, integers["contact_pair"], to=pair),
        "contact_feature_pair": _joined(contacts, integers["contact_feature_pair"], to=slots.feature_pair),
        "contact_eta": _ends(_joined(contacts, rooms))[:-1],
        "impact_law": _joined(contacts, integers["impact_law"]),
        **{
            name: _ends(_joined(contacts, np.diff(integers[name])))
            for name in ("contact_friction", "contact_friction_row")
        },
        **{
            f"friction_{name}": constraint.repeated(integers[f"friction_{name}"])
            for name in ("kind", "row", "body")
        },
    }
    of_pairs = {
        **{name: pair.ranges(integers[name]) for name in ("pair_contact", "pair_feature_pair")},
        **{name: pair.repeated(integers[name]) for name in ("pair_search", "pair_is_candidate")},
        "pair_balls": pair.repeated(integers["pair_balls"], 2),
    }
    of_features = {
        **{
            f"feature_pair_{name}": _joined(features, integers[f"feature_pair_{name}"])
            for name in ("kind", "o", "f", "group", "parameters")
        },
        "feature_pair_owner": _joined(features, integers["feature_pair_owner"], to=pair),
        "feature_pair_condition": _ends(_joined(features, np.diff(integers["feature_pair_condition"]))),
        **{
            f"feature_{name}": _joined(features, integers[f"feature_{name}"], 2)
            for name in ("shape", "parameters", "numbers", "tree", "is_listed")
        },
        **{
            f"condition_{name}": condition.repeated(integers[f"condition_{name}"])
            for name in ("kind", "feature", "numbers", "is_line_end")
        },
        "condition_feature_pair": condition.references(
            integers["condition_feature_pair"], slots.feature_pair
        ),
    }
    starts = {name: patch.ranges(integers[name]) for name in ("patch_arc", "patch_covered", "patch_share")}
    of_patches = {
        **starts,
        "patch_pair": patch.references(integers["patch_pair"], pair),
        "patch_slots": _spans(integers["patch_slots"], patch, slots.patch_slot),
        "patch_arc_f": starts["patch_arc"][:-1]
        + patch.repeated(integers["patch_arc_f"] - integers["patch_arc"][:-1]),
        "patch_numbers": patch.repeated(integers["patch_numbers"]),
        "covered_feature_pair": covered.references(integers["covered_feature_pair"], slots.feature_pair),
        **{
            f"arc_{name}": arc.repeated(integers[f"arc_{name}"])
            for name in ("shape", "parameters", "numbers", "loop")
        },
    }
    made = {
        "restitution": _joined(contacts, reals["restitution"]),
        **{
            f"friction_{name}": constraint.repeated(reals[f"friction_{name}"], width)
            for name, width in (("static", 2), ("kinetic", 2), ("direction", 3))
        },
        "patch_friction": patch.repeated(reals["patch_friction"], 2),
        "pair_normal": pair.repeated(reals["pair_normal"], 3),
    }
    return integers | of_contacts | of_pairs | of_features | of_patches, reals | made


def _joined(axes: tuple[Axis, Axis], column: Array, width: int = 1, to: Axis | None = None) -> Array:
    """A column of entries of one axis, then of another; of numbers of entries of a third, where that is
    given."""
    split = width * axes[0].count
    parts = zip(axes, (column[:split], column[split:]), strict=True)
    return np.concatenate(
        [
            axis.repeated(part, width) if to is None else axis.references(part, to, width)
            for axis, part in parts
        ]
    )


def _ends(counts: Array) -> Array:
    """The column of starts of ranges of these lengths."""
    return np.concatenate([[0], np.cumsum(counts)])


def _within(axis: Axis, starts: Array) -> Axis:
    """The axis of what the entries of another one have, by the column of their starts."""
    blocks = [Block(int(starts[each.first]), int(starts[each.end]), each.slots) for each in axis.blocks]
    return Axis(int(starts[axis.count]), blocks, int(starts[axis.at]))


def _spans(column: Array, patch: Axis, to: Axis) -> Array:
    """A column of first and last + 1 entries of another axis."""
    last = column.reshape(-1, 2)[:, 1] - 1
    ends = patch.references(column.reshape(-1, 2)[:, 0].copy(), to), patch.references(last, to) + 1
    return np.stack(ends, axis=1).ravel()
