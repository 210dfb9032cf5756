"""Modules that draw and tabulate records register their functions when they are imported."""

# ruff: noqa: F401
from rbsdem.checks import code_comparison, code_values
from rbsdem.output import (
    band_views,
    calibration_view,
    code_figure,
    code_table,
    comparison_view,
    contact_sheet,
    ensemble_figure,
    ensemble_table,
    ensemble_tables,
    envelope_figure,
    gallery,
    interaction_figure,
    limit_state_figure,
    limit_state_table,
    methods_figure,
    methods_files,
    methods_table,
    motion_figure,
    peer_tables,
    section_figure,
    shear_figure,
    spread_figure,
)
