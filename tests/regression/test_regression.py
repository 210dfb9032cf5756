"""Whole cases through the executable against stored rows.

A stored result shows only that nothing has changed: that these analyses are right is proved by
closed forms, balances and independent methods in the other tests. Each `NN-name.nml` must give the
rows of `NN-name.csv` to 1e-9: every fifth, and the last, whose energies add up all before. What is
meant to change is stored anew by RBSDEM_UPDATE=1 python -m pytest tests/regression.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from rbsdem import __main__ as command

HERE = Path(__file__).parent
CASES = sorted(path.stem for path in HERE.glob("*.nml"))


def read_rows(path: Path) -> dict[str, np.ndarray]:
    lines = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
    table = np.array([[float(word) for word in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), table.T, strict=True))


@pytest.mark.parametrize("name", CASES)
def test_rows_are_those_stored(name: str, tmp_path: Path) -> None:
    program = Path(os.environ.get("RBSDEM_EXECUTABLE") or command.executable()).absolute()
    result = subprocess.run(
        [program, "run", HERE / f"{name}.nml", "--quiet", "--output", tmp_path / "rows.csv"],
        capture_output=True, text=True, timeout=20, check=False,
    )  # fmt: skip
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    if os.environ.get("RBSDEM_UPDATE"):
        lines = (tmp_path / "rows.csv").read_text("utf-8").splitlines()
        kept = [*lines[:4], *lines[4:-1:5], lines[-1], ""]
        (HERE / f"{name}.csv").write_text("\n".join(kept))
    got, stored = read_rows(tmp_path / "rows.csv"), read_rows(HERE / f"{name}.csv")
    assert list(got) == list(stored)
    size = len(next(iter(got.values())))
    kept = sorted({*range(0, size, 5), size - 1})
    energy = max(np.max(np.abs(stored[f"{kind}_J"])) for kind in ("input", "spring"))
    for label, values in stored.items():
        # What round-off leaves where a zero should be is not stored knowledge.
        scale = energy if label.endswith("_J") else np.max(np.abs(values))
        np.testing.assert_allclose(
            got[label][kept], values, rtol=1e-9, atol=1e-9 * scale, err_msg=label
        )
