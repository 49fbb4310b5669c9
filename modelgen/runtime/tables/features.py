"""Features and conditions of the feature pairs in the tables of the core (modelgen.h)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import accumulate, chain
from math import hypot, pi
from typing import Any, TypeVar

from modelgen.codegen.manifest import Manifest, have_spines

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
    """`integers`: arrays of mg_system; `numbers`: its array of numbers; parameters of shapes are added to
    `parameters`."""

    def __init__(self, manifest: Manifest, parameters: list[float], endless: float) -> None:
        self.numbers: list[float] = []
        instance, kinds, length = manifest.instance, manifest.kinds, manifest.instance["scales"]["length"]
        trees = _Trees(kinds)

        def placed(side: Entry) -> list[float]:
            return _side_numbers(side, endless, spans(side, kinds["shape"], length))

        counts = _each(instance, lambda pair: [len(each["conditions"]) for each in pair])
        self.integers: dict[str, list[int]] = {
            "feature_pair_condition": [0, *accumulate(counts)],
            "feature_shape": _each(instance, lambda pair: [side["kind"] for side in _sides(pair)]),
            "feature_parameters": _pooled(
                instance, parameters, lambda pair: [side["parameters"] for side in _sides(pair)]
            ),
            "feature_numbers": _features(
                instance, self.numbers, lambda pair: [placed(side) for side in _sides(pair)]
            ),
            "feature_tree": _each(instance, trees.of),
            "feature_is_listed": _each(instance, lambda pair: _listed(pair, trees.of(pair))),
            "condition_kind": _each(
                instance, lambda pair: [CONDITIONS.index(each["kind"]) for each in _conditions(pair)]
            ),
            "condition_feature": _each(instance, lambda pair: [each["side"] for each in _conditions(pair)]),
            "condition_feature_pair": _beyond(instance, counts),
            "condition_numbers": _pooled(
                instance, self.numbers, lambda pair: [each["numbers"] for each in _conditions(pair)]
            ),
            "condition_is_line_end": _each(
                instance, lambda pair: [int(each.get("line", False)) for each in _conditions(pair)]
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


def _by_pair(instance: Entry, of: Callable[[Sequence[Entry]], Found]) -> Iterator[Found]:
    """What follows from the feature pairs of each pair of shapes, made once for pairs that repeat another."""
    made: dict[int, Found] = {}
    for k, pair in enumerate(instance["pairs"]):
        source = pair.get("repeats", k)
        if source not in made:
            made[source] = of(instance["feature_pairs"][slice(*pair["feature_pairs"])])
        yield made[source]


def _each(instance: Entry, of: Callable[[Sequence[Entry]], list[int]]) -> list[int]:
    return list(chain.from_iterable(_by_pair(instance, of)))


def _pooled(
    instance: Entry, pool: list[float], of: Callable[[Sequence[Entry]], Sequence[Sequence[float]]]
) -> list[int]:
    """Where each of the sequences of numbers starts in the pool, to whose end they are added."""
    starts: list[int] = []
    for found in _by_pair(instance, of):
        starts += accumulate(map(len, found), initial=len(pool))
        starts.pop()  # the end
        pool.extend(chain.from_iterable(found))
    return starts


def _features(
    instance: Entry, pool: list[float], of: Callable[[Sequence[Entry]], Sequence[Sequence[float]]]
) -> list[int]:
    """The same of the numbers of features, which all feature pairs share that a feature has in a pair."""
    starts: list[int] = []
    for found in _by_pair(instance, lambda pair: list(zip(_feature_keys(pair), of(pair), strict=True))):
        known: dict[tuple[Any, ...], int] = {}
        for key, numbers in found:
            whole = (*key, *numbers)
            if whole not in known:
                known[whole] = len(pool)
                pool.extend(numbers)
            starts.append(known[whole])
    return starts


def _feature_keys(pair: Sequence[Entry]) -> Iterator[tuple[Any, ...]]:
    """The body of each side, first or other one of the pair, and kind and parameters of its shape."""
    for each in pair:
        for number, side in enumerate(("shape_o", "shape_f")):
            shape = each[side]
            yield each["of"[number]] == pair[0]["o"], shape["kind"], *shape["parameters"]


def _beyond(instance: Entry, counts: Sequence[int]) -> list[int]:
    """The feature pair beyond each condition, which says its number within the pair, or that of another pair
    to which contacts go over. `counts`: the number of conditions of each feature pair."""
    nexts = _by_pair(instance, lambda pair: [each["next"] for each in _conditions(pair)])
    firsts = (pair["feature_pairs"][0] for pair in instance["pairs"])
    beyond = [
        first + each if each >= 0 else each
        for first, found in zip(firsts, nexts, strict=True)
        for each in found
    ]
    starts = [0, *accumulate(counts)]
    for feature_pair, condition, to in instance.get("handovers", ()):
        beyond[starts[feature_pair] + condition] = to
    return beyond


class _Trees:
    """The number of the tree of cells of each side, or -1: of a point, and of pairs that are not searched by
    cells. Features that differ in their placement alone share one."""

    def __init__(self, kinds: Mapping[str, Sequence[Entry]]) -> None:
        self._kinds = kinds
        self._known: dict[tuple[Any, ...], int] = {}

    def of(self, pair: Sequence[Entry]) -> list[int]:
        """Those of the feature pairs of a pair."""
        return [number for feature_pair in pair for number in self._of(feature_pair)]

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


def append(pool: list[float], values: Sequence[float]) -> int:
    """Adds the values at the end; returns where they start."""
    start = len(pool)
    pool.extend(values)
    return start


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
