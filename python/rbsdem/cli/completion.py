"""The command `rbsdem completion`: what the tabulator completes in a shell.

The words of the command line are stated once, in the parsers of the commands; names of groups and
rules come from the list of keys.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module

from rbsdem import _core
from rbsdem._optional import need_shtab
from rbsdem.cli.parser import CommandParser, run_command

SHELLS = ("bash", "zsh", "fish")

DESCRIPTION = """\
Print a script that completes commands, options, files, and names of groups and rules.
"""

EPILOG = """\
bash:  rbsdem completion bash > ~/.local/share/bash-completion/completions/rbsdem
zsh:   rbsdem completion zsh > DIR/_rbsdem, where DIR is one of $fpath
fish:  rbsdem completion fish > ~/.config/fish/completions/rbsdem.fish
Exit codes: 0 printed, 1 the package shtab is missing, 2 the input is wrong.
"""


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("completion", DESCRIPTION, EPILOG)
    parser.add_argument("shell", choices=SHELLS, help="shell that completes")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str
        Words after `completion`.

    Returns
    -------
    int
        Exit code.
    """
    given = parser().parse_args(arguments)
    return run_command("rbsdem: completion", lambda: _print(given.shell))


def _print(shell: str) -> int:
    shtab = need_shtab()
    whole = whole_parser()
    _name_files(whole, shtab.FILE, shtab.DIRECTORY)
    print(shtab.complete(whole, shell=shell))
    return 0


def whole_parser() -> argparse.ArgumentParser:
    """Return one parser of all commands, those of the executable among them."""
    # By its name, as that module imports the commands by theirs.
    commands_of_python = import_module("rbsdem.__main__").COMMANDS
    whole = argparse.ArgumentParser(prog="rbsdem")
    whole.add_argument("--version", action="store_true", help="number of the version")
    commands = whole.add_subparsers()
    _add_executable(commands)
    for name, module in commands_of_python.items():
        source = import_module(module)
        commands.add_parser(
            name,
            parents=[source.parser()],
            conflict_handler="resolve",
            help=source.DESCRIPTION.split(".", maxsplit=1)[0],
        )
    return whole


def _add_executable(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the commands of the executable, which has no parser of Python."""
    quiet = ("-q", "--quiet")
    run = commands.add_parser("run", help="solve a case, write a csv")
    run.add_argument("case", metavar="CASE.nml")
    run.add_argument("-o", "--output", metavar="FILE", help="file for the rows")
    run.add_argument(*quiet, action="store_true", help="no summary and no progress")
    check = commands.add_parser("check", help="find all errors of the input")
    check.add_argument("case", metavar="CASE.nml")
    check.add_argument(*quiet, action="store_true", help="print errors only")
    modes = commands.add_parser("modes", help="natural frequencies, stable step")
    modes.add_argument("case", metavar="CASE.nml")
    modes.add_argument("--count", metavar="N", help="this many, the lowest")
    modes.add_argument("--matrices", action="store_true", help="mass and stiffness matrices too")
    keys = commands.add_parser("keys", help="keys of a group or rule, or all")
    known = _core.keys()
    keys.add_argument("name", nargs="?", choices=[*known["groups"], *known["rules"]])
    keys.add_argument("--json", action="store_true", help="all keys as JSON")


def _name_files(
    parser: argparse.ArgumentParser, file: dict[str, str], folder: dict[str, str]
) -> None:
    """Tell which arguments are files and folders, by the words that stand for their values."""
    kinds = {"DIR": folder} | dict.fromkeys(("CASE.nml", "FILE", "RECORD", "RECORDS"), file)
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for one in action.choices.values():
                _name_files(one, file, folder)
        elif action.metavar in kinds:
            vars(action)["complete"] = kinds[action.metavar]
