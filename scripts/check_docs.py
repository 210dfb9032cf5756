"""Run every example in the documentation and compare with the output printed there.

    python scripts/check_docs.py [FILE.md ...]

In the Markdown files of docs (README.md of the project too, if named):

- a block after ``<!-- file: NAME -->`` is written to a file of that name in a scratch folder;
- a block of language ``console`` is run there, line by line that begins with ``$``, and the output
  (both streams) must be what stands below it; ``...`` stands for anything within a line;
- a block of language ``python`` is run there with this interpreter and must not fail;
- a block after ``<!-- skip -->`` is left alone;
- a name of a test (``test_...``, or its begin with an ellipsis) must be that of one.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

BLOCK = re.compile(
    r"(?:^<!-- (?P<mark>skip|file: (?P<name>\S+)) -->\n+)?"
    r"^```(?P<language>\w+)\n(?P<body>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)


ROOT = Path(__file__).resolve().parents[1]

NAME = re.compile(r"`(test_\w+)(\.py|…)?`")


def tests() -> str:
    """Return the text of all Python tests, and the names of their files."""
    files = sorted((ROOT / "tests").rglob("*.py"))
    return "\n".join(f"file {file.name}\n{file.read_text(encoding='utf-8')}" for file in files)


def missing_tests(path: Path, source: str) -> list[str]:
    """Return the names of tests that a file names and that are not there."""
    faults = []
    for name, ending in NAME.findall(path.read_text(encoding="utf-8")):
        sought = {".py": f"file {name}.py\n", "…": f"def {name}"}.get(ending, f"def {name}(")
        if sought not in source:
            faults.append(f"{path.name}: there is no test {name}{ending}")
    return faults


def check(path: Path, folder: Path) -> list[str]:
    """Run the blocks of one file; return what went wrong."""
    faults = []
    text = path.read_text(encoding="utf-8")
    for block in BLOCK.finditer(text):
        line = text.count("\n", 0, block.start("body"))
        body = block["body"]
        if block["mark"] == "skip":
            continue
        if block["name"]:
            (folder / block["name"]).write_text(body, encoding="utf-8")
        elif block["language"] == "console":
            faults += console(body, folder, f"{path.name}:{line}")
        elif block["language"] == "python":
            code, output = run([sys.executable, "-W", "error", "-c", body], folder)
            if code:
                faults.append(f"{path.name}:{line}: exit code {code}\n{output}")
    return faults


def console(body: str, folder: Path, place: str) -> list[str]:
    """Run the commands of a block; return those whose output is another one."""
    faults = []
    code = 0
    for part in re.split(r"^\$ ", body, flags=re.MULTILINE)[1:]:
        command, _, expected = part.partition("\n")
        if command == "echo $?":
            output = f"{code}\n"
        else:
            code, output = run(["bash", "-c", command], folder)
        pattern = ".*".join(re.escape(piece) for piece in expected.rstrip("\n").split("..."))
        if not re.fullmatch(pattern, output.rstrip("\n")):
            faults.append(f"{place}: $ {command}\n--- printed\n{expected}--- found\n{output}")
    return faults


def run(command: list[str], folder: Path) -> tuple[int, str]:
    """Run a command in the scratch folder with this interpreter's programs first in the path."""
    programs = Path(sys.executable).parent
    environment = os.environ | {
        "PATH": f"{programs}{os.pathsep}{os.environ.get('PATH', '')}",
        "MPLBACKEND": "Agg",
    }
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=300,
    )
    # Blanks at the end of a line do not survive an editor.
    return done.returncode, re.sub(r"[ \t]+$", "", done.stdout, flags=re.MULTILINE)


def main() -> int:
    """Check all files; return 1 if an example does not do what it says."""
    paths = [Path(name) for name in sys.argv[1:]] or sorted((ROOT / "docs").glob("*.md"))
    faults = []
    source = tests()
    for path in paths:
        faults += missing_tests(path, source)
        with tempfile.TemporaryDirectory() as folder:
            faults += check(path, Path(folder))
    print("\n".join(faults) if faults else f"examples of {len(paths)} files: all as printed")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
