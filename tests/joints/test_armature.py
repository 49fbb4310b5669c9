"""Armature of joints: an inertia on the rate of a coordinate alone, in every form of a scene.

The judges are Lagrange's equations of two links in their relative angles, energy and momentum of random
chains of all kinds, and equations of impacts in the angles.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from modelgen import (
    Accuracy,
    as_casadi,
    derive,
    emit,
    gradient,
    linearise,
    require,
    sensitivity,
    simulate,
    start,
    start_many,
)  # fmt: skip
from modelgen.casadi_functions.as_casadi import rhs_arguments
from modelgen.casadi_functions.complementarity import mpcc
from modelgen.errors import SceneError
from modelgen.optimal_control.transcription import Transcription
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.joint_format import ARMATURE
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Scene
from tests.running import compiled, library_of

Array = np.ndarray[Any, Any]
M1, J1, C1, LINK = 2.0, 0.1, 0.25, 0.5  # kg, kg m^2, m to the centre of mass, m to the second joint
M2, J2, C2 = 1.0, 0.05, 0.15
I1, I2, STIFFNESS, DAMPING, G = 0.03, 0.1, 20.0, 0.2, 9.81
TILT = 0.3
ALONG_Y = "rpy = [-1.5707963267948966, 0.0, 0.0]"

LINKS = f"""
gravity = [0.0, 0.0, {-G}]
[[parameter]]
name = "rotor"
value = {I2}
[[parameter]]
name = "heavy"
value = {M2}
[[parameter]]
name = "bend"
value = {TILT}
[[body]]
name = "upper"
mass = {M1}
inertia = [{J1}, {J1}, {J1}]
center_of_mass = [0.0, 0.0, {-C1}]
angular_velocity = [0.0, 0.7, 0.0]
velocity = [{-0.7 * C1}, 0.0, 0.0]
[[body]]
name = "lower"
mass = "heavy"
inertia = [{J2}, {J2}, {J2}]
center_of_mass = [0.0, 0.0, {-C2}]
position = [0.0, 0.0, {-LINK}]
rpy = [0.0, "bend", 0.0]
angular_velocity = [0.0, 0.7, 0.0]
velocity = ["{-0.7 * LINK} - {0.7 * C2}*cos(bend)", 0.0, "{0.7 * C2}*sin(bend)"]
[[joint]]
name = "a"
kind = "revolute"
between = ["world", "upper"]
frames = [{{ {ALONG_Y} }}, {{ {ALONG_Y} }}]
armature = {I1}
[[joint]]
name = "b"
kind = "revolute"
between = ["upper", "lower"]
frames = [{{ position = [0.0, 0.0, {-LINK}], {ALONG_Y} }}, {{ {ALONG_Y} }}]
stiffness = {STIFFNESS}
damping = {DAMPING}
armature = "rotor"
"""
FLOOR = """
[[body]]
name = "floor"
motion = "fixed"
position = [0.0, 0.0, -0.81]
shape = { kind = "plane" }
[[contact]]
between = ["foot", "floor"]
restitution = 0.6
"""


def lagrange(
    a: float, b: float, da: float, db: float, rotor: float = I2, heavy: float = M2
) -> tuple[Array, Array]:
    """Mass matrix and forces of two links in their relative angles (a, b)."""
    T = np.array([[1.0, 0.0], [1.0, 1.0]])  # absolute rates of relative ones
    coupling = heavy * LINK * C2
    M = np.array(
        [
            [J1 + M1 * C1**2 + heavy * LINK**2, coupling * np.cos(b)],
            [coupling * np.cos(b), J2 + heavy * C2**2],
        ]
    )
    bias = coupling * np.sin(b) * np.array([-((da + db) ** 2), da**2])
    weight = G * np.array([(M1 * C1 + heavy * LINK) * np.sin(a), heavy * C2 * np.sin(a + b)])
    force = T.T @ (-bias - weight) + np.array([0.0, -STIFFNESS * b - DAMPING * db])
    return T.T @ M @ T + np.diag([I1, rotor]), force


def slope(_: float, y: Array) -> list[float]:
    M, force = lagrange(*y)
    return [*y[2:], *np.linalg.solve(M, force)]


def integrated(times: Array) -> Array:
    """(4, n): angles and rates of the two links."""
    return np.asarray(
        solve_ivp(
            slope, (0.0, times[-1]), [0.0, TILT, 0.7, 0.0], "DOP853", t_eval=times, rtol=1e-12, atol=1e-13
        ).y
    )


def links(more: str = "", **changes: str) -> Scene:
    text = LINKS + more
    for old, new in changes.items():
        text = text.replace(f'"{old}"', new)
    return read_text(text, "links.toml")


def angles(path: Trajectory) -> Array:
    """(2, n)."""
    return np.array([path.coordinates[:, path.coordinate_names.index(f"{name}.angle")] for name in "ab"])


def test_two_links_move_by_lagranges_equations() -> None:
    path = simulate(library_of(links()), until=0.8, samples=20, accuracy="tight")
    assert np.abs(angles(path) - integrated(path.t)[:2]).max() < 1e-10
    assert path.is_trusted
    assert path.energy_drift < 1e-12


def test_the_steps_of_time_stepping_converge_to_lagranges_equations() -> None:
    errors = []
    for step in (2e-3, 1e-3):
        stepping = Accuracy(method="time-stepping", step=step)
        path = simulate(library_of(links()), until=0.4, samples=4, accuracy=stepping)
        errors.append(np.abs(angles(path) - integrated(path.t)[:2]).max())
        assert path.energy_drift < 1e-2
    assert errors[1] < 3e-4
    assert errors[0] / errors[1] > 1.8


def chain(seed: int) -> Scene:
    """A chain in free space with a joint of every kind that may have armature, in random order."""
    random = np.random.default_rng(seed)
    bodies, joints = [], []
    kinds = list(random.permutation(sorted(ARMATURE)))
    place = np.zeros(3)
    for k in range(len(kinds) + 1):
        bodies.append(
            make.dynamic(
                f"b{k}", mass=random.uniform(0.5, 2.0), inertia=list(random.uniform(0.02, 0.03, 3)),
                position=list(place), velocity=list(0.3 * random.normal(size=3)),
                angular_velocity=list(random.normal(size=3)),
            )
        )  # fmt: skip
        place = place + random.uniform(-0.3, 0.3, 3)
    for k, kind in enumerate(kinds):
        inertias = [float(each) for each in 10 ** random.uniform(-2, 0, len(ARMATURE[kind]))]
        keys: dict[str, Any] = {"armature": inertias if len(inertias) > 1 else inertias[0]}
        if kind == "screw":
            keys["lead"] = 0.3
        turn = {"axis": list(random.normal(size=3)), "angle": float(random.uniform(0, 3))}
        middle = [
            (a + b) / 2 for a, b in zip(bodies[k].pose.position, bodies[k + 1].pose.position, strict=True)
        ]
        joints.append(
            {
                "name": f"j{k}",
                "kind": kind,
                "between": [f"b{k}", f"b{k + 1}"],
                "position": middle,
                "axis_angle": turn,
            }
            | keys
        )
    return make.scene("chain", bodies, joint=joints, gravity=[0.0, 0.0, 0.0])


@pytest.mark.cases(2)
@pytest.mark.parametrize("seed", range(12))
def test_chains_of_all_kinds_keep_energy_and_momentum(seed: int) -> None:
    scene = chain(seed)
    path = simulate(library_of(scene), until=1.0, samples=5, accuracy="tight", estimate=False)
    assert path.outcome is Outcome.DONE
    assert path.energy_drift < 1e-10
    masses = np.array([body.mass for body in scene.bodies])
    momentum = np.einsum("b,nbi->ni", masses, path.v)
    inertia = np.array([body.inertia for body in scene.bodies])
    R = Rotation.from_quat(path.quaternion[..., [1, 2, 3, 0]].reshape(-1, 4)).as_matrix()
    R = R.reshape(*path.p.shape, 3)
    spins = np.einsum("nbij,bjk,nblk,nbl->nbi", R, inertia, R, path.w)
    angular = (spins + masses[:, None] * np.cross(path.p, path.v)).sum(axis=1)
    size = np.abs(spins).max() + 1.0
    assert np.ptp(momentum, axis=0).max() < 1e-10 * size
    assert np.ptp(angular, axis=0).max() < 1e-9 * size


def struck() -> Scene:
    """Two links whose foot strikes a floor."""
    text = LINKS.replace('"lower"', '"foot"')
    shape = f'shape = {{ kind = "sphere", radius = 0.02, position = [0.0, 0.0, {-2 * C2}] }}'
    text = text.replace('rpy = [0.0, "bend", 0.0]', f'rpy = [0.0, "bend", 0.0]\n{shape}')
    return read_text(text + FLOOR, "struck.toml")


def foot_row(a: float, b: float) -> Array:
    """Rate of the height of the foot by the rates of the relative angles."""
    return np.array([LINK * np.sin(a) + 2 * C2 * np.sin(a + b), 2 * C2 * np.sin(a + b)])


def test_a_blow_changes_the_rates_by_the_mass_matrix_with_armature() -> None:
    path = simulate(library_of(struck()), until=1.0, samples=10, accuracy="tight", estimate=False)
    event = next(event for event in path.events if event.kind == "impact")
    before = simulate(library_of(struck()), until=event.t - 1e-9, samples=1, accuracy="tight", estimate=False)
    after = simulate(library_of(struck()), until=event.t + 1e-9, samples=1, accuracy="tight", estimate=False)
    a, b = angles(before)[:, -1]
    q = []
    for run in (before, after):
        w = [run.w[-1, run.body_names.index(name), 1] for name in ("upper", "foot")]
        q.append(np.array([w[0], w[1] - w[0]]))
    M, _ = lagrange(a, b, *q[0])
    j = foot_row(a, b)
    response = np.linalg.solve(M, j)
    wanted = q[0] - response * (1.6 * (j @ q[0])) / (j @ response)
    assert np.abs(q[1] - wanted).max() < 1e-6
    assert path.energy_drift < 1e-10


def limited(friction: float) -> Scene:
    """Two links that hang at rest at the limits of both joints, with torques on them, and a floor below."""
    lines = [line for line in LINKS.splitlines() if not line.startswith(("angular_velocity", "velocity"))]
    text = "\n".join(lines).replace(f"value = {TILT}", "value = 0.0").replace('"lower"', '"foot"')
    text = text.replace("armature", "limits = [0.0, 2.0]\narmature")
    text = text.replace(
        "position = [0.0, 0.0, -0.5]\nrpy",
        'position = [0.0, 0.0, -0.5]\nshape = { kind = "sphere", radius = 0.01 }\nrpy',
    )
    for name in "ab":
        text += f'''
[[input]]
name = "push_{name}"
[[actuator]]
joint = "{name}"
force = "push_{name}"
gain = 1.0
'''
    return read_text(text + FLOOR.replace("restitution = 0.6", f"friction = {friction}"), "limited.toml")


def limited_accelerations(torques: Array) -> Array:
    """Of two angles at their lower limits, of which those that the torques press against them do not turn."""
    M, _ = lagrange(0.0, 0.0, 0.0, 0.0)
    for free in ([0, 1], [0], [1], []):
        found = np.zeros(2)
        found[free] = np.linalg.solve(M[np.ix_(free, free)], torques[free])
        reactions = M @ found - torques
        if (found >= 0).all() and (np.delete(reactions, free) >= 0).all():
            return found
    raise AssertionError(torques)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_joints_with_armature_leave_their_limits_by_the_accelerations(friction: float) -> None:
    library, span = library_of(limited(friction)), 1e-3
    turns = np.linspace(0.0, 2 * np.pi, 24, endpoint=False) + 0.05
    torques = np.array([np.cos(turns), np.sin(turns)])
    pushes = dict(zip(("push_a", "push_b"), torques, strict=True))
    many = start_many(library, len(turns), inputs=pushes, accuracy="tight")
    many.step(span)
    instance = library.manifest.instance
    places = {body["name"]: instance["n_q"] + body["u"] + 4 for body in instance["bodies"]}
    upper, foot = (many.state[:, places[name]] for name in ("upper", "foot"))
    wanted = np.array([limited_accelerations(each) for each in torques.T])
    assert np.abs(np.array([upper, foot - upper]).T / span - wanted).max() < 0.01 * np.abs(wanted).max()
    kinds = {event.kind for lane in range(many.n) for event in many.events(lane)}
    assert kinds <= {"lift-off"}


@pytest.mark.parametrize("scene", [links(), struck()], ids=["smooth", "struck"])
def test_derivatives_are_those_of_differences_both_ways(scene: Scene) -> None:
    library = compiled(emit(derive(require(scene)), derivatives=True))
    name = scene.bodies[1].name
    of, by = [f"{name}.position", f"{name}.velocity"], ["rotor", "heavy", "bend"]
    found = sensitivity(library, [0.5], of=of, by=by, accuracy="tight")
    assert found.verdict
    for k, (parameter, value) in enumerate((("rotor", I2), ("heavy", M2), ("bend", TILT))):
        step = 1e-4 * value
        ends = [
            sensitivity(
                library, [0.5], of=of, by=[], parameters={parameter: value + sign * step}, accuracy="tight"
            ).value
            for sign in (1, -1)
        ]
        wanted = (ends[0] - ends[1]) / (2 * step)
        assert np.abs(found.jacobian[..., k] - wanted).max() < 1e-6 * (1 + np.abs(wanted).max())
    values = ca.MX.sym("values", *found.value.shape)
    back = gradient(
        library, [0.5], ca.Function("loss", [values], [ca.sumsqr(values)]), of=of, by=by, accuracy="tight"
    )
    wanted = 2 * np.einsum("ij,ijk->k", found.value, found.jacobian)
    assert np.abs(back.gradient - wanted).max() < 1e-10 * np.abs(wanted).max()


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(4))
def test_casadi_functions_have_the_accelerations_of_a_run(seed: int) -> None:
    derivation = derive(require(chain(seed)))
    model = derivation.model
    run = start(library_of(chain(seed)))
    run.step(0.1)
    session = run.session
    x, slope_ = np.array(session.x), np.zeros_like(session.x)
    session.evaluate(run.t, x, slope_)
    wanted = slope_[model.n_q : model.n_q + model.n_u]
    outputs = as_casadi(derivation, mode=run).call([ca.DM(each) for each in rhs_arguments(model, run)])
    assert np.array(outputs[1]).ravel() == pytest.approx(wanted, abs=1e-9)
    system = mpcc(model)
    names = ("t", "x", "u", "gravity", "p")
    given = [run.t, x[:-1], [], system["g0"], system["p0"]]
    function = ca.Function(
        "system",
        [system[name] for name in names],
        [system[name] for name in ("M", "f_v", "J_joint", "Gamma1", "invM")],
    )
    M, f_v, J, gamma, inverse = (np.array(each) for each in function(*given))
    force = np.linalg.lstsq(J, M @ wanted - f_v.ravel(), rcond=None)[0]
    assert M @ wanted == pytest.approx(f_v.ravel() + J @ force, abs=1e-8)
    assert J.T @ wanted + gamma.ravel() == pytest.approx(np.zeros(J.shape[1]), abs=1e-8)
    assert M @ inverse == pytest.approx(np.eye(model.n_u), abs=1e-9)


def test_modes_about_rest_have_the_frequencies_of_lagranges_equations() -> None:
    still = (
        LINKS.replace("0.7", "0.0")
        .replace(f"velocity = [{-0.7 * C1}, 0.0, 0.0]", "")
        .replace(f"damping = {DAMPING}", "damping = 0.0")
    )
    still = "\n".join(line for line in still.splitlines() if not line.startswith("velocity"))
    scene = read_text(
        still.replace(f'name = "bend"\nvalue = {TILT}', 'name = "bend"\nvalue = 0.0'), "still.toml"
    )
    modes = linearise(derive(require(scene)), library_of(scene)).modes
    M, _ = lagrange(0.0, 0.0, 0.0, 0.0)
    h = 1e-6
    K = -np.column_stack(
        [(lagrange(*(h * e), 0.0, 0.0)[1] - lagrange(*(-h * e), 0.0, 0.0)[1]) / (2 * h) for e in np.eye(2)]
    )
    wanted = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real))
    found = np.sort([mode.frequency for mode in modes])
    assert found == pytest.approx(wanted, rel=1e-8)


@pytest.mark.parametrize(
    ("kind", "keys", "told"),
    [
        ("revolute", "armature = -0.1", "armature"),
        ("planar", "armature = 0.1", "a list of 3"),
        ("weld", "armature = 0.1", "armature"),
        ("revolute", 'armature = 0.1\nmotion = "t"', "motion"),
    ],
)
def test_what_cannot_have_armature_is_refused(kind: str, keys: str, told: str) -> None:
    body = '[[body]]\nname = "a"\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\n'
    text = f'{body}[[joint]]\nkind = "{kind}"\nbetween = ["world", "a"]\n{keys}\n'
    with pytest.raises(SceneError, match=told):
        read_text(text, "refused.toml")


def test_a_plan_without_freedom_is_the_motion_of_the_run() -> None:
    scene = links()
    derivation, library = derive(require(scene)), library_of(scene)
    plan = Transcription(derivation, 0.2, 8, stages=4, impacts=False)
    guess = plan.guess(library)
    n_q, n_u = derivation.model.n_q, derivation.model.n_u
    plan.start_at(guess[:n_q], guess[n_q : n_q + n_u])
    found = plan.solve(guess, (1e-9,))
    path = simulate(library, until=0.2, samples=1, accuracy="tight", estimate=False)
    for body in derivation.model.bodies:
        if body.name in ("upper", "lower"):
            place = found.x[-1][body.q : body.q + 3]
            assert np.abs(place - path.p[-1, path.body_names.index(body.name)]).max() < 1e-9
