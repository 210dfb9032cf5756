"""A trade as csv."""

from __future__ import annotations

import os

from rbsdem._files import write_csv
from rbsdem._views import view_of
from rbsdem.methods.outcome import Trade

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
            row.setting.dt,
            row.setting.tolerance,
            row.setting.parts,
            row.seconds,
            row.repeats,
            row.response_rms,
            row.response_max,
            row.moment,
            row.energy,
            row.peak,
            row.error,
            row.move,
            int(row.pareto),
            row.status,
            row.reason,
        )
        for row in trade.rows
    ]
    write_csv(path, [COLUMNS, *rows])


@view_of(Trade, "physics_to_csv")
def write_physics(trade: Trade, path: str | os.PathLike[str]) -> None:
    """Write the effects of the parts of the model as csv."""
    effects = trade.physics.effects if trade.physics else ()
    rows = [
        (
            effect.part,
            effect.peak,
            effect.residual,
            effect.moment,
            effect.energy,
            effect.history,
            effect.time_ratio,
            "" if effect.matters is None else int(effect.matters),
            effect.status,
            effect.reason,
        )
        for effect in effects
    ]
    write_csv(path, [EFFECT_COLUMNS, *rows])
