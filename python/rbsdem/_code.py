"""A digest of the installed package, by which kept results know what they were made by."""

from __future__ import annotations

import hashlib
import importlib.util
from functools import cache
from pathlib import Path

__all__ = ["code_digest"]


@cache
def code_digest() -> bytes:
    """Return the digest of the code of the package: Python files and extension."""
    root = Path(__file__).resolve().parent
    files = sorted(root.rglob("*.py"))
    extension = importlib.util.find_spec("rbsdem._rbsdem")
    if extension is not None and extension.origin is not None:
        files.append(Path(extension.origin))
    digest = hashlib.sha256()
    for file in files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.digest()
