"""Make the pictures of docs/gallery.md by running the examples.

    python scripts/gallery.py [FOLDER]

Every example runs as it stands in a scratch folder; of the figures that it writes those that the
page names are kept in FOLDER (docs/_gallery), at most 1000 pixels wide. The build of the pages
calls this, so that a picture is that of the program beside it.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "gallery.md"
WIDTH = 1000

#: A picture of the page: example and figure, as _gallery/07-blind_blind.png.
PICTURE = re.compile(r"\(_gallery/(\d\d-[a-z0-9-]+)_(\w+)\.png\)")


def pictures() -> dict[str, list[str]]:
    """Return the figures that the page names, by example."""
    found: dict[str, list[str]] = {}
    for example, figure in PICTURE.findall(PAGE.read_text(encoding="utf-8")):
        found.setdefault(example, []).append(figure)
    return found


def run(example: str, folder: Path) -> None:
    """Run the scripts of an example in a folder."""
    for script in sorted((ROOT / "examples" / example).glob("*.py")):
        done = subprocess.run(
            [sys.executable, script],
            cwd=folder,
            env=os.environ | {"MPLBACKEND": "Agg"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise SystemExit(f"{script}: exit code {done.returncode}\n{done.stderr[-2000:]}")


def keep(source: Path, target: Path) -> None:
    """Write a picture again, not wider than the page, in the grays and colours it has."""
    with Image.open(source) as image:
        drawn = image.convert("RGB")
        if drawn.width > WIDTH:
            size = WIDTH, round(drawn.height * WIDTH / drawn.width)
            drawn = drawn.resize(size, Image.Resampling.LANCZOS)
        drawn.quantize(64).save(target, optimize=True)


def make(target: Path) -> None:
    """Run the examples that the page names, and keep its pictures."""
    target.mkdir(parents=True, exist_ok=True)
    for example, figures in pictures().items():
        with tempfile.TemporaryDirectory() as folder:
            run(example, Path(folder))
            written = {path.stem: path for path in Path(folder).rglob("*.png")}
            for figure in figures:
                if figure not in written:
                    raise SystemExit(f"docs/gallery.md: {example} writes no {figure}.png")
                keep(written[figure], target / f"{example}_{figure}.png")


if __name__ == "__main__":
    make(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "_gallery")
