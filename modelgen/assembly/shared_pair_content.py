"""What follows from the shapes and terms of a contact pair, made once for pairs that differ in their bodies
alone."""

from __future__ import annotations

from dataclasses import dataclass, fields
from operator import attrgetter

from modelgen.assembly.contacts_per_pair import PairContacts, confined, contacts_of_pair
from modelgen.assembly.feature_pairs import Whole, feature_pairs_of
from modelgen.assembly.kind_list import KindList
from modelgen.assembly.patches import PlanarPair, planar_pairs_of
from modelgen.contact.form_table import eta_layout
from modelgen.model import ContactKind, FeaturePairEntry, Search, ShapeKind
from modelgen.notation import ETA_SIZE
from modelgen.scene.scene_types import ContactPair

_TERMS = attrgetter(*(field.name for field in fields(ContactPair) if field.name != "between"))


@dataclass(frozen=True, slots=True)
class PairContent:
    """Feature pairs of a pair, how contacts follow them, and its faces that may rest on each other."""

    feature_pairs: tuple[FeaturePairEntry, ...]
    way: PairContacts
    rooms: tuple[int, ...]  # entries of eta of each contact
    planar_pairs: tuple[PlanarPair, ...]
    first: int  # the number of the first pair with this content

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
        self._known: dict[tuple[object, ...], PairContent] = {}
        self._numbers: dict[tuple[object, ...], int] = {}  # of shapes without their bodies
        self._number_of: dict[int, tuple[Whole, int]] = {}  # by the identity of the shape, which is kept

    def of(self, a: Whole, b: Whole, pair: ContactPair, where: str, index: int) -> PairContent:
        """The content of the pair of that number, as an earlier one has it if it is the same; raises
        SceneError."""
        key = self._number(a), self._number(b), *_TERMS(pair)
        if key not in self._known:
            self._known[key] = self._made(a, b, pair, where, index)
        return self._known[key]

    def _number(self, whole: Whole) -> int:
        """The same for shapes that differ in their bodies alone."""
        if id(whole) not in self._number_of:
            number = self._numbers.setdefault(whole.without_body, len(self._numbers))
            self._number_of[id(whole)] = whole, number
        return self._number_of[id(whole)][1]

    def _made(self, a: Whole, b: Whole, pair: ContactPair, where: str, index: int) -> PairContent:
        feature_pairs = feature_pairs_of(a, b, pair, self._wish, where, self.shapes, self.kinds, index)
        kinds = [self.kinds.kinds[each] for each in {entry.kind for entry in feature_pairs}]
        room = max(map(eta_size, kinds))
        explicit = room < 2 and all(eta_layout(kind)[1] == "none" for kind in kinds)
        is_cut = a.left is not None or b.left is not None
        way = contacts_of_pair(a.shape, b.shape, pair, feature_pairs, explicit, is_cut)
        feature_pairs = confined(feature_pairs) if way.own else feature_pairs
        planar_pairs = planar_pairs_of(a, b, pair, where, feature_pairs, self.shapes, self.kinds)
        own = (eta_size(self.kinds.kinds[each.kind]) for each in feature_pairs)
        rooms = tuple(own) if way.own else (room,) * way.contacts
        return PairContent(feature_pairs, way, rooms, planar_pairs, index)


def eta_size(kind: ContactKind) -> int:
    """Number of entries of eta of one contact of this kind."""
    return sum(ETA_SIZE[layout] for layout in eta_layout(kind))
