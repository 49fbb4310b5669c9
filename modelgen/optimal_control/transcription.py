"""Motions of a scene over a horizon as a program with complementarity constraints.

Finite elements with Radau IIA collocation (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II,
1996). In an element, the force of a contact at each stage is complementary to its gap at each stage, and slip
to what is left of the bound of friction, so that contacts open, close, stick and slip at the ends of elements
alone; with free lengths of elements, these find the instants (finite elements with switch detection:
A. Nurkanovic, M. Sperl, S. Albrecht, M. Diehl, Numer. Math. 156 (2024), 1115-1162). At the start of each,
impulses without rebound act on closed contacts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from modelgen.codegen.library import Library
from modelgen.composition.complementarity_system import ComplementaritySystem, complementarity_system
from modelgen.composition.contact_mode import friction_of_contacts, named_feature_pairs
from modelgen.composition.scene_symbols import parameter_values
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError
from modelgen.optimal_control.complementarity_program import ComplementarityProgram
from modelgen.optimal_control.motion_guess import MotionGuess, guessed_motion
from modelgen.optimal_control.relaxation import RELAXATIONS, RelaxedSolution, RelaxedSolver

Array = np.ndarray[Any, Any]
MOST_STAGES = 4
TINY = 1e-12  # m/s, slip without a direction
LENGTHS = (0.25, 2.0)  # of free elements, in parts of the mean


@dataclass(frozen=True)
class Plan:
    """A solution.

    Attributes:
        t: (n + 1,) ends of the elements, s.
        x: (n + 1, n_x) q, u, eta there, before impulses.
        inputs: (n, inputs) held over each element.
        forces: (n, stages, rows) N.
        solution: what the solver says.
    """

    t: Array
    x: Array
    inputs: Array
    forces: Array
    solution: RelaxedSolution
    unknowns: Array = field(repr=False)


@dataclass(frozen=True)
class _Element:
    """The unknowns of an element as expressions."""

    h: ca.MX
    u: ca.MX
    after: ca.MX  # u after the impulses at its start
    impulse: ca.MX
    stages: list[tuple[ca.MX, ca.MX, ca.MX, ca.MX, ca.MX]]  # q, u, eta, forces, speeds


class Transcription:
    """The program of one scene; what is wanted of the motion is added to it, then it is solved.

    `states`, `inputs`, `lengths`: expressions of the unknowns, for `minimise` and `demand`.
    """

    def __init__(
        self,
        derivation: Derivation,
        horizon: float,
        n: int,
        *,
        stages: int = 2,
        free_lengths: bool = False,
        impacts: bool = True,
        feature_pairs: Mapping[str, str] | None = None,
    ) -> None:
        """
        Args:
            horizon: s.
            n: elements.
            stages: of collocation in each, 1 to 4: q is of order 1, 3, 5 or 7 in the length of elements.
            free_lengths: elements are as long as the solution wants, within bounds, over the same horizon.
            impacts: contacts may close at ends of elements; False saves these unknowns.
            feature_pairs: of contacts between shapes of several features, by the name of the contact.

        Raises:
            ModelgenError: impacts rebound, n or stages are none that are known.
        """
        model = derivation.model
        if not 1 <= stages <= MOST_STAGES or n < 1 or not horizon > 0:
            found = f"stages = {stages}, n = {n}, horizon = {horizon}"
            known = f"1 to {MOST_STAGES} stages, n from 1 on, a horizon in seconds"
            raise ModelgenError("Transcription", found, known)
        _refuse_rebound(derivation, impacts)
        pairs = tuple(named_feature_pairs(model, (feature_pairs or {}).items()))
        self.derivation, self.horizon, self.n = derivation, float(horizon), n
        self.model = model
        self._A, self._c = radau(stages)
        system = complementarity_system(model, derivation.functions(), pairs, ca.SX)
        self._units = _units(system)
        self._stage, self._kick = _functions(system, self._units)
        self._contacts = len(system.contacts)
        self._rows, self._speeds = int(system.loads.numel()), int(system.speeds.numel())
        self._load_units = _load_units(system, self._units[0])
        self._impacts, self._free = impacts and self._contacts > 0, free_lengths
        self._unknowns: list[ca.MX] = []
        self._bounds: list[tuple[Array, Array]] = []
        self._equal: list[ca.MX] = []
        self._demands: list[tuple[ca.MX, Array, Array]] = []
        self._first: list[ca.MX] = []
        self._second: list[ca.MX] = []
        self._pairs: list[tuple[int, int]] = []
        self._begin = (0, 0)  # of the last element among the entries of G and H
        self._into = 0  # of the approach at its start, among those of H
        self._objective = ca.MX(0)
        n_x = (model.n_q, model.n_u, model.n_eta)
        self._start = [self._unknown(size) for size in n_x]
        self._elements: list[_Element] = []
        self._build()

    @property
    def states(self) -> list[ca.MX]:
        """(n_x,) q, u, eta at the start and at the end of each element."""
        ends = [ca.vertcat(*each.stages[-1][:3]) for each in self._elements]
        return [ca.vertcat(*self._start), *ends]

    @property
    def inputs(self) -> list[ca.MX]:
        """Values of the inputs in each element."""
        return [each.u for each in self._elements]

    @property
    def lengths(self) -> list[ca.MX]:
        """s, of each element."""
        return [each.h for each in self._elements]

    def minimise(self, expression: ca.MX) -> None:
        """Add to what is minimised."""
        self._objective = self._objective + expression

    def demand(self, expression: ca.MX, lower: Any, upper: Any = None) -> None:
        """Bound an expression; without `upper`, it is equal to `lower`."""
        size = int(expression.numel())
        low = np.broadcast_to(np.asarray(lower, dtype=float), size)
        high = low if upper is None else np.broadcast_to(np.asarray(upper, dtype=float), size)
        self._demands.append((expression, low, high))

    def start_at(self, q: Any, u: Any = None) -> None:
        """Fix the start; a velocity of None is free."""
        self.demand(self._start[0], q)
        if u is not None:
            self.demand(self._start[1], u)

    def solver(self, relaxations: Sequence[float] = RELAXATIONS, **options: Any) -> RelaxedSolver[ca.MX]:
        """The solver of the program as it is now; `options` are those of IPOPT."""
        first, second = _stacked(self._first), _stacked(self._second)
        g = ca.vertcat(*self._equal, *(each for each, _, _ in self._demands))
        equal = np.zeros(sum(int(each.numel()) for each in self._equal))
        program = ComplementarityProgram(
            x=ca.vertcat(*self._unknowns),
            f=self._objective,
            g=g,
            lbx=np.concatenate([low for low, _ in self._bounds]),
            ubx=np.concatenate([high for _, high in self._bounds]),
            lbg=np.concatenate([equal, *(low for _, low, _ in self._demands)]),
            ubg=np.concatenate([equal, *(high for _, _, high in self._demands)]),
            first=first,
            second=second,
            pairs=self._pairs,
        )
        return RelaxedSolver(program, relaxations, {"expand": True} | options)

    def solve(
        self,
        guess: Array,
        relaxations: Sequence[float] = RELAXATIONS,
        solver: RelaxedSolver[ca.MX] | None = None,
    ) -> Plan:
        """The plan from a guess of all unknowns (`guess`)."""
        found = (solver or self.solver(relaxations)).solve(guess)
        return self._plan(found)

    def guess(self, library: Library, start: Array | None = None, inputs: Array | None = None) -> Array:
        """All unknowns from a simulated run.

        Args:
            library: of the same scene.
            start: (n_q + n_u,) q and u; None: those of the scene.
            inputs: (n, inputs) held over the elements; None: the defaults of the scene.
        """
        h = self.horizon / self.n
        times = [h * (k + c) for k in range(self.n) for c in self._c]
        held = None if inputs is None else np.repeat(np.asarray(inputs, dtype=float), len(self._c), axis=0)
        return self._packed(guessed_motion(self.derivation, library, times, start, held))

    def _unknown(self, size: int, low: float = -np.inf, high: float = np.inf) -> ca.MX:
        symbol = ca.MX.sym(f"x{len(self._unknowns)}", size)
        self._unknowns.append(symbol)
        self._bounds.append((np.full(size, low), np.full(size, high)))
        return symbol

    def _build(self) -> None:
        mean = self.horizon / self.n
        q, u, eta = self._start
        t = ca.MX(0)
        for _ in range(self.n):
            h = self._unknown(1, LENGTHS[0] * mean, LENGTHS[1] * mean) if self._free else ca.MX(mean)
            inputs = self._unknown(len(self.model.scene.inputs))
            after, impulse = self._kicked(t, q, u, eta, inputs)
            sizes = (self.model.n_q, self.model.n_u, self.model.n_eta, self._rows, self._speeds)
            stages = [tuple(self._unknown(size) for size in sizes) for _ in self._c]
            element = _Element(h, inputs, after, impulse, stages)  # type: ignore[arg-type]
            self._collocate(t, q, element)
            self._elements.append(element)
            (q, u, eta), t = stages[-1][:3], t + h
        if self._free:
            self._equal.append(ca.sum(ca.vertcat(*self.lengths)) - self.horizon)

    def _kicked(self, t: ca.MX, q: ca.MX, u: ca.MX, eta: ca.MX, inputs: ca.MX) -> tuple[ca.MX, ca.MX]:
        """u after impulses, and these."""
        if not self._impacts:
            return u, ca.MX(0, 1)
        after, impulse = self._unknown(self.model.n_u), self._unknown(self._rows)
        speeds = self._unknown(self._speeds)
        apart, into = (self._unknown(self._contacts) for _ in range(2))
        found = self._kick(t, q, after, eta, inputs, impulse, speeds)
        response, _, rate, first, second, equal = found
        self._equal += [after - u - response, equal, rate - apart + into]
        rates = ca.vertcat(second, apart, into)  # a normal impulse is beside its gap and both of its rates
        places = [*range(self._contacts)] * 2
        self._pair([first], [rates], [[*range(int(first.numel())), *places]])
        self._into = self._sizes()[1] - self._contacts
        return after, impulse

    def _collocate(self, t: ca.MX, q: ca.MX, element: _Element) -> None:
        found = [
            self._stage(t + c * element.h, *stage[:3], element.u, *stage[3:])
            for c, stage in zip(self._c, element.stages, strict=True)
        ]
        for row, stage in zip(self._A, element.stages, strict=True):
            moved = [sum(a * each[k] for a, each in zip(row, found, strict=True)) for k in range(2)]
            self._equal += [
                stage[0] - q - element.h * moved[0],
                stage[1] - element.after - element.h * moved[1],
            ]
        for each in found:
            self._equal += [each[2], each[3], each[6]]
        begin = self._sizes()
        self._pair([each[4] for each in found], [each[5] for each in found])
        if self._free and self._elements:
            self._pair_with_left_end(begin, int(found[0][4].numel()))
        self._begin = begin
        if self._impacts:  # what carries force in the element does not approach at its start
            size = int(found[0][4].numel())
            for begun in range(begin[0], begin[0] + size * len(self._c), size):
                self._pairs += [(begun + k, self._into + k) for k in range(self._contacts)]

    def _sizes(self) -> tuple[int, int]:
        """Entries of G and of H so far."""
        return tuple(sum(int(each.numel()) for each in listed) for listed in (self._first, self._second))  # type: ignore[return-value]

    def _pair_with_left_end(self, begin: tuple[int, int], size: int) -> None:
        """Pair forces of an element with the gap at its start, and what is left of the bound of friction with
        the slip there, so that contacts close and stick at the ends of elements alone. Impulses let slip
        jump."""
        first, second = (each + size * (len(self._c) - 1) for each in self._begin)  # of the last stage before
        for stage in range(len(self._c)):
            at = [each + size * stage for each in begin]
            self._pairs += [(at[0] + k, second + k) for k in range(self._contacts)]
            if not self._impacts:
                self._pairs += [(first + k, at[1] + k) for k in range(self._contacts, size)]

    def _pair(self, first: list[ca.MX], second: list[ca.MX], partners: list[list[int]] | None = None) -> None:
        """Pair the entries of each column of `first` with those of each of `second`: with the same, or with
        those whose number is that in `partners`."""
        size = int(first[0].numel())
        if not size:
            return
        before = self._sizes()
        self._first += first
        self._second += second
        numbers = partners or [[*range(size)]] * len(second)
        for i in range(len(first)):
            at = before[1]
            for listed in numbers:
                self._pairs += [(before[0] + size * i + k, at + place) for place, k in enumerate(listed)]
                at += len(listed)

    def _packed(self, motion: MotionGuess) -> Array:
        """The unknowns in their order; impulses zero."""
        speed = self._units[1]
        at = iter(range(len(motion.x)))
        sizes = np.cumsum([self.model.n_q, self.model.n_u])
        parts = list(np.split(motion.start, sizes))
        last = parts[1]
        for _ in range(self.n):
            parts += [np.array([self.horizon / self.n])] if self._free else []
            places = [next(at) for _ in self._c]
            parts.append(motion.inputs[places[0]])
            if self._impacts:
                parts += [last, np.zeros(self._rows), np.zeros(self._speeds), np.zeros(2 * self._contacts)]
            for place in places:
                directions, speeds = self._friction(motion.forces[place], motion.rates[place])
                parts += [*np.split(motion.x[place], sizes), directions / self._load_units, speeds / speed]
            last = np.split(motion.x[places[-1]], sizes)[1]
        return np.concatenate(parts)

    def _friction(self, forces: Array, rates: Array) -> tuple[Array, Array]:
        """The loads of these forces (rows,), N, and the speeds of friction, m/s. A direction is that of the
        force where there is one, else against the slip."""
        loads, speeds = forces.copy(), []
        for places, index, kinetic in self._frictions():
            slip = rates[places] * kinetic
            speeds.append(np.linalg.norm(slip))
            bound = forces[index] * kinetic
            pushed = bound.min(initial=np.inf) > 0.0
            direction = forces[places] / bound if pushed else -slip / max(speeds[-1], TINY)
            loads[places] = direction / max(np.linalg.norm(direction), 1.0)
        return loads, np.array(speeds)

    def _forces(self, loads: Array) -> Array:
        """N, of loads (.., rows)."""
        forces = loads.copy()
        for places, index, kinetic in self._frictions():
            forces[..., places] = loads[..., index, None] * kinetic * loads[..., places]
        return forces

    def _frictions(self) -> Iterator[tuple[Array, int, Array]]:
        """Rows, contact and coefficients of each friction constraint."""
        at = len(self.model.contacts) + len(self.model.limits)
        for index, constraint in friction_of_contacts(self.model):
            yield np.arange(at, at + constraint.rows), index, np.array(constraint.kinetic[: constraint.rows])
            at += constraint.rows

    def _plan(self, found: RelaxedSolution) -> Plan:
        x = ca.vertcat(*self._unknowns)
        listed = [ca.horzcat(*self.states), ca.horzcat(*self.lengths), ca.horzcat(*self.inputs)]
        listed.append(ca.horzcat(*(stage[3] for each in self._elements for stage in each.stages)))
        states, lengths, inputs, forces = (
            np.array(each) for each in ca.Function("plan", [x], listed)(found.x)
        )
        return Plan(
            t=np.concatenate([[0.0], np.cumsum(lengths.ravel())]),
            x=states.T,
            inputs=inputs.T.reshape(self.n, -1),
            forces=self._forces(self._load_units * forces.T).reshape(self.n, len(self._c), -1),
            solution=found,
            unknowns=found.x,
        )


def radau(stages: int) -> tuple[Array, Array]:
    """(stages, stages) and (stages,): matrix and nodes of Radau IIA."""
    nodes = np.array(ca.collocation_points(stages, "radau"))
    powers = np.arange(1, stages + 1)  # the method integrates the powers below stages
    return (nodes[:, None] ** powers / powers) @ np.linalg.inv(nodes[:, None] ** (powers - 1)), nodes


def _refuse_rebound(derivation: Derivation, impacts: bool) -> None:
    for pair in derivation.model.pairs:
        if impacts and pair.restitution.value > 0:
            raise ModelgenError(
                "Transcription", f"contact {pair.name!r} rebounds", "contacts with restitution 0",
                "write restitution = 0, or impacts=False where contacts do not close",
            )  # fmt: skip


def _stacked(parts: list[ca.MX]) -> ca.MX:
    return ca.vertcat(*parts) if parts else ca.MX(0, 1)


def _units(system: ComplementaritySystem) -> tuple[float, float]:
    """Of forces, N, and of speeds, m/s."""
    scales = system.scene.model.scales
    return scales.mass * scales.length / scales.time**2, scales.length / scales.time


def _load_units(system: ComplementaritySystem, force: float) -> Array:
    """(rows,) of the loads: those of friction are directions."""
    return np.array([1.0 if row.kind == "friction" else force for row in system.scene.rows.rows])


def _functions(system: ComplementaritySystem, units: tuple[float, float]) -> tuple[ca.Function, ca.Function]:
    """Of a stage: (t, q, u, eta, inputs, loads, speeds) -> (qdot, udot, eta_error, joint_value, G, H, zero);
    of impulses: the same -> (change of u, gap, rate, G, H, zero). Loads and speeds are in units."""
    scene, (force, speed) = system.scene, units
    model, symbols = scene.model, scene.symbols
    inputs = ca.SX.sym("inputs", len(model.scene.inputs))
    loads, speeds = ca.SX.sym("loads", system.loads.numel()), ca.SX.sym("speeds", system.speeds.numel())
    settings = (
        [part for value in ca.vertsplit(inputs) for part in (value, ca.SX(0), symbols.t)]
        if inputs.numel()
        else []
    )
    known = [symbols.gravity, symbols.parameters, symbols.inputs, system.loads, system.speeds]
    given = [
        ca.SX(ca.DM(list(model.scene.gravity))),
        ca.SX(ca.DM(parameter_values(model))),
        ca.vertcat(ca.SX(0, 1), *settings),
        ca.DM(_load_units(system, force)) * loads,
        speed * speeds,
    ]
    n, length = len(system.contacts), model.scales.length
    none = ca.SX(0, 1)
    first, second = ca.vertcat(none, *system.first), ca.vertcat(none, *system.second)
    equal = ca.vertcat(none, *system.equal)
    unit_first = ca.DM([force] * n + [speed] * (int(first.numel()) - n))
    unit_second = ca.DM([length] * n + [1.0] * (int(second.numel()) - n))
    conditions = [first / unit_first, second / unit_second, equal / speed]
    response = scene.times_inverse_mass(
        sum((row.J.T * system.forces[k] for k, row in enumerate(scene.rows.rows)), ca.SX(model.n_u, 1))
    )
    joint = system.joint_value if system.joint_value.numel() else ca.SX(0, 1)
    of_stage = [scene.qdot, system.udot, system.eta_error, joint / length, *conditions]
    of_impulse = [response, system.gap / length, system.rate / speed, *conditions]
    arguments = [symbols.t, symbols.q, symbols.u, symbols.eta, inputs, loads, speeds]

    def made(name: str, outputs: list[Any]) -> ca.Function:
        written = ca.substitute([ca.densify(ca.SX(each)) for each in outputs], known, given)
        return ca.Function(name, arguments, ca.cse(written))

    return made("stage", of_stage), made("impulse", of_impulse)
