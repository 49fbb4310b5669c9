"""The equilibrium near the start of a scene, and its small motions: frequencies and modes.

Source: M xi'' + C xi' + K xi = 0 on the motions that keep the touching contacts closed, from the exact
derivatives of the right-hand side (Section 3) about a place at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modelgen.codegen.library import Library
from modelgen.derive import Derivation
from modelgen.errors import SimulationError, expect
from modelgen.model import Model, Scales
from modelgen.report.small_motions import Mode, least_pressing, small_motions
from modelgen.report.touching import Array, Place, Touching

STEPS = 100  # of Newton's method towards the equilibrium
FARTHEST = 0.2  # of one step, rad or characteristic lengths
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
    force: dict[str, float]  # N, of each contact that touches
    coordinates: dict[str, slice]  # of each dynamic body in u
    mass: Array  # (n, n) kg, kg m^2
    motions: Array  # (n, k), motions^T mass motions = 1
    stiffness: Array  # (k, k) 1/s^2
    damping: Array  # (k, k) 1/s
    modes: tuple[Mode, ...]  # by frequency
    redundant: int  # contacts that touch beyond the rank of their rows; the forces have minimum norm then

    @property
    def frequencies(self) -> Array:
        """Of the oscillations, rad/s, ascending."""
        return np.array([mode.frequency for mode in self.modes if mode.frequency])


def linearise(derivation: Derivation, library: Library) -> Linearised:
    """The small motions about the equilibrium near the start of a scene, at rest and without bounces.

    An equilibrium that the scene starts in is kept, stable or not; from elsewhere the search goes downhill.
    The contacts that touch at the start are held closed.

    Args:
        derivation: of the scene.
        library: what `build` made of it, which finds the contact points of the start.

    Raises:
        ModelgenError: what is given is something else.
        SimulationError: a body is driven, no equilibrium is near, or a contact would have to pull there.
    """
    expect("linearise", derivation, Derivation)
    expect("linearise", library, Library)
    touching = Touching(derivation, library)
    place = equilibrium(touching)
    force = _forces(place, touching)
    bodies = [body for body in touching.model.bodies if _size(touching.model, body.kind)]
    return Linearised(
        scene=touching.model.scene.name,
        p={body.name: place.q[body.q : body.q + 3] for body in bodies},
        quaternion={
            body.name: _turn(place.q[body.q + 3 : body.q + 7], touching, body.kind) for body in bodies
        },
        force=force,
        coordinates={body.name: slice(body.u, body.u + _size(touching.model, body.kind)) for body in bodies},
        mass=place.mass,
        motions=place.motions,
        stiffness=place.stiffness,
        damping=place.damping,
        modes=small_motions(place, touching.model.scales.time, NEUTRAL),
        redundant=len(place.gaps) - len(touching.held),
    )


def equilibrium(touching: Touching) -> Place:
    """The place at rest near the start. Raises SimulationError if there is none."""
    scales = touching.model.scales
    q, etas = np.array(touching.model.initial_q), tuple(contact.eta for contact in touching.contacts)
    for _ in range(STEPS):
        place = touching.at(q, etas)
        if _unrest(place, scales) < AT_REST:
            if touching.stands(place.q):
                return place
            break
        q, etas = _nearer(place, touching.model), place.etas
    raise SimulationError(
        f"{touching.model.scene.name}: linearise",
        "no equilibrium near the start",
        "the contacts that touch at the start, loads and gravity must hold all bodies at rest",
        "start near a state of rest",
    )


def _unrest(place: Place, scales: Scales) -> float:
    push = np.abs(place.push).max(initial=0.0) * scales.time**2 / (scales.length * np.sqrt(scales.mass))
    return float(max(push, np.abs(place.gaps).max(initial=0.0) / scales.length))


def _nearer(place: Place, model: Model) -> Array:
    """q after one step: back onto the contacts, and along the motions as far as their stiffness lets."""
    weighted = np.linalg.solve(place.mass, place.J.T)
    back = weighted @ np.linalg.lstsq(place.J @ weighted, place.gaps, rcond=None)[0]
    values, vectors = np.linalg.eigh((place.stiffness + place.stiffness.T) / 2)
    resist = np.abs(values) * model.scales.time**2 > NEUTRAL
    ease = np.divide(1.0, np.abs(values), out=np.zeros_like(values), where=resist)
    step = place.motions @ (vectors @ (ease * (vectors.T @ place.push)))
    size = np.abs(step).max(initial=0.0)
    q = place.q + place.B @ (step * min(1.0, FARTHEST / size if size else 1.0) - back)
    for body in model.bodies:
        if _size(model, body.kind) == 6:
            turn = slice(body.q + 3, body.q + 7)
            q[turn] /= np.linalg.norm(q[turn])
    return np.asarray(q)


def _size(model: Model, kind: int) -> int:
    """Coordinates of a body in u."""
    return {"point": 3, "free": 6}.get(model.body_kinds[kind].motion, 0)


def _turn(quaternion: Array, touching: Touching, kind: int) -> Array:
    return quaternion if _size(touching.model, kind) == 6 else np.array([1.0, 0.0, 0.0, 0.0])


def _forces(place: Place, touching: Touching) -> dict[str, float]:
    """Of each contact, >= 0 and of minimum norm: J^T force = -M free. Raises SimulationError if only pulling
    does."""
    wanted = -place.mass @ place.free
    force = least_pressing(place.J.T, wanted)
    if len(force) and np.linalg.norm(place.J.T @ force - wanted) > NEUTRAL * np.linalg.norm(wanted):
        raise SimulationError(
            f"{touching.model.scene.name}: linearise",
            "a contact would have to pull at the equilibrium near the start",
            "contacts press",
            "start near a state of rest in which they do",
        )
    return {contact.name: float(each) for contact, each in zip(touching.contacts, force, strict=True)}
