"""Errors for names that users of other libraries try first, which say what to use instead.

Nothing here costs time where a name is right: a class has a descriptor for each such name, whereas
``__getattr__`` and ``__setattr__`` would delay every access. :func:`suggest_on_set` is for classes whose
attributes are rarely set.
"""

from __future__ import annotations

import inspect
import re
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from voxshell.base.name_advice import (
    ABSENT,
    ARGUMENTS,
    MISSING,
    OF_PACKAGE,
    READ_ONLY,
    SYNONYMS,
    UNNAMED,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

Class = TypeVar("Class", bound=type[Any])

_MOST_LETTERS = 60
"""Letters of a wrong name that are compared."""


class Absent:
    """A name that a class does not have: its use raises an AttributeError that says what to use."""

    def __init__(self, owner: str, name: str, advice: str) -> None:
        self._owner, self._name, self._advice = owner, name, advice
        self.__doc__ = f"Absent: {advice}"  # what help() shows

    def __get__(self, thing: object, cls: type | None = None) -> Any:
        own = getattr(thing, "__dict__", {})  # of a class that a user has derived
        if self._name in own:
            return own[self._name]
        # Without an object, Python adds no suggestion of its own, which compares letters alone.
        text = f"{self._owner!r} object has no attribute {self._name!r}: {self._advice}"
        raise AttributeError(text, name=self._name, obj=None)

    def __set__(self, thing: object, value: object) -> None:
        if not hasattr(thing, "__dict__"):
            self.__get__(thing)
        vars(thing)[self._name] = value


class Refusal:
    """The setter of a property that cannot be set: it raises an AttributeError with a remedy."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def __call__(self, thing: object, value: object) -> NoReturn:
        """Refuse a value."""
        raise AttributeError(self._text)


def know_near_names(cls: Class) -> Class:
    """Give a class the errors that the tables of :mod:`voxshell.base.name_advice` have for it.

    Example:
        >>> class Contacts: ...
        >>> know_near_names(Contacts)().depth
        Traceback (most recent call last):
        AttributeError: 'Contacts' object has no attribute 'depth': did you mean depths?
        >>> hasattr(Contacts(), "depth"), "depth" in dir(Contacts())
        (False, False)
    """
    owner = cls.__name__
    for name, advice in ABSENT.get(owner, {}).items():
        setattr(cls, name, Absent(owner, name, advice))
    for name, advice in READ_ONLY.get(owner, {}).items():
        given = inspect.getattr_static(cls, name)
        refusal = Refusal(f"{name} of a {owner.lower()} cannot change: {advice}")
        setattr(cls, name, property(given.fget, refusal, doc=given.__doc__))
    cls.__dir__ = _list_names  # pyright: ignore[reportAttributeAccessIssue]
    return cls


def suggest_on_set(cls: Class) -> Class:
    """Make errors about misspelled attributes that are set say which one was probably meant.

    Python suggests names only where attributes are read. The class needs ``__slots__``, so that it refuses
    others. Each assignment takes a fifth of a microsecond longer.

    Example:
        >>> class Ball:
        ...     __slots__ = ("radius",)
        >>> suggest_on_set(Ball)().radus = 1
        Traceback (most recent call last):
        AttributeError: 'Ball' object has no attribute 'radus': did you mean radius?
    """
    cls.__setattr__ = _set_known  # pyright: ignore[reportAttributeAccessIssue]
    return cls


def _set_known(thing: Any, name: str, value: object) -> None:
    """Set an attribute; an error about a name that a thing does not have says which one was probably meant."""
    try:
        object.__setattr__(thing, name, value)
    except AttributeError:
        cls = type(thing)
        if any(name in vars(base) for base in cls.__mro__):
            raise  # by a property, which says what it refuses
        meant = find_closest(name, [each for each in dir(thing) if not each.startswith("_")])
        advice = f": did you mean {meant}?" if meant else ""
        # Without an object, Python adds no suggestion of its own.
        text = f"{cls.__name__!r} object has no attribute {name!r}{advice}"
        raise AttributeError(text, name=name, obj=None) from None


def _list_names(thing: Any) -> list[str]:
    """Return what dir() lists: the names that a thing has."""
    absent = {name for base in type(thing).__mro__ for name in ABSENT.get(base.__name__, ())}
    return [name for name in object.__dir__(thing) if name not in absent]


def advise_on_argument(call: str, name: str, known: Collection[str]) -> str:
    """Return what to do instead of passing an argument that a call does not have; "" if unknown.

    Example:
        >>> advise_on_argument("World", "dt", ["gravity", "time_step"])
        'did you mean time_step?'
        >>> advise_on_argument("Model.from_mesh", "tolerence", ["scale", "tolerance"])
        'did you mean tolerance?'
        >>> advise_on_argument("Sphere", "dt", ["radius"])
        ''
    """
    advice = ARGUMENTS.get(call, {}).get(name)
    if advice is not None:
        return advice
    synonyms = SYNONYMS.get(_as_snake(name), ())
    meant = next((each for each in synonyms if each in known), None) or find_closest(name, known)
    return f"did you mean {meant}?" if meant else ""


def advise_on_name(name: str, known: Collection[str]) -> str:
    """Return what to use instead of a name that the package does not have; "" if unknown.

    Example:
        >>> advise_on_name("loadURDF", ["World", "load_mjcf", "load_urdf"])
        'did you mean load_urdf?'
        >>> advise_on_name("setGravity", ["World"])
        'pass gravity=... to voxshell.World(), or set World.gravity'
        >>> advise_on_name("__path__", ["World"])
        ''
    """
    if name.startswith("_"):  # Python looks for such names by itself
        return ""
    advice = OF_PACKAGE.get(name)
    if advice is not None:
        return advice
    meant = find_closest(name, known)
    return f"did you mean {meant}?" if meant else ""


def _as_snake(name: str) -> str:
    """Return a name in lower case, with words parted: "loadURDF" is "load_urdf"."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def advise_on_unnamed(call: str, values: tuple[Any, ...]) -> str:
    """Return what to do about too many arguments without names; "" if unknown.

    Example:
        >>> advise_on_unnamed("Body.apply_force", (0, 0, 1))
        'pass the three numbers as one argument: apply_force((0, 0, 1))'
        >>> advise_on_unnamed("World.view", (8080,))
        ''
    """
    advice = UNNAMED.get(call)
    if advice is None and len(values) == 3 and all(isinstance(v, (int, float)) for v in values):
        advice = f"pass the three numbers as one argument: {call.split('.')[-1]}({values})"
    return advice or ""


def find_closest(name: str, known: Iterable[str]) -> str | None:
    """Return the name that was probably meant, whatever its case, or None.

    Example:
        >>> find_closest("colision", ["visual", "collision"])
        'collision'
        >>> find_closest("plugin", ["visual", "collision"]) is None
        True
    """
    import difflib

    spelled = {_as_snake(each): each for each in known}
    wanted = _as_snake(name[:_MOST_LETTERS])
    found = difflib.get_close_matches(wanted, sorted(spelled), n=1, cutoff=0.65)
    return spelled[found[0]] if found else None


def advise_on_missing(call: str) -> str:
    """Return what to do about missing arguments; "" if unknown.

    Example:
        >>> advise_on_missing("Mesh")
        'a Mesh holds the arrays of model.mesh; for a model of a file, call Model.from_mesh(path)'
        >>> advise_on_missing("World.step")
        ''
    """
    return MISSING.get(call, "")
