"""The README and the pages of the manual, and what they contain."""

from __future__ import annotations

import re
from pathlib import Path

from modelgen.cli.manual import FOLDER

ROOT = Path(__file__).parents[2]
MANUAL = FOLDER  # of the package that is tested, a wheel too
IMAGES = MANUAL / "images"
README = ROOT / "README.md"
PAGES = (README, *sorted(MANUAL.glob("*.md")))
EXAMPLES = tuple(path.stem for path in PAGES if path.stem.startswith("example_"))  # pages that are one script


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def blocks(path: Path, language: str) -> list[str]:
    """The code blocks of one language on a page."""
    found: list[str] = re.findall(rf"^```{language}\n(.*?)^```$", text_of(path), re.MULTILINE | re.DOTALL)
    return found


def prose(path: Path) -> str:
    """A page without its code blocks."""
    return re.sub(r"^```.*?^```$", "", text_of(path), flags=re.MULTILINE | re.DOTALL)


def links(path: Path) -> list[str]:
    """The targets of the links of a page."""
    return re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", prose(path)))


def anchors(path: Path) -> set[str]:
    """The anchors that the headings of a page have, as GitHub writes them."""
    titles = re.findall(r"^#+ (.*)$", prose(path), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
