"""What require leaves in the Model is what the scene needs, and no more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modelgen import require
from modelgen.errors import SceneError
from modelgen.model import Model
from modelgen.rotations import rotation_of
from modelgen.scene.read import read_text
from tests.model.scenes import TABLE, WIDE, ball, ball_on_table, contact, egg, scene
from tests.running import SCENES


def motion(model: Model, name: str) -> str:
    entry = next(body for body in model.bodies if body.name == name)
    return model.body_kinds[entry.kind].motion


def test_equal_structure_is_one_kind_whatever_the_numbers() -> None:
    eggs = [egg("a"), egg("b", "[0.3, 0.2, 0.1]", "density = 700.0")]
    model = require(scene(TABLE, *eggs, contact("a", "table"), contact("b", "table")))
    assert len(model.contact_kinds) == 1
    assert len(model.shape_kinds) == 2  # ellipsoid and plane
    assert [kind.motion for kind in model.body_kinds] == ["fixed", "free"]
    assert model.feature_pairs[0].parameters != model.feature_pairs[1].parameters


def test_kinds_have_names_of_their_own() -> None:
    for kinds in (require(WIDE).body_kinds, require(WIDE).contact_kinds, require(WIDE).load_kinds):
        assert len({kind.name for kind in kinds}) == len(kinds)
        assert all(kind.name.isidentifier() for kind in kinds)


def test_folded_numbers_leave_no_parameters_and_split_kinds() -> None:
    parts = (TABLE, egg("a"), egg("b", "[0.3, 0.2, 0.1]"), contact("a", "table"), contact("b", "table"))
    model = require(replace(scene(*parts), fold=True))
    assert len(model.contact_kinds) == 2
    assert all(entry.parameters == () for entry in model.feature_pairs)
    assert all(body.parameters == () for body in model.bodies if body.name != "table")


def test_order_in_the_file_changes_only_the_flag() -> None:
    one, other = (
        require(scene(TABLE, egg(), contact(*pair))) for pair in (("egg", "table"), ("table", "egg"))
    )
    assert one.contact_kinds == other.contact_kinds
    assert (one.feature_pairs[0].o, one.feature_pairs[0].f) == (
        other.feature_pairs[0].o,
        other.feature_pairs[0].f,
    )
    assert one.feature_pairs[0].swapped != other.feature_pairs[0].swapped


PUSH = '[[force]]\nbody = "ball"\n'
HOLD = '[[spring]]\nbetween = ["table", "ball"]\nstiffness = 1\n'
FREE = [
    ("off its centre", {"shape": ", position = [0.0, 0.0, 0.01]", "more": "mass = 1.0\ninertia = [1, 1, 1]"}),
    ("spinning", {"more": "density = 1.0\nangular_velocity = [0.0, 0.0, 1.0]"}),
    ("under a torque", {"load": '[[torque]]\nbody = "ball"\ntorque = ["0", "0", "1"]'}),
    ("pushed off its centre", {"load": PUSH + 'force = ["1", "0", "0"]\npoint = [0, 0.1, 0]'}),
    ("pushed in body axes", {"load": PUSH + 'force = ["1", "0", "0"]\nframe = "body"'}),
    ("pushed by its spin", {"load": PUSH + 'force = ["wx", "0", "0"]'}),
    ("held off its centre", {"load": HOLD + "anchors = [[0, 0, 0], [0, 0, 0.1]]"}),
    ("observed", {"head": 'observe = ["ball.orientation"]'}),
]  # fmt: skip
POINT = [
    ("alone", {}),
    ("displaced with its centre of mass", {"shape": ", position = [0.1, 0.2, 0.3]"}),
    ("pushed at its centre", {"load": PUSH + 'force = ["t*vx", "x", "0"]'}),
    ("held at its centre", {"load": HOLD}),
    ("spinning unobserved", {
        "more": "density = 1.0\nangular_velocity = [0, 0, 1.0]", "head": 'observe = ["ball.position"]',
    }),
]  # fmt: skip


@pytest.mark.parametrize(("why", "parts"), FREE, ids=[why for why, _ in FREE])
def test_a_ball_keeps_its_orientation_when_it_is(why: str, parts: dict[str, str]) -> None:
    assert motion(require(ball_on_table(**parts)), "ball") == "free"


@pytest.mark.parametrize(("why", "parts"), POINT, ids=[why for why, _ in POINT])
def test_a_ball_needs_no_orientation_when_it_is(why: str, parts: dict[str, str]) -> None:
    model = require(ball_on_table(**parts))
    assert motion(model, "ball") == "point"
    assert (model.n_q, model.n_u) == (3, 3)
    assert [sentence.split(":")[0] for sentence in model.left_out] == ["ball"]


@pytest.mark.parametrize(
    ("inertia", "kind"),
    [
        ("[0.1, 0.1, 0.1]", "isotropic"),
        ("[0.1, 0.1, 0.12]", "diagonal"),
        ("[[0.1, 0.01, 0], [0.01, 0.1, 0], [0, 0, 0.1]]", "full"),
    ],
)
def test_inertia_is_as_general_as_its_numbers(inertia: str, kind: str) -> None:
    model = require(scene(TABLE, egg(more=f"mass = 1.0\ninertia = {inertia}"), contact("egg", "table")))
    assert model.body_kinds[1].inertia == kind
    body = model.bodies[1]
    numbers = body.parameters[1:]
    full = {1: numbers * 3 + (0, 0, 0), 3: (*numbers, 0, 0, 0), 6: numbers}[len(numbers)]
    xx, yy, zz, xy, xz, yz = full
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    inverse = np.reshape(body.mass_inverse[1:], (3, 3), order="F")
    np.testing.assert_allclose(inverse @ matrix, np.eye(3), atol=1e-14)


def test_density_gives_the_solid_ellipsoid() -> None:
    model = require(scene(TABLE, egg(), contact("egg", "table")))
    a, b, c = 0.12, 0.09, 0.07
    m = 1000 * 4 / 3 * np.pi * a * b * c
    expected = (m, m * (b * b + c * c) / 5, m * (a * a + c * c) / 5, m * (a * a + b * b) / 5)
    assert model.body_kinds[1].inertia == "diagonal"
    np.testing.assert_allclose(model.bodies[1].parameters, expected, rtol=1e-12)


def test_two_balls_balance_at_their_common_centre() -> None:
    shapes = ", ".join(f'{{ kind = "sphere", radius = 0.1, position = [{x}, 0, 0], name = "{n}" }}'
                       for n, x in (("left", 0.1), ("right", 0.5)))  # fmt: skip
    dumbbell = f'[[body]]\nname = "pair"\nshape = [{shapes}]\ndensity = 1000.0\nposition = [1.0, 0, 0]\n'
    touch = contact("pair/left", "table") + contact("pair/right", "table")
    model = require(scene(TABLE, dumbbell, touch))
    m = 1000 * 4 / 3 * np.pi * 0.1**3
    about_x, about_y = 2 * 0.4 * m * 0.01, 2 * (0.4 * m * 0.01 + m * 0.2**2)
    np.testing.assert_allclose(model.bodies[1].centre_of_mass, (0.3, 0, 0), atol=1e-15)
    np.testing.assert_allclose(model.initial_q[:3], (1.3, 0, 0), rtol=1e-14)
    np.testing.assert_allclose(model.bodies[1].parameters, (2 * m, about_x, about_y, about_y), rtol=1e-12)
    np.testing.assert_allclose(
        [entry.parameters[1] for entry in model.feature_pairs], (-0.2, 0.2), rtol=1e-13
    )
    assert [entry.name for entry in model.contacts] == ["pair/left-table/plane", "pair/right-table/plane"]


def test_initial_spin_is_in_body_axes_and_position_is_of_the_centre_of_mass() -> None:
    turn = "axis_angle = { axis = [1.0, 2.0, 3.0], angle = 0.7 }"
    more = f"mass = 1.0\ninertia = [1.0, 1.1, 1.2]\n{turn}\nposition = [1.0, 2.0, 3.0]\n"
    more += "center_of_mass = [0.1, 0.2, 0.3]\nangular_velocity = [0.4, 0.5, 0.6]"
    made = scene(TABLE, egg(more=more), contact("egg", "table"))
    model, R = require(made), rotation_of(made.bodies[1].pose.quaternion)
    np.testing.assert_allclose(model.initial_q[:3], np.array([1, 2, 3]) + R @ [0.1, 0.2, 0.3], rtol=1e-15)
    np.testing.assert_allclose(R @ np.array(model.initial_u[3:]), (0.4, 0.5, 0.6), rtol=1e-14)
    assert model.feature_pairs[0].parameters[3:6] == (-0.1, -0.2, -0.3)


def test_a_fixed_body_at_the_origin_has_no_pose() -> None:
    poses = [require(scene(TABLE + at, egg(), contact("egg", "table"))).contact_kinds[0].o.pose
             for at in ("", "position = [0.0, 0.0, 0.1]\n")]  # fmt: skip
    assert poses == ["identity", "general"]


def test_scales_follow_the_smallest_body_the_largest_mass_and_gravity() -> None:
    model = require(WIDE)
    assert model.scales.length == 0.1
    assert model.scales.mass == max(body.parameters[0] for body in model.bodies if body.mass_inverse[0])
    assert model.scales.time == pytest.approx((0.1 / 9.81) ** 0.5, rel=1e-15)


def test_without_gravity_time_is_length_over_speed() -> None:
    made = ball_on_table(more="density = 1.0\nvelocity = [0.0, 0.0, 4.0]", head="gravity = [0, 0, 0]")
    assert require(made).scales.time == pytest.approx(0.1 / 4.0)


def test_a_form_that_does_not_apply_is_refused_with_those_that_do() -> None:
    made = scene(TABLE, egg(), contact("egg", "table", 'form = "explicit"'))
    with pytest.raises(
        SceneError, match=r"test.toml: contact\[0\].form: .*'explicit'.*plane.*ellipsoid.*support"
    ):
        require(made)


def test_forced_forms_are_taken() -> None:
    made = scene(TABLE, egg(), contact("egg", "table", 'form = "implicit"'))
    assert [kind.form for kind in require(made).contact_kinds] == ["implicit"]


@pytest.mark.parametrize("name", ["ball.colour", "ball-table.colour", "bowl.position"])
def test_unknown_observed_names_are_refused(name: str) -> None:
    with pytest.raises(SceneError, match=r"observe\[0\].*no quantity"):
        require(replace(ball_on_table(), observe=(name,)))


@pytest.mark.parametrize("name", ["elbow.coordinates", "elbow.torque", "elbow:min.force", "lower.position"])
def test_quantities_of_joints_and_their_limits_can_be_observed(name: str) -> None:
    text = (SCENES / "double_pendulum.toml").read_text(encoding="utf-8")
    made = require(read_text(f'observe = ["{name}"]\n{text}', "pendulum.toml"))
    assert [made.body_kinds[body.kind].motion for body in made.bodies if body.name == "lower"] == ["free"]


@pytest.mark.parametrize(
    ("name", "words"),
    [("elbow.angle", "no quantity 'elbow.angle'"), ("shoulder:min.gap", "no quantity"),
     ("elbo.force", "no body named 'elbo'.*did you mean 'elbow'")],
)  # fmt: skip
def test_unknown_quantities_of_joints_are_refused(name: str, words: str) -> None:
    text = (SCENES / "double_pendulum.toml").read_text(encoding="utf-8")
    with pytest.raises(SceneError, match=words):
        require(read_text(f'observe = ["{name}"]\n{text}', "pendulum.toml"))


def test_contact_quantities_can_be_observed() -> None:
    assert motion(require(replace(ball_on_table(), observe=("ball-table.force",))), "ball") == "point"


def test_a_turning_body_without_inertia_is_refused() -> None:
    made = scene(TABLE, egg(), contact("egg", "table"))
    bare = replace(made, bodies=(made.bodies[0], replace(made.bodies[1], density=None, mass=1.0)))
    with pytest.raises(SceneError, match=r"body\[1\].*no inertia"):
        require(bare)


def test_an_open_shape_has_no_density() -> None:
    made = scene(TABLE, ball(), contact("ball", "table"))
    sheet = replace(made.bodies[1], shapes=made.bodies[0].shapes)
    with pytest.raises(SceneError, match=r"body\[1\].*no finite volume"):
        require(replace(made, bodies=(made.bodies[0], sheet), contacts=()))
