"""Features and conditions of the feature pairs in the tables of the core (modelgen.h)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from math import hypot, pi
from typing import Any, TypeVar

import numpy as np

from modelgen.codegen.manifest import Manifest, have_spines
from modelgen.runtime.tables.number_pool import INTEGER, Array, NumberPool

Entry = Mapping[str, Any]
Found = TypeVar("Found")

CELLS_PER_TREE, CELLS_MIN, CELLS_MAX = 4096, 32768, 1 << 20
CONDITIONS = (
    "quadric",
    "parameter",
    "disc",
    "wing",
    "direction",
    "tilt",
    "coaxial",
    "tip",
)  # MG_CONDITION_QUADRIC ..


BORDERS = ("quadric", "parameter", "disc")  # kinds of conditions that tell features of one surface apart


class FeatureTables:
    """`integers`: arrays of mg_system. Parameters of contact kinds and of shapes are added to `parameters`,
    numbers of features and conditions to `numbers`."""

    def __init__(
        self, manifest: Manifest, parameters: NumberPool, numbers: NumberPool, endless: float
    ) -> None:
        instance, kinds, length = manifest.instance, manifest.kinds, manifest.instance["scales"]["length"]
        trees, pairs = _Trees(kinds), _Pairs(instance, parameters.shares)

        def placed(side: Entry) -> list[float]:
            return _side_numbers(side, endless, spans(side, kinds["shape"], length))

        def column(key: str) -> Array:
            return pairs.each(lambda entries: [each[key] for each in entries])

        counts = pairs.each(lambda entries: [len(each["conditions"]) for each in entries])
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(INTEGER)
        o, f = pairs.bodies()
        self.integers: dict[str, Array] = {
            "pair_feature_pair": pairs.starts,
            "feature_pair_kind": column("kind"),
            "feature_pair_o": o,
            "feature_pair_f": f,
            "feature_pair_owner": pairs.owners(),
            "feature_pair_group": column("face_group"),
            "feature_pair_parameters": pairs.pooled(
                lambda entries: [parameters.place(each["parameters"]) for each in entries]
            ),
            "feature_pair_condition": starts,
            "feature_shape": pairs.each(lambda entries: [side["kind"] for side in _sides(entries)]),
            "feature_parameters": pairs.pooled(
                lambda entries: [parameters.place(side["parameters"]) for side in _sides(entries)]
            ),
            "feature_numbers": pairs.pooled(
                lambda entries: _feature_places(entries, [placed(side) for side in _sides(entries)], numbers)
            ),
            "feature_tree": pairs.each(trees.of),
            "tree_shape": trees.shapes(),
            "feature_is_listed": pairs.each(lambda entries: _listed(entries, trees.of(entries))),
            "condition_kind": pairs.each(
                lambda entries: [CONDITIONS.index(each["kind"]) for each in _conditions(entries)]
            ),
            "condition_feature": pairs.each(lambda entries: [each["side"] for each in _conditions(entries)]),
            "condition_feature_pair": _beyond(instance, pairs, starts),
            "condition_numbers": pairs.pooled(
                lambda entries: [numbers.place(each["numbers"]) for each in _conditions(entries)]
            ),
            "condition_is_line_end": pairs.each(
                lambda entries: [int(each.get("line", False)) for each in _conditions(entries)]
            ),
        }


def _sides(pair: Sequence[Entry]) -> list[Entry]:
    return [each[side] for each in pair for side in ("shape_o", "shape_f")]


def _conditions(pair: Sequence[Entry]) -> list[Entry]:
    return [condition for each in pair for condition in each["conditions"]]


def _listed(pair: Sequence[Entry], trees: Sequence[int]) -> list[int]:
    """1 at one place of each feature among those of a pair, at one where it has a tree if there is one."""
    places: dict[tuple[Any, ...], int] = {}
    for place, (each, number) in enumerate((each, number) for each in pair for number in range(2)):
        shape = each[("shape_o", "shape_f")[number]]
        borders = (
            tuple(condition["numbers"])
            for condition in each["conditions"]
            if condition["side"] == number and condition["kind"] in BORDERS
        )
        numbers = (tuple(shape[key]) for key in ("parameters", "placement"))
        domain = map(tuple, shape["domain"])
        feature = (each["of"[number]], shape["kind"], *numbers, *domain, *borders)
        if feature not in places or trees[places[feature]] < 0 <= trees[place]:
            places[feature] = place
    chosen = set(places.values())
    return [int(place in chosen) for place in range(2 * len(pair))]


class _Pairs:
    """The pairs of shapes, by what they repeat."""

    def __init__(self, instance: Entry, shares: bool = True) -> None:
        """`shares`: places of numbers are the same of pairs that repeat another."""
        self._pairs, self._entries = instance["pairs"], instance["feature_pairs"]
        self._shares = shares
        self._source = [pair.get("repeats", k) for k, pair in enumerate(self._pairs)]
        self._own: dict[int, Sequence[Entry]] = {}
        ends = [0, *(pair["feature_pairs"][1] for pair in self._pairs)]
        self.starts = np.array(ends, dtype=INTEGER)

    def _of(self, source: int) -> Sequence[Entry]:
        if source not in self._own:
            self._own[source] = self._entries[slice(*self._pairs[source]["feature_pairs"])]
        return self._own[source]

    def by_pair(self, of: Callable[[Sequence[Entry]], Found]) -> list[Found]:
        """What follows from the feature pairs of each pair, made once for pairs that repeat another."""
        made = {source: of(self._of(source)) for source in dict.fromkeys(self._source)}
        return [made[source] for source in self._source]

    def each(self, of: Callable[[Sequence[Entry]], Sequence[int]]) -> Array:
        """The integers of all pairs, one after another."""
        return _joined(self.by_pair(lambda entries: np.array(of(entries), dtype=INTEGER)))

    def pooled(self, of: Callable[[Sequence[Entry]], Sequence[int]]) -> Array:
        """The same of places of numbers, of each pair its own where numbers are not shared."""
        if self._shares:
            return self.each(of)
        return _joined([np.array(of(self._of(source)), dtype=INTEGER) for source in self._source])

    def owners(self) -> Array:
        """The number of the pair of each feature pair."""
        return np.repeat(np.arange(len(self._pairs), dtype=INTEGER), np.diff(self.starts))

    def bodies(self) -> tuple[Array, Array]:
        """Bodies o and f of each feature pair."""
        named = np.array([pair["bodies"] for pair in self._pairs], dtype=INTEGER).reshape(-1, 2)
        each = named[self.owners()]
        is_swapped = self.each(lambda entries: [each["swapped"] for each in entries])[:, None]
        o, f = np.where(is_swapped, each[:, ::-1], each).T
        return np.ascontiguousarray(o), np.ascontiguousarray(f)


def feature_pair_names(instance: Entry) -> tuple[str, ...]:
    """The names of all feature pairs of shapes."""
    names = _Pairs(instance).by_pair(lambda entries: [str(each["name"]) for each in entries])
    return tuple(chain.from_iterable(names))


def _joined(parts: Sequence[Array]) -> Array:
    return np.concatenate(parts) if parts else np.zeros(0, dtype=INTEGER)


def with_rows(integers: dict[str, Array], rows: Mapping[str, Sequence[int]]) -> None:
    """Adds entries at the ends of arrays of integers."""
    for name, values in rows.items():
        integers[name] = np.concatenate([integers[name], np.array(values, dtype=INTEGER)])


def without_features(count: int) -> dict[str, Sequence[int]]:
    """The entries of feature pairs of limits or of support points, which have no features."""
    return {
        "feature_parameters": [0] * (2 * count),
        "feature_numbers": [0] * (2 * count),
        "feature_shape": [-1] * (2 * count),
        "feature_tree": [-1] * (2 * count),
        "feature_is_listed": [1] * (2 * count),
        "feature_pair_group": [-1] * count,
    }


def _feature_places(
    entries: Sequence[Entry], numbers: Sequence[Sequence[float]], pool: NumberPool
) -> list[int]:
    """Where the numbers of the features of a pair are, which all feature pairs share that a feature has in
    it."""
    known: dict[tuple[Any, ...], int] = {}
    places = []
    for key, own in zip(_feature_keys(entries), numbers, strict=True):
        whole = (*key, *own)
        if whole not in known:
            known[whole] = pool.place(own, key)
        places.append(known[whole])
    return places


def _feature_keys(entries: Sequence[Entry]) -> Iterator[tuple[Any, ...]]:
    """The body of each side, first or other one of the pair, and kind and parameters of its shape."""
    for each in entries:
        for number, side in enumerate(("shape_o", "shape_f")):
            shape = each[side]
            yield each["of"[number]] == entries[0]["o"], shape["kind"], *shape["parameters"]


def _beyond(instance: Entry, pairs: _Pairs, starts: Array) -> Array:
    """The feature pair beyond each condition, which says its number within the pair, or that of another pair
    to which contacts go over. `starts`: the first condition of each feature pair."""
    nexts = pairs.by_pair(
        lambda entries: np.array([each["next"] for each in _conditions(entries)], dtype=INTEGER)
    )
    beyond = _joined(nexts)
    first = np.repeat(pairs.starts[:-1], [len(each) for each in nexts])
    beyond = np.where(beyond >= 0, first + beyond, beyond)
    for feature_pair, condition, to in instance.get("handovers", ()):
        beyond[starts[feature_pair] + condition] = to
    return beyond.astype(INTEGER)


class _Trees:
    """The number of the tree of cells of each side, or -1: of a point, and of pairs that are not searched by
    cells. Features that differ in their placement alone share one."""

    def __init__(self, kinds: Mapping[str, Sequence[Entry]]) -> None:
        self._kinds = kinds
        self._known: dict[tuple[Any, ...], int] = {}

    def of(self, pair: Sequence[Entry]) -> list[int]:
        """Those of the feature pairs of a pair."""
        return [number for feature_pair in pair for number in self._of(feature_pair)]

    def shapes(self) -> Array:
        """The kind of shape of each tree given out so far."""
        return np.array([key[0] for key in self._known], dtype=INTEGER)

    def _of(self, feature_pair: Entry) -> Iterator[int]:
        kind = self._kinds["contact"][feature_pair["kind"]]
        shapes = feature_pair["shape_o"], feature_pair["shape_f"]
        is_closed_form = have_spines(self._kinds["shape"][shape["kind"]]["kind"] for shape in shapes)
        for shape in shapes:
            if kind["convex"] or not kind["n_eta"] or not shape["domain"] or is_closed_form:
                yield -1
            else:
                key = (shape["kind"], tuple(shape["parameters"]), *(tuple(ends) for ends in shape["domain"]))
                yield self._known.setdefault(key, len(self._known))


def cell_capacity(trees: int) -> int:
    """Room for the cells of this many trees."""
    return min(max(CELLS_PER_TREE * trees, CELLS_MIN), CELLS_MAX) if trees else 1


def spans(side: Mapping[str, Any], kinds: Sequence[Mapping[str, Any]], length: float) -> list[float]:
    """The scale of each coordinate of a shape: its range over 2 pi; if unbounded, the characteristic length,
    or the angle of a helix over that length."""
    turning = kinds[side["kind"]]["kind"] == "helix"
    endless = length / hypot(*side["parameters"]) if turning else length
    return [endless if None in ends else (ends[1] - ends[0]) / (2 * pi) for ends in side["domain"]]


def _side_numbers(side: Mapping[str, Any], endless: float, spanned: Sequence[float]) -> list[float]:
    """Placement (12), bounds of u and v (4), radius and centre of a bounding ball (4), scales of u and v
    (2)."""
    bounds = [*side["domain"], [0.0, 0.0], [0.0, 0.0]][:2]
    low_high = [
        end if bound is None else bound
        for interval in bounds
        for bound, end in zip(interval, (-endless, endless), strict=True)
    ]
    radius = endless if side["bounding_radius"] is None else side["bounding_radius"]
    return [*side["placement"], *low_high, radius, *side["centre"], *[*spanned, 1.0, 1.0][:2]]
