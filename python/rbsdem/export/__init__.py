"""Results as tables and files."""

from rbsdem.export import table as table
from rbsdem.export.files import load

__all__ = ["load"]
