"""The two partners of a contact as symbols: arguments of its kernels and what follows from them at once.

Each side brings the pose and twist of its body and the placement of its shape in the body. Whatever a
fixed body, an identity pose or a body without rotation makes zero is zero structurally.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.geometry.frames import (
    POSE_SIZE,
    SEAM,
    TWIST_SIZE,
    Frame,
    cross,
    frame_of,
    identity_frame,
    zeros,
)
from modelgen.geometry.surface_kernel import shape_parameters
from modelgen.model import ContactKind, ShapeKind, Side
from modelgen.notation import ETA_SIZE


@dataclass(frozen=True)
class Partner:
    """One side of a contact. The shape's axes are the common language of everything local."""

    shape: ShapeKind
    columns: int  # of J: 6, 3 or 0
    pose: ca.SX  # argument, (12,) or (0,)
    twist: ca.SX  # argument, (6,) or (0,)
    argument: ca.SX  # parameters of the shape, then its placement (12,) where general
    parameters: ca.SX  # of the shape
    centre: ca.SX  # (3,) m, world, centre of mass
    velocity: ca.SX  # (3,) m/s, world, of the centre of mass
    placement: Frame  # shape axes in body axes
    rotation: ca.SX  # (3,3) shape axes -> world
    spin: ca.SX  # (3,) rad/s, shape axes
    arm: ca.SX  # (3,) m, shape axes, from the centre of mass to the shape's origin
    seam: float = 0.0  # of `tangent_frame` on it

    @property
    def origin(self) -> ca.SX:
        """World position of the shape's origin, (3,) m."""
        return self.centre + ca.mtimes(self.rotation, self.arm)

    @property
    def spin_world(self) -> ca.SX:
        return ca.mtimes(self.rotation, self.spin)

    def seen(self, direction: ca.SX, rate: ca.SX) -> ca.SX:
        """The rate (3,) in shape axes of a world direction with the given world rate, seen from the body."""
        return ca.mtimes(self.rotation.T, rate) - cross(self.spin, ca.mtimes(self.rotation.T, direction))

    def row(self, linear: ca.SX, angular: ca.SX) -> ca.SX:
        """The columns of J as (columns,): `linear` in world axes, `angular` in shape axes."""
        if self.columns == TWIST_SIZE:
            return ca.vertcat(linear, ca.mtimes(self.placement.rotation, angular))
        return linear if self.columns else ca.SX(0, 1)


def partner(side: Side, name: str, seam: float = 0.0) -> Partner:
    """The symbols of one side; `name` is "o" or "f"."""
    posed = not (side.motion == "fixed" and side.pose == "identity")
    pose = ca.SX.sym(f"pose_{name}", POSE_SIZE if posed else 0)
    twist = ca.SX.sym(f"twist_{name}", 0 if side.motion == "fixed" else TWIST_SIZE)
    body = frame_of(pose) if posed else identity_frame()
    if side.motion == "point":
        body = Frame(body.position, ca.SX.eye(3))
    turning = side.motion in ("driven", "free")
    shape_argument, parameters = shape_parameters(side.shape)
    placed = side.placement == "general"
    placement_argument = ca.SX.sym(f"placement_{name}", POSE_SIZE if placed else 0)
    placement = frame_of(placement_argument) if placed else identity_frame()
    return Partner(
        shape=side.shape,
        columns={"fixed": 0, "point": 3, "driven": 6, "free": 6}[side.motion],
        pose=pose,
        twist=twist,
        argument=ca.vertcat(shape_argument, placement_argument),
        parameters=parameters,
        centre=body.position,
        velocity=twist[0:3] if side.motion != "fixed" else zeros(3),
        placement=placement,
        rotation=ca.mtimes(body.rotation, placement.rotation),
        spin=ca.mtimes(placement.rotation.T, twist[3:6]) if turning else zeros(3),
        arm=ca.mtimes(placement.rotation.T, placement.position),
        seam=seam,
    )


Layout = tuple[str, str]  # how eta carries the points of o and f: a key of ETA_SIZE each


@dataclass(frozen=True)
class Pair:
    """The arguments of a contact kernel, o and f as in the paper."""

    o: Partner
    f: Partner
    layout: Layout
    eta: ca.SX  # (n_eta,), that of o first
    eta_o: ca.SX
    eta_f: ca.SX


def pair(kind: ContactKind, layout: Layout) -> Pair:
    """Symbols of a contact whose eta has the given layout."""
    size_o, size_f = ETA_SIZE[layout[0]], ETA_SIZE[layout[1]]
    eta = ca.SX.sym("eta", size_o + size_f)
    seam = SEAM if kind.rows > 1 else 0.0
    o, f = partner(kind.o, "o", seam), partner(kind.f, "f", seam)
    return Pair(o, f, layout, eta, eta[:size_o], eta[size_o:])
