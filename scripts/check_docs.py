"""Run every example in the documentation and compare with the output printed there.

    python scripts/check_docs.py [FILE.md ...]

In README.md and the Markdown files of docs:

- a block after ``<!-- file: NAME -->`` is written to a file of that name in a scratch folder;
- a block of language ``console`` is run there, line by line that begins with ``$``, and the output
  (both streams) must be what stands below it; ``...`` stands for anything within a line;
- a block of language ``python`` is run there by itself and must not fail; if a block of
  language ``text`` follows at once, that is what it prints;
- a block after ``<!-- skip -->`` is left alone;
- a name of a test (``test_...``, or its begin with an ellipsis) must be that of one.

Of these files, README.md, CONTRIBUTING.md and the docstrings of the package, the words in backticks
are resolved: `rbsdem.x.y` and `Class.member` are names of the package, paths are those of files.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import os
import pkgutil
import re
import subprocess
import sys
import tempfile
import traceback
import warnings
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


def classes() -> dict[str, list[type]]:
    """Return the classes of the package by their names."""
    package = importlib.import_module("rbsdem")
    found: dict[str, list[type]] = {}
    for module in pkgutil.walk_packages([str(ROOT / "python/rbsdem")], "rbsdem."):
        if module.name != "rbsdem.__main__":
            for name, kind in inspect.getmembers(importlib.import_module(module.name)):
                if inspect.isclass(kind) and kind.__module__.startswith(package.__name__):
                    found.setdefault(name, []).append(kind)
    return found


def resolves(words: list[str], known: dict[str, list[type]]) -> bool:
    """Return whether a dotted name of the package, or of a class and its member, is there."""
    if words[0] != "rbsdem":
        return any(member(kind, words[1:]) for kind in known.get(words[0], ()))
    for end in range(len(words), 0, -1):
        try:
            module = importlib.import_module(".".join(words[:end]))
        except ImportError:
            continue
        return member(module, words[end:])
    return False


def member(owner: object, words: list[str]) -> bool:
    """Return whether an attribute, or a field of a dataclass, can be reached."""
    if not words:
        return True
    if hasattr(owner, words[0]):
        return member(getattr(owner, words[0]), words[1:])
    return words[0] in {
        n for k in getattr(owner, "__mro__", ()) for n in inspect.get_annotations(k)
    }


#: A dotted name in single backticks, with or without arguments behind it.
DOTTED = re.compile(r"(?<![`\w])`((?:rbsdem|[A-Z]\w*[a-z]\w*)(?:\.\w+)+)(?:`(?!`)|\()")
PATHS = re.compile(r"`+([\w-]+(?:/[\w.-]+)+|\w+)\.(py|f90|c|sh|md|csv|json|toml|js)`")


def unknown_names(name: str, text: str, known: dict[str, list[type]], files: set[str]) -> list[str]:
    """Return the names and paths in backticks that are not there."""
    faults = [
        f"{name}: there is no {dotted}"
        for dotted in dict.fromkeys(DOTTED.findall(text))
        if not dotted.endswith(".csv") and not resolves(dotted.split("."), known)
    ]
    made = set(re.findall(r"<!-- file: (\S+) -->", text))
    for stem, ending in dict.fromkeys(PATHS.findall(text)):
        path = f"{stem}.{ending}"
        # Data may be a user's own, and NAME is for one to choose.
        sought = ending in ("py", "f90", "c", "sh", "js") and "NAME" not in path
        there = path in made or any(f"/{file}".endswith(f"/{path}") for file in files)
        if sought and not there:
            faults.append(f"{name}: there is no file {path}")
    return faults


def check_names() -> list[str]:
    """Return the names in documentation and docstrings that are not there."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    ).stdout.split()  # fmt: skip
    files = set(listed) or {str(p.relative_to(ROOT)) for p in ROOT.rglob("*") if p.is_file()}
    known, faults = classes(), []
    pages = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    for page in pages:
        faults += unknown_names(page.name, page.read_text("utf-8"), known, files)
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
    for path in sorted((ROOT / "python/rbsdem").rglob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        texts = [ast.get_docstring(n) or "" for n in ast.walk(tree) if isinstance(n, documented)]
        name = str(path.relative_to(ROOT / "python"))
        faults += unknown_names(name, "\n".join(texts), known, files)
    return faults


def check(path: Path, folder: Path) -> list[str]:
    """Run the blocks of one file; return what went wrong."""
    faults = []
    text = path.read_text(encoding="utf-8")
    blocks = list(BLOCK.finditer(text))
    for block, following in zip(blocks, [*blocks[1:], None], strict=False):
        line = text.count("\n", 0, block.start("body"))
        body = block["body"]
        if block["mark"] == "skip":
            continue
        if block["name"]:
            (folder / block["name"]).write_text(body, encoding="utf-8")
        elif block["language"] == "console":
            faults += console(body, folder, f"{path.name}:{line}")
        elif block["language"] == "python":
            code, output = run_block(body, folder)
            if code:
                faults.append(f"{path.name}:{line}: exit code {code}\n{output}")
            elif following and following["language"] == "text" and not following["mark"]:
                printed = following["body"]
                if not text[block.end() : following.start()].strip() and not same(printed, output):
                    faults.append(f"{path.name}:{line}: prints\n{output}--- in place of\n{printed}")
    return faults


def same(printed: str, output: str) -> bool:
    """Return whether an output is the printed one; ``...`` there stands for anything in a line."""
    pattern = ".*".join(re.escape(piece) for piece in printed.rstrip("\n").split("..."))
    return bool(re.fullmatch(pattern, output.rstrip("\n")))


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
        if not same(expected, output):
            faults.append(f"{place}: $ {command}\n--- printed\n{expected}--- found\n{output}")
    return faults


def run_block(body: str, folder: Path) -> tuple[int, str]:
    """Run a program in a copy of this process, which has the libraries; warnings are errors."""
    with tempfile.TemporaryFile() as output:
        sys.stdout.flush()
        child = os.fork()
        if not child:
            code = 1
            os.dup2(output.fileno(), 1)
            os.dup2(output.fileno(), 2)
            try:
                os.chdir(folder)
                sys.path[0] = str(folder)
                warnings.simplefilter("error")
                exec(compile(body, "<string>", "exec"), {"__name__": "__main__"})
                code = 0
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(code)
        _, status = os.waitpid(child, 0)
        output.seek(0)
        return status, without_blanks(output.read().decode())


def without_blanks(text: str) -> str:
    """Return a text without blanks at the end of lines, which do not survive an editor."""
    return re.sub(r"[ \t]+$", "", text, flags=re.MULTILINE)


def run(command: list[str], folder: Path) -> tuple[int, str]:
    """Run a command in the scratch folder with this interpreter's programs first in the path."""
    programs = Path(sys.executable).parent
    environment = os.environ | {"PATH": f"{programs}{os.pathsep}{os.environ.get('PATH', '')}"}
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
    return done.returncode, without_blanks(done.stdout)


def main() -> int:
    """Check all files; return 1 if an example does not do what it says."""
    paths = [Path(name) for name in sys.argv[1:]] or [
        ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))
    ]  # fmt: skip
    faults = [] if sys.argv[1:] else check_names()
    source = tests()
    os.environ["MPLBACKEND"] = "Agg"
    for library in ("matplotlib.pyplot", "pandas", "rbsdem.plot"):
        importlib.import_module(library)
    for path in paths:
        faults += missing_tests(path, source)
        with tempfile.TemporaryDirectory() as folder:
            faults += check(path, Path(folder))
    print("\n".join(faults) if faults else f"examples of {len(paths)} files: all as printed")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
