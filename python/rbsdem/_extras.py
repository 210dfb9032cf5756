"""Packages of the extras, which may be missing."""

from __future__ import annotations

from importlib import import_module
from typing import Any

#: Extra of each package.
_EXTRAS = {"pyarrow": "ensembles", "xarray": "netcdf", "distributed": "cluster"}


def extra(module: str) -> Any:
    """Return a module of an extra, or raise `ImportError` with the installation command."""
    package = module.partition(".")[0]
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(
            f'{package} is not installed: pip install "rbsdem[{_EXTRAS[package]}]"'
        ) from error
