"""The steady motion near the start of a scene, its forces, and the modes of the small motions about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modelgen.assembly import require
from modelgen.codegen.library import Library
from modelgen.derivation import Derivation
from modelgen.errors import expect
from modelgen.linearisation.admissible_contact_forces import Friction, resting_forces
from modelgen.linearisation.eigenmodes import Mode
from modelgen.linearisation.equilibrium_and_modes import NEUTRAL
from modelgen.linearisation.rest_linearisation import Touching, size_of
from modelgen.linearisation.steady_motion import SteadyMotion, SteadySearch
from modelgen.linearisation.touching_contact import Array
from modelgen.runtime.arguments import values_by_name, with_parameters
from modelgen.runtime.by_name import ByName
from modelgen.scene.parameter_rereading import scene_with

Spectrum = np.ndarray[Any, np.dtype[np.complex128]]
RESISTANCES = ("spin", "roll")  # that hold a contact: it cannot turn in a steady motion


@dataclass(frozen=True, slots=True)
class SteadyMode(Mode):
    """A small motion about a steady motion, as seen by axes that the steady motion carries along.

    Neither frequency nor growth: the steady motion has another beside it.
    """

    rate: Array  # (n,) complex, change of the velocities with `shape`

    @property
    def eigenvalue(self) -> complex:
        """1/s."""
        return complex(self.growth, self.frequency)


@dataclass(frozen=True, slots=True)
class LinearisedSteady:
    """The motion of a scene about a steady motion; arrays are read-only.

    `matrix` is that of y_dot = matrix y, with the changes (xi, du) = changes y of places and velocities. They
    keep joints and contacts, and leave out those along symmetries, which change the time and place of the
    same motion only.
    """

    scene: str
    p: dict[str, Array]  # of each dynamic body (3,) m, the centre of mass
    quaternion: dict[str, Array]  # (4,) (w, x, y, z); of a body without orientation the unit
    v: dict[str, Array]  # (3,) m/s, world axes
    w: dict[str, Array]  # (3,) rad/s, world axes; of a body without orientation zero
    force: dict[str, float]  # N, of each contact that touches, along its normal
    friction: dict[str, Friction]  # of each of them that has friction
    coordinates: dict[str, slice]  # of each dynamic body in u
    symmetries: int  # independent directions along which the scene does not change
    changes: Array  # (2 n, r) of xi, then du; of each body v in world, then w in body axes
    matrix: Array  # (r, r) 1/s
    modes: tuple[SteadyMode, ...]  # by frequency; of a pair of conjugates the one above the real axis
    time: float  # s, characteristic
    redundant: int  # rows of what touches beyond their rank; above 0 the forces are not unique

    @property
    def eigenvalues(self) -> Spectrum:
        """(r,) complex, 1/s, by real part; those of neutral motions are zero."""
        found = [mode.eigenvalue for mode in self.modes]
        conjugates = [value.conjugate() for value in found if value.imag]
        return np.sort_complex(np.array([*found, *conjugates], dtype=complex))

    @property
    def growth(self) -> float:
        """1/s, of the motion that grows fastest; negative where all but the neutral ones die out, and zero
        where the slowest does not."""
        return max((mode.growth for mode in self.modes if mode.kind != "neutral"), default=0.0)

    @property
    def neutral(self) -> int:
        """How many independent neutral motions there are."""
        return sum(mode.kind == "neutral" for mode in self.modes)


def linearise_steady(
    derivation: Derivation, library: Library, *, parameters: Mapping[str, float] | None = None
) -> LinearisedSteady:
    """The small motions about the steady motion near the start of a scene: a wheel that rolls straight ahead
    or in a circle, a bicycle, a top that turns about the vertical, a governor.

    A steady motion goes along symmetries, which are found: shifts and turns of bodies and turns about their
    own axes that leave shapes, joints, loads and gravity as they are. A start that is one is kept; from
    elsewhere the nearest by the mass is sought. The contacts that touch at the start are held closed, those
    with friction roll without slip, joints hold, inputs have their default values.

    Args:
        derivation: of the scene.
        library: what `build` made of it, which finds the contact points of the start.
        parameters: values of parameters of the scene by name; others keep the scene's own.

    Raises:
        ModelgenError: what is given is something else, or a parameter is refused.
        SimulationError: a body is driven, loads depend on time, a joint has a prescribed motion or is at its
            limit, a contact turns at the start against a resistance, no steady motion is near, or a contact
            would have to pull in it or hold more than its friction does.
    """
    expect("linearise_steady", derivation, Derivation)
    expect("linearise_steady", library, Library)
    return SteadyFamily(derivation, library).at(values_by_name("parameters", parameters))


class SteadyFamily:
    """A scene whose parameters vary; what does not depend on them is made once."""

    def __init__(self, derivation: Derivation, library: Library) -> None:
        self._derivation, self._library = derivation, library
        self._known: SteadySearch | None = None

    def at(self, parameters: Mapping[str, float]) -> LinearisedSteady:
        """About the steady motion with these values of parameters."""
        library, derivation = self._library, self._derivation
        if parameters:
            library = with_parameters(library, parameters)
            model = require(scene_with(derivation.model.whole, parameters), known=derivation.model)
            derivation = replace(derivation, model=model)
        search = SteadySearch(Touching(derivation, library, RESISTANCES), self._known)
        self._known = search
        return _described(search.touching, search.steady())


def _described(touching: Touching, motion: SteadyMotion) -> LinearisedSteady:
    model, state = touching.model, motion.state
    force, friction = resting_forces(touching, state)
    bodies = [body for body in model.bodies if size_of(model, body.kind)]
    turned = {body.name: size_of(model, body.kind) == 6 for body in bodies}
    return LinearisedSteady(
        scene=model.scene.name,
        p=ByName({body.name: state.q[body.q : body.q + 3] for body in bodies}, "body"),
        quaternion=ByName(
            {
                body.name: state.q[body.q + 3 : body.q + 7] if turned[body.name] else np.eye(4)[0]
                for body in bodies
            },
            "body",
        ),
        v=ByName({body.name: state.u[body.u : body.u + 3] for body in bodies}, "body"),
        w=ByName(
            {
                body.name: turn @ state.u[body.u + 3 : body.u + 6] if turned[body.name] else np.zeros(3)
                for body, turn in zip(bodies, touching.turns_of_dynamic(state.q), strict=True)
            },
            "body",
        ),
        force=ByName(force, "contact"),
        friction=ByName(friction, "contact"),
        coordinates=ByName(
            {body.name: slice(body.u, body.u + size_of(model, body.kind)) for body in bodies}, "body"
        ),
        symmetries=motion.symmetries,
        changes=motion.scale @ motion.changes,
        matrix=motion.system,
        modes=_modes(motion, NEUTRAL / model.scales.time),
        time=model.scales.time,
        redundant=state.redundant,
    )


def _modes(motion: SteadyMotion, slow: float) -> tuple[SteadyMode, ...]:
    """By frequency; rates below `slow`, 1/s, count as zero."""
    n, system = len(motion.state.u), motion.system
    sizes = np.linalg.svd(system, compute_uv=False)
    moved, still = split(system, int((sizes <= slow).sum()))
    found = [(0.0, 0.0, z) for z in still.T]
    values, vectors = np.linalg.eig(moved.T @ system @ moved)
    for value, z in zip(values, vectors.T, strict=True):
        if value.imag < 0:
            continue
        frequency, growth = (float(x) if abs(x) > slow else 0.0 for x in (value.imag, value.real))
        change = moved @ z
        if frequency or growth:
            change = change + still @ (still.T @ system @ change) / value
        found.append((frequency, growth, change if frequency else np.real(change)))
    changes = motion.scale @ motion.changes
    modes = [SteadyMode(rate, growth, *np.split(changes @ z, [n])) for rate, growth, z in found]
    return tuple(sorted(modes, key=lambda mode: (mode.frequency, mode.growth)))


def split(system: Array, neutral: int) -> tuple[Array, Array]:
    """Orthonormal columns (r, r - neutral) and (r, neutral); the matrix takes the latter nearest to zero."""
    vectors = np.linalg.svd(system)[2]
    return vectors[: len(vectors) - neutral].T, vectors[len(vectors) - neutral :].T
