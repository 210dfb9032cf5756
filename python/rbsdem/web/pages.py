"""Files of the page, and pages that are one file: html, style, modules and results together."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

#: Modules that pages and reports share, each after those that it imports.
_SHARED = (
    "units.js", "chart.js", "fields.js", "section.js", "drawing.js", "panels.js", "history.js",
    "answers.js", "machine.js", "columns.js",
)  # fmt: skip
#: Modules of the page, and of a report of columns.
PAGE, REPORT = (*_SHARED, "frame.js", "main.js"), (*_SHARED, "report.js")

_KINDS = {"html": "html", "css": "css", "js": "javascript"}
TYPES = {ending: f"text/{kind}; charset=utf-8" for ending, kind in _KINDS.items()}

_IMPORT = re.compile(r"^import \{[^}]*\} from \"\./[a-z]+\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export ", re.MULTILINE)


def parts(page: str = "index.html", modules: Sequence[str] = PAGE) -> dict[str, bytes]:
    """Return the files of a page by their names."""
    folder = resources.files("rbsdem.web").joinpath("page")
    return {name: folder.joinpath(name).read_bytes() for name in (page, "page.css", *modules)}


def one_file(
    title: str,
    data: Mapping[str, Any] | None,
    modules: Sequence[str] = REPORT,
    sheets: tuple[str, str] = ("", ""),
) -> str:
    """Return a page with its style, its modules and its results inside.

    It uses no network: its policy allows only the script and the style that are in it.

    Parameters
    ----------
    title : str
        Title of the document.
    data : mapping or None
        Answers of the server that the page needs.
    modules : sequence of str, optional
        `REPORT`, or none for a page of sheets.
    sheets : tuple of str, optional
        Html that stands before and behind what the modules draw.
    """
    name = "index.html" if modules else "report.html"
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
    before, behind = (f'<div class="sheets">{html}</div>\n' if html else "" for html in sheets)
    for old, new in (
        ("<main", f"{before}<main"),
        ("</main>\n", f"</main>\n{behind}"),
        ("<title>rbsdem</title>", f"<title>{plain(title)}</title>"),
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
    """Return the digest by which the policy of a page allows a script or a style."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def plain(text: str) -> str:
    """Return a text for html."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
