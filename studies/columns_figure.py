"""Draw docs/columns.png: the four columns, predicted from their drawings and as in the paper.

python studies/columns_figure.py FOLDER

It is the first figure of the main job, examples/01-paper-columns, at the resolution of a page.
FOLDER has the full histories.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import rbsdem
from rbsdem.plot import style

ROOT = Path(__file__).resolve().parents[1]


def main_job() -> ModuleType:
    """Return the example that runs the four columns, as a module."""
    path = ROOT / "examples" / "01-paper-columns" / "run.py"
    spec = importlib.util.spec_from_file_location("main_job", path)
    if spec is None or spec.loader is None:
        raise ImportError(path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["main_job"] = module  # its dataclasses ask for it
    spec.loader.exec_module(module)
    return module


def main() -> None:
    """Compute and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    job = main_job()
    drawn, paper = {}, {}
    for key, column in rbsdem.peer.paper_columns().items():
        drive = job.read(key, given.folder)
        drawn[key], _ = job.from_drawing(drive, rbsdem.peer.paper_sections()[key])
        paper[key], _ = job.by_force(drive, column, job.ROW_TIME)
    with style():
        job.both_models(drawn, paper).savefig(ROOT / "docs" / "columns.png", dpi=130)


if __name__ == "__main__":
    main()
