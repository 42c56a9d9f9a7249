"""The public interface is what the committed list says: every change of it is seen in a review."""

from __future__ import annotations

import difflib

import list_public_api
import pytest

RENEW = (
    "the public interface is not what tests/python/public_api.txt says; if the change is meant, run "
    "`.venv/bin/python tools/list_public_api.py --write` and commit the file:\n"
)


def test_the_public_interface_is_the_committed_one():
    committed = list_public_api.COMMITTED.read_text().splitlines()
    found = list_public_api.list_api().splitlines()
    changes = "\n".join(difflib.unified_diff(committed, found, "committed", "found", lineterm=""))
    assert not changes, RENEW + changes


def test_the_list_has_every_kind_of_thing_once():
    lines = list_public_api.list_api().splitlines()
    paths = [line.split("(")[0].split(":")[0] for line in lines if not line.startswith(" ")]
    assert len(paths) == len(set(paths))
    for line in (
        "class voxshell.errors.MeshError is a VoxshellError, ValueError",
        "class voxshell.Box(half_extents: ArrayLike) -> None is a Field",
        "    half_extents: NDArray[np.float64] (property)",
        "    pose: NDArray[np.float64] (property, settable)",
        "    time_step: float (property)",
        "    step(self, n: int = 1, callback: Callable[[World], object] | None = None, *, before: "
        "Callable[[World], object] | None = None) -> None",
        "    load(path: str | os.PathLike[str]) -> Model (classmethod)",
        "voxshell.testing: module",
    ):
        assert line in lines


def test_wrong_arguments_show_how_to_use_it(capsys: pytest.CaptureFixture[str]):
    assert list_public_api.main(["--renew"]) == 2
    assert "--write" in capsys.readouterr().out
