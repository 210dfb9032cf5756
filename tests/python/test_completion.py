"""The command `rbsdem completion`, and `rbsdem keys NAME`."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import click
import pytest

from rbsdem.__main__ import COMMANDS
from rbsdem.cli import COMPLETE, app, main


def test_every_command_and_option_of_the_executable_is_known(run_cli):
    """The commands that stand for the executable have the words of its help."""
    own, python = run_cli(["--help"]).stdout.split("with the Python package")
    usage = re.findall(r"^  rbsdem ([a-z]+) (.*?)  ", own, re.MULTILINE)
    assert {name for name, _ in usage} == set(app.commands)
    assert set(re.findall(r"^  rbsdem ([a-z]+) ", python, re.MULTILINE)) == set(COMMANDS)
    assert set(app.list_commands(click.Context(app))) == {*app.commands, *COMMANDS}
    for name, words in usage:
        known = {option for param in app.commands[name].params for option in param.opts}
        assert set(re.findall(r"--\w+", words)) == {o for o in known if o.startswith("--")}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_script_asks_the_program(shell, capsys):
    assert main(["completion", shell]) == 0
    assert f"{COMPLETE}={shell}_complete" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("rbsdem mo", ["plain,modes"]),
        ("rbsdem keys peak", ["plain,peak_oriented"]),
        ("rbsdem run --out", ["plain,--output"]),
        ("rbsdem check a", ["file,a"]),
        ("rbsdem ida --out ", ["dir,"]),
    ],
)
def test_completions(words, offered):
    asked = words.split(" ")
    given = {"COMP_WORDS": words, "COMP_CWORD": str(len(asked) - 1), COMPLETE: "bash_complete"}
    done = subprocess.run(
        [sys.executable, "-m", "rbsdem"],
        env=os.environ | given, capture_output=True, text=True, check=True, timeout=20,
    )  # fmt: skip
    assert done.stdout.splitlines() == offered
