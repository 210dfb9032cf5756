"""The files of the page, read once; and all of them as one file, for a report."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

#: Modules of the page, each after those that it imports.
MODULES = (
    "units.js",
    "chart.js",
    "fields.js",
    "drawing.js",
    "panels.js",
    "history.js",
    "answers.js",
    "main.js",
)

#: Modules of the page of all tests.
GALLERY = ("units.js", "chart.js", "fields.js", "panels.js", "gallery.js")

TYPES = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
}

_IMPORT = re.compile(r"^import \{[^}]*\} from \"\./[a-z]+\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export ", re.MULTILINE)


def parts(page: str = "index.html", modules: Sequence[str] = MODULES) -> dict[str, bytes]:
    """Return the files of a page by their names."""
    folder = resources.files("rbsdem.web").joinpath("page")
    return {name: folder.joinpath(name).read_bytes() for name in (page, "page.css", *modules)}


def one_file(title: str, data: Mapping[str, Any], modules: Sequence[str] = MODULES) -> str:
    """Return a page with its style, its modules and its results inside.

    It asks nothing of a network: its policy allows only the script and the style that are in it.

    Parameters
    ----------
    title : str
        Title of the document.
    data : mapping
        What the page would have got from the server.
    modules : sequence of str, optional
        `MODULES` or `GALLERY`.
    """
    name = "gallery.html" if modules is GALLERY else "index.html"
    files = {key: raw.decode("utf-8") for key, raw in parts(name, modules).items()}
    script = "\n".join(_EXPORT.sub("", _IMPORT.sub("", files[module])) for module in modules)
    style = files["page.css"]
    policy = (
        f"default-src 'none'; script-src '{_digest(script)}'; style-src '{_digest(style)}'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    # In JSON "<" stands only in texts, where it can be written so that no tag ends.
    packed = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    page = files[name]
    for old, new in (
        ("<title>rbsdem</title>", f"<title>{_plain(title)}</title>"),
        (
            '<link rel="stylesheet" href="page.css">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
            f"<style>{style}</style>",
        ),
        (
            '<script type="module" src="main.js"></script>',
            f'<script type="application/json" id="report">{packed}</script>\n'
            f'<script type="module">{script}</script>',
        ),
    ):
        if page.count(old) != 1:
            raise AssertionError(old)
        page = page.replace(old, new)
    return page


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _plain(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
