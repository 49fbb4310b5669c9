"""How many contacts a pair of shapes has, and when the pair is searched for more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from modelgen.geometry.coordinate_domains import dimension_of
from modelgen.geometry.curvature_bounds import is_hollow, touches_once
from modelgen.geometry.shape_features import features_of, is_composite
from modelgen.model import ENDS, WATCHED, FeaturePairEntry, Search
from modelgen.scene.scene_types import ContactPair, Shape

SMOOTH, MANY = 4, 8  # contacts of a pair that may touch more than once: smooth shapes side by side, others
ROUND = ("sphere", "ellipsoid", "superellipsoid")


@dataclass(frozen=True, slots=True)
class PairContacts:
    """Number of contacts of a pair of shapes, and whether each keeps a feature pair of its own."""

    contacts: int
    own: bool
    search: Search


def contacts_of_pair(
    a: Shape,
    b: Shape,
    pair: ContactPair,
    feature_pairs: Sequence[FeaturePairEntry],
    explicit: bool,
    is_cut: bool,
) -> PairContacts:
    """The contacts of the shapes (a, b) with these feature pairs. explicit: no feature pair has
    contact parameters. is_cut: features of one of them end at a shape that is fixed to it.

    A plane is held off by every vertex, edge and bulge at once, unless these run into one another or a single
    surface or curve has several; of a convex body one follows the other down, of others any may come down
    next, so that steps are kept short. Two convex shapes, one of them round, touch once. A body in a hollow
    may be near to several of its sides, though it touches one at a time; where the shapes are not so
    simple, it may touch all around. Others touch in several points, searched for as the bodies move, or
    whenever they could touch where there are edges, which come down on faces all along, open ends, over which
    closest points come in that were none before, at any gap, or two curves, which do not show that they have
    passed.
    """
    hollow = is_hollow(a) or is_hollow(b)
    alone = touches_once(a, b)
    once = alone and (explicit or not hollow)
    leading = any(
        condition.next >= 0 for feature_pair in feature_pairs for condition in feature_pair.conditions
    )
    bulging = len(feature_pairs) == 1 or any(shape.chart is not None for shape in (a, b))
    several = bulging and not once and not explicit
    if (_is_plane(a) or _is_plane(b)) and not several and not (leading and (runs_on(a) or runs_on(b))):
        bounded = is_composite(a) or is_composite(b)
        search: Search = "always" if bounded or explicit else "moved"
        return PairContacts(len(feature_pairs), True, search if once or len(feature_pairs) == 1 else "ahead")
    is_open = is_cut or has_open_ends(a) or has_open_ends(b)
    if once and len(feature_pairs) == 1 and not is_open:
        return PairContacts(1, True, "always" if explicit else "moved")
    if once and not is_cut and (len(feature_pairs) == 1 or a.kind in ROUND or b.kind in ROUND):
        return PairContacts(1, False, "never")
    smooth = is_smooth(a) and is_smooth(b)
    around = not alone and (a.cavity or b.cavity)
    count = pair.points or (SMOOTH if smooth and not around else MANY)
    if not smooth or explicit or is_open or dimension_of(a) == dimension_of(b) == 1:
        return PairContacts(count, False, "always")
    return PairContacts(count, False, "apart" if alone else "moved")


def runs_on(shape: Shape) -> bool:
    """Whether faces of the shape, or pieces of the curve, join smoothly, without an edge."""
    features = features_of(shape).features
    dimensions = {feature.name: feature.dimension for feature in features}
    return any(
        dimensions.get(condition.next or "") == feature.dimension and condition.next != feature.name
        for feature in features
        for condition in feature.conditions
    )


def has_open_ends(shape: Shape) -> bool:
    """Whether the shape has ends or edges that carry no contact: those of a curve or of an open surface."""
    features = features_of(shape).features
    ends = any(condition.next is None for feature in features for condition in feature.conditions)
    return ends and (shape.chart is not None or not shape.cavity)


def is_smooth(shape: Shape) -> bool:
    """Whether the shape has no edges: it has one feature, or several that join smoothly. The rims at which a
    chart is open are none: they are round."""
    dimensions = {feature.dimension for feature in features_of(shape).features}
    return len(dimensions) == 1 or shape.chart is not None


def _is_plane(shape: Shape) -> bool:
    return shape.kind == "plane"


def confined(feature_pairs: Sequence[FeaturePairEntry]) -> tuple[FeaturePairEntry, ...]:
    """The feature pairs of a pair with conditions under which a contact of its own ends where its feature
    pair ends, or goes on around it."""
    return tuple(
        replace(
            feature_pair,
            conditions=tuple(
                each if each.next == number else replace(each, next=ENDS)
                for each in feature_pair.conditions
                if each.next != WATCHED
            ),
        )
        for number, feature_pair in enumerate(feature_pairs)
    )
