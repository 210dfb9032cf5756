"""Packages that may be missing, and the message if one of them is needed."""

from __future__ import annotations

from typing import Any


def need_matplotlib() -> None:
    """Raise `ImportError` with the installation command if matplotlib is not installed."""
    try:
        import matplotlib  # noqa: PLC0415
    except ImportError as error:
        raise ImportError(
            "plots need matplotlib, which is not installed: pip install rbsdem[plot]"
        ) from error
    del matplotlib


def need_rich() -> Any:
    """Return rich, or raise `ImportError` with the installation command."""
    try:
        import rich.box  # noqa: PLC0415
        import rich.progress  # noqa: PLC0415
        import rich.table  # noqa: PLC0415
    except ImportError as error:
        raise ImportError(
            "tables and progress need rich, which is not installed: pip install rbsdem[plot]"
        ) from error
    return rich


def need_jinja2() -> Any:
    """Return jinja2, or raise `ImportError` with the installation command."""
    try:
        import jinja2  # noqa: PLC0415
    except ImportError as error:
        raise ImportError(
            "the gallery needs jinja2, which is not installed: pip install rbsdem[gallery]"
        ) from error
    return jinja2


def escaped(text: str) -> str:
    """Return a text with the markup of rich escaped."""
    from rich.markup import escape  # noqa: PLC0415

    return escape(text)
