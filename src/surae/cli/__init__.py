"""The command line: `surae COMMAND …`.

A command is one module with one click command; it is imported only when it is called, and imports
what computes only when its input is in order, so that help and errors come at once. Errors are one
line on stderr: exit 2 for wrong use or input, 1 when the computation failed, 130 when the user
stopped it.
"""

import inspect
import io
import os
import signal
import sys
import warnings
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import NoReturn

import click

from surae._version import __version__
from surae.base.docstrings import docstring
from surae.base.errors import InputError, SuraeError
from surae.base.formatting import nearest
from surae.base.plugins import loaded, plugin_of
from surae.cli.progress import StoppedError

#: Command → its module, or the distribution that offers it as an entry point of the group
#: `surae.commands`; and its one-line help.
COMMANDS = {
    "demo": ("surae.cli.demo", "Fit an embedded virtual subject and write its report."),
    "example": ("surae.cli.example", "Write trials of a virtual leg, to try surae with."),
    "inspect": ("surae.cli.inspect", "List a file's channels and guess which signal each is."),
    "convert": ("surae.cli.convert", "Write a recording in another format."),
    "check": ("surae.cli.check", "Look for faults in recordings before they are fitted."),
    "fit": ("surae.cli.fit", "Estimate a model's parameters from recordings."),
    "session": ("surae.cli.session", "Fit the trials of one leg, each and all together."),
    "measures": ("surae.cli.measures", "Compute stiffness, torque and more in Nm and degrees."),
    "relaxed": ("surae.cli.relaxed", "Measure a relaxed ankle, from rest alone, without a model."),
    "impedance": ("surae.cli.impedance", "Tell tissue from reflex by small perturbations."),
    "stretches": ("surae.cli.stretches", "Take slow and fast stretches apart: tissue and nerve."),
    "export": ("surae.cli.export", "Write the leg as a model of OpenSim or MuJoCo."),
    "judge": ("surae.cli.judge", "Give a second opinion on other programs’ muscle parameters."),
    "change": ("surae.cli.change", "Compare a leg between two sessions."),
    "cohort": ("surae.cli.cohort", "Compare groups of legs, and every leg with its group."),
    "profile": ("surae.cli.profile", "Compute profile likelihoods and their intervals."),
    "posterior": ("surae.cli.posterior", "Sample the posterior of the parameters."),
    "simulate": ("surae.cli.simulate", "Compute the torque that a model gives for a recording."),
    "protocol": ("surae.cli.protocol", "Make a measurement protocol for a device."),
    "expect": ("surae.cli.expect", "Predict how well a protocol determines each parameter."),
    "design": ("surae.cli.design", "Design the most informative protocol."),
    "study": ("surae.cli.study", "Fit thousands of virtual trials over crossed factors."),
    "batch": ("surae-thesis", "Fit a cohort's recordings by several models, in one table."),
    "reproduce": ("surae-thesis", "Compute the thesis's results again, claim by claim."),
    "live": ("surae-workbench[live]", "Record, show and judge trials as they are measured."),
    "serve": ("surae-workbench", "Open the workbench in the browser."),
    "project": ("surae-workbench", "Copy or check a project of the workbench."),
    "reassess": ("surae.cli.reassess", "Judge a saved fit as this version does."),
    "validate": ("surae.cli.validate", "Predict other recordings with the parameters of a fit."),
}


class _Lazy(click.Group):
    """A group that imports a command when it is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            ctx.fail(f"there is no command {cmd_name!r}{nearest(cmd_name, COMMANDS)}")
        home, _ = COMMANDS[cmd_name]
        if not home.startswith("surae."):
            return _offered(cmd_name, home)
        command: click.Command = import_module(home).command
        if command.help is None and command.callback is not None:  # python -OO
            command.help = inspect.cleandoc(docstring(command.callback))
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


def _offered(name: str, distribution: str) -> click.Command:
    """The command that another distribution offers; `distribution` is where it should be."""
    from importlib.metadata import entry_points

    points = list(entry_points(group="surae.commands", name=name))
    home = distribution.partition("[")[0]
    ours = [point for point in points if point.dist is None or point.dist.name == home]
    strange = [point.dist.name for point in points if point not in ours and point.dist is not None]
    if not ours:
        more = f" ({', '.join(strange)} offers another of its name)" if strange else ""
        raise InputError(f'surae {name} is not installed{more}; run pip install "{distribution}"')
    if strange:
        warnings.warn(
            f"surae {name} of {', '.join(strange)} is left out: it is {home}'s", stacklevel=2
        )
    try:
        command: click.Command = loaded(ours[0])
    except SuraeError:
        raise
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        raise InputError(f"surae {name} cannot be loaded ({why}); install {home} again") from error
    return command


@click.group(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="surae %(version)s")
def group() -> None:
    """Ankle muscle parameters from a robot's recording of one leg.

    Add --debug to any command to see where an error came from.
    """


def main() -> NoReturn:
    """Run the command line and exit."""
    arguments, debug = _debug(sys.argv[1:])
    _end_in_order()
    if sys.stdout is None:  # closed by whoever called
        sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without … or ×
    warnings.showwarning = lambda said, *_args, **_more: click.echo(f"surae: {said}", err=True)
    try:
        code = group.main(arguments, prog_name="surae", standalone_mode=False)
        sys.stdout.flush()
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        sys.exit(0)
    except OSError as error:  # files of the user's have become InputErrors: stdout, the cache
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        _fail(f"{error.filename or 'stdout'}: {error.strerror or error}", 1, debug)
    except SystemExit as error:
        if not plugin_of(error):
            raise
        _fail(*_said(error), debug)
    except (Exception, KeyboardInterrupt) as error:
        _fail(*_said(error), debug)
    sys.exit(code if isinstance(code, int) else 0)


def _said(error: BaseException) -> tuple[str, int]:
    """What an error says in one line, and the code that the process ends with."""
    if isinstance(error, KeyboardInterrupt | click.Abort):
        return "stopped by the user", 130
    if isinstance(error, click.ClickException):
        context = getattr(error, "ctx", None)
        hint = f" (see `{context.command_path} --help`)" if context else ""
        return f"{error.format_message()}{hint}", 2
    if isinstance(error, SuraeError):
        code = {StoppedError: 130, InputError: 2}
        return str(error), next((n for kind, n in code.items() if isinstance(error, kind)), 1)
    if isinstance(error, MemoryError):
        return "not enough memory for this recording; cut or downsample it", 1
    if isinstance(error.__cause__ or error.__context__, KeyboardInterrupt):
        return "stopped by the user", 130  # compiled code makes it a SystemError
    text = f"{type(error).__name__}: {error}"
    whole = f"internal error ({text}); run again with --debug and report it"
    if plugin := plugin_of(error):
        whole = f"the plugin {plugin} failed ({text}); ask its authors, or uninstall it"
    return whole, 1


def _end_in_order() -> None:
    """Let a polite kill, or a terminal that closes, end us as an error does: half files go."""

    def stop(number: int, frame: object) -> NoReturn:
        del frame
        raise SystemExit(128 + number)

    for name in ("SIGTERM", "SIGHUP"):  # Windows has one of them; nohup ignores the other
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, stop)


def _debug(arguments: list[str]) -> tuple[list[str], bool]:
    """The arguments without --debug, wherever it stands before a bare ``--``."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    rest = [text for text in arguments[:end] if text != "--debug"]
    return [*rest, *arguments[end:]], len(rest) < end


def _fail(message: str, code: int, debug: bool) -> NoReturn:
    """One line on stderr, the traceback only when asked for."""
    if debug:
        import traceback

        traceback.print_exc()
    click.echo("surae: " + " ".join(message.split()), err=True)
    sys.exit(code)
