"""The status of each formula: proved by SymPy, or tested against an independent route, or failed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from modelgen.derivation import Derivation, Formula
from modelgen.model import JointKind, LimitKind, LoadKind, Model
from modelgen.verification.bodies import check_body
from modelgen.verification.closest_point_search import check_search
from modelgen.verification.contacts import check_contact, sample
from modelgen.verification.findings import Finding, Status
from modelgen.verification.joints import Drawn, check_coordinates, check_limit, check_rows, check_spring, draw
from modelgen.verification.loads import check_load
from modelgen.verification.proofs import must_be_proved, prove
from modelgen.verification.random_configurations import Partnership, partnership
from modelgen.verification.right_hand_side import check_rhs
from modelgen.verification.sensors import check_sensors
from modelgen.verification.shapes import check_shape

OF_BODIES = ("pose", "motion", "energy", "path")
OF_SHAPES = ("surface", "curve", "point")
OF_CONTACTS = ("rates", "place", "angle")
OF_SEARCH = ("aim", "seek")
OF_JOINTS = ("rows", "coordinates")
OF_LOADS = ("wrench", "deflection")


@dataclass(frozen=True, slots=True)
class Verdict:
    """The claims about a formula, and the findings where they were requested."""

    claim: Status
    findings: tuple[Finding, ...] = ()

    @property
    def status(self) -> str:
        """`claim` where nothing was computed; failed where anything failed."""
        if any(finding.status == "failed" for finding in self.findings):
            return "failed"
        return self.claim if self.findings else f"{self.claim}, not recomputed"

    def as_dict(self) -> dict[str, Any]:
        tested = [finding for finding in self.findings if finding.n]
        return {
            "status": self.status,
            "claim": self.claim,
            "configurations": max((finding.n for finding in tested), default=0),
            "worst": max((finding.worst for finding in tested), default=0.0),
            "findings": [finding.as_dict() for finding in self.findings],
        }


def claimed(formula: Formula, model: Model) -> Verdict:
    """The claims of the tables, without any computation."""
    return Verdict("proved" if must_be_proved(formula, model) else "tested")


def verified(formula: Formula, derivation: Derivation, n: int, seed: int) -> Verdict:
    """Proofs where they are due, and a comparison on n random configurations, made now."""
    model = derivation.model
    found = (*prove(formula, model), *_compared(formula, derivation, n, seed))
    return Verdict(claimed(formula, model).claim, tuple(found))


def _compared(formula: Formula, derivation: Derivation, n: int, seed: int) -> list[Finding]:
    model, role, function = derivation.model, formula.role, formula.function
    if role in OF_BODIES:
        return check_body(role, function, model.body_kinds[formula.kind], n, seed)
    if role in OF_SHAPES:
        numbers = lengths_of(model, formula.kind)
        return check_shape(function, model.shape_kinds[formula.kind], numbers, n, seed)
    if is_of_joint(formula, model):
        return _of_joint(formula, model, drawn_joints(formula, model, n, seed))
    if role in OF_CONTACTS:
        return check_contact(role, function, sample(partnership_of(model, formula.kind), n, seed))
    if role in OF_SEARCH:
        return check_search(role, function, partnership_of(model, formula.kind), n, seed)
    if role in OF_LOADS:
        return check_load(role, function, model.load_kinds[formula.kind], n, seed)
    if role == "sensors":
        return check_sensors(function, derivation, n, seed)
    return check_rhs(function, derivation, n, seed)


def is_of_joint(formula: Formula, model: Model) -> bool:
    """Rows and coordinates of joints, their limits, which count among the contacts, and their springs."""
    if formula.role in OF_LOADS:
        return bool(model.load_kinds[formula.kind].joint)
    return formula.role in OF_JOINTS or is_of_limit(formula, model)


def is_of_limit(formula: Formula, model: Model) -> bool:
    """Whether it is of a limit of a joint."""
    return formula.role in OF_CONTACTS and formula.kind >= len(model.contact_kinds)


def joint_kind(formula: Formula, model: Model) -> JointKind | LimitKind | LoadKind:
    """The kind that a formula of a joint, of a limit or of a spring is of."""
    if formula.role in OF_LOADS:
        return model.load_kinds[formula.kind]
    if is_of_limit(formula, model):
        return model.limit_kinds[formula.kind - len(model.contact_kinds)]
    return model.joint_kinds[formula.kind]


def drawn_joints(formula: Formula, model: Model, n: int, seed: int) -> list[Drawn]:
    """Configurations of the first joint of the kind that the formula is of, with its own numbers."""
    kind = joint_kind(formula, model)
    if isinstance(kind, LoadKind):
        load = next(load for load in model.loads if load.kind == formula.kind)
        return draw(kind.joint, load.parameters, n, seed)
    entries, first = (
        (model.limits, len(model.contact_kinds)) if isinstance(kind, LimitKind) else (model.joints, 0)
    )
    entry = next(entry for entry in entries if entry.kind == formula.kind - first)
    return draw(kind.kind, entry.parameters, n, seed)


def _of_joint(formula: Formula, model: Model, drawn: list[Drawn]) -> list[Finding]:
    function, kind = formula.function, joint_kind(formula, model)
    if isinstance(kind, LoadKind):
        return check_spring(formula.role, function, kind, drawn)
    if isinstance(kind, LimitKind):
        return check_limit(formula.role, function, kind, drawn)
    return check_rows(function, kind, drawn) if formula.role == "rows" else check_coordinates(function, drawn)


def partnership_of(model: Model, kind: int) -> Partnership:
    """A contact kind with the numbers of the first contact that is of it."""
    numbers = next(numbers for each, numbers in _contacts_of(model) if each == kind)
    return partnership(model.contact_kinds[kind], numbers, model.scales.length)


def _contacts_of(model: Model) -> Iterator[tuple[int, tuple[float, ...]]]:
    """Kinds and parameters: of feature pairs, and of the points that faces rest on."""
    for feature_pair in model.feature_pairs:
        yield feature_pair.kind, feature_pair.parameters
    for patch in model.patches:
        for number, parameters in enumerate(patch.parameters):
            yield patch.kind if number or patch.friction_kind < 0 else patch.friction_kind, parameters


def lengths_of(model: Model, shape: int) -> tuple[float, ...]:
    """The parameters of a shape kind in the first feature pair that has it."""
    kind = model.shape_kinds[shape]
    if kind.folded is not None:
        return kind.folded
    for index, parameters in _contacts_of(model):
        contact = model.contact_kinds[index]
        whole = partnership(contact, parameters, model.scales.length)
        for side, numbers in zip((contact.o, contact.f), whole.numbers, strict=True):
            if side.shape == kind:
                return tuple(float(x) for x in numbers)
    return ()
