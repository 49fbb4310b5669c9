"""The site of the manual and the docstrings has every page and public name, and no broken link."""

from __future__ import annotations

import re
import subprocess
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import modelgen
from modelgen.cli.manual import TOPICS
from tests.docs.pages import MANUAL, ROOT, text_of


def test_the_contents_have_every_page_once() -> None:
    named = re.findall(r"^   (\w+)$", text_of(MANUAL / "index.rst"), re.MULTILINE)
    assert sorted(named) == sorted([*TOPICS, "reference"])


def test_the_reference_has_every_public_name_once() -> None:
    named = re.findall(r"^\.\. auto\w+:: modelgen\.(\w+)$", text_of(MANUAL / "reference.rst"), re.MULTILINE)
    assert sorted(set(named) - {"errors"}) == sorted(modelgen.__all__)
    assert len(named) == len(set(named))


@pytest.mark.slow
def test_the_site_builds_without_a_warning_or_a_broken_link(tmp_path: Path) -> None:
    for extra in ("sphinx", "myst_parser", "furo"):
        pytest.importorskip(extra, reason=f"{extra} is not installed (extra `docs`)")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-W",
        "-n",
        "-q",
        "-c",
        ".docs",
        "modelgen/manual",
        str(tmp_path),
    ]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    pages = sorted(tmp_path.rglob("*.html"))
    assert {path.stem for path in pages} >= {*TOPICS, "index", "reference"}
    assert not [
        f"{path.name}: {link}" for path in pages for link in parsed(path).links if is_broken(path, link)
    ]


class Page(HTMLParser):
    """The links of a page, and the places in it to which links may lead."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.append(value)
            elif name == "id" and value:
                self.places.add(value)


@cache
def parsed(path: Path) -> Page:
    return Page(text_of(path))


def is_broken(path: Path, link: str) -> bool:
    """Whether a link of a page within the site leads nowhere."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return False
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if not target.is_file():
        return True
    return bool(parts.fragment) and target.suffix == ".html" and parts.fragment not in parsed(target).places
