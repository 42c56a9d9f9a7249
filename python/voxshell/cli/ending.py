"""The end of commands: messages and exit codes."""

from __future__ import annotations

import os
import sys
import warnings
from typing import TYPE_CHECKING

from cyclopts import CycloptsError, UnusedCliTokensError
from rich.console import Console
from rich.markup import escape

from voxshell.base.outputs import OF_WRITING
from voxshell.cli.interrupts import raising_interrupts
from voxshell.cli.option_names import find_command, list_options, name_options
from voxshell.errors import FileAccessError, MissingExtraError, MissingFileError, VoxshellError
from voxshell.model.cache import CacheWarning
from voxshell.model.meshes import MeshWarning

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cyclopts import App

SUCCESS, FAILURE, WRONG_USE, INTERRUPTED = 0, 1, 2, 130


def run(app: App, arguments: Sequence[str]) -> int:
    """Run a command; report an error in one message on standard error.

    Returns:
        The exit code: 0 on success; 1 on failure; 2 if arguments, settings or input files are
        wrong; 130 after Ctrl-C.
    """
    _open_closed_streams()

    def say(kind: str, text: str) -> None:
        _say(kind, name_options(text, list_options(app, arguments)))

    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: say("warning", str(message))
        for ours in (CacheWarning, MeshWarning):
            warnings.simplefilter("always", ours)
        try:
            with raising_interrupts():
                app(
                    list(arguments),
                    exit_on_error=False,
                    print_error=False,
                    result_action="return_none",
                )
                sys.stdout.flush()
        except CycloptsError as error:
            hint = f"{' '.join(['voxshell', *find_command(app, arguments)])} --help"
            _say("error", f"{_describe(error)} (see {hint})")
            return WRONG_USE
        except MissingFileError as error:
            _say("error", str(error))
            return WRONG_USE
        except (FileAccessError, MissingExtraError) as error:
            _say("error", str(error))
            return FAILURE
        except VoxshellError as error:
            say("error", str(error))
            return WRONG_USE
        except BrokenPipeError:
            # The reader of the output has ended; Python would report that again when it flushes.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return FAILURE
        except OSError as error:
            _say("error", _describe_system_error(error))
            return FAILURE
        except MemoryError:
            _say("error", "out of memory; use fewer or simpler meshes, or larger sizes")
            return FAILURE
        except KeyboardInterrupt:
            _say("stopped", "")
            return INTERRUPTED
    return SUCCESS


def _open_closed_streams() -> None:
    """Discard what is printed if the program was started with closed streams, as by ``>&-``.

    Otherwise the next file that is opened would take the stream's number, and get what libraries
    print.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode))  # noqa: SIM115, until the process ends


def _describe(error: CycloptsError) -> str:
    if isinstance(error, UnusedCliTokensError) and error.unused_tokens:
        return f"too many arguments: {' '.join(error.unused_tokens)}"
    text = str(error).strip()
    return text if text.endswith("...") else text.removesuffix(".")


def _describe_system_error(error: OSError) -> str:
    """Describe an error; those without a file name come from printing."""
    if error.filename is None and error.errno in OF_WRITING:
        return f"cannot write to standard output: {error.strerror}"
    return str(error)


def _say(kind: str, text: str) -> None:
    color = {"error": "red", "warning": "yellow"}.get(kind, "")
    label = f"[bold {color}]{kind}:[/] " if color else kind
    Console(stderr=True, highlight=False).print(label + escape(text), soft_wrap=True)
