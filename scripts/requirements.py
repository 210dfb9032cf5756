"""Print the build requirements of pyproject.toml and those of the extras named, one a line."""

import re
import sys
from pathlib import Path

text = (Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8")


def names(key: str) -> list[str]:
    """Return the strings of the list `key = [...]` (Python 3.10 has no toml reader)."""
    found = re.search(rf"^{key} = \[(.*?)\]", text, re.MULTILINE | re.DOTALL)
    if found is None:
        sys.exit(f"pyproject.toml has no list {key}")
    return re.findall(r'"([^"]+)"', found.group(1))


for key in ["requires", "dependencies", *sys.argv[1:]]:
    print(*names(key), sep="\n")
