"""The two frames of a joint, one in each body, as symbols; rates of what hangs on them."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.geometry.frames import POSE_SIZE, TWIST_SIZE, Frame, dot, frame_of


@dataclass(frozen=True)
class Rate:
    """Derivatives of k expressions: value_dot = J_a u_a + J_b u_b + bias, value_ddot = J u_dot + gamma."""

    J_a: ca.SX  # (k, 6)
    J_b: ca.SX  # (k, 6)
    gamma: ca.SX  # (k,)
    bias: ca.SX  # (k,) what time alone makes of the rate
    total: ca.SX  # (k,) value_dot


@dataclass(frozen=True)
class Meeting:
    """Arguments of the kernels of a joint. Frames coincide where all coordinates of a joint are zero."""

    t: ca.SX
    pose_a: ca.SX
    twist_a: ca.SX
    pose_b: ca.SX
    twist_b: ca.SX
    placements: ca.SX  # (24,) both frames in the axes of their bodies' centres of mass
    length: ca.SX  # m, by which angles are measured
    a: Frame  # in the world
    b: Frame

    @property
    def moving(self) -> dict[str, ca.SX]:
        """Poses and twists by the names of arguments."""
        return {
            "pose_a": self.pose_a, "twist_a": self.twist_a, "pose_b": self.pose_b, "twist_b": self.twist_b
        }  # fmt: skip

    @property
    def span(self) -> ca.SX:
        """From the origin of a to that of b, (3,) m, world."""
        return self.b.position - self.a.position

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
        """Of a vector of expressions in t and the poses, by differentiation along the rigid motions."""
        poses = ca.vertcat(self.pose_a, self.pose_b)
        moved = ca.vertcat(_pose_rate(self.pose_a, self.twist_a), _pose_rate(self.pose_b, self.twist_b))
        bias = ca.jacobian(value, self.t)
        total = ca.jtimes(value, poses, moved) + bias
        J = ca.jacobian(total, ca.vertcat(self.twist_a, self.twist_b))
        gamma = ca.jtimes(total, poses, moved) + ca.jacobian(total, self.t)
        return Rate(J[:, :TWIST_SIZE], J[:, TWIST_SIZE:], gamma, bias, total)


def meeting() -> Meeting:
    """Fresh symbols."""
    pose_a, pose_b = ca.SX.sym("pose_a", POSE_SIZE), ca.SX.sym("pose_b", POSE_SIZE)
    placements = ca.SX.sym("placements", 2 * POSE_SIZE)
    return Meeting(
        ca.SX.sym("t"),
        pose_a,
        ca.SX.sym("twist_a", TWIST_SIZE),
        pose_b,
        ca.SX.sym("twist_b", TWIST_SIZE),
        placements,
        ca.SX.sym("length"),
        _within(frame_of(pose_a), frame_of(placements[:POSE_SIZE])),
        _within(frame_of(pose_b), frame_of(placements[POSE_SIZE:])),
    )


def _within(outer: Frame, inner: Frame) -> Frame:
    position = outer.position + ca.mtimes(outer.rotation, inner.position)
    return Frame(position, ca.mtimes(outer.rotation, inner.rotation))


def _pose_rate(pose: ca.SX, twist: ca.SX) -> ca.SX:
    """p_dot = v, R_dot = R [w]x with w in body axes."""
    turned = ca.mtimes(frame_of(pose).rotation, ca.skew(twist[3:6]))
    return ca.vertcat(twist[0:3], ca.vec(turned))
