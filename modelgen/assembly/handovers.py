"""Where a contact goes over to a feature pair of another pair of shapes.

This is at borders at which the surfaces of shapes that are fixed to each other join smoothly.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from modelgen.assembly.joined_solids import JoinedSolids
from modelgen.assembly.placed_shapes import Partner
from modelgen.assembly.smooth_borders import Beyond, BorderName
from modelgen.model import ENDS, FeaturePairEntry, HandoverEntry, PairEntry
from modelgen.scene.scene_types import ContactPair

Found = Mapping[tuple[Partner, str, Partner, str], int]  # by the shapes and features, in both orders


def handovers_of(
    contacts: Sequence[ContactPair],
    pairs: Sequence[PairEntry],
    feature_pairs: Sequence[FeaturePairEntry],
    joined: JoinedSolids,
) -> tuple[HandoverEntry, ...]:
    """Those of all pairs; `contacts`: the same pairs as the scene has them."""
    borders = [
        [joined.smooth_borders(*pair.between), joined.smooth_borders(*pair.between[::-1])]
        for pair in contacts
    ]
    if not any(map(any, borders)):
        return ()
    numbers: dict[tuple[Partner, str, Partner, str], int] = {}
    for pair, entry in zip(contacts, pairs, strict=True):
        (a, b), (first, end) = pair.between, entry.feature_pairs
        for number, (one, two) in enumerate((each.features for each in feature_pairs[first:end]), first):
            numbers[a, one, b, two] = numbers[b, two, a, one] = number
    return tuple(
        each
        for pair, entry, sides in zip(contacts, pairs, borders, strict=True)
        for number in range(*entry.feature_pairs)
        for each in _of_feature_pair(pair, number, feature_pairs[number], sides, numbers)
    )


def _of_feature_pair(
    pair: ContactPair,
    number: int,
    entry: FeaturePairEntry,
    borders: Sequence[Mapping[BorderName, Beyond]],
    numbers: Found,
) -> Iterator[HandoverEntry]:
    """`borders`: the smooth borders of the first and second shape."""
    for k, condition in enumerate(entry.conditions):
        side = condition.side if not entry.swapped else 1 - condition.side
        beyond = borders[side].get((entry.features[side], condition.kind, condition.numbers))
        if condition.next == ENDS and beyond is not None:
            partner, feature = pair.between[1 - side], entry.features[1 - side]
            to = numbers.get((*beyond, partner, feature))
            if to is not None:
                yield HandoverEntry(number, k, to)
