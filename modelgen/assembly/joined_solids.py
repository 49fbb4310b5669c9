"""Shapes that are fixed or welded together and touch the same partner are one solid for it.

What of a shape lies in the material of another one, or flush with it, is no feature of the solid. A border at
which a face goes over smoothly into a face of another shape is none either: contacts go on there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from modelgen.assembly.faces_across_shapes import terms_of
from modelgen.assembly.placed_shapes import Partner, Partners, PlacedShapes
from modelgen.assembly.smooth_borders import Beyond, BorderName, Group, SmoothBorders
from modelgen.assembly.welded_bodies import Stand
from modelgen.geometry.exposed_features import Beside, exposed, is_hidden, without_edges
from modelgen.geometry.shape_features import features_of
from modelgen.scene.scene_types import Feature, Scene


class JoinedSolids:
    """The features of shapes that are left beside the shapes that are fixed to them."""

    def __init__(self, scene: Scene, stands: Sequence[Stand], flush: float) -> None:
        """`stands`: of the bodies; `flush`: m, height up to which surfaces are one."""
        self._shapes = PlacedShapes(scene, stands, flush)
        touching: dict[Partner, set[Partner]] = {}
        for pair in scene.contacts:
            for one, other in (pair.between, pair.between[::-1]):
                touching.setdefault(one, set()).add(other)
        self._joined: dict[tuple[Partner, int], Partners] = {}  # that a partner may touch, by body
        for name in self._shapes.names:
            for partner in touching.get(name, ()):
                key = partner, self._shapes.solid(name)
                self._joined[key] = (*self._joined.get(key, ()), name)
        self._terms = {
            names: (terms_of(pair), pair.features)
            for pair in scene.contacts
            for names in (pair.between, pair.between[::-1])
        }
        self._known: dict[tuple[Partner, Group], tuple[Feature, ...] | None] = {}
        self._exposed: dict[tuple[Partner, Partners], tuple[Feature, ...]] = {}
        self._smooth = SmoothBorders(self._shapes, self._exposed_of)

    def features_left(self, shape: Partner, partner: Partner) -> tuple[Feature, ...] | None:
        """The features of a shape that a partner can touch; None where all are left as they are."""
        group = self._group(shape, partner)
        if len(group.all) < 2:
            return None
        if (shape, group) not in self._known:
            self._known[shape, group] = self._left(shape, group)
        return self._known[shape, group]

    def smooth_borders(self, shape: Partner, partner: Partner) -> Mapping[BorderName, Beyond]:
        """Borders of a shape at which contacts with a partner go over to a face of another shape."""
        return self._smooth.of(shape, self._group(shape, partner))

    def told(self) -> Iterator[str]:
        """What of shapes nothing touches, and where contacts go on over other shapes, in words."""
        hidden = {name: sum(map(is_hidden, left)) for (name, _), left in self._known.items() if left}
        for name, count in hidden.items():
            if count:
                yield f"{'/'.join(name)}: {count} faces, edges and corners, joined to what is beside it"
        for name, count in self._smooth.counts():
            yield f"{'/'.join(name)}: borders at which other shapes go on smoothly: {count}"

    def _group(self, shape: Partner, partner: Partner) -> Group:
        """The shapes that form one solid with a shape for a partner, that shape among them."""
        are_known = shape in self._shapes and partner in self._shapes  # the scene may name what there is not
        joined = self._joined[partner, self._shapes.solid(shape)] if are_known else ()
        if len(joined) < 2:
            return Group(joined, (), on_plane=False)
        terms = self._terms[shape, partner]
        alike = () if terms[1] else tuple(e for e in joined if self._terms[e, partner] == terms)
        faces = features_of(self._shapes.shape(partner)).features
        return Group(joined, alike, any(each.shape.kind == "plane" for each in faces))

    def _left(self, name: Partner, group: Group) -> tuple[Feature, ...] | None:
        features = features_of(self._shapes.shape(name)).features
        left = without_edges(self._exposed_of(name, group.all), self._smooth.of(name, group))
        for face, condition, _ in self._smooth.ends_of(name, group):
            left = tuple(
                replace(each, conditions=(*each.conditions, condition)) if each.name == face else each
                for each in left
            )
        is_whole = len(left) == len(features) and all(a is b for a, b in zip(left, features, strict=True))
        return None if is_whole else left

    def _exposed_of(self, name: Partner, joined: Partners) -> tuple[Feature, ...]:
        """The features of a shape, or parts of them, that are left beside the material of others."""
        key = name, joined
        if key not in self._exposed:
            shape = self._shapes.shape(name)
            features = features_of(shape).features
            if not shape.cavity and len(features) > 1:
                beside = [
                    Beside(cell, joined.index(each) < joined.index(name))
                    for each in self._shapes.near(name, joined)
                    for cell in self._shapes.cells(name, (each,))
                ]
                features = exposed(features, beside, self._shapes.flush)
            self._exposed[key] = features
        return self._exposed[key]
