"""The command ``denoc``: finds the verb, runs it, and turns what can go wrong into one line and an exit status."""

from __future__ import annotations

import os
import shlex
import sys
from contextlib import suppress
from importlib import import_module
from typing import Any, NoReturn

import click

from harness.cli.interrupt import Interrupted, hear_at_once, of_interrupt, swallowed
from harness.errors import EngineUnavailableError, InputError, one_line, unforeseen

# Verb to its one line of help; the verb's own module is imported when it is run.
VERBS = {
    "validate": "Compare the native dynamics with the other engines: built-in suite, or your models.",
    "gate": "Hold the suite against the accepted figures (for CI).",
    "report": "Render saved results again: HTML, Markdown, CSV, JUnit XML.",
    "diagnose": "Find the physics a model left out, from recordings of the real system.",
    "decay": "Read damping off the decay of a free swing.",
    "prove": "Conceal effects in other engines' recordings, find them blind, score.",
    "audit": "Check whether a parameter table is physically possible.",
    "simulate": "Run a system once, to a recording or a plot.",
    "view": "Show a mechanism in motion, simulated beside a recording: MuJoCo's viewer, or a page.",
    "paper": "Compute the paper's figures, and what it leaves open.",
    "bench": "Measure time and memory against the peers, side by side.",
    "doctor": "List the engines, their versions, and a tiny run of each.",
}
OK, NOT_WELL, UNUSABLE, INTERRUPTED = 0, 1, 2, 130
COMMAND = "harness.command"  # of the context: the line that was given, for reports
STOPPED = "stopped; nothing was written"


class Verbs(click.Group):
    """The verbs, in their own order, each loaded from ``harness.cli.<verb>`` when needed."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.meta[COMMAND] = shlex.join(["denoc", *args])
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise Interrupted(STOPPED) from None

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in VERBS:
            return None
        command: click.Command = getattr(import_module(f"harness.cli.{cmd_name}"), cmd_name)
        return command

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        if args[0] not in VERBS and not args[0].startswith("-"):
            from harness.system.suggest import did_you_mean

            raise InputError(f"no command is named {args[0]!r}", mend=did_you_mean(args[0], VERBS))
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        # The stock version would import every verb for its help.
        with formatter.section("Commands"):
            formatter.write_dl(list(VERBS.items()))


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="denoc-harness", prog_name="denoc")
def denoc() -> None:
    """DeNOC multibody dynamics: checked against other engines, and what a model left out found.

    \b
    Examples:
      denoc validate                          the built-in suite over all engines
      denoc validate robot.urdf               the same comparison on your robot
      denoc diagnose run1.csv run2.csv --model robot.urdf

    Exit status: 0 all well, 1 the thing checked is not well, 2 unusable input.
    """


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run the command and end the process with its exit status."""
    hear_at_once()
    sys.exit(status_of(arguments))


def status_of(arguments: list[str] | None = None) -> int:
    """Run the command in this process; the exit status."""
    try:
        result = denoc.main(args=arguments, prog_name="denoc", standalone_mode=False)
        sys.stdout.flush()
        return result if isinstance(result, int) else OK
    except (InputError, EngineUnavailableError) as error:
        return _say(str(error), UNUSABLE)
    except click.exceptions.NoArgsIsHelpError as error:
        with suppress(OSError):  # nowhere to print it to: the line below is what is left to say
            print(error.format_message())
        return _say(f"name a verb, for example `{error.ctx.command_path} validate`" if error.ctx else "", UNUSABLE)
    except click.UsageError as error:
        hint = f" (see `{error.ctx.command_path} --help`)" if error.ctx else ""
        return _say(one_line(error.format_message()) + hint, UNUSABLE)
    except click.ClickException as error:
        return _say(one_line(error.format_message()), UNUSABLE)
    except click.exceptions.Exit as error:
        return error.exit_code
    except (KeyboardInterrupt, click.Abort):
        return _say(STOPPED, INTERRUPTED)
    except Interrupted as told:
        if sys.stderr.isatty():
            print(file=sys.stderr)  # after the ^C that the terminal has just echoed
        return _say(str(told), INTERRUPTED)
    except BrokenPipeError:
        # The reader (`| head`) has left: no message, and no complaint from Python's own flush at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OK
    except MemoryError:
        return _say("not enough memory (fewer samples or a smaller mechanism will do)", UNUSABLE)
    except Exception as error:
        if swallowed() or of_interrupt(error):
            return _say(STOPPED, INTERRUPTED)
        if os.environ.get("DENOC_TRACEBACK"):
            raise
        return _say(unforeseen(error), UNUSABLE)


def _say(text: str, status: int) -> int:
    """On standard error, behind what standard output has; the status stands where either cannot be written to."""
    for stream, line in ((sys.stdout, ""), (sys.stderr, f"denoc: {text}\n")):
        with suppress(OSError):
            stream.write(line)
            stream.flush()
    return status
