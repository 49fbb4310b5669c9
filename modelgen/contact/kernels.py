"""What a form delivers, and its wrapping as kernels with the names and shapes of the generated C."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.model import ContactKind

RATES_INPUTS = ("pose_o", "twist_o", "pose_f", "twist_f", "eta", "parameters")
RATES_OUTPUTS = ("d", "J_o", "J_f", "gamma", "eta_dot", "normal")
SLIP_OUTPUTS = (*RATES_OUTPUTS, "tangents")  # of kinds with tangential rows
PLACE_INPUTS = ("pose_o", "pose_f", "eta", "parameters")
PLACE_OUTPUTS = ("eta_next", "d", "residual", "margin", "normal", "point_o", "point_f")


@dataclass(frozen=True)
class Foot:
    """The contact point on one body, lever + offset N; vectors in the axes of its shape."""

    lever: ca.SX  # (3,) m, from the centre of mass
    slide: ca.SX | None  # (3,) m/s, its rate; None where `Rates.passing` is known
    normal: ca.SX  # (3,) N
    offset: ca.SX = field(default_factory=lambda: ca.SX(1, 1))  # (1,) m, constant: the radius of a centre


@dataclass(frozen=True)
class Passing:
    """How the material point of f passes that of o, world axes."""

    V: ca.SX  # (3,) m/s, its velocity past that of o
    pull: ca.SX  # (3,) m/s^2, the rate of V without accelerations


@dataclass(frozen=True)
class Rates:
    """Instantaneous quantities of a contact on its extremal pair of points.

    J_o, J_f and gamma are those of the normal row; `slip` puts the tangential rows below them.
    """

    d: ca.SX  # (1,) m, positive when apart
    J_o: ca.SX  # (rows x columns of o,) row after row
    J_f: ca.SX  # (rows x columns of f,)
    gamma: ca.SX  # (rows,) m/s^2, rad/s^2, d/dt (J u) without accelerations
    eta_dot: ca.SX  # (n_eta,) m/s for points, parameter/s for charts
    normal: ca.SX  # (3,) world, from o to f
    normal_rate: ca.SX  # (3,) 1/s, world
    turning: ca.SX  # (3,) 1/s, rate of the normal seen from o, shape axes of o
    foot_o: Foot
    foot_f: Foot
    passing: Passing | None = None  # of forms in world axes; follows from the feet otherwise
    steps: Mapping[str, ca.SX] = field(default_factory=dict)  # what they are made of, by name, in order
    tangents: ca.SX = field(default_factory=lambda: ca.SX(0, 1))  # (6,) t1, t2, world; none with one row


@dataclass(frozen=True)
class Placement:
    """One Newton step of the extremality system, and what holds at the given eta."""

    eta_next: ca.SX  # (n_eta,)
    d: ca.SX  # (1,) m
    residual: ca.SX  # (2,) m along and off the surfaces; 1 of normals that are not opposite
    margin: ca.SX  # (2,) mu, and sigma_min(A) in 1/m
    normal: ca.SX  # (3,) world
    point_o: ca.SX  # (3,) m, world
    point_f: ca.SX  # (3,) m, world


@dataclass(frozen=True)
class ContactKernels:
    """The two kernels of a contact kind; beside them, for inspection and tests, the rate of its normal and
    the rates with the quantities that they are made of as outputs before them.

    Each function is derived when it is first asked for.
    """

    kind: ContactKind
    pair: Pair
    stated: Callable[[], Rates]
    placed: Callable[[], Placement]

    @cached_property
    def rates(self) -> ca.Function:
        """`mg_<name>_rates`"""
        return self._of_rates("rates", vars(self._rates), self._outputs)

    @cached_property
    def place(self) -> ca.Function:
        """`mg_<name>_place`"""
        resting = [self.pair.o.pose, self.pair.f.pose, self.pair.eta, self._parameters]
        name = f"mg_{self.kind.name}_place"
        return _function(name, resting, PLACE_INPUTS, vars(self.placed()), PLACE_OUTPUTS)

    @cached_property
    def normal_rate(self) -> ca.Function:
        """`mg_<name>_normal_rate`"""
        return self._of_rates("normal_rate", vars(self._rates), ("normal_rate",))

    @cached_property
    def steps(self) -> ca.Function:
        """`mg_<name>_steps`"""
        known = vars(self._rates)
        stated = {out: known[out] for out in self._outputs}
        made = {**self._rates.steps, "normal_rate": self._rates.normal_rate, **stated}
        return self._of_rates("steps", made, tuple(made))

    @cached_property
    def _rates(self) -> Rates:
        return self.stated()

    @property
    def _outputs(self) -> tuple[str, ...]:
        return RATES_OUTPUTS if self.kind.rows == 1 else SLIP_OUTPUTS

    @property
    def _parameters(self) -> ca.SX:
        return ca.vertcat(self.pair.o.argument, self.pair.f.argument)

    def _of_rates(self, what: str, values: Mapping[str, ca.SX], outputs: tuple[str, ...]) -> ca.Function:
        o, f = self.pair.o, self.pair.f
        moving = [o.pose, o.twist, f.pose, f.twist, self.pair.eta, self._parameters]
        return _function(f"mg_{self.kind.name}_{what}", moving, RATES_INPUTS, values, outputs)


def _function(
    name: str,
    inputs: list[ca.SX],
    in_names: tuple[str, ...],
    values: Mapping[str, ca.SX],
    out_names: tuple[str, ...],
) -> ca.Function:
    outputs = ca.cse([ca.densify(values[out]) for out in out_names])
    return ca.Function(name, inputs, outputs, list(in_names), list(out_names))
