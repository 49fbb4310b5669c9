"""`inspect`: the facts of a scene or of a kind of contact, and how they are written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from modelgen.derivation import Derivation
from modelgen.report.formula_list import OF_A_JOINT, OF_A_PAIR, Format, View, formula_facts
from modelgen.report.formula_page import page
from modelgen.report.formula_text_and_latex import STYLES
from modelgen.report.inputs_at_closest_points import ClosestInputs
from modelgen.report.kind_scenes import kind_scene
from modelgen.report.shape_and_errata_facts import errata_facts, shape_facts, singularity_facts
from modelgen.scene.scene_types import Scene

PAGE = 50  # configurations of a page, where nothing else is asked for


def inspected(
    source: str,
    scene: Scene | None,
    formula: str | None,
    style: Format,
    view: tuple[int, Mapping[str, Any], int | None],
    derive: Callable[[Scene], Derivation],
) -> dict[str, Any]:
    """The object of `inspect --json`; of a page with shapes, singularities and errata as well.

    `view` is the seed, the given inputs, and on how many configurations each status is computed, if at all.
    """
    seed, given, asked = view
    n = asked or (PAGE if style == "html" else 0)
    derivation = derive(scene or kind_scene(source))
    closest = ClosestInputs(derivation, derive, "" if scene else source) if given else None
    roles = () if scene else OF_A_JOINT if derivation.model.joints else OF_A_PAIR
    facts = {
        "source": source,
        "formulas": formula_facts(derivation, formula, style, roles, View(seed, given, n, closest)),
    }
    if style != "html":
        return facts
    shapes, singular = shape_facts(derivation, n, seed), singularity_facts(derivation)
    return {**facts, "shapes": shapes, "singularities": singular, "errata": errata_facts(n, seed)}


def written(facts: Mapping[str, Any], style: Format) -> str:
    """The facts as a text."""
    if style == "html":
        return page(str(facts["source"]), facts)
    return "\n\n".join(map(STYLES[style], facts["formulas"]))
