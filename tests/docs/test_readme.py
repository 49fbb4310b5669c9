"""The README is short, and states what the tests of a clean clone need."""

from __future__ import annotations

import re

from modelgen import __version__
from modelgen.cli.manual import TOPICS
from tests.docs.pages import MANUAL, README, ROOT, text_of


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
