"""Sphinx configuration.

bash scripts/docs.sh
"""

import re
import subprocess
import sys
from importlib.metadata import version as installed_version
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
import key_tables

project = "rbsdem"
author = "the rbsdem authors"
project_copyright = author
version = release = installed_version("rbsdem")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build", "ford.md"]

myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]

napoleon_google_docstring = False
napoleon_numpy_docstring = True
napoleon_use_ivar = True
napoleon_preprocess_types = False

# The docstrings give types, with shapes and units.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
add_module_names = False

html_theme = "furo" if find_spec("furo") else "alabaster"
html_title = f"rbsdem {release}"
html_show_sphinx = False
html_static_path = ["_static"]
html_css_files = ["wide.css"]


def _split_names(*event) -> None:
    """Make entries of `a, b : type`, which napoleon does not take among attributes."""
    lines = event[-1]
    out: list[str] = []
    while lines:
        entry = re.fullmatch(r"(\w+(?:, \w+)+) : (.*)", lines[0])
        block = [lines.pop(0)]
        while entry and lines and lines[0].startswith(" "):
            block.append(lines.pop(0))
        for name in entry[1].split(", ") if entry else ():
            out += [f"{name} : {entry[2]}", *block[1:]]
        if not entry:
            out += block
    lines[:] = out


def _escape_bars(*event) -> None:
    """Keep |D_m| in a docstring from being taken for a substitution."""
    lines = event[-1]
    lines[:] = [re.sub(r"\|(\w+)\|", r"\\|\1\\|", line) for line in lines]


def _make_gallery(app) -> None:
    """Run the examples, whose pictures docs/gallery.md shows."""
    docs = Path(app.srcdir)
    subprocess.run(
        [sys.executable, docs.parent / "scripts" / "gallery.py", docs / "_gallery"], check=True
    )


def _fill_tables(app, page: str, source: list[str]) -> None:
    """Put the tables of the keys where a page has their marks."""
    if key_tables.BLOCK.search(source[0]):
        source[0] = key_tables.filled(source[0])


def setup(app) -> None:
    """Connect the above; the first comes before napoleon."""
    app.connect("builder-inited", _make_gallery)
    app.connect("source-read", _fill_tables)
    app.connect("autodoc-process-docstring", _split_names, priority=400)
    app.connect("autodoc-process-docstring", _escape_bars)
