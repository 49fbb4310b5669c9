"""The formulas of every kind of joint, of its limits and of its springs, as `inspect` writes them."""

from __future__ import annotations

from math import prod

import pytest

from modelgen import derive, require
from modelgen.joint.joint_equations import FORMS
from modelgen.report.formula_list import OF_A_JOINT, formula_facts
from modelgen.report.kind_scenes import kind_scene
from modelgen.scene.joint_format import ARMATURE

MOTIONS = [f"{joint}:motion" for joint, form in FORMS.items() if form.given]
INERTIAL = [f"{joint}:armature" for joint in ARMATURE]


@pytest.mark.parametrize("kind", [*FORMS, *MOTIONS, *INERTIAL])
def test_every_entry_of_every_output_has_a_line(kind: str) -> None:
    facts = formula_facts(derive(require(kind_scene(kind))), None, "text", OF_A_JOINT)
    for formula in facts:
        names = [line["name"] for line in formula["definition"]]
        assert len(set(names)) == len(names)
        sizes = {port["name"]: prod(port["shape"]) for port in formula["outputs"]}
        assert len(names) >= sum(sizes.values())
        if "J" in sizes:
            entries = {
                f"J_{row + 1}_{side}_{k + 1}"
                for row in range(sizes["J"] // 12)
                for side in "ab"
                for k in range(6)
            }
            assert entries <= set(names)
