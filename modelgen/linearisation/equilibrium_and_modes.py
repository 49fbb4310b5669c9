"""The equilibrium near the start of a scene, and its small motions: frequencies and modes.

Source: M xi'' + C xi' + K xi = 0 on the motions that keep joints and the touching contacts closed, from the
exact derivatives of the right-hand side (Section 3) about a place at rest. Contacts with friction stick: they
roll without slip, and K need not be symmetric.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from modelgen.assembly import require
from modelgen.codegen.library import Library
from modelgen.derivation import Derivation
from modelgen.errors import SimulationError, expect
from modelgen.linearisation.admissible_contact_forces import Friction, resting_forces
from modelgen.linearisation.eigenmodes import Mode, small_motions
from modelgen.linearisation.rest_linearisation import DEPENDENT, NoPlaceError, Place, Touching, moved, size_of
from modelgen.linearisation.touching_contact import Array
from modelgen.model import Scales
from modelgen.runtime.arguments import values_by_name, with_parameters
from modelgen.runtime.by_name import ByName
from modelgen.scene.parameter_rereading import scene_with

STEPS = 100  # of Newton's method towards the equilibrium
FARTHEST = 0.2  # of one step, rad or characteristic lengths
HALVINGS = 10  # of a step that goes too far
MISSED = 0.5  # of what drives a step, in what is expected to drive the next
AT_REST = 1e-11  # acceleration and gaps that remain, dimensionless
NEUTRAL = 1e-8  # stiffness and damping that are rounding, dimensionless


@dataclass(frozen=True, slots=True)
class Linearised:
    """The motion of a scene about an equilibrium; arrays are read-only.

    `stiffness` and `damping` are those of the motions xi = motions y: y'' + damping y' + stiffness y = 0.
    """

    scene: str
    p: dict[str, Array]  # of each dynamic body (3,) m, the centre of mass
    quaternion: dict[str, Array]  # (4,) (w, x, y, z); of a body without orientation the unit
    force: dict[str, float]  # N, of each contact that touches, along its normal
    friction: dict[str, Friction]  # of each of them that has friction
    coordinates: dict[str, slice]  # of each dynamic body in u
    mass: Array  # (n, n) kg, kg m^2
    motions: Array  # (n, k) all that the contacts leave, motions^T mass motions = 1; k = 0: all is held
    stiffness: Array  # (k, k) 1/s^2
    damping: Array  # (k, k) 1/s
    modes: tuple[Mode, ...]  # by frequency
    redundant: int  # rows of what touches beyond their rank; above 0 the forces are not unique

    @property
    def frequencies(self) -> Array:
        """Frequencies of the oscillations, rad/s, ascending."""
        return np.array([mode.frequency for mode in self.modes if mode.frequency])


def linearise(
    derivation: Derivation, library: Library, *, parameters: Mapping[str, float] | None = None
) -> Linearised:
    """The small motions about the equilibrium near the start of a scene, at rest and without bounces.

    An equilibrium that the scene starts in is kept, stable or not; from elsewhere the search goes downhill.
    Of equilibria that lie beside each other, as those of a ball on a plane, it is the one that is reached.
    The contacts that touch at the start are held closed; those with friction do not slip, nor spin or roll
    where they have resistance to it. Joints hold; inputs have their default values. Where that leaves no
    motion there are no modes.

    Args:
        derivation: of the scene.
        library: what `build` made of it, which finds the contact points of the start.
        parameters: values of parameters of the scene by name; others keep the scene's own.

    Raises:
        ModelgenError: what is given is something else, or a parameter is refused.
        SimulationError: a body is driven, a joint has a prescribed motion or is at its limit, a contact with
            friction slips at the start, no equilibrium is near, or a contact would have to pull there or hold
            more than its friction does.
    """
    expect("linearise", derivation, Derivation)
    expect("linearise", library, Library)
    if given := values_by_name("parameters", parameters):
        library = with_parameters(library, given)
        derivation = replace(derivation, model=require(scene_with(derivation.model.whole, given)))
    touching = Touching(derivation, library)
    place = equilibrium(touching)
    force, friction = resting_forces(touching, place)
    bodies = [body for body in touching.model.bodies if size_of(touching.model, body.kind)]
    return Linearised(
        scene=touching.model.scene.name,
        p=ByName({body.name: place.q[body.q : body.q + 3] for body in bodies}, "body"),
        quaternion=ByName(
            {body.name: _turn(place.q[body.q + 3 : body.q + 7], touching, body.kind) for body in bodies},
            "body",
        ),
        force=ByName(force, "contact"),
        friction=ByName(friction, "contact"),
        coordinates=ByName(
            {body.name: slice(body.u, body.u + size_of(touching.model, body.kind)) for body in bodies}, "body"
        ),
        mass=place.mass,
        motions=place.motions,
        stiffness=place.stiffness,
        damping=place.damping,
        modes=small_motions(place, touching.model.scales.time, NEUTRAL),
        redundant=place.redundant,
    )


def equilibrium(touching: Touching) -> Place:
    """The place at rest near the start. Raises SimulationError if there is none."""
    try:
        place = _sought(touching)
    except NoPlaceError:
        place = None
    if place is not None and touching.stands(place.q):
        return place
    raise SimulationError(
        f"{touching.model.scene.name}: linearise",
        "no equilibrium near the start",
        "the contacts that touch at the start, loads and gravity must hold all bodies at rest",
        "start near a state of rest",
    )


def _sought(touching: Touching) -> Place | None:
    """The place to which Newton's method converges; None if it does not converge."""
    place = touching.at(np.array(touching.model.initial_q), tuple(each.eta for each in touching.contacts))
    for _ in range(STEPS):
        if _unrest(place, touching.model.scales) < AT_REST:
            return place
        place = _nearer(place, touching)
    return None


def _unrest(place: Place, scales: Scales) -> float:
    push = np.abs(place.push).max(initial=0.0) * scales.time**2 / (scales.length * np.sqrt(scales.mass))
    return float(max(push, np.abs(place.value).max(initial=0.0) / scales.length))


def _nearer(place: Place, touching: Touching) -> Place:
    """After one step: back onto the contacts, and along the motions as far as their stiffness lets, or half
    as far again and again until the stiffness tells what pushes there."""
    Z, scales = place.motions, touching.model.scales
    square, unit = scales.time**2, scales.length * np.sqrt(scales.mass)
    back = place.root @ np.linalg.lstsq(place.J @ place.root, place.value, rcond=DEPENDENT)[0]
    K = place.stiffness + Z.T @ place.mass @ _turning(place, touching) @ Z
    along = unit * _eased(K * square, place.push * square / unit)
    size = np.abs(Z @ along).max(initial=0.0)
    along *= min(1.0, FARTHEST / size if size else 1.0)
    for _ in range(HALVINGS):
        q = moved(place.q, place.B @ (Z @ along - back), touching.model)
        with suppress(NoPlaceError):
            found = touching.at(q, place.etas)
            if _missed(found, Z @ (place.push - K @ along), place, touching) <= MISSED:
                return found
        along = along / 2
    return touching.at(q, place.etas)


def _missed(found: Place, expected: Array, place: Place, touching: Touching) -> float:
    """How far what drives the place found is from what was expected to (n,), over what drives the place
    before; as the bodies see it."""
    driven = touching.turning(found.q).T @ found.motions @ found.push
    missed = touching.turning(place.q) @ driven - expected
    size = float(np.linalg.norm(place.push))
    return float(np.sqrt(missed @ place.mass @ missed)) / size if size else 0.0


def _turning(place: Place, touching: Touching) -> Array:
    """(n, n) what of D is but the turning of a body, with its acceleration, under the world axes of v."""
    found, rest = np.zeros_like(place.D), place.motions @ place.push
    for body, turn in zip(touching.model.bodies, touching.turns(place.q), strict=True):
        if size_of(touching.model, body.kind) == 6:
            v, w = slice(body.u, body.u + 3), slice(body.u + 3, body.u + 6)
            found[v, w] = np.cross(turn.T, rest[v]).T
    return found


def _eased(K: Array, push: Array) -> Array:
    """(sign(K) K + |push|)^-1 push: where a motion that friction slows down would end, and away from where it
    would come from; not far where K is too soft for the push, and never along motions that it leaves neutral.

    K and push are dimensionless, K of any form.
    """
    _, sizes, vectors = np.linalg.svd(K)
    across = vectors[sizes > NEUTRAL].T
    values, vectors = np.linalg.eig(across.T @ K @ across)
    stiff = np.where(values.real < 0, -values, values) + np.linalg.norm(push)
    return np.asarray(across @ np.real(vectors @ (np.linalg.solve(vectors, across.T @ push) / stiff)))


def _turn(quaternion: Array, touching: Touching, kind: int) -> Array:
    return quaternion if size_of(touching.model, kind) == 6 else np.array([1.0, 0.0, 0.0, 0.0])
