"""The two frames of a joint, one in each body, as symbols; rates of what hangs on them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import casadi as ca

from modelgen.dynamics.bodies import kernel
from modelgen.geometry.frames import POSE_SIZE, TWIST_SIZE, Frame, cross, dot, frame_of


@dataclass(frozen=True)
class Rate:
    """Derivatives of k expressions: value_dot = J_a u_a + J_b u_b + bias, value_ddot = J u_dot + gamma."""

    J_a: ca.SX  # (k, 6)
    J_b: ca.SX  # (k, 6)
    gamma: ca.SX  # (k,)
    bias: ca.SX  # (k,) what time alone makes of the rate
    total: ca.SX  # (k,) value_dot


@dataclass(frozen=True)
class Side:
    """One body of a joint: its pose, its twist and the frame of the joint in it, all in world axes."""

    pose: ca.SX
    twist: ca.SX
    placement: ca.SX  # (12,) of the frame in the axes of the body's centre of mass
    rotation: ca.SX  # (3, 3) symbols of the frame's axes

    @property
    def body(self) -> Frame:
        return frame_of(self.pose)

    @property
    def arm(self) -> ca.SX:
        """From the centre of mass to the frame's origin, (3,) m."""
        return ca.mtimes(self.body.rotation, frame_of(self.placement).position)

    @property
    def position(self) -> ca.SX:
        """The frame's origin, (3,) m."""
        return self.body.position + self.arm

    @property
    def angular_velocity(self) -> ca.SX:
        """(3,) rad/s."""
        return ca.mtimes(self.body.rotation, self.twist[3:6])

    @property
    def turned(self) -> ca.SX:
        """The frame's axes as expressions of pose and placement, (3, 3)."""
        return ca.mtimes(self.body.rotation, frame_of(self.placement).rotation)


@dataclass(frozen=True)
class Meeting:
    """Arguments of the kernels of a joint. Frames coincide where all coordinates of a joint are zero.

    Rows and coordinates are expressions of `t`, `span` and the axes of both frames, which are symbols until
    `kernel` puts the poses in their place: derivatives are taken by few symbols.
    """

    t: ca.SX
    a: Side
    b: Side
    span: ca.SX  # (3,) m, world: symbols, from the origin of a's frame to that of b's
    length: ca.SX  # m, by which angles are measured

    @property
    def placements(self) -> ca.SX:
        """(24,) both frames in the axes of their bodies' centres of mass."""
        return ca.vertcat(self.a.placement, self.b.placement)

    @property
    def moving(self) -> dict[str, ca.SX]:
        """Poses and twists by the names of arguments."""
        return {
            "pose_a": self.a.pose, "twist_a": self.a.twist, "pose_b": self.b.pose, "twist_b": self.b.twist
        }  # fmt: skip

    def axis(self, name: str) -> ca.SX:
        """`xa`: the unit vector (3,), world, of the x axis of frame a."""
        return (self.a if name[1] == "a" else self.b).rotation[:, "xyz".index(name[0])]

    def cosine(self, one: str, other: str) -> ca.SX:
        """The product of two axes."""
        return dot(self.axis(one), self.axis(other))

    def along(self, axis: str) -> ca.SX:
        """The component of the span along an axis, m."""
        return dot(self.axis(axis), self.span)

    def rate(self, value: ca.SX) -> Rate:
        """Rate of a vector of expressions of t, the span and the axes, as both bodies move.

        With g = d value/d span and h the angular gradients, in world axes,
        value_dot = g.(v_b + w_b x s_b - v_a - w_a x s_a) + h_a.w_a + h_b.w_b + bias, s_a and s_b the arms.
        """
        velocity, spins = ca.SX.sym("velocity", 3), [ca.SX.sym("spin", 3) for _ in range(2)]
        bias = ca.jacobian(value, self.t)
        along = ca.jacobian(value, self.span)
        turning = [_angular_gradient(value, side.rotation) for side in (self.a, self.b)]
        total = (
            ca.mtimes(along, velocity)
            + ca.mtimes(turning[0], spins[0])
            + ca.mtimes(turning[1], spins[1])
            + bias
        )
        places = ca.vertcat(self.span, ca.vec(self.a.rotation), ca.vec(self.b.rotation), self.t)
        moved = ca.vertcat(velocity, *(ca.vec(_turned(w, side.rotation)) for w, side in self._with(spins)), 1)
        w_a, w_b = self.a.angular_velocity, self.b.angular_velocity
        swing_a, swing_b = cross(w_a, self.a.arm), cross(w_b, self.b.arm)
        relative = self.b.twist[0:3] + swing_b - self.a.twist[0:3] - swing_a
        pull = cross(w_b, swing_b) - cross(w_a, swing_a)
        total, curved = ca.substitute(
            [total, ca.jtimes(total, places, moved)], [velocity, *spins], [relative, w_a, w_b]
        )
        return Rate(
            J_a=ca.horzcat(-along, ca.mtimes(turning[0] + _levered(along, self.a.arm), self.a.body.rotation)),
            J_b=ca.horzcat(along, ca.mtimes(turning[1] - _levered(along, self.b.arm), self.b.body.rotation)),
            gamma=curved + ca.mtimes(along, pull),
            bias=bias,
            total=total,
        )

    def relative_spin(self) -> Rate:
        """The relative angular velocity w_b - w_a along the axes of frame a, as k = 3 rates."""
        w_a, w_b = self.a.angular_velocity, self.b.angular_velocity
        axes, still = self.a.rotation.T, ca.SX(3, 3)
        return Rate(
            J_a=ca.horzcat(still, -ca.mtimes(axes, self.a.body.rotation)),
            J_b=ca.horzcat(still, ca.mtimes(axes, self.b.body.rotation)),
            gamma=-ca.mtimes(axes, cross(w_a, w_b)),
            bias=ca.SX(3, 1),
            total=ca.mtimes(axes, w_b - w_a),
        )

    def kernel(self, name: str, inputs: dict[str, ca.SX], outputs: dict[str, ca.SX]) -> ca.Function:
        """A kernel whose outputs are expressions of the span and the axes."""
        return kernel(name, inputs, dict(zip(outputs, self.placed(outputs.values()), strict=True)))

    def placed(self, values: Iterable[ca.SX]) -> list[ca.SX]:
        """Expressions of the span and the axes as expressions of the poses."""
        symbols = [self.span, self.a.rotation, self.b.rotation]
        places = [self.b.position - self.a.position, self.a.turned, self.b.turned]
        return list(ca.substitute(list(values), symbols, places))

    def _with(self, spins: list[ca.SX]) -> list[tuple[ca.SX, Side]]:
        return list(zip(spins, (self.a, self.b), strict=True))


def meeting() -> Meeting:
    """Fresh symbols."""
    return Meeting(ca.SX.sym("t"), _side("a"), _side("b"), ca.SX.sym("span", 3), ca.SX.sym("length"))


def _side(name: str) -> Side:
    return Side(
        ca.SX.sym(f"pose_{name}", POSE_SIZE),
        ca.SX.sym(f"twist_{name}", TWIST_SIZE),
        ca.SX.sym(f"placement_{name}", POSE_SIZE),
        ca.SX.sym(f"rotation_{name}", 3, 3),
    )


def _angular_gradient(value: ca.SX, rotation: ca.SX) -> ca.SX:
    """(k, 3) h with d value = h.w dt where the axes x turn at w: the sum of x cross d value/d x."""
    found = ca.SX(value.numel(), 3)
    for k in range(3):
        found += _levered(ca.jacobian(value, rotation[:, k]), -rotation[:, k])
    return found


def _levered(rows: ca.SX, arm: ca.SX) -> ca.SX:
    """(k, 3): each row g as g x arm."""
    return ca.mtimes(rows, ca.skew(arm)) if rows.nnz() else ca.SX(rows.shape[0], 3)


def _turned(spin: ca.SX, rotation: ca.SX) -> ca.SX:
    """The rate of axes that turn at a spin, world axes."""
    return ca.horzcat(*(cross(spin, rotation[:, k]) for k in range(3)))
