"""The command `rbsdem completion`, and `rbsdem keys NAME`."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from rbsdem import _core
from rbsdem.__main__ import COMMANDS
from rbsdem.cli import completion


def test_every_command_and_option_of_the_executable_is_known(run_cli):
    """The parser that stands for the executable has the words of its help."""
    whole = completion.whole_parser()
    parsers = next(a for a in whole._actions if a.choices).choices
    usage = re.findall(r"^  rbsdem ([a-z]+) (.*?)  ", run_cli(["--help"]).stdout, re.MULTILINE)
    assert {name for name, _ in usage} == set(parsers) - set(COMMANDS)
    for name, words in usage:
        known = {o for a in parsers[name]._actions for o in a.option_strings}
        assert set(re.findall(r"--\w+", words)) == {o for o in known if o.startswith("--")} - {
            "--help"
        }


@pytest.mark.parametrize("shell", completion.SHELLS)
def test_script_names_commands_and_rules(shell, capsys):
    pytest.importorskip("shtab")
    assert completion.main([shell]) == 0
    text = capsys.readouterr().out
    for word in [*COMMANDS, "modes", "takeda", "--model-version"]:
        assert word in text, word


def test_bash_completes(tmp_path):
    pytest.importorskip("shtab")
    if not shutil.which("bash"):
        pytest.skip("there is no bash")
    script = tmp_path / "rbsdem"
    done = subprocess.run(
        ["bash", "-c", f"rbsdem completion bash > {script}"], check=False, timeout=60
    )
    assert done.returncode == 0
    (tmp_path / "a column.nml").touch()

    def offered(*words: str) -> list[str]:
        line = " ".join(f"'{word}'" for word in ("rbsdem", *words))
        commands = (
            f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words)}; "
            'COMP_LINE="${COMP_WORDS[*]}"; _shtab_rbsdem; printf "%s\\n" "${COMPREPLY[@]}"'
        )
        done = subprocess.run(
            ["bash", "-c", commands],
            cwd=tmp_path, capture_output=True, text=True, check=True, timeout=20,
        )  # fmt: skip
        return done.stdout.split("\n")[:-1]

    assert offered("mo") == ["modes"]
    assert offered("keys", "peak") == ["peak_oriented"]
    assert offered("run", "--out") == ["--output"]
    assert offered("check", "a") == ["a column.nml"]


def test_keys_of_one_rule_or_group(run_cli):
    whole = run_cli(["keys"]).stdout
    one = run_cli(["keys", "takeda"]).stdout
    assert one in whole
    assert one.startswith("rule = 'takeda'")
    assert {line.split()[0] for line in one.splitlines()[1:]} == {
        key["name"] for key in _core.keys()["rules"]["takeda"]["keys"]
    }
    assert run_cli(["keys", "column"]).stdout.startswith("&column\n")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["takedo"], "there is no group or rule 'takedo'; did you mean 'takeda'?"),
        (["takeda", "column"], "one argument too many: 'column'"),
        (["takeda", "--json"], "--json prints all keys; leave takeda away"),
    ],
)
def test_keys_that_are_not_there(run_cli, words, text):
    done = run_cli(["keys", *words])
    assert done.returncode == 2
    assert text in done.stderr
