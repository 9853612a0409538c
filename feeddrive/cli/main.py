"""The command line: the table of commands and the border at which errors become one line.

A command is a module of this folder with one function `command`, whose annotations and docstring Typer reads; in the
docstring, what follows a form feed (`\\f`) is not shown to people. The module is imported only when its command is
invoked, so that `feeddrive --help` answers at once.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

from feeddrive import __version__
from feeddrive.errors import InputError

FINISHED, INTERNAL_ERROR, INPUT_ERROR, INTERRUPTED = 0, 1, 2, 130
"""Exit statuses; the last is the shell's own for Ctrl-C."""


@dataclass(frozen=True)
class Entry:
    """A line of the table of commands.

    Args:
        module: module of `feeddrive.cli` that holds the function `command`.
        summary: one line for the list in `feeddrive --help`.
    """

    module: str
    summary: str


COMMANDS: dict[str, Entry] = {
    "demo": Entry("demo", "Diagnose a shipped machine from a shipped recording."),
    "list": Entry("list_plants", "List the machines that come with feeddrive."),
    "show": Entry("show", "Show a machine: stiffness budget, inertias, friction, modes."),
    "modes": Entry("modes", "Natural frequencies of a machine along its stroke."),
    "bode": Entry("bode", "Frequency response of machine or loop; resonances, margins."),
    "lump": Entry("lump", "Write a machine of parts as the nearest three inertias."),
    "tune": Entry("tune", "Recommend gains and filters of a cascade, and say why."),
    "thermal": Entry("thermal", "Warm a machine up: temperatures, error, time constants."),
    "check": Entry("check", "Check a machine against rules of plausibility."),
    "run": Entry("run", "Run a scenario: a machine under control; figures, metrics."),
    "sweep": Entry("sweep", "Run a scenario over varied values: one table, one figure."),
    "diagnose": Entry("diagnose", "Find what a machine's model lacks, from recordings of it."),
    "export": Entry("export", "Write a machine as state space, .mat, CasADi, C, FMU or JSON."),
    "reproduce": Entry("reproduce", "Compare the source papers' numbers with computed ones."),
}
"""Commands by name, in the order in which `feeddrive --help` lists them."""


class LazyGroup(TyperGroup):
    """Typer's group of commands, where a command's module is imported only when the command is invoked."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Put the real command in the place of its stand-in, then resolve as Typer does.

        Args:
            ctx: Typer's context of the group.
            args: what was typed after the group's own options; the first is the command's name.

        Returns:
            Name, command and remaining arguments.
        """
        name = args[0]
        if name in COMMANDS:
            self.commands[name] = load(name)
        return super().resolve_command(ctx, args)


def load(name: str) -> Any:
    """Import a command of the table and make Typer's command object of it.

    Args:
        name: a key of `COMMANDS`.

    Raises:
        ModuleNotFoundError: the command's module is not there.
    """
    module = import_module(f"feeddrive.cli.{COMMANDS[name].module}")
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    single.command(name)(module.command)
    return get_command(single)


def application() -> Any:
    """Typer's command object of the whole command line, with a stand-in for every command."""
    # Plain help: in Rich's markup a unit such as [mm] would be taken for a style and vanish.
    group = typer.Typer(name="feeddrive", cls=LazyGroup, add_completion=False, rich_markup_mode=None)
    group.callback(no_args_is_help=True, context_settings={"help_option_names": ["-h", "--help"]})(_options)
    for name, entry in COMMANDS.items():
        group.command(name, help=entry.summary)(_stand_in)
    return get_command(group)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: what was typed after `feeddrive`; those of the process if None.

    Returns:
        Exit status: 0 finished, 1 an error of feeddrive itself, 2 unusable input, 130 interrupted.
    """
    try:
        application().main(args=arguments, prog_name="feeddrive")
    except SystemExit as ending:
        return ending.code if isinstance(ending.code, int) else FINISHED
    except KeyboardInterrupt:
        return INTERRUPTED
    except InputError as error:
        return _refuse(str(error))
    except OSError as error:
        # A file of the person's that cannot be read or written; an error without a file name is one of feeddrive.
        return _refuse(f"{error.filename}: {error.strerror}") if error.filename else _apologise(error)
    except Exception as error:
        return _apologise(error)
    return FINISHED


def _refuse(line: str) -> int:
    typer.echo(f"error: {line}", err=True)
    return INPUT_ERROR


def _apologise(error: Exception) -> int:
    if os.environ.get("FEEDDRIVE_TRACEBACK") == "1":
        traceback.print_exception(error, file=sys.stderr)
    what = " ".join(f"{type(error).__name__}: {error}".split())
    typer.echo(f"internal error: {what}; please report it with what FEEDDRIVE_TRACEBACK=1 shows", err=True)
    return INTERNAL_ERROR


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(f"feeddrive {__version__}")
        raise typer.Exit


def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", is_eager=True, callback=_show_version)
    ] = False,
) -> None:
    """Simulate machine-tool ball-screw feed drives, and find from measurements what the model lacks."""


def _stand_in() -> None:
    raise NotImplementedError("a command was invoked before its module was imported")
