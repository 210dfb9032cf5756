"""The house keeps its order: arrows between rooms go one way, each room does its own job.

Reads the sources; needs neither a compiler nor the installed package. `faults` returns a line of
text for everything that is wrong with a tree. It is run on this repository, and on small trees with
one fault each, to show that it can fail.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

#: Rooms of src/ by floor: a room may use those on lower floors, not its neighbours.
FLOORS = (
    ("base",),
    ("hysteresis",),
    ("structure", "section"),
    ("loading",),
    ("case",),
    ("output",),
    ("solve",),
    ("io",),
    ("bindings",),
    ("app",),
)
FLOOR = {room: number for number, rooms in enumerate(FLOORS) for room in rooms}

#: Rooms inside solve, by floor: each kind of analysis stands alone, except that time asks modal
#: and the steps of one body.
ANALYSES = {"modal": 0, "one_body": 0, "static": 1, "time": 1, "ensemble": 2}

#: What each room inside solve/ may use of the others; what they share lies beside them.
INNER = {
    "": (),
    "modal": (),
    "one_body": (),
    "static": (),
    "time": ("modal", "one_body"),
    "ensemble": ("modal", "one_body", "time"),
}

#: Files without a module: what f2py reads, and the program.
NO_MODULE = ("bindings/bindings.f90", "app/main.f90")

#: A handler of signals gets nothing but their number, so it needs a variable that outlives a call.
HANDLER = "app/signals.f90"

#: The one generated module; anyone may use it.
VERSION = ("version.f90.in", "rbs_version")

LAPACK = re.compile(
    r"\b(?:call|subroutine|function) +"
    r"((?!stream\b|correct\b)[sdcz](?:ge|gb|gt|po|pp|pb|pt|sy|sp|sb|st|tr|tb|or|la)\w{2,4})\b"
)
DECLARATION = re.compile(
    r"(?:integer|real|complex|logical|character|double precision|type *\(|class *\(|procedure *\()"
)
FILE_STATEMENT = re.compile(r"(?:open|close|inquire|rewind|backspace|endfile|flush) *\(")
MACHINE_PATH = re.compile(
    r"(?<![\w.~$})/:-])/(?:home|Users|root|work|mnt|media|srv|tmp)/\w|\b[A-Z]:\\\w"
)

Fault = tuple[Path, str]


#: Dense solvers of LAPACK, which may start threads, belong to one analysis that calls them once.
ONCE = {"solve_dense"}


# ---- Fortran -------------------------------------------------------------------------------------


def statements(text: str) -> list[str]:
    """Return the statements: lower case, continuations joined, comments out, strings emptied."""
    found: list[str] = []
    pending = ""
    for line in text.splitlines():
        code = re.sub(r"'[^']*'|\"[^\"]*\"", "''", line)
        code = code.split("!", 1)[0].strip().lower()
        if not code:
            continue
        pending += code.removeprefix("&").strip() if pending else code
        if pending.endswith("&"):
            pending = pending[:-1].rstrip() + " "
            continue
        found += [part.strip() for part in pending.split(";") if part.strip()]
        pending = ""
    return found


def without_condition(statement: str) -> str:
    """Return what a one-line `if (...)` does."""
    match = re.match(r"if *\(", statement)
    if not match:
        return statement
    depth = 1
    for place in range(match.end(), len(statement)):
        depth += {"(": 1, ")": -1}.get(statement[place], 0)
        if depth == 0:
            return statement[place + 1 :].strip()
    return statement


def is_declaration(statement: str) -> bool:
    return bool(DECLARATION.match(statement)) and "::" in statement


def room_of(module: str) -> str:
    return module.split("_")[1] if module.count("_") else module


def uses(code: list[str]) -> Iterator[str]:
    for statement in code:
        match = re.match(r"use *(?:, *(?:non_)?intrinsic)? *(?:::)? *(\w+)", statement)
        if match:
            yield match[1]


def inner_room(name: str) -> str:
    """Return the room inside solve/ that a file or a module of it belongs to, or an empty text."""
    match = re.match(r"(?:rbs_)?solve[/_](\w+?)[/_]", name)
    return match[1] if match and match[1] in INNER else ""


def check_arrows(name: str, code: list[str]) -> Iterator[str]:
    """`use` goes to lower floors and stays in the room otherwise."""
    room = name.split("/", maxsplit=1)[0].removesuffix(".f90")
    if room not in FLOOR:
        yield f"the room {room} has no floor"
        return
    for module in uses(code):
        if not module.startswith("rbs_") or module == VERSION[1]:
            continue
        other = room_of(module)
        if other not in FLOOR:
            yield f"uses {module}, whose room has no floor"
        elif other != room and FLOOR[other] >= FLOOR[room]:
            yield f"uses {module}: an arrow from {room} back to {other}"
        elif other == room == "solve":
            here, there = inner_room(name), inner_room(module)
            if there not in ("", here, *INNER[here]):
                yield f"uses {module}: an arrow from solve/{here} to solve/{there}"
    for statement in code:
        match = re.match(r"use\b(.*)", statement)
        if match and "only" not in match[1]:
            yield f"'use{match[1]}' has no only"


def check_module(name: str, code: list[str]) -> Iterator[str]:
    """One module a file, named like the file; `implicit none` and `private`."""
    modules = [m[1] for s in code if (m := re.match(r"module +(?!procedure\b)(\w+)$", s))]
    if name in NO_MODULE:
        if modules:
            yield f"has a module {modules[0]}"
        # The procedures inside a program take it from there.
        program = any(statement.startswith("program ") for statement in code)
        units = 1 if program else sum(s.startswith("subroutine ") for s in code)
        if code.count("implicit none") < units:
            yield "has a program unit without implicit none"
        return
    expected = "rbs_" + name.removesuffix(".f90").replace("/", "_")
    if modules != [expected]:
        yield f"holds {modules or 'no module'}; its path asks for {expected}"
    head = code[: code.index("contains")] if "contains" in code else code
    for statement in ("implicit none", "private"):
        if statement not in outside_types(head):
            yield f"has no '{statement}'"


def outside_blocks(code: list[str], begin: str, end: str) -> list[str]:
    kept, inside = [], False
    for statement in code:
        if re.match(begin, statement):
            inside = True
        if not inside:
            kept.append(statement)
        if re.match(end, statement):
            inside = False
    return kept


def outside_interfaces(code: list[str]) -> list[str]:
    return outside_blocks(code, r"(?:abstract +)?interface\b", r"end *interface\b")


def outside_types(code: list[str]) -> list[str]:
    return outside_blocks(code, r"type *(?:,[^()]*)?(?:::)? *\w+$|type *,.*::", r"end *type\b")


def check_state(name: str, code: list[str]) -> Iterator[str]:
    """No state that outlives a call: no `save`, written out or implied, no module variables."""
    own = outside_interfaces(outside_types(code))
    in_head = name not in NO_MODULE
    for statement in own:
        if statement == "contains":
            in_head = False
        if re.match(r"save\b", statement) or re.search(r", *save\b.*::", statement):
            yield f"saves state: '{statement}'"
        if not is_declaration(statement) or re.search(r", *parameter\b.*::", statement):
            continue
        if in_head and name == HANDLER:
            continue
        if in_head:
            yield f"has a module variable: '{statement}'"
        elif re.search(r"::.*[^=<>/]=(?!=)", re.sub(r"\([^()]*\)", "", statement)):
            yield f"saves state by an initial value: '{statement}'"


def check_deferred(name: str, code: list[str]) -> Iterator[str]:
    """No function returns text of deferred length: a caller's threads would share the length.

    gfortran keeps the length of such a result in static storage of the caller, with -frecursive too
    (`static integer(kind=8) slen` in its tree dump). A length from a pure function is all right.
    """
    if name.startswith("app/"):
        return
    function = result = ""
    for statement in code:
        if re.match(r"end *function|(?:\w+ +)*subroutine ", statement):
            result = ""
        match = re.match(
            r"(?!end\b)(?:[\w() ,=*]+ )?function +(\w+)(?:.*result *\((\w+)\))?", statement
        )
        if match:
            function, result = match[1], match[2] or match[1]
        deferred = re.match(r"character *\( *len *= *: *\).*::(.*)", statement)
        if deferred and result and result in re.findall(r"\w+", deferred[1]):
            yield f"the function {function} returns text of deferred length"


def check_lapack(name: str, code: list[str]) -> Iterator[str]:
    """One wall around LAPACK."""
    if name == "base/linalg.f90":
        return
    for statement in code:
        for match in LAPACK.finditer(statement):
            yield f"has to do with LAPACK: {match[1]}"


def check_manners(name: str, code: list[str]) -> Iterator[str]:
    """Only app ends the process; only io and app touch files and terminals."""
    room = name.split("/", maxsplit=1)[0]
    texts = {
        variable
        for statement in code
        if statement.startswith("character")
        for variable in re.findall(r"\w+", statement.split("::")[-1])
    }
    for full in code:
        statement = without_condition(full)
        if room != "app" and re.match(r"(?:error +)?stop\b", statement):
            yield f"stops: '{statement}'"
        if room in ("io", "app"):
            continue
        if re.match(r"print\b", statement) or FILE_STATEMENT.match(statement):
            yield f"reads or writes: '{statement}'"
        match = re.match(r"(?:read|write) *\( *(?:unit *= *)?([^,)]*)", statement)
        if match and re.match(r"\w*", match[1].strip())[0] not in texts:
            yield f"reads or writes: '{statement}'"


CHECKS: tuple[Callable[[str, list[str]], Iterator[str]], ...] = (
    check_arrows,
    check_module,
    check_state,
    check_deferred,
    check_lapack,
    check_manners,
)


def fortran_faults(root: Path) -> Iterator[Fault]:
    src = root / "src"
    for path in sorted(src.rglob("*.f90")):
        name = path.relative_to(src).as_posix()
        code = statements(path.read_text(encoding="utf-8"))
        for check in CHECKS:
            for fault in check(name, code):
                yield path, fault


# ---- Python and texts ----------------------------------------------------------------------------


def tracked(root: Path, pattern: str, *folders: str) -> list[Path]:
    """Return files of some folders, without what builds and caches leave there."""
    found = (path for folder in folders for path in (root / folder).rglob(pattern))
    hidden = ("__pycache__", "_build")
    return sorted(
        path
        for path in found
        if path.is_file()
        and not any(p in hidden or p.startswith(".") for p in path.relative_to(root).parts)
    )


def imported(tree: ast.AST) -> Iterator[str]:
    """Return every name that is imported, with its module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module or ''}.{alias.name}" for alias in node.names)


def python_faults(root: Path) -> Iterator[Fault]:
    """Only `_core.py` knows the extension."""
    for path in tracked(root, "*.py", "python", "tests", "examples", "studies", "scripts"):
        if path == root / "python" / "rbsdem" / "_core.py":
            continue
        for name in imported(ast.parse(path.read_text(encoding="utf-8"))):
            if "_rbsdem" in name.split("."):
                yield path, f"imports the extension: {name}"


def path_faults(root: Path) -> Iterator[Fault]:
    """Tests and texts name no path of the machine that they were written on."""
    files = tracked(root, "*", "tests", "docs", "examples", "studies", "data")
    files += sorted(root.glob("*.md"))
    for path in files:
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for match in MACHINE_PATH.finditer(text):
            number = text.count("\n", 0, match.start()) + 1
            yield path, f"line {number} names a path of one machine: {match[0]}..."


def faults(root: Path) -> list[str]:
    """Return everything that is wrong with a tree, one line each."""
    checks = (fortran_faults, python_faults, path_faults)
    return [
        f"{path.relative_to(root).as_posix()}: {text}"
        for check in checks
        for path, text in check(root)
    ]


# ---- Tests ---------------------------------------------------------------------------------------


def test_this_repository() -> None:
    assert faults(ROOT) == []


def test_the_repository_is_read() -> None:
    files = {path.relative_to(ROOT / "src").as_posix() for path in (ROOT / "src").rglob("*.f90")}
    assert set(NO_MODULE) <= files
    assert {"base/kinds.f90", "solve/static/path.f90", "hysteresis/rules/takeda.f90"} <= files
    code = statements((ROOT / "src/solve/static/path.f90").read_text(encoding="utf-8"))
    assert "rbs_hysteresis_springs" in set(uses(code))
    assert f"module {VERSION[1]}" in (ROOT / "src" / VERSION[0]).read_text(encoding="utf-8")


def test_statements_are_read_as_fortran_reads_them() -> None:
    text = "A = 'it''s ! no comment' ! stop\n x = 1; Y = &\n  ! between\n  & 2 + &\n 3\n"
    assert statements(text) == ["a = ''''", "x = 1", "y = 2 + 3"]
    assert without_condition("if (f(a, (b))) stop 1") == "stop 1"


GOOD_MODULE = """\
!> Does nothing; error stop, print and save are words of this comment.
module {module}
   use, intrinsic :: iso_fortran_env, only: real64
   use rbs_base_kinds, only: wp
   use rbs_version, only: version
   implicit none
   private

   public :: thing

   real(wp), parameter :: none(2) = [0.0_wp, 1.0_wp]

   type :: thing
      !> A component may have a default
      real(wp) :: value = 0.0_wp
      class(thing), pointer :: next => null()
   contains
      procedure :: stop_now
   end type thing

contains

   subroutine stop_now(self, text)
      class(thing), intent(in) :: self
      character(len=*), intent(out) :: text
      character(len=20) :: buffer
      integer, parameter :: start = 1
      real(wp) :: stopped

      stopped = self%value
      write (buffer, '(a)') 'save print stop'
      if (stopped > none(start)) read (buffer(2:), *) stopped
      text = buffer
   end subroutine stop_now

end module {module}
"""
KINDS = """\
module rbs_base_kinds
   implicit none
   private
   integer, parameter, public :: wp = kind(1.0d0)
end module rbs_base_kinds
"""
# Written in two parts, so that this file does not name the path itself.
ELSEWHERE = "/" + "home/someone/rbsdem/case.nml"


def plant(root: Path, name: str, text: str) -> None:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def good_tree(root: Path) -> None:
    plant(root, "src/base/kinds.f90", KINDS)
    for room in ("case", "structure", "section", "solve", "io", "app"):
        plant(root, f"src/{room}/thing.f90", GOOD_MODULE.format(module=f"rbs_{room}_thing"))
    plant(root, "src/section.f90", GOOD_MODULE.format(module="rbs_section"))
    plant(root, "src/bindings/bindings.f90", "subroutine s()\n implicit none\nend subroutine s\n")
    plant(root, "src/app/main.f90", "program p\n implicit none\n stop 1\nend program p\n")
    plant(root, "python/rbsdem/_core.py", "from rbsdem import _rbsdem\n")
    plant(root, "python/rbsdem/column.py", "from rbsdem import _core\n")
    plant(root, "tests/python/test_x.py", "PATH = 'data/x.csv'\n")
    plant(
        root, "README.md", "See [docs](docs/home/index.md), https://example.org/home/x, ../tmp/y.\n"
    )


def test_a_good_tree_has_no_faults(tmp_path: Path) -> None:
    good_tree(tmp_path)
    assert faults(tmp_path) == []


def changed(old: str, new: str) -> str:
    """Return the good module of src/solve with one change."""
    text = GOOD_MODULE.format(module="rbs_solve_thing")
    assert old in text
    return text.replace(old, new, 1)


USE = "   use rbs_base_kinds, only: wp\n"
WRITE = "      write (buffer, '(a)') 'save print stop'\n"
SOLVE = "src/solve/thing.f90"

BAD = {
    "an arrow back": (
        SOLVE,
        changed(USE, USE + "   use rbs_io_thing, only: thing\n"),
        "arrow from solve",
    ),
    "base uses case": (
        "src/base/kinds.f90",
        KINDS.replace("   implicit none", "   use rbs_case_thing, only: thing\n   implicit none"),
        "arrow from base back to case",
    ),
    "io sees bindings": (
        "src/io/thing.f90",
        GOOD_MODULE.format(module="rbs_io_thing").replace(
            USE, USE + "use rbs_bindings_runs, only: x\n"
        ),
        "arrow from io back to bindings",
    ),
    "bindings see app": (
        "src/bindings/bindings.f90",
        "subroutine s()\n use rbs_app_thing, only: thing\n implicit none\nend subroutine s\n",
        "arrow from bindings back to app",
    ),
    "neighbours": (
        "src/structure/column/thing.f90",
        GOOD_MODULE.format(module="rbs_structure_column_thing").replace(
            USE, USE + "use rbs_section, only: x\n"
        ),
        "arrow from structure back to section",
    ),
    "an unknown room": (
        "src/attic/thing.f90",
        GOOD_MODULE.format(module="rbs_attic_thing"),
        "no floor",
    ),
    "static uses time": (
        "src/solve/static/thing.f90",
        GOOD_MODULE.format(module="rbs_solve_static_thing").replace(
            USE, USE + "   use rbs_solve_time_thing, only: x\n"
        ),
        "arrow from solve/static to solve/time",
    ),
    "what is shared uses time": (
        SOLVE,
        changed(USE, USE + "   use rbs_solve_time_thing, only: x\n"),
        "arrow from solve/ to solve/time",
    ),
    "use without only": (SOLVE, changed(USE, "   use rbs_base_kinds\n"), "has no only"),
    "a continued arrow back": (
        SOLVE,
        changed(USE, USE + "   use &\n      rbs_app_thing, only: thing\n"),
        "arrow from solve back to app",
    ),
    "module not named like its file": (
        SOLVE,
        GOOD_MODULE.format(module="rbs_solve_other"),
        "its path asks for rbs_solve_thing",
    ),
    "two modules in a file": (
        SOLVE,
        changed("", "") + "module m\nend module m\n",
        "its path asks for",
    ),
    "no implicit none": (SOLVE, changed("   implicit none\n", ""), "no 'implicit none'"),
    "no private": (SOLVE, changed("   private\n", ""), "no 'private'"),
    "f2py file without implicit none": (
        "src/bindings/bindings.f90",
        "subroutine s()\nend subroutine s\n",
        "without implicit none",
    ),
    "save as attribute": (
        SOLVE,
        changed("real(wp) :: stopped", "real(wp), save :: stopped"),
        "saves state",
    ),
    "save as statement": (SOLVE, changed("   private\n", "   private\n   save\n"), "saves state"),
    "save implied": (SOLVE, changed(":: stopped", ":: stopped = 0.0_wp"), "by an initial value"),
    "module variable": (
        SOLVE,
        changed("   public", "   integer :: calls\n   public"),
        "module variable",
    ),
    "text of deferred length": (
        SOLVE,
        changed(
            "contains\n\n",
            "contains\n\n   function f(x) result(y)\n"
            "      character(len=:), allocatable :: y\n   end function f\n\n",
        ),
        "text of deferred length",
    ),
    "LAPACK called": (SOLVE, changed(WRITE, "      call dgesv(1)\n"), "LAPACK: dgesv"),
    "LAPACK declared": (
        SOLVE,
        changed(
            "   public",
            "   interface\n subroutine dsygv()\n end subroutine\n end interface\n public",
        ),
        "LAPACK: dsygv",
    ),
    "stop": (SOLVE, changed(WRITE, "      if (stopped > 0) stop 1\n"), "stops: 'stop 1'"),
    "error stop": (SOLVE, changed(WRITE, "      error stop 'no'\n"), "stops: 'error stop"),
    "print": (SOLVE, changed(WRITE, "      print *, stopped\n"), "reads or writes: 'print"),
    "write to the terminal": (
        SOLVE,
        changed(WRITE, "      write (*, *) stopped\n"),
        "reads or writes",
    ),
    "write to a unit": (
        SOLVE,
        changed(WRITE, "      write (unit=6, fmt=*) 1\n"),
        "reads or writes",
    ),
    "write to a unit by name": (
        SOLVE,
        changed(WRITE, "      write(error_unit, *) 1\n"),
        "reads or writes",
    ),
    "open": (SOLVE, changed(WRITE, "      open (newunit=i, file='x')\n"), "reads or writes: 'open"),
    "extension imported": (
        "python/rbsdem/column.py",
        "from rbsdem import _rbsdem\n",
        "imports the extension: rbsdem._rbsdem",
    ),
    "extension imported by a test": (
        "tests/python/test_x.py",
        "def test():\n    import rbsdem._rbsdem as core\n",
        "imports the extension: rbsdem._rbsdem",
    ),
    "path of a machine in a test": (
        "tests/python/test_x.py",
        f"PATH = '{ELSEWHERE}'\n",
        "line 1 names a path of one machine",
    ),
    "path of a machine in a text": (
        "docs/run.md",
        f"Run it:\n\n    rbsdem run {ELSEWHERE}\n",
        "line 3 names a path of one machine",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_tree_has_its_fault(name: str, tmp_path: Path) -> None:
    path, text, expected = BAD[name]
    good_tree(tmp_path)
    plant(tmp_path, path, text)
    found = faults(tmp_path)
    assert len(found) == 1, found
    assert found[0].startswith(path + ": ")
    assert expected in found[0]


def test_no_dense_solver_of_lapack_stands_in_a_loop_over_events_or_steps():
    """Full matrices are solved once, if asked for. What is solved again has a band or our loops."""
    used = {}
    for path in sorted((ROOT / "src").rglob("*.f90")):
        for line in statements(path.read_text()):
            if found := re.fullmatch(r"use rbs_base_linalg *, *only *: *(.*)", line):
                used[path.parent.name] = used.get(path.parent.name, set()) | set(
                    re.split(r" *, *", found[1])
                )
    assert ONCE & used.pop("modal")
    bands = {"solve_general_band", "solve_tridiagonal"}
    assert set().union(*used.values()) <= bands, used
