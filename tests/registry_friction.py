"""The shipped scenes with friction and with blows at several contacts: part of the registry."""

from __future__ import annotations

from collections.abc import Mapping

from tests.shipped import CURVE_ON_SURFACE, Shipped

ON_A_FACE = ("plane_point_explicit", "plane_point_explicit_spin")  # of the points that hold a face

WITH_FRICTION: Mapping[str, Shipped] = {
    "balancing_wheel": Shipped(
        kinds=(
            "fixed",
            "free_diagonal_loaded",
            "plane_torus_support_slip",
            "revolute_actuator",
            "planar",
            "revolute",
        ),
        forms=("support", "implicit", "block", "paper", "differentiated", "mixed"),
        reference="runtime/test_driven_runs.py::"
        "test_a_balancing_wheel_under_sampled_feedback_follows_lagranges_equations",
    ),
    "block_on_incline": Shipped(
        kinds=("fixed", "free_diagonal_loaded", "plane_point_explicit_slip", *ON_A_FACE, "force"),
        forms=("explicit", "support"),
        reference="oracles/friction/test_sliding_scenes.py::test_a_block_slips_when_it_is_pulled_hard_enough",
        events={"face-contact": 1, "slip-start": 1},
        apart=1e-9,
        single=1e-3,
        reachable=10,
    ),
    "bouncing_ellipsoid": Shipped(
        kinds=("fixed", "free_diagonal", "plane_ellipsoid_support_slip"),
        forms=("support", "implicit"),
        reference="oracles/friction/test_bouncing_scenes.py::test_a_bouncing_ellipsoid_follows_its_reference",
        events={"impact": 7},
        apart=1e-10,
    ),
    "brake_shoe": Shipped(
        kinds=(
            "driven",
            "free_isotropic_loaded",
            "fixed",
            "plane_sphere_implicit_slip",
            "torque",
            "revolute",
        ),
        forms=("explicit", "support", "implicit"),
        reference="oracles/friction/test_machine_scenes.py::"
        "test_a_brake_shoe_is_pressed_on_by_its_friction_and_off_again",
        events={"slip-reversal": 4},
        drift=(1e-4, 1e-9, 1e-10),
    ),
    "coin": Shipped(
        kinds=("fixed", "free_diagonal", "plane_circle_support_spin"),
        forms=("support", *CURVE_ON_SURFACE),
        reference="oracles/friction/test_coin_scene.py::test_a_coin_settles_as_its_reference",
        apart=1e-10,
        drift=(1e-3, 1e-8, 1e-11),
    ),
    "cube_toss": Shipped(
        kinds=("fixed", "free_isotropic", "plane_point_explicit_slip", *ON_A_FACE),
        forms=("explicit", "support"),
        reference="oracles/friction/test_bouncing_scenes.py::test_a_cube_toss_goes_as_measured",
        events={"impact": None, "touch-down": None, "lift-off": None, "face-contact": 1},
        apart=1e-8,
        single=5e-4,
        reachable=8,
    ),
    "gripper": Shipped(
        kinds=(
            *("driven", "driven_2", "free_isotropic_loaded", "free_diagonal"),
            *("plane_ellipsoid_implicit_slip", "plane_ellipsoid_implicit_slip_2", "force", "prismatic"),
        ),
        forms=("support", "implicit"),
        reference="oracles/friction/test_machine_scenes.py::test_a_gripper_rolls_an_egg_in_place",
        drift=(1e-3, 1e-8, 1e-10),
    ),
    "newton_cradle": Shipped(
        kinds=("free_isotropic", "fixed", "sphere_sphere_explicit", "revolute"),
        forms=("explicit", "implicit", "centre_surface"),
        reference="oracles/friction/test_bouncing_scenes.py::"
        "test_a_newton_cradle_follows_pendulums_that_strike",
        events={"impact": 16},
    ),
    "painleve_rod": Shipped(
        kinds=("fixed", "free_diagonal", "plane_point_explicit_slip"),
        forms=("explicit", "support"),
        reference="oracles/friction/test_painleve.py::"
        "test_the_shipped_rod_is_stopped_by_a_blow_and_turns_about_its_tip",
        events=dict.fromkeys(("fallback-start", "fallback-end", "lift-off"), 1)
        | dict.fromkeys(("slip-stop", "touch-down")),
        drift=(1e-4, 1e-4, 1e-4),
        loose=100.0,
        single=1e-3,
    ),
    "rattleback": Shipped(
        kinds=("fixed", "free_full", "plane_ellipsoid_support_slip"),
        forms=("support", "implicit"),
        reference="oracles/friction/test_top_scenes.py::test_a_rattleback_turns_back_as_its_reference",
        drift=(1e-4, 1e-8, 1e-11),
    ),
    "rolling_disc": Shipped(
        kinds=("fixed", "free_diagonal", "plane_circle_support_slip"),
        forms=("support", *CURVE_ON_SURFACE),
        reference="oracles/friction/test_rolling_scenes.py::test_a_coin_rolls_as_published",
    ),
    "rolling_ellipsoid": Shipped(
        kinds=("fixed", "free_diagonal", "plane_ellipsoid_support_slip"),
        forms=("support", "implicit"),
        reference="oracles/friction/test_rolling_scenes.py::test_a_passive_ellipsoid_rolls_as_its_reference",
    ),
    "sliding_puck": Shipped(
        kinds=(
            "fixed",
            "free_diagonal",
            "plane_circle_support_slip",
            "plane_point_explicit_slip",
            *ON_A_FACE,
        ),
        forms=("explicit", "support", *CURVE_ON_SURFACE),
        reference="oracles/friction/test_puck.py::test_a_sliding_puck_follows_its_reference",
        events={"face-contact": 1, "slip-stop": 1},
    ),
    "sphere_slide_to_roll": Shipped(
        kinds=("fixed", "free_isotropic", "plane_sphere_explicit_slip"),
        forms=("explicit", "support", "implicit"),
        reference="oracles/friction/test_sliding_scenes.py::test_a_ball_comes_to_roll_as_published",
        events={"slip-stop": 1},
    ),
    "spinning_egg": Shipped(
        kinds=("fixed", "free_diagonal", "plane_ellipsoid_support_slip"),
        forms=("support", "implicit"),
        reference="oracles/friction/test_top_scenes.py::test_a_spinning_egg_rises_as_its_reference",
    ),
    "tippe_top": Shipped(
        kinds=("fixed", "free_diagonal", "plane_sphere_explicit_slip"),
        forms=("explicit", "support", "implicit"),
        reference="oracles/friction/test_top_scenes.py::test_a_tippe_top_turns_over_as_its_reference",
        events={"slip-stop": 1},
    ),
    "turntable": Shipped(
        kinds=("driven", "free_isotropic", "plane_sphere_explicit_slip"),
        forms=("explicit", "support", "implicit"),
        reference="oracles/friction/test_rolling_scenes.py::"
        "test_a_ball_on_a_turntable_goes_round_a_circle_of_its_own",
        apart=1e-11,
    ),
    "wheel_on_rail": Shipped(
        kinds=("fixed", "free_diagonal", "bezier_chart_block_slip", "bezier_circle_curve_block_slip"),
        forms=("block", "paper", "differentiated"),
        reference="oracles/friction/test_machine_scenes.py::"
        "test_a_wheel_on_rail_follows_a_second_formulation",
        events={"feature-change": 1},
    ),
}
