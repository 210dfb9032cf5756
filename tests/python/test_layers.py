"""The house keeps its order: arrows between rooms go one way, each room does its own job.

Reads the sources; needs neither a compiler nor the installed package. What a linter can say of one
file (`implicit none`, `only`, `private`, initial values that save), fortitude says; here stands
what it cannot: arrows between rooms, names of modules, state, LAPACK, and who may stop or write.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / "src"

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

#: What each room inside solve/ may use of the others; what they share lies beside them.
INNER: dict[str, tuple[str, ...]] = {
    "": (),
    "modal": (),
    "begin": ("modal", "static"),
    "one_body": (),
    "static": (),
    "time": ("modal", "one_body"),
    "ensemble": ("modal", "one_body", "time"),
}

#: Files without a module: what f2py reads, and the program. A handler of signals gets nothing but
#: their number, so it needs a variable that outlives a call. The version is generated.
NO_MODULE = ("bindings/bindings.f90", "app/main.f90")
HANDLER, VERSION = "app/signals.f90", "rbs_version"

LAPACK = re.compile(
    r"\b(?:call|subroutine|function) +"
    r"((?!stream\b|correct\b)[sdcz](?:ge|gb|gt|po|pp|pb|pt|sy|sp|sb|st|tr|tb|or|la)\w{2,4})\b"
)
DECLARATION = re.compile(
    r"(?:integer|real|complex|logical|character|(?:type|class|procedure) *\().*::"
)
STOPS = re.compile(r"(?:if *\(.*\) *)?(?:error +)?stop\b")
WRITES = re.compile(
    r"(?:if *\(.*\) *)?(?:print\b|(?:open|close|inquire|rewind|backspace|endfile|flush) *\("
    r"|(?:read|write) *\( *(?:unit *= *)?(?:\*|\d|\w*unit\b))"
)
MACHINE_PATH = re.compile(
    r"(?<![\w.~$})/:-])/(?:home|Users|root|work|mnt|media|srv|tmp)/\w|\b[A-Z]:\\\w"
)


def statements(text: str) -> list[str]:
    """Return the statements: lower case, continuations joined, comments out, strings emptied."""
    text = re.sub(r"'[^'\n]*'|\"[^\"\n]*\"", "''", text)
    text = re.sub(r"!.*", "", text.lower())
    text = re.sub(r"&\s*\n\s*&?", " ", text)
    return [part.strip() for part in re.split(r"[;\n]", text) if part.strip()]


def without(code: list[str], begin: str, end: str) -> list[str]:
    """Return the statements outside of blocks."""
    kept, inside = [], False
    for statement in code:
        inside = inside or bool(re.match(begin, statement))
        if not inside:
            kept.append(statement)
        inside = inside and not re.match(end, statement)
    return kept


def faults(name: str, code: list[str]) -> Iterator[str]:
    """Yield what is wrong with a file of src/, by its statements."""
    room, inner, *_ = *name.split("/")[:-1], "", ""
    for statement in code:
        match = re.match(r"use *(?:, *\w+ *)?(?:::)? *(rbs_\w+)", statement)
        if match and match[1] != VERSION:
            parts = match[1].split("_")
            if parts[1] != room and FLOOR.get(parts[1], 99) >= FLOOR[room]:
                yield f"uses {match[1]}: an arrow back"
            there = next((x for x in INNER if x and "_".join(parts[2:]).startswith(x + "_")), "")
            if room == parts[1] == "solve" and there not in ("", inner, *INNER[inner]):
                yield f"uses {match[1]}: an arrow from solve/{inner}"
        if name != "base/linalg.f90" and (match := LAPACK.search(statement)):
            yield f"has to do with LAPACK: {match[1]}"
        if room != "app" and STOPS.match(statement):
            yield f"stops: {statement}"
        if room not in ("io", "app") and WRITES.match(statement):
            yield f"reads or writes: {statement}"
    if name not in NO_MODULE:
        yield from faults_of_module(name, code)


def faults_of_module(name: str, code: list[str]) -> Iterator[str]:
    """Yield what is wrong with a module: its name, and state that outlives a call."""
    kind = r"(?:sub)?module *(?:\(\w+\))? +(?!procedure\b)(\w+)$"
    modules = [m[1] for s in code if (m := re.match(kind, s))]
    expected = "rbs_" + name.removesuffix(".f90").replace("/", "_")
    if modules != [expected]:
        yield f"holds {modules}, its path asks for {expected}"
    own = without(code, r"type *(?:,[^()]*)?(?:::)? *\w+$|type *,.*::", r"end *type\b")
    own = without(own, r"(?:abstract +)?interface\b", r"end *interface\b")
    head = own[: own.index("contains")] if "contains" in own else own
    for statement in head:
        if DECLARATION.match(statement) and "parameter" not in statement and name != HANDLER:
            yield f"has a module variable: {statement}"
    if any(re.match(r"save\b|.*, *save\b.*::", statement) for statement in own):
        yield "saves state"
    # gfortran keeps the length of such a result in static storage of the caller, which threads
    # would share.
    for function in re.findall(r"\bfunction \w+.*?end function", "\n".join(own), re.DOTALL):
        result = re.search(r"result *\((\w+)\)", function)
        deferred = re.search(r"character\(len=:\).*::.*", function)
        if (
            not name.startswith("app/")
            and result
            and deferred
            and re.search(rf"\b{result[1]}\b", deferred[0])
        ):
            yield f"a function returns text of deferred length: {function.splitlines()[0]}"


@pytest.mark.parametrize(
    "path", sorted(SRC.rglob("*.f90")), ids=lambda path: path.relative_to(SRC).as_posix()
)
def test_a_file_keeps_the_order(path: Path) -> None:
    assert not list(
        faults(path.relative_to(SRC).as_posix(), statements(path.read_text(encoding="utf-8")))
    )


def test_only_one_module_knows_the_extension() -> None:
    knows = re.compile(r"import _rbsdem|import .*, _rbsdem|rbsdem\._rbsdem\b")
    files = [path for path in (ROOT / "python").rglob("*.py") if knows.search(path.read_text())]
    assert {path.name for path in files} <= {"_core.py", "_package.py"}


def test_texts_name_no_path_of_the_machine_that_they_were_written_on() -> None:
    found = []
    for folder in ("tests", "docs", "examples", "studies", "data"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix in (".py", ".md", ".nml", ".csv", ".txt", ".f90") and path.is_file():
                text = path.read_text(encoding="utf-8", errors="ignore")
                found += [f"{path}: {match[0]}" for match in MACHINE_PATH.finditer(text)]
    assert not found


def test_no_dense_solver_of_lapack_stands_in_a_loop_over_events_or_steps() -> None:
    """Full matrices are solved once, if asked for. What is solved again has a band or our loops."""
    used: dict[str, set[str]] = {}
    for path in SRC.rglob("*.f90"):
        for line in statements(path.read_text(encoding="utf-8")):
            if match := re.fullmatch(r"use rbs_base_linalg *, *only *: *(.*)", line):
                used.setdefault(path.parent.name, set()).update(re.split(r" *, *", match[1]))
    assert "solve_dense" in used.pop("modal")
    assert set().union(*used.values()) <= {"solve_general_band", "solve_tridiagonal"}, used
