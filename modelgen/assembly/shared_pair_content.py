"""What follows from the shapes and terms of a contact pair, made once for pairs that differ in their bodies
alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from modelgen.assembly.contacts_per_pair import PairContacts, confined, contacts_of_pair
from modelgen.assembly.feature_pairs import Whole, feature_pairs_of, repeated
from modelgen.assembly.kind_list import KindList
from modelgen.assembly.patches import PlanarPair, planar_pairs_of
from modelgen.contact.form_table import eta_layout
from modelgen.model import ContactKind, FeaturePairEntry, Search, ShapeKind
from modelgen.notation import ETA_SIZE
from modelgen.scene.scene_types import ContactPair


@dataclass(frozen=True, slots=True)
class PairContent:
    """Feature pairs of a pair, how contacts follow them, and its faces that may rest on each other."""

    feature_pairs: tuple[FeaturePairEntry, ...]
    way: PairContacts
    room: int  # entries of eta of a contact that may follow each of them
    planar_pairs: tuple[PlanarPair, ...]
    repeats: int | None = None  # the number of the first pair with this content

    @property
    def search(self) -> Search:
        """When the pair is searched for contacts: never where they never end."""
        endless = self.way.own and not any(each.conditions for each in self.feature_pairs)
        return "never" if endless else self.way.search


class PairContents:
    """The contents of pairs, with the kinds that they need."""

    def __init__(self, wish: str) -> None:
        """`wish`: the form that contacts take where it is regular, if their pair names none."""
        self.shapes, self.kinds = KindList[ShapeKind](), KindList[ContactKind]()
        self._wish = wish
        self._known: dict[tuple[object, ...], tuple[int, PairContent]] = {}

    def of(self, a: Whole, b: Whole, pair: ContactPair, where: str, index: int) -> PairContent:
        """The content of the pair of that number; raises SceneError."""
        key = a.without_body, b.without_body, replace(pair, between=(("", ""), ("", "")))
        if key in self._known:
            first, content = self._known[key]
            feature_pairs = repeated(content.feature_pairs, a, b, index)
            return replace(content, feature_pairs=feature_pairs, repeats=first)
        self._known[key] = index, self._made(a, b, pair, where, index)
        return self._known[key][1]

    def _made(self, a: Whole, b: Whole, pair: ContactPair, where: str, index: int) -> PairContent:
        feature_pairs = feature_pairs_of(a, b, pair, self._wish, where, self.shapes, self.kinds, index)
        kinds = [self.kinds.kinds[each] for each in {entry.kind for entry in feature_pairs}]
        room = max(map(eta_size, kinds))
        explicit = room < 2 and all(eta_layout(kind)[1] == "none" for kind in kinds)
        is_cut = a.left is not None or b.left is not None
        way = contacts_of_pair(a.shape, b.shape, pair, feature_pairs, explicit, is_cut)
        feature_pairs = confined(feature_pairs) if way.own else feature_pairs
        planar_pairs = planar_pairs_of(a, b, pair, where, feature_pairs, self.shapes, self.kinds)
        return PairContent(feature_pairs, way, room, planar_pairs)

    def rooms(self, content: PairContent) -> Sequence[int]:
        """Entries of eta of each contact of a pair."""
        if not content.way.own:
            return [content.room] * content.way.contacts
        return [eta_size(self.kinds.kinds[each.kind]) for each in content.feature_pairs]


def eta_size(kind: ContactKind) -> int:
    """Number of entries of eta of one contact of this kind."""
    return sum(ETA_SIZE[layout] for layout in eta_layout(kind))
