"""The site of the manual and of the public docstrings, by Sphinx (modelgen/manual/development.md)."""

from __future__ import annotations

from sphinx.ext.napoleon import Config
from sphinx.ext.napoleon.docstring import GoogleDocstring

from modelgen import __version__

project = "modelgen"
author = "The modelgen authors"
project_copyright = author
release = version = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = f"modelgen {version}"
myst_heading_anchors = 3  # levels of headings that links may name

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
default_role = "code"  # what stands between single backquotes in docstrings
nitpick_ignore_regex = [  # types that the site does not document: those of others, and names for annotations
    ("py:class", r"(casadi|collections|numpy|os|pathlib|typing)\..*"),
    ("py:class", r"modelgen\.(importing\.importing\.Chosen|runtime\.settings\.Stepping)"),
]

SECTIONS = Config(
    napoleon_custom_sections=["Returns"],  # prose, which does not begin with a type
    napoleon_use_ivar=True,
    napoleon_attr_annotations=False,
)
MADE_BY_USERS = ("modelgen.Accuracy",)  # other classes are what functions return: no one calls them


def docstring_as_rst(app, kind, name, documented, options, lines) -> None:
    """Sections of a docstring as fields; bars are those of absolute values."""
    lines[:] = [line.replace("|", r"\|") for line in lines]
    if kind not in ("attribute", "property"):
        lines[:] = GoogleDocstring(lines, SECTIONS, app, kind, name, documented, options).lines()


def without_constructor(app, kind, name, documented, options, signature, returned) -> tuple[str, str] | None:
    return ("", "") if kind == "class" and name not in MADE_BY_USERS else None


def setup(app) -> None:
    app.connect("autodoc-process-docstring", docstring_as_rst)
    app.connect("autodoc-process-signature", without_constructor)
