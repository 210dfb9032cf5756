"""Numbers that follow from others unless they are given.

`dataclasses.replace` hands on what an object holds, whether it was given or not: a number that
followed from another must be known as such, or it would stay behind when the other changes.
"""

from __future__ import annotations

__all__ = ["Derived", "given"]


class Derived(float):
    """A number that was not given."""

    __slots__ = ()


def given(value: float | None) -> float | None:
    """Return a value if somebody gave it, else None."""
    return None if isinstance(value, Derived) else value
