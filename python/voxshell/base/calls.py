"""Errors of calls whose arguments do not fit: with public names, a remedy, and all arguments."""

from __future__ import annotations

import inspect
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

from voxshell.base.near_names import advise_on_argument, advise_on_missing, advise_on_unnamed
from voxshell.errors import InputTypeError, MemoryLimitError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Public = TypeVar("Public", bound="Callable[..., Any]")

_PACKAGE = __name__.split(".")[0]


def explain_calls(thing: Public) -> Public:
    """Make calls of a function, or of a class and its methods, raise InputTypeError where they do not fit.

    Where Python has no memory left, they raise MemoryLimitError.

    A class gets wrapped copies of the methods that it inherits from classes that are not wrapped
    themselves, so that messages name the class that users know. A call takes 70 ns longer; queries
    of contacts of two bodies, which may take a microsecond, are not wrapped.

    Example:
        >>> @explain_calls
        ... def fall(height, *, time_step=0.1): ...
        >>> fall(1.0, dt=0.2)
        Traceback (most recent call last):
        voxshell.errors.InputTypeError: fall() has no argument 'dt': did you mean time_step? Call it as fall(height, *, time_step=...)
    """
    if inspect.isclass(thing):
        _wrap_methods(thing)
        return cast("Public", thing)
    return cast("Public", _wrap(thing, thing.__qualname__, takes_self=False))


def check_takes(value: object, what: str, **callbacks: Callable[..., object] | None) -> None:
    """Refuse callbacks that cannot take one value; call this after one has raised TypeError.

    Raises:
        InputTypeError: One cannot. The message names it.
    """
    for name, callback in callbacks.items():
        if callback is None:
            continue
        try:
            inspect.signature(callback).bind(value)
        except ValueError:  # Python does not know what it takes
            continue
        except TypeError as error:
            raise InputTypeError(
                f"{name} is called with one argument, {what}, but does not take it ({error})"
            ) from None


def check_options(
    call: str, options: Mapping[str, object], function: Callable[..., Any], own: tuple[str, ...]
) -> None:
    """Refuse options that a call would pass on to a function that does not have them.

    Args:
        call: The public name of the call.
        options: What is to be passed on.
        function: What takes them, by name only.
        own: The arguments of the call itself; the function may have them, too.

    Raises:
        InputTypeError: There is no such option. The message names the call, and the arguments that it has.
    """
    theirs = inspect.signature(function).parameters.values()
    names = dict.fromkeys([*own, *(p.name for p in theirs if p.kind is p.KEYWORD_ONLY)])
    for name in options:
        if name not in names:
            usage = ", ".join(["path", "*", *(f"{known}=..." for known in names)])
            advice = advise_on_argument(call, name, names)
            raise InputTypeError(
                _join(f"{call}() has no argument {name!r}", advice, f"{call}({usage})")
            )


def _wrap_methods(thing: type) -> None:
    ours = [base for base in thing.__mro__ if base.__module__.split(".")[0] == _PACKAGE]
    members = {name: member for base in reversed(ours) for name, member in vars(base).items()}
    for name, member in members.items():
        if name.startswith("_") and name not in ("__init__", "__new__"):
            continue
        kind = type(member) if isinstance(member, (classmethod, staticmethod)) else None
        function = member if kind is None else member.__func__
        if inspect.isfunction(function) and not hasattr(function, "__wrapped__"):
            takes_self = kind is not staticmethod or name == "__new__"
            wrapped = _wrap(function, f"{thing.__name__}.{name}", takes_self=takes_self)
            setattr(thing, name, wrapped if kind is None else kind(wrapped))


def _wrap(function: Callable[..., Any], title: str, *, takes_self: bool) -> Callable[..., Any]:
    @wraps(function)
    def explained(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            place = error.__traceback__
            if place is None or place.tb_next is not None:  # the function has begun
                raise
        except MemoryError as error:
            raise MemoryLimitError(f"no memory left for {title}()") from error
        raise InputTypeError(_explain(function, title, args[takes_self:], kwargs, takes_self))

    explained.__qualname__ = title
    return explained


def _explain(
    function: Callable[..., Any],
    title: str,
    args: tuple[Any, ...],
    kwargs: Mapping[str, Any],
    takes_self: bool,
) -> str:
    """Return why a call does not fit, what to do, and the arguments that the function has."""
    parameters = list(inspect.signature(function).parameters.values())[takes_self:]
    call = title.removesuffix(".__init__").removesuffix(".__new__")
    named = {p.name: p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    ordered = [p.name for p in named.values() if p.kind is p.POSITIONAL_OR_KEYWORD]
    given = {*ordered[: len(args)], *kwargs}
    usage = f"{call}({', '.join(_list_arguments(parameters))})"
    unknown = next((name for name in kwargs if name not in named), None)
    if unknown is not None:
        advice = advise_on_argument(call, unknown, named.keys() - given)
        return _join(f"{call}() has no argument {unknown!r}", advice, usage)
    if len(args) > len(ordered):
        names = f" ({', '.join(ordered)})" if ordered else ""
        plural = "" if len(ordered) == 1 else "s"
        allowed = f"{len(ordered) or 'no'} positional argument{plural}{names}"
        count = "1 was" if len(args) == 1 else f"{len(args)} were"
        advice = advise_on_unnamed(call, args) or f"name {'the others' if ordered else 'all'}"
        return _join(f"{call}() takes {allowed}, but {count} given", advice, usage)
    twice = next((name for name in ordered[: len(args)] if name in kwargs), None)
    if twice is not None:
        return _join(f"{call}() got {twice!r} twice, once without its name", "", usage)
    missing = [p.name for p in named.values() if p.default is p.empty and p.name not in given]
    return _join(f"{call}() needs {' and '.join(missing)}", advise_on_missing(call), usage)


def _list_arguments(parameters: list[inspect.Parameter]) -> list[str]:
    shown = []
    stars = False
    for parameter in parameters:
        if parameter.kind is parameter.KEYWORD_ONLY and not stars:
            shown.append("*")
            stars = True
        star = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        stars = stars or star == "*"
        default = "" if star or parameter.default is parameter.empty else "=..."
        shown.append(f"{star}{parameter.name}{default}")
    return shown


def _join(text: str, advice: str, usage: str) -> str:
    remedy = f": {advice}{'' if advice.endswith('?') else '.'}" if advice else "."
    return f"{text}{remedy} Call it as {usage}"
