"""Instructions saved by each decision to prune a scene's code, from a derivation without that decision."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from modelgen.assembly import require
from modelgen.codegen.emit import emit
from modelgen.composition.all_sticking_dynamics import why_not_closed
from modelgen.contact.form_table import instructions, regular_forms
from modelgen.derivation import Derivation, derive
from modelgen.dynamics.planar_motion_proof import in_a_plane
from modelgen.errors import SceneError
from modelgen.model import ContactKind, Model
from modelgen.scene.scene_types import Friction, Scene

WITHOUT_ETA = ("explicit", "support")  # forms that know their contact points at once
MOST_FOLDED = 200  # kinds of contact for which `fold` is tried out
ANY_FRICTION = Friction((0.3, 0.3), (0.3, 0.3))  # the code is the same for all coefficients


@dataclass(frozen=True, slots=True)
class Size:
    """Size of the code of a scene, and of its state."""

    instructions: int  # of the kernels of one evaluation of the right-hand side
    bytes: int  # of C text
    states: int


@dataclass(frozen=True, slots=True)
class Saving:
    """One decision, with the sizes for it as `taken` says and for the alternative."""

    decision: str
    of: str  # which bodies or contacts
    taken: bool
    size: Size
    other: Size

    def as_json(self) -> dict[str, Any]:
        """`saved`: what it saves if it is taken, or would save if it were."""
        with_it, without = (self.size, self.other) if self.taken else (self.other, self.size)
        saved = {key: value - asdict(with_it)[key] for key, value in asdict(without).items()}
        return {**asdict(self), "saved": saved}


def savings_of(derivation: Derivation) -> list[Saving]:
    """The savings of every decision that applies to the scene; derives the scene again for each."""
    model = derivation.model
    own, found = size_of(derivation), []
    for decision, undo in DECISIONS.items():
        undone = undo(model)
        if undone is None:
            continue
        of, scene = undone
        try:
            other = size_of(derive(require(scene)))
        except SceneError:  # the scene admits nothing else
            continue
        found.append(Saving(decision, of, decision != "fold" or model.scene.fold, own, other))
    return [*found, *_of_the_whole(derivation, own)]


def size_of(derivation: Derivation) -> Size:
    """Instructions of one evaluation: each body, load, joint and followed contact once; the text of their
    kernels."""
    model = derivation.model
    files = emit(derivation.of_kinds()).files
    counts: Mapping[tuple[str, int], int] = {
        (formula.role, formula.kind): formula.instructions for formula in derivation.formulas
    }
    feature_pairs = [
        model.feature_pairs[
            contact.feature_pair if contact.feature_pair >= 0 else model.pairs[contact.pair].feature_pairs[0]
        ]
        for contact in model.contacts
    ]
    parts = [
        *((role, body.kind) for body in model.bodies for role in ("pose", "motion", "path")),
        *(("rates", feature_pair.kind) for feature_pair in feature_pairs),
        *(("wrench", load.kind) for load in model.loads),
        *(("rows", joint.kind) for joint in model.joints),
    ]
    text = sum(len(files[name].encode()) for name in ("kernels.c", "model.c"))
    return Size(sum(counts.get(part, 0) for part in parts), text, model.n_q + model.n_u + model.n_eta)


Undone = tuple[str, Scene] | None  # of what, and the scene without the decision


def _fixed(model: Model) -> Undone:
    """Bodies at rest as bodies on a path that happens to be none."""
    names = [body.name for body in model.scene.bodies if body.motion == "fixed"]
    bodies = tuple(
        replace(body, motion="driven") if body.motion == "fixed" else body for body in model.scene.bodies
    )
    return (", ".join(names), replace(model.scene, bodies=bodies)) if names else None


def _without_eta(model: Model) -> Undone:
    """The cheapest form that carries its contact points in the state."""
    names, pairs = [], []
    for pair, entry in zip(model.scene.contacts, model.pairs, strict=True):
        kinds = {model.feature_pairs[k].kind for k in range(*entry.feature_pairs)}
        forms = [_carrying(model.contact_kinds[kind]) for kind in kinds]
        form = forms[0] if len(forms) == 1 else None
        names += [entry.name] if form else []
        pairs.append(replace(pair, form=form) if form else pair)
    return (", ".join(names), replace(model.scene, contacts=tuple(pairs))) if names else None


def _carrying(kind: ContactKind) -> str | None:
    if kind.form not in WITHOUT_ETA:
        return None
    others = [form for form in regular_forms(kind.o, kind.f) if form not in WITHOUT_ETA]
    return min(others, key=lambda form: instructions(replace(kind, form=form)), default=None)


def _frictionless(model: Model) -> Undone:
    names = [
        entry.name
        for pair, entry in zip(model.scene.contacts, model.pairs, strict=True)
        if pair.friction is None
    ]
    pairs = tuple(
        replace(pair, friction=ANY_FRICTION) if pair.friction is None else pair
        for pair in model.scene.contacts
    )
    return (", ".join(names), replace(model.scene, contacts=pairs)) if names else None


def _without_turning(model: Model) -> Undone:
    """All bodies turn."""
    names = [body.name for body in model.bodies if model.body_kinds[body.kind].motion == "point"]
    if any(
        body.inertia is None and body.density is None for body in model.scene.bodies if body.name in names
    ):
        return None
    turning = (f"{body.name}.orientation" for body in model.scene.bodies if body.motion == "dynamic")
    observe = tuple(dict.fromkeys((*model.scene.observe, *turning)))
    return (", ".join(names), replace(model.scene, observe=observe)) if names else None


def _observed(model: Model) -> Undone:
    """Everything is observed."""
    return (", ".join(model.scene.observe), replace(model.whole, observe=())) if model.scene.observe else None


def _folded(model: Model) -> Undone:
    """Left out where every pair of features would become a kind, and there are many."""
    kinds = {(each.kind, *(shape.parameters for shape in each.shapes)) for each in model.feature_pairs}
    if not model.scene.fold and len(kinds) > MOST_FOLDED:
        return None
    return "shapes and bodies", replace(model.scene, fold=not model.scene.fold)


DECISIONS: Mapping[str, Callable[[Model], Undone]] = {
    "fixed body": _fixed,
    "form without eta": _without_eta,
    "no friction": _frictionless,
    "no rotation": _without_turning,
    "observe": _observed,
    "fold": _folded,
}


def _of_the_whole(derivation: Derivation, own: Size) -> list[Saving]:
    """What can be said of the composed right-hand side alone: derivatives, which are exported nowhere, and
    motion in a plane, which is not taken up."""
    if why_not_closed(derivation.model):
        return []
    rhs = derivation.function("mg_rhs")
    whole = replace(own, instructions=int(rhs.n_instructions()), bytes=0)
    slopes = replace(whole, instructions=int(rhs.jacobian().n_instructions()))
    found = [
        Saving(
            "no derivatives",
            "right-hand side",
            True,
            whole,
            replace(slopes, instructions=whole.instructions + slopes.instructions),
        )
    ]
    plane = in_a_plane(derivation.model, rhs)
    if plane is not None:
        smaller = Size(plane.instructions, 0, plane.states)
        found.append(Saving("planar motion", f"the plane {plane.axes}", False, whole, smaller))
    return found
