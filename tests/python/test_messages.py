"""What is wrong is told: each fault of `messages.txt` by the sentence beside it, through all doors.

A line there is ``what is given => what is said``; more of what is said follows on lines that begin
with ``=>``. To write it anew: RBSDEM_UPDATE=1 python -m pytest tests/python/test_messages.py; then
read what has changed as the engineer who has made the mistake.
"""

from __future__ import annotations

import os
import pickle
import re
import shlex
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import DYNAMIC
from strategies import GOOD

import rbsdem
from rbsdem import _core, motions, peer, springs
from rbsdem.cli import main
from rbsdem.model.springs import SPRINGS
from rbsdem.springs import Elastic

FILE = Path(__file__).with_name("messages.txt")
FATAL = ("Fortran runtime", "Backtrace", "SIG", "At line", "Traceback", "\0")

Tell = Callable[[str], list[str]]


def sections() -> dict[str, list[tuple[str, list[str]]]]:
    """Return what is given and what is said, by the section of the file."""
    found: dict[str, list[tuple[str, list[str]]]] = {}
    for line in FILE.read_text("utf-8").splitlines():
        if line.startswith("["):
            entries = found.setdefault(line.strip("[]"), [])
        elif "=>" in line and found:
            given, _, told = (part.strip() for part in line.partition("=>"))
            if given:
                entries.append((given, [told]))
            else:
                entries[-1][1].append(told)
    return found


def update(section: str, told: list[tuple[str, list[str]]]) -> None:
    """Write what is said now in the place of what was said, and leave headings alone."""
    head, mark, rest = FILE.read_text("utf-8").partition(f"[{section}]\n")
    own, *tail = rest.partition("\n[")
    news = iter(told)
    lines = []
    for line in own.splitlines():
        if "=>" not in line:
            lines.append(line)
        elif not line.startswith("    =>"):
            given, said = next(news)
            lines.append(f"{given} " + "\n    ".join(f"=> {sentence}" for sentence in said))
    FILE.write_text(head + mark + "\n".join(lines) + "\n" + "".join(tail), "utf-8")


TAKEDA = springs.Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
COLUMN = rbsdem.Column(1.6, 614.4, springs.Bilinear(7.0387e8, 1.296e-4, 8.3185e6), TAKEDA)
STEEL = rbsdem.Steel(446e6)
TIES = rbsdem.Ties(0.007, 0.085, rbsdem.Steel(364e6), legs=4)
SECTION = rbsdem.RectangularSection(
    0.4, 0.4, rbsdem.Concrete(46.5e6), ties=TIES, cover=0.013,
    layout=rbsdem.Layout(12, 0.016, STEEL),
)  # fmt: skip
SPECIMEN = peer.Specimen("x", "rectangular", 1.6, 0.4, 0.4, 46.5e6, 744e3, 12)
ROUND = rbsdem.CircularSection(
    1.0, rbsdem.Concrete(30e6), layout=rbsdem.Layout(16, 0.016, STEEL), cover=0.03, wall=0.2,
    spiral=rbsdem.Spiral(0.01, 0.1, STEEL), inner_layout=rbsdem.Layout(16, 0.016, STEEL),
)  # fmt: skip
WALL = rbsdem.WallSection(
    2.0, 0.2, rbsdem.Concrete(30e6),
    boundary=rbsdem.Boundary(0.3, [(0.05, 1e-3, STEEL)], rbsdem.Hoops(0.01, 0.1, STEEL)),
    vertical=rbsdem.Curtain(0.01, 0.2, STEEL), horizontal=rbsdem.Curtain(0.01, 0.2, STEEL),
)  # fmt: skip
DRAWN_OF = {"spiral": ROUND, "inner_layout": ROUND, "boundary": WALL, "curtain": WALL}
RECORD = motions.synthetic(1)[0]
LOADING = "&loading drive = 'displacement', amplitudes = 0.001 /\n"
DRAWN = rbsdem.section.column(SECTION, 1.6, axial_load=744e3).to_namelist() + LOADING

FRAMED = """\
&frame storeys = 3.2, 3.2, bays = 6.0, 5.0, kinematics = 'pdelta' /
&floor mass = 4e4, dead_load = 2e4 /
&member_kind name = 'C', modulus = 3e10, area = 0.16, inertia = 2e-3, yield_moment = 2.5e5 /
&member_kind name = 'B', modulus = 3e10, area = 0.15, inertia = 2e-3, interior = 'rigid' /
&flexure kind = 'B', position = 0, 0.5, 1, rule = 'bilinear', k = 6e7, d_y = 4e-3, k_post = 1e5 /
&column_of kind = 'C', rigid_end = 0.3 /
&beam_of kind = 'B' /
&node name = 'A', x = 14.0, y = 3.2, support = 'roller' /
&member name = 'M', from = 'N-3-1', to = 'A', kind = 'C' /
"""
INFILL = "&infill name = 'I', thickness = 0.2, fm = 2e6 /\n&infill_of bay = 1, kind = 'I' /\n"
LOSS = "&loss member = 'M' /\n"
NODE_LOAD = "&node_load line = 1, floor = 1, load = 1e3 /\n"
PLANE = "&plane name = 'x-1' /\n"
STRIP = "rule = 'concrete', k = 2e9, f_peak = 6e5, d_peak = 6e-4, k_soft = 4e7"
LAYER_SPRINGS = [f"id = 1, {STRIP}", "id = 2, rule = 'steel', k = 6e8, f_y = 5.4e5, k_post = 0"]
#: A layered joint whose bars do not harden.
LAYERED = {
    "column": "height = 1.6, mass = 600, kinematics = 'pdelta', axial_load = 7e5",
    "flexure": "rule = 'layered'",
    "layers": "y = 0, 0, -0.15, 0.15, -0.16, 0.16, spring = 1, 1, 1, 1, 2, 2",
}
AT2 = """\
PEER NGA STRONG MOTION DATABASE RECORD
Imperial Valley-06, 10/15/1979, El Centro Array #6, 230
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      7, DT=   .0050 SEC,
  .1000000E-03  -.2000000E-02   .3000000E+00  -.4000000E+00   .5000000E-01
 -.6000000E-01   .7000000E-05
"""
TIME = np.linspace(0.0, 3.0, 90)
D = np.round(12.0 * TIME * np.sin(2 * np.pi * TIME), 3)
# A loop that takes up energy: the force is ahead of the displacement.
F = np.round(180 * np.tanh((D + 4 * np.cos(2 * np.pi * TIME) * (TIME > 0)) / 10), 2)
LABORATORY = "t,d,f\n" + "".join(f"{t:g},{d:g},{f:g}\n" for t, d, f in zip(TIME, D, F, strict=True))


def motion(text: str, **options: Any) -> object:
    Path("a.csv").write_text(text)
    return motions.read_motion("a.csv", **options)


def at2(old: str, new: str) -> object:
    Path("a.AT2").write_text(AT2.replace(old, new))
    return motions.read_motion("a.AT2")


def history(text: str, **options: Any) -> object:
    Path("a.csv").write_text(text)
    return peer.read_peer("a.csv", **options)


def laboratory(text: str = LABORATORY, **given: Any) -> object:
    Path("a.csv").write_text(text)
    usual = {"pdelta_code": 2, "length": 1.6, "units": ("mm", "kN")}
    return rbsdem.read_test("a.csv", **usual | given)


NAMES = {name: getattr(rbsdem, name) for name in rbsdem.__all__} | vars(springs) | globals()
NAMES |= {"E": Elastic(1e8), "nan": np.nan, "inf": np.inf}


def changes(given: str) -> dict[str, Any]:
    """Groups put into a case: "&name entries", several of one name, "&name none"."""
    found: dict[str, Any] = {}
    for part in re.split(r" (?=&\w)", given):
        name, _, entries = part[1:].partition(" ")
        found[name] = None if entries == "none" else [*found.get(name, []), entries]
    return found


def plain(text: str) -> bytes:
    """Bytes of a file; \\n, \\t and the like stand for themselves."""
    return b"" if text == "(empty)" else text.encode().decode("unicode_escape").encode("latin-1")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def told_by_python(call: Callable[[], object]) -> list[str]:
    with pytest.raises(rbsdem.InputError) as caught:
        call()
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.faults, str(again)) == (caught.value.faults, str(caught.value))
    return str(caught.value).splitlines()


def refused(result: Any) -> list[str]:
    """Lines of a failure: the code, nothing on stdout, the program's name before every line."""
    assert (result.returncode, result.stdout) == (2, ""), result
    assert not any(word in result.stderr for word in FATAL)
    lines = result.stderr.splitlines()
    assert all(line.startswith("rbsdem: ") for line in lines), lines
    return [line.removeprefix("rbsdem: ") for line in lines]


def framed(given: str) -> str:
    """Return the case of a frame with changes, ``old -> new`` with semicolons between."""
    text = FRAMED + LOADING
    for change in given.split("; "):
        old, new = change.split(" -> ")
        assert old in text, old
        text = text.replace(old, "" if new == "nothing" else new)
    return text


@pytest.fixture
def by_file(run_cli, folder):
    """Faults of `case.nml`: of `check`, `run` and Python the same; nothing is written."""

    def tell(content: str | bytes) -> list[str]:
        (folder / "case.nml").write_bytes(content.encode() if isinstance(content, str) else content)
        before = sorted(os.listdir(folder))
        check, run = (refused(run_cli([word, "case.nml"], folder)) for word in ("check", "run"))
        assert check == run
        assert sorted(os.listdir(folder)) == before
        python = told_by_python(lambda: rbsdem.read_case("case.nml").run())
        assert python == check or "has no loading" in check[0]
        return check

    return tell


@pytest.fixture
def doors(run_cli, case_text, folder, by_file, capsys) -> dict[str, Tell]:
    def arguments(given: str) -> list[str]:
        (folder / "case.nml").write_text(case_text())
        lines = refused(run_cli(shlex.split(given)[1:], folder))
        assert os.listdir(folder) == ["case.nml"]
        return lines

    def layers(given: str) -> list[str]:
        put = changes(given)
        own = LAYER_SPRINGS + put.pop("layer_spring", [])
        if len(own) > 2:  # the first layer is one of the third
            put["layers"] = LAYERED["layers"].replace("spring = 1", "spring = 3")
        return by_file(case_text(**LAYERED | {"layer_spring": own} | put))

    def drawing(given: str) -> list[str]:
        old, new = given.split(" -> ")
        assert old in DRAWN
        (folder / "case.nml").write_text(DRAWN.replace(old, "" if new == "nothing" else new))
        return told_by_python(lambda: rbsdem.read_case("case.nml"))

    def of_history(given: str) -> list[str]:
        keys, _, content = given.partition(" < ")
        (folder / "h.csv").write_bytes(plain(content))
        loading = f"{keys}, file = 'h.csv'"
        return by_file(case_text(loading=loading, analysis="method = 'rk4'"))

    def record(given: str) -> list[str]:
        old, new = given.split(" -> ")
        (folder / "record.AT2").write_text(AT2.replace(old, new))
        loading = "drive = 'ground_acceleration', file = 'record.AT2'"
        return by_file(case_text(loading=loading, analysis="method = 'rk4'"))

    def of_test(given: str) -> list[str]:
        (folder / "test.txt").write_bytes(plain(given))
        told = by_file(case_text(loading="drive = 'displacement', file = 'test.txt'"))
        assert told_by_python(lambda: peer.read_peer("test.txt")) == told
        assert max(map(len, told)) < 300
        assert all(map(str.isprintable, told))
        return told

    def note(given: str) -> list[str]:
        """Of `check`, of `run` where it comes to its end, and as warnings of Python."""
        (folder / "case.nml").write_text(case_text(**changes(given)))
        check, run = (run_cli([word, "case.nml"], folder) for word in ("check", "run"))
        told = {
            name: [line[6:] for line in result.stdout.splitlines() if line.startswith("note: ")]
            for name, result in (("check", check), ("run", run))
        }
        whole = told["run"] if run.returncode == 0 else told["check"]
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with suppress(rbsdem.SolveError):
                rbsdem.read_case("case.nml").run()
        assert [str(one.message) for one in caught] == whole
        assert run_cli(["check", "case.nml", "-q"], folder).stdout == ""
        return whole or ["nothing"]

    def python(given: str) -> list[str]:
        told = told_by_python(lambda: eval(given, dict(NAMES)))
        assert not any(word in line for line in told for word in FATAL)
        return told

    def command(given: str) -> list[str]:
        (folder / "case.nml").write_text(case_text(**DYNAMIC))
        assert main(shlex.split(given)[1:]) == 2
        assert set(os.listdir(folder)) <= {"case.nml", "out"}
        told = capsys.readouterr()
        assert told.out == ""
        return told.err.splitlines()

    return {
        "arguments": arguments,
        "case": lambda given: by_file(case_text(**changes(given))),
        "case in time": lambda given: by_file(case_text(**DYNAMIC | changes(given))),
        "layers": layers,
        "drawing": drawing,
        "frame": lambda given: by_file(framed(given)),
        "file": lambda given: by_file(plain(given)),
        "history": of_history,
        "record": record,
        "test": of_test,
        "note": note,
        "python": python,
        "command": command,
    }


@pytest.mark.parametrize("section", sections())
def test_each_fault_is_told_as_it_stands_in_the_file(doors, section):
    entries = sections()[section]
    told = [(given, doors[section](given)) for given, _ in entries]
    if os.environ.get("RBSDEM_UPDATE"):
        update(section, told)
    assert told == entries


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: rbsdem.Concrete(46.5), "concrete.fc"),
        (lambda: Elastic(-1.0), "elastic spring.k"),
        (lambda: rbsdem.Layout("many", 0.016, STEEL), "layout.number"),
        (lambda: rbsdem.protocol([]), "protocol.amplitudes"),
        (lambda: rbsdem.protocol([0.01, "x"]), "amplitudes"),
        (lambda: rbsdem.protocol([0.01, -0.02]), "loading.amplitudes"),
    ],
)
def test_an_input_error_knows_its_field(call, field):
    with pytest.raises(rbsdem.InputError) as caught:
        call()
    assert caught.value.field == field


def test_each_line_of_an_input_error_has_its_field():
    lines = "a b.nml line 4: k = 1 must be 2\nties: legs_across = 9 do not fit\nthere is no column"
    error = rbsdem.InputError(lines)
    assert [field for field, _ in error.faults] == ["k", "ties.legs_across", ""]
    assert rbsdem.InputError("no core is left", "section: cover").field == "section.cover"


def test_many_runs_are_warned_of_once():
    """Python shows a warning once for a line of code, if the text is the same."""
    code = """
import rbsdem
elastic = rbsdem.springs.Elastic(1e6)
column = rbsdem.Column(1.0, 100.0, elastic, elastic, axial_load=2e3, kinematics="pdelta")
for i in range(20):
    rbsdem.cyclic(column, displacement=[0.0, 0.3 + 0.01 * i])
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stderr.count("AccuracyWarning") == 1


KEYS = _core.keys()
SPRING_PAIR = {"shear": Elastic(1e8), "flexure": Elastic(1e8)}
METHODS = {"tolerance": "rk45", "rho_infinity": "hht"}
#: Groups through the keywords of Python that they stand for.
KEYWORDS: dict[str, Callable[..., object]] = {
    "column": lambda **v: rbsdem.Column(**{"height": 2.0, "mass": 500.0} | SPRING_PAIR | v),
    "damping": lambda **v: rbsdem.Column(2.0, 500.0, **SPRING_PAIR, damping=rbsdem.Damping(**v)),
    "analysis": lambda **v: rbsdem.time_history(
        COLUMN, [0.0, 1.0], force=[0.0, 0.0], method=METHODS.get(*v, "rk4"), **v
    ),
    "loading": lambda **v: rbsdem.protocol(**{"amplitudes": [0.1]} | v),
    "section": lambda **v: replace(SECTION, **v),
    "concrete": lambda **v: rbsdem.Concrete(**{"fc": 30e6} | v),
    "steel": lambda **v: rbsdem.Steel(**{"fy": 4e8} | v),
}
#: Keys of a file that are no keywords, or go by other words.
IN_FILES = {"footing_mass", "footing_inertia", "footing_height", "duration", "period", "interval"}
IN_FILES |= {"reference", "largest", "strips", "scale", "time", "values"}
#: Keys whose refusals name what they refer to, and stand in `messages.txt`.
REFERENCES = {"joint", "id", "spring", "steel", "between_steel", "y", "position"}
OF_OTHER_KINDS = {
    "real": ("'1.6'", "must be a number without quotes"),
    "integer": ("1.5", "must be a whole number"),
    "logical": ("1", "must be .true. or .false."),
    "word": ("1", "must be a text in quotes: '1'"),
    "text": ("1", "must be a text in quotes: '1'"),
}


def faulty_numbers(key: dict[str, Any]) -> Iterator[tuple[float, str]]:
    """Yield values beside the bounds of a key, and none at all, and what each must be."""
    low, high = key.get("least"), key.get("most")
    if None not in (low, high) and not (key.get("least_open") or key.get("most_open")):
        sentence = re.escape(f"must be from {low:g} to {high:g}")
        yield from ((value, sentence) for value in (low // 2 if low else -1, 2 * high))
    elif low is not None:
        if key.get("least_open"):
            yield low, f"must be above {low:g}" if low else "must be above zero"
        else:
            yield low - 1, f"must be {low:g} or more" if low else "must not be negative"
        if key.get("most_open"):
            yield high, f"must be below {high:g}"
        elif high is not None:
            yield 2 * high, f"must not be above {high:g}"
    if key["kind"] == "real":
        yield from ((value, "must be a finite number") for value in (np.nan, -np.inf))
        yield 1e60, "(is outside the range in which products|must)"


def put(text: str, group: str, name: str, value: str) -> str:
    """Put a key into the first group of its name, in place of what it has there."""
    if f"&{group} " not in text:
        return f"{text}&{group} {name} = {value} /\n"
    own = re.search(rf"&{group} .*?/\n", text, re.DOTALL)[0]
    others = re.sub(rf"(?<=[ ,\n]){name} = [^=]*?(, |\s*(?=/))(?=\w+ =|/)", "", own)
    return text.replace(own, others.replace(f"&{group} ", f"&{group} {name} = {value}, ", 1), 1)


@pytest.mark.parametrize("group", KEYS["groups"])
@pytest.mark.filterwarnings("ignore:the section is hollow")
def test_a_key_refuses_what_it_cannot_take(folder, case_text, group):
    """Other kinds of values, and numbers beside its bounds: these in a file and as a keyword."""
    text = case_text()
    if group in ("analysis", "loading"):
        text = case_text(**DYNAMIC)
    elif group in ("layer_spring", "layers"):
        text = case_text(**LAYERED, layer_spring=LAYER_SPRINGS)
    elif group in DRAWN_OF:
        text = rbsdem.section.column(DRAWN_OF[group], 3.0, axial_load=1e6).to_namelist() + LOADING
    elif f"&{group} " not in text and f"&{group} " in FRAMED + LOSS + INFILL + NODE_LOAD + PLANE:
        text = FRAMED + LOSS * (group == "loss") + INFILL * ("infill" in group) + LOADING
        text += NODE_LOAD * (group == "node_load") + PLANE * (group == "plane")
    elif f"&{group} " not in text and f"&{group} " in DRAWN:
        text = DRAWN
    for key in KEYS["groups"][group]:
        name = key["name"]
        faults: list[tuple[Any, str]] = [OF_OTHER_KINDS[key["kind"]]]
        if key["kind"] in ("real", "integer") and name not in REFERENCES:
            faults += faulty_numbers(key)
        if "choices" in key:
            faults.append(("'none'", f"is not known; it is one of {', '.join(key['choices'])}"))
        for value, sentence in faults:
            changed = put(text, group, name, str(value))
            if group == "analysis" and name != "method":
                changed = put(changed, group, "method", f"'{METHODS.get(name, 'rk4')}'")
            Path("case.nml").write_text(changed)
            said = re.compile(rf"\b{name}(\(1\))? = .*{sentence}")
            in_file = [*filter(said.search, told_by_python(lambda: rbsdem.read_case("case.nml")))]
            assert len(in_file) == 1, (name, value)
            if group in KEYWORDS and name not in IN_FILES and not isinstance(value, str):
                is_array = "values" in key
                # Arrays, and the numbers of a drawing, have other words for what is not finite.
                if abs(value) < 1e50 or (group in ("column", "analysis") and not is_array):
                    call = partial(KEYWORDS[group], **{name: [value] if is_array else value})
                    assert [*filter(said.search, told_by_python(call))] == in_file, (name, value)


@pytest.mark.parametrize("rule", GOOD)
def test_a_parameter_of_a_rule_refuses_what_it_cannot_take(folder, case_text, rule):
    """And is asked for, where a rule must have it."""
    group = "axial_spring" if rule in ("compression", "concrete") else "flexure"
    place = group.replace("flexure", "flexure spring").replace("_", " ")
    for key in KEYS["rules"][rule]["keys"]:
        for value, sentence in faulty_numbers(key) if key["kind"] == "real" else ():
            given = GOOD[rule] | {key["name"]: value}
            entries = ", ".join(f"{name} = {number}" for name, number in given.items())
            Path("case.nml").write_text(case_text(**{group: f"rule = '{rule}', {entries}"}))
            python = told_by_python(lambda given=given: SPRINGS[rule](**given))
            assert re.match(rf"{rule} spring: {key['name']} = .*{sentence}", python[0])
            in_file = told_by_python(lambda: rbsdem.read_case("case.nml"))
            assert [re.sub(rf"^line \d+: {place}: ", "", line) for line in in_file] == [
                line.removeprefix(f"{rule} spring: ") for line in python
            ]
    Path("case.nml").write_text(case_text(**{group: f"rule = '{rule}'"}))
    missing = told_by_python(lambda: rbsdem.read_case("case.nml"))
    assert [line.split(": ")[2].split()[0] for line in missing] == list(GOOD[rule])
