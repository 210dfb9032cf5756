"""A trade as csv."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Sequence
from pathlib import Path

from rbsdem._views import view_of
from rbsdem.accuracy.outcome import Trade

COLUMNS = (
    "method",
    "events",
    "kinematics",
    "dt_s",
    "tolerance",
    "parts",
    "wall_time_s",
    "repeats",
    "response_rms",
    "response_max",
    "base_moment_rms",
    "energy",
    "peak",
    "error",
    "move_to_finer",
    "pareto",
    "status",
    "reason",
)

EFFECT_COLUMNS = (
    "part",
    "peak",
    "residual",
    "peak_base_moment",
    "energy",
    "response_rms",
    "wall_time_ratio",
    "matters",
    "status",
    "reason",
)


@view_of(Trade, "to_csv")
def write_settings(trade: Trade, path: str | os.PathLike[str]) -> None:
    """Write the settings as csv."""
    rows = [
        (
            row.setting.method,
            row.setting.events or "",
            row.setting.kinematics,
            *(_cell(v) for v in (row.setting.dt, row.setting.tolerance, row.setting.parts)),
            _cell(row.seconds),
            row.repeats,
            *(_cell(v) for v in (row.response_rms, row.response_max, row.moment, row.energy)),
            *(_cell(v) for v in (row.peak, row.error, row.move)),
            int(row.pareto),
            row.status,
            row.reason,
        )
        for row in trade.rows
    ]
    _write(path, COLUMNS, rows)


@view_of(Trade, "physics_to_csv")
def write_physics(trade: Trade, path: str | os.PathLike[str]) -> None:
    """Write the effects of the parts of the model as csv."""
    effects = trade.physics.effects if trade.physics else ()
    rows = [
        (
            effect.part,
            *(_cell(v) for v in (effect.peak, effect.residual, effect.moment, effect.energy)),
            *(_cell(v) for v in (effect.history, effect.time_ratio)),
            "" if effect.matters is None else int(effect.matters),
            effect.status,
            effect.reason,
        )
        for effect in effects
    ]
    _write(path, EFFECT_COLUMNS, rows)


def _write(path: str | os.PathLike[str], names: Sequence[str], rows: Sequence[tuple]) -> None:
    """Write a csv whole or not at all."""
    target = Path(path)
    partial = target.with_name(f"{target.name}.partial")
    with partial.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(rows)
    partial.replace(target)


def _cell(value: float | None) -> str:
    return "" if value is None or not math.isfinite(value) else f"{value:.6g}"
