"""Change the program in the ways of mutants.csv, one at a time; see which test notices each.

    python scripts/mutants.py [--work DIR] [--only NAME ...] [--own] [--table]
    python scripts/mutants.py --draw COUNT SEED

Every mutant is a slip that a programmer could make: a factor left out, a sign, a bound, a wrong
index. The tree is copied once to a working folder and built there. Then each mutant in turn is
applied, built and tested, first by the suites and files that own the behaviour and, if these pass
and `--own` is not given, by all suites in Fortran and all tests in Python. A mutant that no test
notices has survived: a behaviour is not proved.

The results are kept in DIR/results.json, so that a run can be stopped and taken up again; remove
the file to begin anew. `--table` prints it as a table in Markdown. The exit code is 1 if a mutant
has survived. `--draw` prints rows for mutants.csv, drawn at random from the package.

It needs the virtual environment that scripts/test.sh makes, in which the package is installed
plainly: an editable install would hide changes of Python. It takes about half an hour.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import csv
import json
import os
import random
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

CONSOLE = "tests/python/test_command_line.py::test_console_command_hands_over_to_the_executable"

# A test that takes longer than this is caught in a loop, which counts as noticed [s].
SUITE_TIMEOUT, PYTHON_TIMEOUT = 300, 1800


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes
    ----------
    name : str
        Its name in the table.
    file : str
        The file that is changed, from the root.
    old, new : str
        Text that stands there once, and what replaces it.
    breaks : str
        What is wrong then.
    tests : str
        What is run first: suites, and files of tests/python without their ending.
    """

    name: str
    file: str
    old: str
    new: str
    breaks: str
    tests: str


with (ROOT / "scripts" / "mutants.csv").open(encoding="utf-8", newline="") as _rows:
    MUTANTS = tuple(Mutant(**row) for row in csv.DictReader(_rows))


#: What a drawn mutant exchanges.
EXCHANGED = {
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*",
    ast.Lt: ">=", ast.LtE: ">", ast.Gt: "<=", ast.GtE: "<",
}  # fmt: skip
SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
         ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}  # fmt: skip
#: Rooms of the package that are not drawn from.
LEFT_OUT = ("output", "web", "cli")


def draw(count: int, seed: int) -> list[Mutant]:
    """Return mutants of the package that are drawn at random.

    Of sums, products, comparisons and numbers an operator is exchanged, a comparison turned round,
    a number made a tenth larger.
    """
    root = ROOT / "python" / "rbsdem"
    files = (path for path in sorted(root.rglob("*.py")) if path.parent.name not in LEFT_OUT)
    slips = [slip for path in files for slip in _slips(path)]
    return [_drawn(*slip) for slip in random.Random(seed).sample(slips, count)]


def _slips(path: Path) -> Iterator[tuple[Path, str, str, str]]:
    """Yield file, line before and after, and function, of all slips that are one in their file."""
    text = path.read_text("utf-8")
    lines = text.splitlines()
    tree = ast.parse(text)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    # What an annotation says changes no run.
    types = [
        getattr(node, name, None) for node in ast.walk(tree) for name in ("annotation", "returns")
    ]
    annotated = {id(part) for kind in types if kind for part in ast.walk(kind)}
    for node in ast.walk(tree):
        at, new = (0, "") if id(node) in annotated else _slip(node, lines)
        if new in ("", lines[at]) or text.count(lines[at].strip()) != 1:
            continue
        around = [f for f in functions if f.lineno <= at + 1 <= (f.end_lineno or 0)]
        if around:
            yield path, lines[at].strip(), new.strip(), around[-1].name


def _slip(node: ast.AST, lines: list[str]) -> tuple[int, str]:
    """Return the place of a line and what becomes of it; an empty text if nothing does."""
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        line, more = lines[node.lineno - 1], repr(round(1.1 * node.value, 12))
        more = repr(node.value + 1) if isinstance(node.value, int) else more
        return node.lineno - 1, line[: node.col_offset] + more + line[node.end_col_offset :]
    if isinstance(node, ast.BinOp):
        left, right, kind = node.left, node.right, type(node.op)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        left, right, kind = node.left, node.comparators[0], type(node.ops[0])  # type: ignore[assignment]
    else:
        return 0, ""
    if kind not in SIGNS or left.end_lineno != right.lineno or not left.end_lineno:
        return 0, ""
    line = lines[left.end_lineno - 1]
    between = line[left.end_col_offset : right.col_offset]
    if between.strip(" ()") != SIGNS[kind]:  # type: ignore[index]
        return 0, ""
    other = between.replace(SIGNS[kind], EXCHANGED[kind])  # type: ignore[index]
    return left.end_lineno - 1, line[: left.end_col_offset] + other + line[right.col_offset :]


def _drawn(path: Path, old: str, new: str, function: str) -> Mutant:
    """Return a drawn mutant with the tests that name its function, or its module."""
    tests = {
        test.stem: test.read_text("utf-8") for test in (ROOT / "tests/python").glob("test_*.py")
    }
    known = [name for name, text in tests.items() if re.search(rf"\b{function}\b", text)]
    known += [name for name, text in tests.items() if re.search(rf"\b{path.stem}\b", text)]
    likely = " ".join(sorted(dict.fromkeys(known))[:4])
    where = str(path.relative_to(ROOT))
    return Mutant(f"py-{path.stem}-{function.strip('_')}", where, old, new, path.stem, likely)


class MutantError(Exception):
    """The tree cannot be prepared, or a mutant does not fit it."""


def run(command: list[str], cwd: Path, timeout: float, **environment: str) -> tuple[int, str]:
    """Run a command and return its exit code and output; -1 where it did not end in time."""
    given = {"cwd": cwd, "timeout": timeout, "env": os.environ | environment, "errors": "replace"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, **given)
    except subprocess.TimeoutExpired:
        return -1, "no end"
    return done.returncode, done.stdout + done.stderr


class Tree:
    """A copy of the tree with a build of its own.

    Parameters
    ----------
    work : Path
        Folder of the copy.
    venv : Path
        Virtual environment with the build requirements and the packages for tests.
    """

    def __init__(self, work: Path, venv: Path) -> None:
        self.source, self.build, self.site = work / "tree", work / "build", work / "site"
        self.python = venv / "bin" / "python"
        # Names of the unit tests, "suite: name"
        self.names: list[str] = []
        self.path = f"{venv / 'bin'}{os.pathsep}{os.environ['PATH']}"

    def prepare(self) -> None:
        """Copy what git knows, as it is in the folder, and build it."""
        listed = subprocess.run(
            ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.splitlines()
        for name in listed:
            target = self.source / name
            content = (ROOT / name).read_bytes()
            if not target.is_file() or target.read_bytes() != content:
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, target)
        if not (self.build / "build.ninja").is_file():
            setup = ["meson", "setup", str(self.build), str(self.source), "-Dpython=enabled"]
            # Built faster; what a test sees is the same.
            self._must(
                [*setup, "-Doptimization=1", "-Dpython.platlibdir=/", "-Dpython.purelibdir=/"]
            )
        self.make("tests/fortran/unit_tests")
        self.install()

    def _must(self, command: list[str], folder: Path | None = None) -> str:
        code, text = run(command, folder or self.source, 3600, PATH=self.path)
        if code != 0:
            raise MutantError(f"{' '.join(command)}:\n{text[-3000:]}")
        return text

    def make(self, *targets: str) -> None:
        """Build what has changed."""
        self._must(["ninja", "-C", str(self.build), *targets])

    def link_suites(self) -> None:
        """Build the library and link the suites with it.

        Meson would compile all tests anew. No mutant changes an interface: they stay as they are.
        """
        self.make("librbsdem_core.a")
        command = ["ninja", "-C", str(self.build), "-t", "commands", "tests/fortran/unit_tests"]
        self._must(["sh", "-c", self._must(command).splitlines()[-1]], self.build)

    def install(self) -> None:
        """Put the package where the tests in Python find it."""
        self.make()
        command = ["meson", "install", "--no-rebuild", "--quiet", "-C", str(self.build)]
        self._must([*command, "--destdir", str(self.site)])

    def fails_suite(self, *suite: str) -> tuple[str, str]:
        """Return suite and name of the first test that fails, blank if none does."""
        program = self.build / "tests" / "fortran" / "unit_tests"
        code, text = run([str(program), *suite], self.source, SUITE_TIMEOUT, PATH=self.path)
        if code == 0:
            self.names += [line[2:].strip() for line in text.splitlines() if line[:2] == "ok"]
            return "", ""
        if "no suite" in text:
            raise MutantError(text)
        for line in text.splitlines():
            if line.startswith("FAIL"):
                failed = line.removeprefix("FAIL").strip()
                # Names and messages both may hold colons.
                known = [name for name in self.names if failed.startswith(name)]
                name, _, test = max(known, key=len, default=failed).partition(": ")
                return name, test
        return "".join(suite) or "unit_tests", "does not end well"

    def fails_python(self, *paths: str) -> tuple[str, str]:
        """Return file and name of the first test in Python that fails, blank if none does."""
        command = [str(self.python), "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *paths]
        # The copy has no command `rbsdem` in the environment.
        command.append(f"--deselect={CONSOLE}")
        environment = {
            "PATH": self.path,
            "PYTHONPATH": str(self.site),
            "MPLBACKEND": "Agg",
            "RBSDEM_PEER_DIR": str(ROOT.parent / "shared" / "peer"),
        }
        code, text = run(command, self.source, PYTHON_TIMEOUT, **environment)
        if code == 0:
            return "", ""
        # A log may hold lines that begin so, too.
        heads = ("FAILED tests/", "ERROR tests/")
        failed = [line for line in text.splitlines() if line.startswith(heads)]
        if not failed:
            return "pytest", "does not end well"
        test = failed[0].split(" - ")[0].split(maxsplit=1)[1].removeprefix("tests/python/")
        file, _, name = test.partition("::")
        return file, name

    @contextlib.contextmanager
    def changed(self, mutant: Mutant) -> Iterator[None]:
        """Apply a mutant, and take it away again."""
        path = self.source / mutant.file
        text = path.read_text("utf-8") if path.is_file() else ""
        if text.count(mutant.old) != 1:
            raise MutantError(
                f"{mutant.name}: its text stands {text.count(mutant.old)} times in {mutant.file}"
            )
        path.write_text(text.replace(mutant.old, mutant.new), "utf-8")
        try:
            yield
        finally:
            path.write_text(text, "utf-8")


def verdict(tree: Tree, mutant: Mutant, own: bool) -> dict[str, str]:
    """Return which test notices a mutant; both texts are blank if it survives."""
    compiled = mutant.file.startswith("src/")
    with tree.changed(mutant):
        if compiled:
            tree.link_suites()
        for suite, test in attempts(tree, mutant.tests.split(), compiled, own):
            if suite:
                return {"suite": suite, "test": test}
    return {"suite": "", "test": ""}


def attempts(tree: Tree, likely: list[str], compiled: bool, own: bool) -> Iterator[tuple[str, str]]:
    """Yield the first failure of the own suites and files, of all suites, of all files."""
    files = [name for name in likely if name.startswith("test_")]
    for suite in likely:
        if suite not in files:
            yield tree.fails_suite(suite)
    if files:
        tree.install()
        yield tree.fails_python(*(f"tests/python/{name}.py" for name in files))
    if own:
        return
    if compiled:
        yield tree.fails_suite()
    tree.install()
    yield tree.fails_python("tests/regression", "tests/python")


def check_unchanged(tree: Tree, results: dict[str, dict[str, str]]) -> None:
    """Refuse results of tests that fail without a mutant too: they have noticed nothing."""
    name, test = tree.fails_suite()
    tests = set()
    for found in results.values():
        file, failed = found["suite"], found["test"].partition("[")[0]
        if file.endswith(".py"):
            # A file that a mutant keeps from being imported names no test.
            path = file if "/" in file else f"tests/python/{file}"
            tests.add(f"{path}::{failed}" if failed else path)
    if not name and tests:
        name, test = tree.fails_python(*sorted(tests))
    if name:
        raise MutantError(f"without a mutant {name}: {test} fails already")


def table(results: dict[str, dict[str, str]]) -> str:
    """Return the results as a table in Markdown."""
    lines = ["| mutant | file | breaks | noticed by |", "|---|---|---|---|"]
    for mutant in MUTANTS:
        found = results.get(mutant.name)
        noticed = "not run" if found is None else "**nothing**"
        if found and found["suite"]:
            noticed = f"{found['suite']}: {found['test']}"
        lines.append(f"| `{mutant.name}` | `{mutant.file}` | {mutant.breaks} | {noticed} |")
    return "\n".join(lines)


def main() -> int:
    """Run the mutants that have no result yet."""
    parser = argparse.ArgumentParser(
        description="Change the program in listed ways and see which test notices each change."
    )
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "mutants")
    parser.add_argument("--venv", type=Path, default=ROOT / ".venv")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these mutants, done or not")
    parser.add_argument("--own", action="store_true", help="run only the tests named in the csv")
    parser.add_argument("--table", action="store_true", help="print the results and stop")
    parser.add_argument("--draw", nargs=2, type=int, metavar=("COUNT", "SEED"))
    given = parser.parse_args()
    if given.draw:
        rows = csv.writer(sys.stdout, lineterminator="\n")
        rows.writerows(astuple(mutant) for mutant in draw(*given.draw))
        return 0
    file = given.work / "results.json"
    results = json.loads(file.read_text("utf-8")) if file.is_file() else {}
    if given.table:
        print(table(results))
        return 0
    try:
        tree = Tree(given.work.resolve(), given.venv.resolve())
        tree.prepare()
        check_unchanged(tree, {})
        for mutant in MUTANTS:
            if mutant.name not in given.only if given.only else mutant.name in results:
                continue
            results[mutant.name] = found = verdict(tree, mutant, given.own)
            print(f"{mutant.name}: {found['suite']} {found['test']}".rstrip(": "), flush=True)
            file.write_text(json.dumps(results, indent=1) + "\n", "utf-8")
        tree.link_suites()
        tree.install()
        check_unchanged(tree, results)
    except MutantError as failure:
        print(f"mutants: {failure}", file=sys.stderr)
        return 2
    survived = [name for name, found in results.items() if not found["suite"]]
    print(f"{len(results)} mutants, {len(survived)} survived {' '.join(survived)}")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
