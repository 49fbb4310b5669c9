"""Every shipped scene with what is expected of it: the one list that tests over scenes run over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from modelgen import read, require
from modelgen.codegen.library import Library
from modelgen.contact.form_table import regular_forms
from modelgen.scene.scene_types import Scene
from tests.registry_friction import WITH_FRICTION
from tests.running import SCENES, library_of
from tests.shipped import CURVE_ON_SURFACE, Shipped

REGISTRY: Mapping[str, Shipped] = {
    "ball_in_bowl": Shipped(
        kinds=("fixed", "point", "sphere_sphere_cavity_explicit"),
        forms=("explicit", "implicit", "centre_surface"),
        reference="oracles/test_closed_forms.py::test_a_ball_in_a_bowl_is_a_pendulum",
    ),
    "ball_in_torus": Shipped(
        kinds=("fixed", "point", "sphere_torus_cavity_centre_surface"),
        forms=("centre_surface", "implicit", "mixed"),
        reference="oracles/test_surface_routes.py::test_a_ball_in_a_torus_is_a_particle_on_a_torus",
        apart=1e-11,
    ),
    "ball_leaves_sphere": Shipped(
        kinds=("fixed", "point", "sphere_sphere_explicit"),
        forms=("explicit", "implicit", "centre_surface"),
        reference="oracles/test_closed_forms.py::test_a_ball_leaves_a_fixed_sphere_at_two_thirds_of_its_height",
        events={"lift-off": 1},
    ),
    "bean_with_poles": Shipped(
        kinds=("fixed", "free_full", "plane_chart_block", "plane_cap_block"),
        forms=("block", "paper", "differentiated", "mixed"),
        reference="oracles/test_surface_routes.py::test_a_pebble_that_passes_its_poles_follows_a_second_route",
        events={"feature-change": 2},
    ),
    "bicycle": Shipped(
        kinds=("fixed", "free_diagonal", "free_full", "plane_circle_support_slip", "revolute"),
        forms=("support", *CURVE_ON_SURFACE),
        reference="linearisation/test_bicycle.py::test_a_run_follows_the_published_equations",
    ),
    "bouncing_ball": Shipped(
        kinds=("fixed", "point", "plane_sphere_explicit"),
        forms=("explicit", "support", "implicit"),
        reference="oracles/test_closed_forms.py::test_a_bouncing_ball_follows_its_geometric_series",
        events={"impact": (43, 50), "touch-down": 1},
    ),
    "box_dropped": Shipped(
        kinds=("fixed", "free_diagonal", "plane_point_explicit"),
        forms=("explicit", "support"),
        reference="oracles/test_dropped.py::test_a_shipped_box_falls_on_the_corner_that_is_lowest",
        events={"touch-down": None, "lift-off": None, "face-contact": 1},
        drift=(1e-7, 1e-9, 1e-9),
        apart=1e-9,
    ),
    "coin_in_bowl": Shipped(
        kinds=("fixed", "free_diagonal", "paraboloid_circle_curve_implicit"),
        forms=CURVE_ON_SURFACE,
        reference="oracles/test_second_formulations.py::test_a_coin_in_a_bowl_follows_a_second_formulation",
    ),
    "cylinder_dropped": Shipped(
        kinds=("fixed", "free_diagonal", "plane_circle_support", "plane_point_explicit"),
        forms=("support", "explicit", *CURVE_ON_SURFACE),
        reference="oracles/test_dropped.py::test_a_shipped_cylinder_topples_from_one_rim_onto_both",
        events={"touch-down": 2},
        drift=(1e-5, 1e-9, 1e-11),
    ),
    "disc_on_rim": Shipped(
        kinds=("fixed", "free_diagonal", "plane_circle_support"),
        forms=("support", *CURVE_ON_SURFACE),
        reference="curves/test_scenes.py::test_a_disc_on_its_rim_is_a_heavy_symmetric_top_on_a_sliding_point",
    ),
    "double_pendulum": Shipped(
        kinds=("free_diagonal", "fixed", "revolute", "revolute_min", "revolute_max"),
        forms=(),
        reference="joints/test_linkages.py::"
        "test_a_double_pendulum_with_a_stop_follows_lagranges_equations_and_newtons_law",
        events={"impact": 4},
    ),
    "egg_on_spline": Shipped(
        kinds=("fixed", "free_diagonal", "ellipsoid_bezier_mixed"),
        forms=("mixed",),
        reference="oracles/test_surface_routes.py::test_an_egg_that_crosses_knots_follows_a_second_route",
        events={"feature-change": 12},
    ),
    "ellipsoid_in_cavity": Shipped(
        kinds=("fixed", "free_diagonal", "ellipsoid_ellipsoid_cavity_implicit"),
        forms=("implicit",),
        reference="oracles/test_second_routes.py::test_an_ellipsoid_in_a_cavity_follows_a_second_route",
    ),
    "ellipsoid_on_ellipsoid": Shipped(
        kinds=("fixed", "free_diagonal", "ellipsoid_ellipsoid_implicit"),
        forms=("implicit",),
        reference="oracles/test_second_routes.py::test_an_ellipsoid_slides_off_an_ellipsoid_as_on_a_second_route",
        events={"lift-off": 1},
    ),
    "ellipsoid_on_plane": Shipped(
        kinds=("fixed", "free_diagonal", "plane_ellipsoid_support"),
        forms=("support", "implicit"),
        reference="oracles/test_second_routes.py::test_an_ellipsoid_on_a_plane_follows_its_reference",
    ),
    "ellipsoids_in_bowl": Shipped(
        kinds=("fixed", "free_diagonal", "ellipsoid_paraboloid_implicit", "ellipsoid_ellipsoid_implicit"),
        forms=("implicit", "mixed"),
        reference="oracles/test_bowl.py::test_up_to_the_first_collision_each_stone_moves_as_if_alone",
        events={"touch-down": None, "lift-off": None},
        drift=(1e-6, 1e-9, 1e-9),
        apart=1e-9,
        reachable=4,
    ),
    "four_bar": Shipped(
        kinds=("free_diagonal", "fixed", "revolute"),
        forms=(),
        reference="joints/test_linkages.py::test_a_four_bar_linkage_follows_lagranges_equation_in_its_crank",
    ),
    "glass_on_table": Shipped(
        kinds=(
            *("fixed", "free_diagonal_loaded", "plane_circle_support", "plane_point_explicit", "force"),
            "torque",
        ),
        forms=("support", "explicit", *CURVE_ON_SURFACE),
        reference="planar/test_edges.py::test_the_shipped_glass_tips_when_its_force_and_torque_have_driven_the_pressure_to_the_rim",
        events={"face-contact": 1, "tipping": 1},
        margin=1e-5,
        apart=1e-8,
    ),
    "gears": Shipped(
        kinds=(
            *("free_diagonal", "free_diagonal_loaded", "fixed", "chart_curve_curve_block", "torque"),
            *("revolute_moved", "revolute"),
        ),
        forms=("curve_block", "curve_paper", "curve_differentiated"),
        reference="oracles/test_gears.py::test_two_gears_turn_at_the_ratio_of_their_teeth_under_load",
        events={"touch-down": 12, "appear": 24, "vanish": 24},
    ),
    "helix_on_cylinder": Shipped(
        kinds=("fixed", "free_diagonal", "cylinder_helix_curve_block"),
        forms=CURVE_ON_SURFACE,
        reference="oracles/test_second_formulations.py::test_a_helix_on_a_cylinder_follows_a_second_formulation",
    ),
    "linked_rings": Shipped(
        kinds=("fixed", "free_diagonal", "circle_circle_curves_block"),
        forms=("curves_block", "curves_differentiated"),
        reference="curves/test_scenes.py::test_linked_rings_swing_for_a_hundred_seconds",
    ),
    "slider_crank": Shipped(
        kinds=(
            *("free_diagonal", "free_isotropic", "free_isotropic_loaded", "fixed"),
            *("ellipsoid_circle_curve_implicit", "prismatic_spring", "revolute", "spherical", "prismatic"),
        ),
        forms=("curve_implicit",),
        reference="joints/test_linkages.py::"
        "test_a_slider_crank_with_a_cam_follower_follows_lagranges_equation_in_its_crank",
    ),
    "peg_in_hole": Shipped(
        kinds=(
            "fixed",
            "free_diagonal",
            "cylinder_cylinder_cavity_implicit",
            "cylinder_cavity_circle_curve_block",
        ),
        forms=("implicit", "block", "mixed", "paper", "differentiated", *CURVE_ON_SURFACE),
        reference="oracles/test_second_formulations.py::test_a_peg_in_a_hole_follows_a_second_formulation",
    ),
    "user_surface": Shipped(
        kinds=("fixed", "free_diagonal", "chart_chart_2_block"),
        forms=("block", "paper", "differentiated"),
        reference="oracles/test_second_routes.py::test_a_bean_on_a_wavy_sheet_follows_its_reference",
    ),
} | WITH_FRICTION


def _forms_of_contacts(scene: Scene) -> list[tuple[str, ...]]:
    """The regular forms of every pair of shapes that may touch, in the scene's order."""
    model = require(scene)
    forms = [regular_forms(kind.o, kind.f) for kind in model.contact_kinds]
    return [
        tuple(
            dict.fromkeys(
                form
                for feature_pair in model.feature_pairs[slice(*pair.feature_pairs)]
                for form in forms[feature_pair.kind]
            )
        )
        for pair in model.pairs
    ]


def forms_of(name: str) -> set[str]:
    """All forms that are regular for one of the contacts of a shipped scene."""
    return {form for forms in _forms_of_contacts(read(SCENES / f"{name}.toml")) for form in forms}


@cache
def forced(name: str, form: str) -> Library:
    """A shipped scene with one form on every contact for which it is regular, the chosen one elsewhere."""
    scene = read(SCENES / f"{name}.toml")
    fitting = zip(scene.contacts, _forms_of_contacts(scene), strict=True)
    contacts = tuple(replace(pair, form=form if form in forms else "auto") for pair, forms in fitting)
    return library_of(replace(scene, contacts=contacts))
