"""Balls, capsules and ellipsoids that roll or slide over smooth joints of surfaces that are fixed together.

    python -m tests.benchmarks.smooth_joints [--count 200] [--part 1/2] [--only GROUND] [--member K]

Two height fields, charts, splines or walls, two surfaces of revolution, a box and a chart, a box and a rod, a
floor and a ramp on it, or the sides of one outline have position and tangent plane in common where they join;
their curvatures differ. They are fixed bodies, shapes of one body or welded bodies, turned at random with
gravity, and passed in both directions. Without friction, and where a ball rolls, the energy of the body is
constant. The centre of a ball that slides moves on the surface at the distance of its radius, which is
integrated independently. The body touches the ground at each sample, by distances of its own geometry. There
is no impact, lift-off or touch-down. Told for each ground: right, doubted, wrong and trusted, and how many
pass the joint.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from scipy.optimize import fsolve, minimize
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, ModelgenError, derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.benchmarks.seams import members_asked_for, quaternion_row, row
from tests.running import compiled

G = 9.81
LOST = 1e-7  # of the kinetic energy at the start
OFF = 1e-7  # m, from the surface, of a body that touches it
APART = 1e-7  # m, from the independent motion, beside the stated error
REACH, WIDTH = 1.2, 0.6  # m, of the ground to both sides of the joint, and to both sides along it
DISTURBING = ("impact", "lift-off", "touch-down", "fallback-start", "slip-start", "near-singular")
GROUNDS = (
    "fields",
    "charts",
    "splines",
    "field and chart",
    "walls",
    "turned",
    "outline",
    "box and chart",
    "rounded box",
    "ramp",
)
HELD = ("bodies", "one body", "welded")
MOVERS = ("ball", "rolling ball", "ellipsoid", "capsule")
MASS = 1.0

Array = np.ndarray[Any, np.dtype[np.float64]]
X, Y = ca.SX.sym("x"), ca.SX.sym("y")


@dataclass(frozen=True)
class Ground:
    """Shapes with the exterior above, and the same surface as heights over x and y."""

    shapes: tuple[Shape, ...]
    heights: tuple[ca.SX, ca.SX]  # before and beyond the joint
    joint: ca.SX  # negative before it

    @cached_property
    def height(self) -> ca.Function:
        return ca.Function("height", [X, Y], [ca.if_else(self.joint < 0, self.heights[0], self.heights[1])])

    def at(self, x: float, y: float) -> float:
        return float(self.height(x, y))

    def normal(self, x: float, y: float) -> Array:
        found = np.array(self._slopes(x, y)).ravel()
        n = np.array([-found[0], -found[1], 1.0])
        return np.asarray(n / np.linalg.norm(n))

    @cached_property
    def _slopes(self) -> ca.Function:
        slopes = [ca.jacobian(each, ca.vertcat(X, Y)) for each in self.heights]
        return ca.Function("slopes", [X, Y], [ca.if_else(self.joint < 0, slopes[0], slopes[1])])

    def distance(self, x: Array) -> float:
        """Of a point above the ground."""
        least = minimize(
            lambda at: (at[0] - x[0]) ** 2 + (at[1] - x[1]) ** 2 + (self.at(*at) - x[2]) ** 2,
            x[:2] - self.normal(x[0], x[1])[:2] * (x[2] - self.at(x[0], x[1])),
            method="Nelder-Mead", options={"xatol": 1e-11, "fatol": 1e-18, "maxfev": 2000},
        )  # fmt: skip
        return float(np.sqrt(least.fun))


def _polynomials(random: np.random.Generator, level: bool) -> tuple[Array, Array]:
    """Coefficients [power of x][power of y], alike up to the first power of x."""
    common = np.zeros((4, 4))
    if not level:
        common[0, 1:3] = random.uniform(-0.1, 0.1), random.uniform(0.05, 0.25)  # holds both ends of a capsule
        common[1, :2] = random.uniform(-0.2, 0.2), random.uniform(-0.1, 0.1)
    found = []
    for _ in range(2):
        own = common.copy()
        own[2, 0], own[3, 0] = random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2)
        if not level:
            own[2, 1] = random.uniform(-0.2, 0.2)
        found.append(own)
    return found[0], found[1]


def _value(p: Array, x: Any, y: Any) -> Any:
    return sum(p[i, j] * x**i * y**j for i in range(4) for j in range(4))


def _text(p: Array, x: str, y: str) -> str:
    terms = [f"({p[i, j]!r})*({x})**{i}*({y})**{j}" for i in range(4) for j in range(4) if p[i, j]]
    return (
        " + ".join(
            term.replace("np.float64", "").replace(f"*({x})**0", "").replace(f"*({y})**0", "")
            for term in terms
        )
        or "0.0"
    )


def _field(p: Array, ends: tuple[float, float], random: np.random.Generator, name: str) -> Shape:
    x, y = (
        np.linspace(*ends, int(random.integers(4, 7))),
        np.linspace(-WIDTH, WIDTH, int(random.integers(4, 7))),
    )
    heights = [[float(_value(p, a, b)) for b in y] for a in x]
    return make.height_field(x.tolist(), y.tolist(), heights, name=name)


def _chart(p: Array, ends: tuple[float, float], random: np.random.Generator, name: str) -> Shape:
    if random.integers(2):
        return make.chart("u", "v", _text(p, "u", "v"), domain=[ends, (-WIDTH, WIDTH)], name=name)
    return make.chart("v", "-u", _text(p, "v", "-u"), domain=[(-WIDTH, WIDTH), ends], name=name)


def _spline(p: Array, ends: tuple[float, float], random: np.random.Generator, name: str) -> Shape:
    x, y = (
        np.linspace(*ends, int(random.integers(4, 6))),
        np.linspace(-WIDTH, WIDTH, int(random.integers(4, 6))),
    )
    along_x = make_interp_spline(x, _value(p, x[:, None], y[None, :]), k=3)
    along_y = make_interp_spline(y, along_x.c.T, k=3)
    places = [[float(np.mean(s.t[k + 1 : k + 4])) for k in range(len(s.t) - 4)] for s in (along_x, along_y)]
    net = [[[a, b, float(along_y.c[j, i])] for j, b in enumerate(places[1])] for i, a in enumerate(places[0])]
    return make.bspline(net, knots=[along_x.t.tolist(), along_y.t.tolist()], name=name)


SHEETS = {
    "fields": (_field, _field),
    "charts": (_chart, _chart),
    "splines": (_spline, _spline),
    "field and chart": (_field, _chart),
}
UPRIGHT = {"rpy": [np.pi / 2, 0.0, 0.0]}  # of a profile in x and y, which turns y into z


def ground_of(kind: str, random: np.random.Generator) -> Ground:
    if kind in SHEETS:
        pieces = _polynomials(random, level=False)
        ends = ((-REACH, 0.0), (0.0, REACH))
        names = ("left", "right")
        shapes = tuple(
            m(p, e, random, n) for m, p, e, n in zip(SHEETS[kind], pieces, ends, names, strict=True)
        )
        return Ground(shapes, (_value(pieces[0], X, Y), _value(pieces[1], X, Y)), X)
    radius = float(random.uniform(1.0, 2.0))
    if kind == "walls":  # a straight profile through points that goes over into an arc
        slope = float(random.uniform(-0.2, 0.2))
        t = np.linspace(REACH, 0.0, 7)
        line = make.profile_wall([[-a, -a * slope] for a in t][::-1], 2 * WIDTH, name="left", **UPRIGHT)
        sign, lean = (1.0 if random.integers(2) else -1.0), float(np.arctan(slope))
        x = f"{sign * radius!r}*(sin({lean!r} + {sign!r}*u) - sin({lean!r}))"
        z = f"{sign * radius!r}*(cos({lean!r}) - cos({lean!r} + {sign!r}*u))"
        arc = make.chart(x, "v", z, domain=[(0.0, 1.1), (-WIDTH, WIDTH)], name="right")
        centre = (-sign * radius * np.sin(lean), sign * radius * np.cos(lean))
        return Ground(
            (line, arc), (slope * X, centre[1] - sign * ca.sqrt(radius**2 - (X - centre[0]) ** 2)), X
        )
    if kind == "turned":  # a dome or bowl about z that goes over into a cone
        sign, a = (1.0 if random.integers(2) else -1.0), float(random.uniform(0.15, 0.4))
        hollow = {"cavity": True} if sign > 0 else {}
        r0, z0 = radius * np.sin(a), radius * (1 - np.cos(a))
        inner = make.revolution(
            f"{radius!r}*sin(t)", f"{sign * radius!r}*(1 - cos(t))", domain=[0.0, a], name="left", **hollow
        )
        outer = make.revolution(
            f"{float(r0)!r} + {float(np.cos(a))!r}*t",
            f"{sign * float(z0)!r} + {sign * float(np.sin(a))!r}*t",
            domain=[0.0, 1.6],
            name="right",
            **hollow,
        )
        rho = ca.sqrt(X**2 + Y**2 + 1e-300)
        heights = (sign * (radius - ca.sqrt(radius**2 - X**2 - Y**2)), sign * (z0 + (rho - r0) * np.tan(a)))
        return Ground((inner, outer), heights, rho - r0)
    arc_down = ca.sqrt(radius**2 - X**2) - radius
    if kind == "outline":
        sides: list[dict[str, object]] = [
            {"kind": "line", "from": [0.0, 0.0], "to": [-REACH, 0.0]},
            {
                "kind": "arc",
                "center": [-REACH, -radius],
                "radius": radius,
                "angles": [np.pi / 2, 3 * np.pi / 2],
            },
            {"kind": "line"},
            {"kind": "arc", "center": [0.0, -radius], "radius": radius, "angles": [-np.pi / 2, np.pi / 2]},
        ]
        wall = make.outline_wall(sides, 2 * WIDTH, name="left", **UPRIGHT)
        return Ground((wall,), (ca.SX(0), arc_down), X)
    box = make.box(REACH, 2 * WIDTH, 0.5, position=[-REACH / 2, 0.0, -0.25], name="left")
    if kind == "rounded box":
        rod = make.cylinder(radius, 2 * WIDTH, position=[0.0, 0.0, -radius], name="right", **UPRIGHT)
        long = radius + REACH
        deep = make.box(long, 2 * WIDTH, 2 * radius, position=[-long / 2, 0.0, -radius], name="left")
        return Ground((deep, rod), (ca.SX(0), arc_down), X)
    p = _polynomials(random, level=True)[1]
    if kind == "ramp":
        p = np.abs(p)
        floor = make.box(2 * REACH, 2 * WIDTH, 0.5, position=[0.0, 0.0, -0.25], name="left")
        return Ground((floor, _chart(p, (0.0, REACH), random, "right")), (ca.SX(0), _value(p, X, Y)), X)
    return Ground((box, _chart(p, (0.0, REACH), random, "right")), (ca.SX(0), _value(p, X, Y)), X)


@dataclass(frozen=True)
class Member:
    """A body on a ground, before the joint."""

    ground: Ground
    kind: str
    held: str
    mover: str
    sizes: tuple[float, ...]  # m: radius; semi-axes; radius and length
    start: tuple[float, float]  # m, of the point of contact, or of the middle of a capsule
    heading: float  # from x
    speed: float
    spin: float  # rad/s about the normal
    yaw: float
    rotation: Rotation  # of the whole scene
    until: float

    @property
    def shape(self) -> Shape:
        if self.mover == "ellipsoid":
            return make.ellipsoid(*self.sizes)
        if self.mover == "capsule":
            return make.capsule(*self.sizes, rpy=[np.pi / 2, 0.0, 0.0])
        return make.sphere(self.sizes[0])

    @property
    def inertia(self) -> list[float]:
        if self.mover == "ellipsoid":
            a, b, c = self.sizes
            return [MASS / 5 * (b * b + c * c), MASS / 5 * (a * a + c * c), MASS / 5 * (a * a + b * b)]
        r = self.sizes[0]
        if self.mover == "capsule":
            across = MASS * (r * r / 4 + (self.sizes[1] + r) ** 2 / 12)
            return [across, MASS * r * r / 2, across]
        return [0.4 * MASS * r * r] * 3

    def placed(self, x: float, y: float) -> tuple[Array, Rotation]:
        """Position and rotation of the body that touches at, or is above, a place."""
        if self.mover == "capsule":

            def gaps(q: Array) -> list[float]:
                ends = _ends(np.array([x, y, q[0]]), self._turn(q[1]), self.sizes[1])
                return [self.ground.distance(each) - self.sizes[0] for each in ends]

            height, roll = fsolve(gaps, [self.ground.at(x, y) + self.sizes[0], 0.0], xtol=1e-12)
            return np.array([x, y, height]), self._turn(float(roll))
        n = self.ground.normal(x, y)
        at = np.array([x, y, self.ground.at(x, y)])
        if self.mover != "ellipsoid":
            return at + self.sizes[0] * n, Rotation.identity()
        tilt = Rotation.align_vectors([n], [[0, 0, 1]])[0]
        turned = tilt * Rotation.from_euler("zx", [self.yaw, 0.1])
        squared = turned.as_matrix() @ np.diag(np.square(self.sizes)) @ turned.as_matrix().T
        return at + squared @ n / np.sqrt(n @ squared @ n), turned

    def _turn(self, roll: float) -> Rotation:
        """Of a capsule, whose axis is y of its body."""
        return Rotation.from_euler("zx", [self.yaw, roll])

    @cached_property
    def state(self) -> tuple[Array, Rotation, Array, Array]:
        """Position, rotation, velocity, angular velocity before the scene is turned."""
        position, turned = self.placed(*self.start)
        ahead = np.array([np.cos(self.heading), np.sin(self.heading)])
        n = self.ground.normal(*self.start)
        if self.mover == "capsule":
            h = 1e-4
            (p, a), (q, b) = (self.placed(*(np.array(self.start) + s * h * ahead)) for s in (1, -1))
            return (
                position,
                turned,
                self.speed * (p - q) / (2 * h),
                self.speed * (a * b.inv()).as_rotvec() / (2 * h),
            )
        along = np.array([*ahead, 0.0])
        along -= (along @ n) * n
        along *= self.speed / np.linalg.norm(along)
        spin = self.spin * n
        if self.mover == "rolling ball":
            return position, turned, along, spin + np.cross(n, along) / self.sizes[0]
        if self.mover == "ellipsoid":
            return position, turned, along, np.zeros(3)
        return position, turned, along, spin

    def scene(self) -> Scene:
        position, turned, v, w = self.state
        whole = self.rotation
        mover = make.dynamic(
            "mover",
            self.shape,
            position=row(whole.apply(position)),
            quaternion=quaternion_row(whole * turned),
            velocity=row(whole.apply(v)),
            angular_velocity=row(whole.apply(w)),
            mass=MASS,
            inertia=self.inertia,
        )
        at = {"quaternion": quaternion_row(whole)}
        shapes, welds = self.ground.shapes, []
        names = [each.name for each in shapes]
        if self.held == "one body" or len(shapes) == 1:
            fixed = [make.fixed("ground", *shapes, **at)]
            names = [f"ground/{name}" for name in names] if len(shapes) > 1 else ["ground"]
        elif self.held == "bodies":
            fixed = [make.fixed(each.name, each, **at) for each in shapes]
        else:
            left, right = shapes
            fixed = [
                make.fixed("left", left, **at),
                make.dynamic("right", right, mass=3.0, inertia=[1.0, 2.0, 2.5], **at),
            ]
            welds = [{"kind": "weld", "between": ["left", "right"]}]
        law = {"friction": 2.0} if self.mover == "rolling ball" else {}
        contacts = [{"between": ["mover", name]} | law for name in names]
        down = row(whole.apply([0, 0, -G]))
        return make.scene("joint", [*fixed, mover], gravity=down, contact=contacts, joint=welds)


def _ends(at: Array, turned: Rotation, length: float) -> list[Array]:
    return [at + turned.apply([0.0, s * length / 2, 0.0]) for s in (-1, 1)]


def drawn(seed: int, grounds: Sequence[str]) -> Member:
    """The member of that number."""
    random = np.random.default_rng([43, seed])
    kind = grounds[seed % len(grounds)]
    ground = ground_of(kind, random)
    held = HELD[int(random.integers(len(HELD)))]
    is_flat = kind in ("walls", "outline", "box and chart", "rounded box", "ramp")  # along the joint
    mover = MOVERS[int(random.integers(3 if is_flat or kind == "turned" else 4))]
    sizes: tuple[float, ...] = (float(random.uniform(0.05, 0.12)),)
    if mover == "ellipsoid":
        a = random.uniform(0.08, 0.15, size=2)
        sizes = (float(a[0]), float(a[1]), float(random.uniform(0.05, 0.08)))
    if mover == "capsule":
        sizes = (float(random.uniform(0.05, 0.1)), float(random.uniform(0.1, 0.2)))
    speed = float(random.uniform(0.5, 1.2))
    start = (float(random.uniform(-0.35, -0.2)), float(random.uniform(-0.1, 0.1)))
    if kind == "turned":
        start = (float(random.uniform(0.02, 0.08)), float(random.uniform(-0.02, 0.02)))
    heading, spin = float(random.uniform(-0.3, 0.3)), float(random.choice([0.0, random.uniform(-5, 5)]))
    if random.integers(2):  # the other way
        reach = -float(ca.Function("joint", [X, Y], [ground.joint])(0.0, 0.0))
        start, heading = (reach + float(random.uniform(0.08, 0.2)), start[1] / 4), heading + np.pi
        speed += 0.6
    rotation = Rotation.identity() if random.integers(2) else Rotation.random(random_state=seed)
    yaw = float(random.uniform(-0.3, 0.3))
    return Member(ground, kind, held, mover, sizes, start, heading, speed, spin, yaw, rotation, 0.45 / speed)


def judged(member: Member) -> tuple[str, str, bool]:
    """(verdict, why, whether the body passes the joint)."""
    try:
        path = run_of(member)
    except ModelgenError as error:
        return "refused", str(error)[:200], False
    told = "" if path.is_trusted else f"{path.outcome} {path.doubts[:2]}"
    wrong = fault(member, path)
    if not wrong:
        return ("right" if path.is_trusted else "right, doubted"), told, _passes(member, path)
    return ("WRONG" if path.is_trusted else "wrong, doubted"), f"{wrong}; {told}", _passes(member, path)


def _passes(member: Member, path: Trajectory) -> bool:
    joint = ca.Function("joint", [X, Y], [member.ground.joint])
    at = member.rotation.inv().apply(path.p[[0, -1], path.body_names.index("mover")])
    return (float(joint(*at[0, :2])) < 0) != (float(joint(*at[1, :2])) < 0)


def run_of(member: Member) -> Trajectory:
    """The run of a member."""
    library = compiled(emit(derive(require(member.scene()))))
    return simulate(library, until=member.until, samples=10, accuracy=Accuracy.balanced())


def fault(member: Member, path: Trajectory) -> str:
    """What is wrong with a run, in words; nothing: it is right."""
    if not len(path.t) or path.t[-1] < member.until * (1 - 1e-9):
        return f"ended at {path.t_end:.3g} of {member.until:.3g}"
    disturbed = [
        f"{each.kind} of {each.contact} at {each.t:.4f}" for each in path.events if each.kind in DISTURBING
    ]
    if disturbed:
        return ", ".join(disturbed[:3])
    lost = _lost_energy(member, path)
    if not lost <= LOST:
        return f"energy {lost:.1e}"
    off = max(abs(_gap(member, path, k)) for k in range(len(path.t)))
    if not off <= OFF:
        return f"{off:.1e} m off the ground"
    if member.mover == "ball":
        body = path.body_names.index("mover")
        apart = np.linalg.norm(member.rotation.inv().apply(path.p[-1, body]) - _centre_at_end(member))
        allowed = APART + 2 * float(path.position_error[-1])
        if not apart <= allowed:
            return f"{apart:.1e} m of {allowed:.1e} from the independent motion"
    return ""


def _lost_energy(member: Member, path: Trajectory) -> float:
    """Largest change of the mover's energy over its kinetic energy at the start."""
    body = path.body_names.index("mover")
    down = member.rotation.apply([0, 0, -1.0])
    spins = [
        Rotation.from_quat(np.roll(q, -1)).inv().apply(w)
        for q, w in zip(path.quaternion[:, body], path.w[:, body], strict=True)
    ]
    if np.isnan(path.quaternion[0, body]).any():
        spins = list(path.w[:, body])
    turning = np.array([0.5 * np.dot(member.inertia, w * w) for w in np.nan_to_num(spins)])
    kinetic = 0.5 * MASS * (path.v[:, body] ** 2).sum(axis=1) + turning
    energy = kinetic - MASS * G * path.p[:, body] @ down
    return float(np.abs(energy - energy[0]).max() / kinetic[0])


def _gap(member: Member, path: Trajectory, k: int) -> float:
    """Of the mover above the ground at a sample, m."""
    body, ground = path.body_names.index("mover"), member.ground
    at = member.rotation.inv().apply(path.p[k, body])
    if member.mover.endswith("ball"):
        return ground.distance(at) - member.sizes[0]
    turned = member.rotation.inv() * Rotation.from_quat(np.roll(path.quaternion[k, body], -1))
    if member.mover == "capsule":
        return min(ground.distance(each) - member.sizes[0] for each in _ends(at, turned, member.sizes[1]))

    def above(angles: Array) -> float:
        a, b = angles
        n = np.array([np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), -np.cos(b)])
        x = at + turned.apply(np.square(member.sizes) * turned.inv().apply(n)) / np.linalg.norm(
            np.array(member.sizes) * turned.inv().apply(n)
        )
        return float(x[2] - ground.at(x[0], x[1]))

    starts = [(a, b) for a in np.linspace(0, 2 * np.pi, 25)[:-1] for b in np.linspace(0.02, 0.8, 14)]
    best = np.array(min(starts, key=lambda each: above(np.array(each))))
    for _ in range(3):
        best = minimize(above, best, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-13}).x
    return above(best)


def _centre_at_end(member: Member) -> Array:
    """Of a ball without friction: a point on the surface of its centres, integrated piece by piece."""
    q, q_dot, g = ca.vertcat(X, Y), ca.SX.sym("q_dot", 2), ca.DM([0, 0, -G])
    joint = ca.Function("joint", [q], [member.ground.joint])
    places, rates = [], []
    for height in member.ground.heights:
        slope = ca.jacobian(height, q)
        n = ca.vertcat(-slope[0], -slope[1], 1) / ca.sqrt(1 + ca.sumsqr(slope))
        centre = ca.vertcat(X, Y, height) + member.sizes[0] * n
        J = ca.jacobian(centre, q)
        across = ca.jtimes(ca.mtimes(J, q_dot), q, q_dot)
        acceleration = ca.solve(ca.mtimes(J.T, J), ca.mtimes(J.T, g - across))
        places.append(ca.Function("centre", [q], [centre, J]))
        rates.append(ca.Function("rate", [q, q_dot], [acceleration]))
    _, _, v, _ = member.state
    t, at = 0.0, np.array(member.start)
    piece = 0 if float(joint(at)) < 0 else 1
    rate = np.linalg.lstsq(np.array(places[piece](at)[1]), v, rcond=None)[0]
    while t < member.until:
        side = -1.0 if piece == 0 else 1.0

        def leaves(_: float, y: Array, side: float = side) -> float:
            return side * float(joint(y[:2])) + 1e-13

        leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
        found = solve_ivp(
            lambda _, y, piece=piece: np.concatenate([y[2:], np.array(rates[piece](y[:2], y[2:])).ravel()]),
            (t, member.until),
            np.concatenate([at, rate]),
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=leaves,
        )
        t, at, rate = float(found.t[-1]), found.y[:2, -1], found.y[2:, -1]
        if t < member.until:
            v = np.array(places[piece](at)[1]) @ rate
            piece = 1 - piece
            rate = np.linalg.lstsq(np.array(places[piece](at)[1]), v, rcond=None)[0]
    return np.array(places[piece](at)[0]).ravel()


def main() -> None:
    seeds, only = members_asked_for(__doc__, 200, GROUNDS)
    table: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for seed in seeds:
        member = drawn(seed, only)
        verdict, why, passes = judged(member)
        table[member.kind][verdict] += 1
        table[member.kind]["pass the joint"] += passes
        if verdict != "right":
            print(seed, verdict, member.kind, member.held, member.mover, why, flush=True)
    for name, counts in table.items():
        print(f"{name:16}", dict(counts))
    print(f"{'all':16}", dict(sum(table.values(), Counter())))


if __name__ == "__main__":
    main()
