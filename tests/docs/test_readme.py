"""The README is short, and states what the tests of a clean clone need."""

from __future__ import annotations

import re

import pytest

from modelgen import __version__
from modelgen.cli.manual import TOPICS
from tests.docs.pages import MANUAL, README, ROOT, anchors, links, text_of


def test_the_readme_is_short() -> None:
    assert len(text_of(README).splitlines()) <= 200


def test_the_test_command_is_stated_once_for_ci() -> None:
    assert len(re.findall(r"^python3 -m venv .*-m pytest$", text_of(README), re.MULTILINE)) == 1


def test_the_readme_leads_to_every_page() -> None:
    missing = [topic for topic in TOPICS if f"(modelgen/manual/{topic}.md)" not in text_of(README)]
    assert not missing


def test_changelog_names_the_version() -> None:
    assert f"## {__version__}" in text_of(MANUAL / "changelog.md")
    assert f'version = "{__version__}"' in text_of(ROOT / "pyproject.toml")
    assert f"version: {__version__}\n" in text_of(ROOT / ".github" / "CITATION.cff")
    assert f"modelgen_contact-{__version__}-" in text_of(MANUAL / "first_steps.md")


@pytest.mark.parametrize("name", ["SECURITY", "CONTRIBUTING"])
def test_links_of_the_pages_for_hosts_lead_somewhere(name: str) -> None:
    page = ROOT / ".github" / f"{name}.md"
    targets = [link.partition("#") for link in links(page)]
    assert targets
    assert [path for path, *_ in targets if not (page.parent / path).is_file()] == []
    assert [at for path, _, at in targets if at and at not in anchors((page.parent / path).resolve())] == []
