from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx
from voxshell.base import arguments

NOT_NUMBERS = ("1", b"1", True, np.True_, None, [1.0, 2.0], 10**400)


@pytest.mark.parametrize("value", [1, 1.5, np.float32(2.0), np.int8(3)])
def test_numbers_of_any_type_become_floats(value: object):
    number = arguments.as_real(value, "mass")
    assert type(number) is float
    assert number == value


@pytest.mark.parametrize("value", NOT_NUMBERS, ids=str)
def test_what_is_no_number_is_named(value: object):
    with pytest.raises(vx.SettingsError, match=r"^mass must be a number, not "):
        arguments.as_real(value, "mass")


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_numbers_must_be_finite(value: float):
    with pytest.raises(vx.SettingsError, match=r"^mass must be finite, not "):
        arguments.as_real(value, "mass")


@pytest.mark.parametrize(
    ("check", "right", "wrong"),
    [
        (arguments.as_positive, (1e-300, 1.0), (0.0, -0.0, -1.0)),
        (arguments.as_not_negative, (0.0, -0.0, 1.0), (-1e-300, -1.0)),
        (arguments.as_fraction, (0.0, 0.5, 1.0), (-1e-300, 1.0 + 1e-15)),
        (arguments.as_length, (1e-300, arguments.FARTHEST), (0.0, 1.001e15)),
    ],
)
def test_ranges_end_where_they_say(check, right, wrong):
    for value in right:
        assert check(value, "it") == value
    for value in wrong:
        with pytest.raises(vx.SettingsError, match=r"^it must be "):
            check(value, "it")


def test_integers_are_of_their_range_and_no_others():
    for value in (1, 4, np.int16(4)):
        assert arguments.as_integer(value, "level", 1, 4) == value
    for value in (0, 5):
        with pytest.raises(vx.SettingsError, match=f"^level must be from 1 to 4, not {value}$"):
            arguments.as_integer(value, "level", 1, 4)
    for value in (True, 1.0, "1", None):
        with pytest.raises(vx.SettingsError, match=r"^level must be an integer, not "):
            arguments.as_integer(value, "level", 1, 4)


def test_no_number_of_threads_is_one_a_core():
    assert arguments.as_threads(None) == 0
    assert arguments.as_threads(3) == 3
    with pytest.raises(vx.SettingsError, match=r"^threads must be from 1 to 1024, not 0$"):
        arguments.as_threads(0)


def test_arrays_have_the_shape_that_is_named():
    array = arguments.as_floats([[1, 2, 3]], "points", (None, 3))
    assert array.dtype == np.float64
    assert array.flags.c_contiguous
    for value, told in (
        (0.1, "not 0.1$"),
        ("a", "not 'a'$"),
        (None, "not None$"),
        ([1, 2, 3], r"not \[1, 2, 3\]$"),
        ([[1, 2]], r"not an array of shape \(1, 2\) and type int64$"),
        ([["a", "b", "c"]], r"not an array of shape \(1, 3\) and type <U1$"),
        (np.array([1, 2], object), r"not an array of shape \(2,\) and type object$"),
        (np.zeros(100), r"not an array of shape \(100,\) and type float64$"),
        ([[1, 2, 3], [1]], r"not \[\[1, 2, 3\], \[1\]\] \(.*inhomogeneous"),
    ):
        with pytest.raises(vx.SettingsError, match=rf"^points must be \(n, 3\) numbers.*{told}"):
            arguments.as_points(value, "points")
    with pytest.raises(vx.PoseError):
        arguments.as_floats([1], "pose", (4, 4), vx.PoseError)


def test_vectors_are_three_finite_numbers():
    assert arguments.as_vector(np.array([1, 2, 3]), "axis") == (1.0, 2.0, 3.0)
    with pytest.raises(vx.SettingsError, match=r"^axis must be finite, not "):
        arguments.as_vector((0, math.nan, 1), "axis")
    with pytest.raises(
        vx.SettingsError, match=r"^axis must be three numbers, such as \(0, 0, 1\), not \[0, 1\]$"
    ):
        arguments.as_vector((0, 1), "axis")


def test_vectors_are_wanted_in_words_with_their_unit():
    """A number where a vector belongs was called "() float64"."""
    with pytest.raises(
        vx.SettingsError, match=r"^force must be three numbers in newtons, not 9.81$"
    ):
        arguments.as_vector(9.81, "force", " in newtons")
    for count, word in ((2, "two"), (4, "four"), (12, r"\(12,\)")):
        with pytest.raises(vx.SettingsError, match=f"^it must be {word} numbers, not 1$"):
            arguments.as_floats(1, "it", (count,))


def test_paths_are_names_of_files():
    assert arguments.as_path("a.stl", "mesh") == arguments.as_path(Path("a.stl"), "mesh")
    with pytest.raises(vx.InputTypeError, match=r"^mesh must be a path, not float$"):
        arguments.as_path(1.0, "mesh")
    for value in ("", "a\0b"):
        with pytest.raises(vx.FileAccessError, match=r"^mesh must name a file, not "):
            arguments.as_path(value, "mesh")


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("part", "'part'"),
        (10**5000, "an integer of 16610 bits"),
        ([10**5000], "a list with an integer of too many digits"),
        ("x" * 200, "'" + "x" * 79 + "..."),
        (np.eye(2), "array([[1., 0.], [0., 1.]])"),
    ],
    ids=["text", "large integer", "large integer in a list", "long text", "array"],
)
def test_values_are_shown_in_a_short_line(value: object, shown: str):
    """An array in the place of a number filled pages, and a large integer raised a ValueError."""
    assert arguments.show_value(value) == shown
    with pytest.raises(vx.SettingsError) as caught:
        arguments.as_real(value, "mass")
    assert str(caught.value) == f"mass must be a number, not {shown}"


def test_numbers_that_differ_are_shown_so():
    assert arguments.show_apart(1.0, 2.0, 1 / 3) == ["1", "2", "0.333333"]
    assert arguments.show_apart(-2.77556e-17, 0.0, 0.31) == ["-2.77556e-17", "0", "0.31"]
    assert arguments.show_apart(math.radians(30), 0.523599) == ["0.5235988", "0.523599"]
    assert arguments.show_apart(1.0, math.nextafter(1.0, 2.0)) == ["1.0", "1.0000000000000002"]
    assert arguments.show_apart(2.0, 2.0) == ["2", "2"]


def test_flags_are_true_or_false():
    assert arguments.as_flag(True, "sleeping") is True
    assert arguments.as_flag(np.False_, "sleeping") is False
    for value in ("no", 0, 1, None, [], np.ones(2)):
        with pytest.raises(vx.SettingsError, match=r"^sleeping must be True or False, not "):
            arguments.as_flag(value, "sleeping")


def test_choices_are_words_of_a_list():
    assert arguments.as_choice("a", "kind", ("a", "b")) == "a"
    for value in ("c", ["a"], np.array(["a", "b"]), {}, None):
        with pytest.raises(vx.SettingsError, match=r"^kind must be 'a' or 'b', not "):
            arguments.as_choice(value, "kind", ("a", "b"))


def test_texts_and_callables_are_of_their_kind():
    assert arguments.as_text("part", "name") == "part"
    arguments.check_callable(None, "progress")
    arguments.check_callable(print, "progress")
    with pytest.raises(vx.InputTypeError, match="name must be a string, not int"):
        arguments.as_text(5, "name")
    with pytest.raises(vx.InputTypeError, match="progress must be callable, not int"):
        arguments.check_callable(5, "progress")


def test_what_is_not_unicode_becomes_question_marks():
    assert arguments.as_unicode("n\udcff\ud800ü") == "n??ü"


def test_infinity_is_a_number_and_no_array():
    assert arguments.is_infinite(math.inf)
    assert arguments.is_infinite(np.float32(math.inf))
    for value in (-math.inf, 1.0, None, "inf", np.array([math.inf, 1.0])):
        assert not arguments.is_infinite(value)


class Unshowable:
    def __repr__(self) -> str:
        raise AttributeError("not made yet")


def nest(depth: int) -> list:
    nested: list = []
    for _ in range(depth):
        nested = [nested]
    return nested


@pytest.mark.parametrize("value", [Unshowable(), nest(10**4)], ids=["object", "list"])
def test_values_that_cannot_be_shown_are_refused_like_others(value: object):
    with pytest.raises(
        vx.SettingsError, match=f"x must be a number, not a {type(value).__name__} that cannot be"
    ):
        arguments.as_real(value, "x")


@pytest.mark.parametrize("value", [range(10**15), np.broadcast_to(0.0, (10**12, 3))])
def test_arguments_beyond_all_memory_are_named(value):
    ball = vx.Sphere(0.1)
    with pytest.raises(vx.MemoryLimitError, match="no memory left for points"):
        arguments.as_points(value, "points")
    with pytest.raises(vx.MemoryLimitError, match="no memory left for a_pose"):
        vx.collide(ball, ball, value)
    with pytest.raises(vx.MemoryLimitError, match="no memory left for a_poses"):
        vx.collide_batch(ball, ball, value)


def test_what_only_seems_iterable_is_not():
    assert arguments.is_iterable([])
    assert arguments.is_iterable(iter("ab"))
    assert not arguments.is_iterable(np.array(1.0))
    for make in (vx.Compound, vx.ConvexDecomposition):
        with pytest.raises(vx.InputTypeError, match="not ndarray"):
            make(np.array(1.0))
