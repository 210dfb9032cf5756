"""Packages that may be missing, and the message if one of them is needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def need_matplotlib() -> None:
    """Raise `ImportError` with the installation command if matplotlib is not installed."""
    _need("matplotlib", "figures need", "plot")


def need_pandas() -> Any:
    """Return pandas, or raise `ImportError` with the installation command."""
    return _need("pandas", "a DataFrame needs", "pandas")


def need_xarray() -> Any:
    """Return xarray, or raise `ImportError` with the installation command."""
    return _need("xarray", "netCDF and Datasets need", "netcdf")


def need_rich() -> Any:
    """Return rich, or raise `ImportError` with the installation command."""
    rich = _need("rich", "tables and progress need", "")
    for part in ("box", "progress", "table"):
        import_module(f"rich.{part}")
    return rich


def need_pyarrow() -> Any:
    """Return pyarrow, or raise `ImportError` with the installation command."""
    return _need("pyarrow", "Parquet needs", "ensembles")


def need_parquet() -> Any:
    """Return pyarrow.parquet, or raise `ImportError` with the installation command."""
    need_pyarrow()
    return import_module("pyarrow.parquet")


def need_shtab() -> Any:
    """Return shtab, or raise `ImportError` with the installation command."""
    return _need("shtab", "scripts of completion need", "completion")


def need_scipy(part: str) -> Any:
    """Return a part of scipy, or raise `ImportError` with the installation command."""
    _need("scipy", "the statistics of ensembles need", "ensembles")
    return import_module(f"scipy.{part}")


def _need(package: str, who: str, extra: str) -> Any:
    try:
        return import_module(package)
    except ImportError as error:
        what = f'"rbsdem[{extra}]"' if extra else package
        raise ImportError(f"{who} {package}, which is not installed: pip install {what}") from error


def console(width: int) -> Any:
    """Return the console of rich on standard output.

    Parameters
    ----------
    width : int
        Letters of a line where standard output is no terminal.
    """
    from rich.console import Console  # noqa: PLC0415

    class Terminal(Console):
        """A console whose reader may leave: what called it decides what that means."""

        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    out = Terminal(highlight=False)
    return out if out.is_terminal else Terminal(highlight=False, width=width)


def plain(text: str, **style: Any) -> Any:
    """Return a text of rich that has no markup, for words that come from outside.

    Parameters
    ----------
    text : str
        The words; what cannot be printed, such as the codes that steer a terminal, becomes "?".
    **style
        Of `rich.text.Text`.
    """
    from rich.text import Text  # noqa: PLC0415

    return Text("".join(c if c.isprintable() else "?" for c in text), **style)
