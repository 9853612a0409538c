"""The command line: the table of commands and the border at which errors become one line.

A command is a module of this folder with one function `command`, whose annotations and docstring Typer reads; in the
docstring, what follows a form feed (`\\f`) is not shown to people. The module is imported only when its command is
invoked, so that `feeddrive --help` answers at once.
"""

from __future__ import annotations

import errno
import gc
import os
import sys
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from types import ModuleType
from typing import Annotated, Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

from feeddrive import __version__
from feeddrive.blas_threads import one_thread_from_now_on
from feeddrive.errors import InputError, quoted
from feeddrive.kept_memory import keep_freed_memory

FINISHED, INTERNAL_ERROR, INPUT_ERROR, INTERRUPTED = 0, 1, 2, 130
"""Exit statuses; the last is the shell's own for Ctrl-C."""

_UsageError: type[Exception] = typer.BadParameter.__bases__[0]
"""What Typer raises where options or arguments do not fit; it has no public name of its own."""

_LONGEST = 400
"""Letters of what Typer or the system says."""


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
    "list": Entry("list", "List the machines that come with feeddrive."),
    "init": Entry("init", "Write a plant file from a few words and the parts catalogue."),
    "parts": Entry("parts", "List the parts catalogue, each value with its source."),
    "keys": Entry("keys", "Show what may stand in a file: keys, units, ranges, defaults."),
    "show": Entry("show", "Show a machine: stiffness budget, inertias, friction, modes."),
    "modes": Entry("modes", "Natural frequencies of a machine along its stroke."),
    "bode": Entry("bode", "Frequency response of machine or loop; resonances, margins."),
    "lump": Entry("lump", "Write a machine of parts as the nearest three inertias."),
    "tune": Entry("tune", "Recommend gains and filters of a cascade, and say why."),
    "bench": Entry("bench", "Write a page to try gains, filters, payload and effects on."),
    "thermal": Entry("thermal", "Warm a machine up: temperatures, error, time constants."),
    "check": Entry("check", "Check a machine against rules of plausibility."),
    "run": Entry("run", "Run a scenario: a machine under control; figures, metrics."),
    "sweep": Entry("sweep", "Run a scenario over varied values: one table, one figure."),
    "read": Entry("read", "Read a trace file of a drive or control; say what it holds."),
    "diagnose": Entry("diagnose", "Find what a machine's model lacks, from recordings of it."),
    "compensate": Entry("compensate", "Write what was found as tables that controls read."),
    "iso230": Entry("iso230", "Measured accuracy after ISO 230: positioning, drift, circle."),
    "watch": Entry("watch", "Follow an axis over months of recordings: trends, changes."),
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
    module = _imported(f"feeddrive.cli.{COMMANDS[name].module}")
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    single.command(name)(module.command)
    made = get_command(single)
    options = {one.name: one.opts[0] for one in made.params if one.opts[0].startswith("--")}
    called: Any = made.callback

    @wraps(called)
    def command(*words: Any, **given: Any) -> Any:
        """Call it, and name the option where the library names the argument of the same name."""
        try:
            return called(*words, **given)
        except InputError as error:
            if error.where not in options:
                raise
            raise InputError(error.what, options[error.where], error.mend) from error

    made.callback = command
    return made


def _imported(name: str) -> ModuleType:
    """A module of this folder. What an import makes is there to stay: garbage is not sought in it, then or ever."""
    first, collected = name not in sys.modules, gc.isenabled()
    gc.disable()
    try:
        return import_module(name)
    finally:
        if first:
            gc.freeze()
        if collected:
            gc.enable()


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
    one_thread_from_now_on()  # before a command imports numpy
    keep_freed_memory()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # letters that a terminal or a pipe cannot take are written as escapes
            stream.reconfigure(errors="backslashreplace")
    with _warnings_as_one_line():
        status = _run(arguments)
    return _flushed(status)


def _run(arguments: Sequence[str] | None) -> int:
    """Run, and turn every error into a line and a status."""
    try:
        ended = application().main(args=arguments, prog_name="feeddrive", standalone_mode=False)
    except SystemExit as ending:  # Rich and Typer end so where the reader of a pipe has left
        return _pipe_left() if ending.code == 1 else int(ending.code or FINISHED)
    except KeyboardInterrupt:
        return INTERRUPTED
    except _UsageError as error:
        return _refuse_usage(error, sys.argv[1:] if arguments is None else arguments)
    except InputError as error:
        return _refuse(str(error))
    except OSError as error:
        return _refuse_system(error)
    except (ArithmeticError, MemoryError, ValueError) as error:
        return _refuse_numbers(error)
    except Exception as error:
        return _apologise(error)
    return ended if isinstance(ended, int) else FINISHED


def _refuse(line: str) -> int:
    typer.echo(f"error: {line}", err=True)
    return INPUT_ERROR


def _refuse_usage(error: Any, arguments: Sequence[str]) -> int:
    """Options or arguments that do not fit; where nothing at all was typed, the help is the answer."""
    if type(error).__name__ == "NoArgsIsHelpError":
        error.show()
        return INPUT_ERROR
    command = " ".join(["feeddrive", *(name for name in arguments[:1] if name in COMMANDS)])
    what = quoted(error.format_message().replace("Value error, ", ""), _LONGEST).rstrip(".")
    return _refuse(f"{command}: {what[:1].lower()}{what[1:]}; {command} --help lists what is possible")


def _refuse_system(error: OSError) -> int:
    """A file that cannot be read or written, a full disk; an error that no system call raised is one of feeddrive."""
    if error.errno is None:
        return _apologise(error)
    if error.errno == errno.EPIPE:
        return _pipe_left()
    where = quoted(str(error.filename), _LONGEST) if error.filename else "this computer"
    return _refuse(f"{where}: {error.strerror}; make room, or name another place")


def _refuse_numbers(error: Exception) -> int:
    """Values so large, small or many that nothing can be computed; any other error of arithmetic is one of feeddrive.

    A division by zero is not among them: it has one cause, which should have been refused by its name.
    """
    from numpy.linalg import LinAlgError  # late: `feeddrive --help` does without

    if isinstance(error, MemoryError):
        return _refuse("more memory is needed than this computer gives; check units, or ask for less at a time")
    if not isinstance(error, OverflowError | FloatingPointError | LinAlgError):
        return _apologise(error)
    _show_traceback(error)
    what = quoted(f"{type(error).__name__}: {error}", _LONGEST)
    mend = "check the units and the sizes of what is given; FEEDDRIVE_TRACEBACK=1 shows where"
    return _refuse(f"the values given are beyond what can be computed ({what}); {mend}")


def _apologise(error: Exception) -> int:
    _show_traceback(error)
    what = quoted(f"{type(error).__name__}: {error}", _LONGEST)
    typer.echo(f"internal error: {what}; please report it with what FEEDDRIVE_TRACEBACK=1 shows", err=True)
    return INTERNAL_ERROR


def _show_traceback(error: Exception) -> None:
    if os.environ.get("FEEDDRIVE_TRACEBACK") == "1":
        traceback.print_exception(error, file=sys.stderr)


def _pipe_left() -> int:
    """End quietly where the reader of a pipe, such as `head`, has what it wants."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # what is still to be written at the end
    os.close(nowhere)
    return FINISHED


def _flushed(status: int) -> int:
    """Write out what is printed, so that a full disk behind `>` is reported."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        return _pipe_left()
    except OSError as error:
        _pipe_left()
        return _refuse(f"standard output: {error.strerror}; make room, or write to another place")
    return status


@contextmanager
def _warnings_as_one_line() -> Iterator[None]:
    """Warnings that reach nobody else in one line each, without the place in the code."""
    usual = warnings.formatwarning

    def one_line(message: Warning | str, *_: Any, **__: Any) -> str:
        return f"warning: {quoted(str(message), _LONGEST)}\n"

    warnings.formatwarning = one_line
    try:
        yield
    finally:
        warnings.formatwarning = usual


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
