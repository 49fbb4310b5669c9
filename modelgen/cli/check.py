"""The command `check`: what a scene requires."""

from __future__ import annotations

from rich.console import Console

from modelgen.cli.options import AsJson, Brief, Form, SceneFile
from modelgen.cli.output import print_facts
from modelgen.cli.pipeline import derive_scene, read_scene


def check(scene: SceneFile, form: Form = None, brief: Brief = False, as_json: AsJson = False) -> None:
    """Say what a scene requires: kinds, forms, instruction counts, what leaving things out saves. Compiles
    nothing."""
    from modelgen.report.check import check_facts, print_check
    from modelgen.report.savings_by_decision import savings_of

    derivation = derive_scene(read_scene(scene, form))
    facts = check_facts(derivation)
    if not brief:
        facts["savings"] = [saving.as_json() for saving in savings_of(derivation)]
    print_facts(facts, as_json, lambda: print_check(facts, Console()))
