"""Running a command: what each outcome prints, and its exit code."""

from __future__ import annotations

import errno
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from enum import IntEnum
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from tautline.cli.output import called, duration
from tautline.cli.output.console import abandon_output, flush_words, print_json, say, unwritable, warnings_said
from tautline.interruption import ended_by_signal
from tautline.kernels.machine.gc_tuning import collected_rarely, left_at_exit
from tautline.results.errors import WriteError
from tautline.scene.errors import Doubt, Problem, SceneError
from tautline.view.words_of_matplotlib import retell

if TYPE_CHECKING:
    import typer


T = TypeVar("T")


class ExitCode(IntEnum):
    """How a command ended."""

    DONE = 0
    INTERNAL_ERROR = 1
    BAD_INPUT = 2
    STOPPED_EARLY = 3
    INTERRUPTED = 130


UNWRITABLE = (errno.ENOSPC, errno.EBADF, errno.EIO)
"""Errors of a standard output that cannot be written."""


class Ended(Exception):
    """A verb that has reported how it ended."""

    def __init__(self, code: ExitCode) -> None:
        self.code = code
        super().__init__(code.name)


def searched(scene: Path, as_json: bool, search: Callable[[], T]) -> T:
    """What a search of a verb finds; one that finds nothing ends the command as a run that stopped early does.

    One that takes long is told to be under way.

    Raises
    ------
    Ended
        Where the search raises `tautline.integrators.status.StoppedEarly`, which has been reported then.
    """
    from tautline.cli.output.preparing import told_if_long
    from tautline.integrators.status import StoppedEarly

    try:
        with told_if_long(lambda: f"searching {scene}: Ctrl-C ends it, and nothing is stored yet"):
            return search()
    except StoppedEarly as stop:
        say(f"{scene}: stopped, {stop.part}: {stop.sentence}", "red")
        if as_json:
            where = {"part": stop.part, "sentence": stop.sentence}
            print_json({"scene": str(scene), "status": stop.status.word, "stopped": where})
        raise Ended(ExitCode.STOPPED_EARLY) from None


def run(app: typer.Typer, arguments: Sequence[str] | None = None) -> NoReturn:
    """Run a command and leave the process with its exit code; there is never a traceback unless ``--debug`` is given.

    Parameters
    ----------
    app : typer.Typer
        From ``make_app``.
    arguments : sequence of str, optional
        Those of the process if None.

    Raises
    ------
    SystemExit
        Always.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    # A process that was started for this command; one that has other things to do keeps its own ways.
    ours = arguments is None
    duration.begin(of_process=ours)
    called.begin(ours, app.info.name or "")
    if ours:
        left_at_exit()
        retell()  # before anything imports matplotlib
    with collected_rarely() if ours else nullcontext(), ended_by_signal() if ours else nullcontext():
        code = _outcome(app, given)
    flush_words()
    sys.exit(int(code))


def _outcome(app: typer.Typer, given: list[str]) -> int:
    as_json, debug = "--json" in given, "--debug" in given
    # `--debug` may stand anywhere, and not only before the verb, where typer would want it.
    arguments = [argument for argument in given if argument != "--debug"]
    try:
        with warnings_said():
            code = app(arguments, standalone_mode=False, prog_name=called.called(app.info.name or ""))
    except Ended as end:
        return end.code
    except BrokenPipeError:
        abandon_output()
        return ExitCode.DONE
    except SystemExit as left:
        # What prints the help leaves by itself where nobody reads on.
        if not isinstance(left.__context__, BrokenPipeError):
            raise
        abandon_output()
        return ExitCode.DONE
    except (KeyboardInterrupt, EOFError):
        code = ExitCode.INTERRUPTED
    except Exception as error:  # the last resort, where every error gets its line
        if debug:
            say(_traceback())
        if isinstance(error, OSError) and error.filename is None and error.errno in UNWRITABLE:
            # The help and the version are printed by others.
            abandon_output()
            error = unwritable(error)
        return _refused(error, app, as_json, next((one for one in arguments if not one.startswith("-")), ""))
    if code == ExitCode.INTERRUPTED:
        say("\ninterrupted", "yellow")
        if as_json:
            with suppress(WriteError):
                print_json({"status": "interrupted"})
    return code if isinstance(code, int) else ExitCode.DONE


def _refused(error: Exception, app: typer.Typer, as_json: bool, verb: str = "") -> ExitCode:
    """Print an error and choose its exit code; `verb` is the one that was asked for."""
    code, status = ExitCode.BAD_INPUT, "bad input"
    if type(error).__name__ == "NoArgsIsHelpError":
        return code  # the help was printed and says it all
    name = called.called(app.info.name or "")
    known = {
        str(one.name or one.callback.__name__).replace("_", "-") for one in app.registered_commands if one.callback
    }
    problems = _problems(error, f"{name} {verb}" if verb in known else name)
    if problems is None:
        if type(error).__name__ == "Abort":
            return ExitCode.INTERRUPTED
        code, status = ExitCode.INTERNAL_ERROR, "internal error"
        problems = [_unexpected(error)]
    elif isinstance(error, WriteError):
        code, status = ExitCode.STOPPED_EARLY, "stopped: the result could not be written"
    written = {key: [str(file) for file in files] for key, files in getattr(error, "written", {}).items() if files}
    for file in chain.from_iterable(written.values()):
        say(f"wrote {file}", "green")
    say(str(SceneError(problems)), "red")
    if as_json:
        with suppress(WriteError):  # where it is standard output that cannot be written
            print_json({"status": status, **written, "problems": [_record(problem) for problem in problems]})
    return code


def _record(problem: Problem) -> dict[str, Any]:
    """What JSON tells of a problem; a warning among them says that it is one."""
    return vars(problem) | ({"warning": True} if isinstance(problem, Doubt) else {})


def _problems(error: Exception, name: str) -> list[Problem] | None:
    """Return the problems that an error stands for, None for an error that nobody foresaw."""
    if isinstance(error, SceneError):
        return error.problems
    if (
        hasattr(error, "cause") and hasattr(error, "cure") and hasattr(error, "path")
    ):  # ResultError and KernelError, not imported here
        return [Problem(str(error.path), None, "", None, error.cause, error.cure)]
    if hasattr(error, "format_message") and getattr(error, "exit_code", None) == ExitCode.BAD_INPUT:
        # A usage error of click, which some versions of typer carry within them under another name.
        if wrong := _wrong_value(error):
            return [wrong]
        verb = getattr(getattr(error, "ctx", None), "command_path", None) or name
        cause = error.format_message().rstrip(".")
        return [Problem(verb, None, "", None, cause, f"{_option_meant(error)}see `{verb} --help`")]
    return None


def _wrong_value(error: Any) -> Problem | None:
    """A value that is outside of what an option takes, where typer has pydantic read it: in words as of a scene's."""
    found = getattr(error.__cause__, "errors", None)
    names = getattr(getattr(error, "param", None), "opts", None)
    if found is None or not names:
        return None
    from tautline.scene.model import plain_words

    first = found()[0]
    option = max(names, key=len)
    return Problem(option, None, "", str(first["input"]), *plain_words(first))


def _option_meant(error: Any) -> str:
    """The option for which a word of the trade stands, as in ``--ff 0.2``, with what parts it from what follows."""
    from tautline.scene.refusal import other_word

    parameters = getattr(getattr(getattr(error, "ctx", None), "command", None), "params", ())
    known = {name.lstrip("-") for one in parameters for name in one.opts if name.startswith("--")}
    word = other_word(str(getattr(error, "option_name", None) or "").lstrip("-").replace("-", "_"), known)
    return f"did you mean --{word}? Else " if word else ""


def _unexpected(error: Exception) -> Problem:
    from tautline.cli.output.blame import place_of

    place, ours = place_of(error)
    text = " ".join(str(error).split())
    cause = f"unexpected {type(error).__name__}: {text}" if text else f"unexpected {type(error).__name__}"
    cure = "this is a fault of the program: report it with the scene and what the same command prints with --debug"
    if not ours:
        cure = "this file is no part of the program: correct it there; --debug shows all that led to it"
    return Problem(place, None, "", None, cause, cure)


def _traceback() -> str:
    import traceback

    return traceback.format_exc()
