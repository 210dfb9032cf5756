"""Build backend: meson-python, with an editable install that needs no build tools afterwards.

meson-python's own editable install builds anew at import, with the tools of the environment it was
made in; `pip install -e .` makes that environment in a temporary folder and removes it. Here the
compiled parts are put beside the Python modules instead; `pip install -e .` again after a change of
the Fortran part.
"""

from __future__ import annotations

import base64
import hashlib
import tempfile
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from mesonpy import (
    build_sdist,
    build_wheel,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
]

PYTHON = Path(__file__).resolve().parent.parent / "python"


def build_editable(
    wheel_directory: str,
    config_settings: dict[str, str | list[str]] | None = None,
    metadata_directory: str | None = None,
) -> str:
    """Build the wheel, put its compiled parts into the checkout, return one that points there."""
    with tempfile.TemporaryDirectory() as folder:
        name = build_wheel(folder, config_settings, metadata_directory)
        with ZipFile(Path(folder) / name) as built:
            _place_compiled(built)
            _write_pointer(built, Path(wheel_directory) / name)
    return name


def _place_compiled(built: ZipFile) -> None:
    """Put extension and executable beside the modules; git ignores them there."""
    for item in built.namelist():
        if item.startswith("rbsdem/") and (
            item.endswith((".so", ".pyd")) or item.startswith("rbsdem/bin/")
        ):
            target = PYTHON / item
            target.parent.mkdir(parents=True, exist_ok=True)
            # A process that has the old file loaded keeps it.
            target.unlink(missing_ok=True)
            target.write_bytes(built.read(item))
            target.chmod(0o755)


def _write_pointer(built: ZipFile, path: Path) -> None:
    """Write a wheel with the metadata of `built` and a .pth file in place of its files."""
    contents = {"rbsdem-editable.pth": f"{PYTHON}\n".encode()}
    for item in built.namelist():
        if ".dist-info/" in item and not item.endswith("/RECORD"):
            contents[item] = built.read(item)
    record = next(item for item in built.namelist() if item.endswith(".dist-info/RECORD"))
    lines = [f"{item},sha256={_digest(data)},{len(data)}" for item, data in contents.items()]
    contents[record] = "\n".join([*lines, f"{record},,", ""]).encode()
    with ZipFile(path, "w", ZIP_DEFLATED) as wheel:
        for item, data in contents.items():
            wheel.writestr(item, data)


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
