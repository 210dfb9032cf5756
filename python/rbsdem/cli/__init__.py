"""The commands that are written in Python: help, completion, messages and exit codes."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import click
from click.shell_completion import CompletionItem, get_completion_class

from rbsdem import _core
from rbsdem._package import COMMANDS
from rbsdem.errors import InputError, RbsdemError

#: Variable of the environment by which a shell asks for completions.
COMPLETE = "_RBSDEM_COMPLETE"
#: Exit code after a keyboard interrupt.
INTERRUPTED = 130
# As a shell reports a process that was ended by a signal.
_TERMINATED = 128 + 15
_BROKEN_PIPE = 128 + 13

FILE = click.Path(path_type=Path)
FOLDER = click.Path(file_okay=False, path_type=Path)
CASE = click.argument("case", type=FILE, metavar="CASE.nml")
quiet = click.option("--quiet", is_flag=True, help="print nothing but errors")


class Values(click.Option):
    """An option that takes all words up to the next option."""

    def __init__(self, names: Sequence[str], **settings: Any) -> None:
        super().__init__(names, **settings | {"multiple": True})


class Command(click.Command):
    """A command whose `Values` take several words."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the name of an option of the type `Values` before each of its values."""
        several = {name for p in self.params if isinstance(p, Values) for name in p.opts}
        words: list[str] = []
        option = ""
        for word in args:
            if word.startswith("--"):
                option = word if word in several else ""
            elif option and words[-1] != option:
                words.append(option)
            words.append(word)
        return super().parse_args(ctx, words)


class _Commands(click.Group):
    """All commands; a module is imported when its command is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names, those of the executable among them."""
        return [*self.commands, *COMMANDS]

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Return a command by its name."""
        if name not in COMMANDS:
            return self.commands.get(name)
        command: click.Command = getattr(import_module(COMMANDS[name]), name)
        # Where click keeps the lines of a help as they are.
        command.help = (command.help or "").replace("\\b\n", "\b\n")
        return command


app = _Commands(
    "rbsdem", context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100}
)


def main(words: Sequence[str]) -> int:
    """Run a command that is written in Python.

    Parameters
    ----------
    words : sequence of str
        Name of the command and its arguments.

    Returns
    -------
    int
        Exit code: that of the command, 2 if the input is wrong, 1 if something else is, 130 after
        a keyboard interrupt, 141 if the reader of the output has closed it.
    """
    if COMPLETE in os.environ:
        app.main(prog_name="rbsdem")
    text = ""
    try:
        with (
            _termination_as_exception(),
            plain_warnings(f"rbsdem: {words[0]}"),
            app.make_context("rbsdem", list(words)) as context,
        ):
            code = int(app.invoke(context))
        _flush()
    except click.exceptions.Exit as end:
        code = end.exit_code
    except click.ClickException as error:
        code, text = error.exit_code, error.format_message().rstrip(".")
    except BrokenPipeError:
        # As with `| head`: an end, and no error.
        code = _BROKEN_PIPE
    except InputError as error:
        code, text = 2, str(error)
    except MemoryError:
        code, text = 1, "not enough memory; raise the limit of the process, or ask for less"
    except (RbsdemError, ImportError, OSError) as error:
        code, text = 1, str(error)
    except KeyboardInterrupt as error:
        code, text = INTERRUPTED, str(error) or "interrupted"
    for line in text.splitlines():
        # Functions that are commands name themselves.
        tell(line.removeprefix(f"{words[0]}: "), words[0])
    _release_stdout()
    return code


def tell(line: str, command: str = "") -> None:
    """Write a line to standard error, with the name of the command in front of it."""
    command = command or str(click.get_current_context().info_name)
    sys.stderr.write(f"rbsdem: {command}: {line}\n")


@contextmanager
def plain_warnings(name: str) -> Iterator[None]:
    """Write warnings as notes of a name, without the line of a program that no user has written."""

    def show(message: Warning | str, *rest: Any, **more: Any) -> None:
        del rest, more
        sys.stderr.writelines(f"{name}: note: {line}\n" for line in str(message).splitlines())

    with warnings.catch_warnings():
        warnings.showwarning = show
        yield


@contextmanager
def _termination_as_exception() -> Iterator[None]:
    """Turn SIGTERM into an exception: no unfinished file and no other process stays behind."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, _terminated)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _terminated(number: int, frame: object) -> NoReturn:
    """Exit as a process that SIGTERM has ended."""
    del number, frame
    sys.exit(_TERMINATED)


def _flush() -> None:
    """Write what standard output still holds."""
    if sys.stdout is not None:  # as it is if it was closed
        sys.stdout.flush()


def _release_stdout() -> None:
    """Write what is left, or drop it: Python would report at its end that it cannot be written."""
    try:
        _flush()
    except OSError:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


# ---- completion ---------------------------------------------------------------------------------


@click.command("completion")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> int:
    r"""Print a script that completes commands, options, files, and names of groups and rules.

    \b
    bash:  rbsdem completion bash > ~/.local/share/bash-completion/completions/rbsdem
    zsh:   rbsdem completion zsh > DIR/_rbsdem, where DIR is one of $fpath
    fish:  rbsdem completion fish > ~/.config/fish/completions/rbsdem.fish
    """
    kind = get_completion_class(shell)
    assert kind is not None
    click.echo(kind(app, {}, "rbsdem", COMPLETE).source())
    return 0


def _named_keys(ctx: click.Context, param: click.Parameter, word: str) -> list[CompletionItem]:
    """Return the groups and rules whose names begin with a word."""
    known = _core.keys()
    names = [*known["groups"], *known["rules"]]
    return [CompletionItem(name) for name in names if name.startswith(word)]


# The commands of the Fortran executable, for completion only.
_case = click.Argument(["case"], type=FILE)
_hush = click.Option(["-q", "--quiet"], is_flag=True)
_output = click.Option(["-o", "--output"], type=FILE)
_of_modes = [_case, click.Option(["--count"]), click.Option(["--matrices"], is_flag=True)]
_key = click.Argument(["name"], shell_complete=_named_keys)
for _name, _help, _params in (
    ("run", "Solve a case.", [_case, _hush, _output, click.Option(["--report"])]),
    ("check", "Find all errors of a case.", [_case, _hush, click.Option(["--json"], is_flag=True)]),
    ("modes", "Natural frequencies, stable step.", _of_modes),
    ("keys", "Keys of a group or rule, or all.", [_key, click.Option(["--json"], is_flag=True)]),
):
    app.add_command(click.Command(_name, params=_params, help=_help))
