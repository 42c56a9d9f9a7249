"""World.view: what it refuses, what it hands to the page, and when the view ends."""

from __future__ import annotations

import gc
import weakref

import pytest
import voxshell as vx
from live_worlds import Screen, make_world


def test_a_world_has_one_view_at_a_time(screens: list[Screen]):
    world, _ = make_world()
    view = world.view()
    with pytest.raises(vx.SettingsError, match=r"already has a view at http://127.0.0.1:1/secret/"):
        world.view()
    view.close()
    view.close()
    assert screens[0].closed
    assert not view.is_open
    assert repr(view) == "LiveView(closed)"
    with world.view() as second:
        assert second.is_open
        world.step(3)


def test_a_view_ends_with_its_world(screens: list[Screen]):
    world, _ = make_world()
    world.view()
    gone = weakref.ref(world)
    del world, _
    gc.collect()
    assert gone() is None
    assert screens[0].closed


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"port": -1}, "port must be from 0 to 65535"),
        ({"speed": 0.0}, "speed must be above 0"),
        ({"wait": -1.0}, "wait must be at least 0"),
        ({"frames_per_second": 0}, "frames_per_second must be above 0"),
        ({"title": 5}, "title must be a string, not int"),
        ({"colors": ["red"]}, "colors must be a mapping from bodies"),
    ],
)
def test_bad_options_are_refused(options: dict[str, object], message: str, screens: list[Screen]):
    world, _ = make_world()
    with pytest.raises((vx.SettingsError, vx.InputTypeError), match=message):
        world.view(**options)
    assert screens == []


def test_the_page_is_given_what_it_is_to_show(screens: list[Screen]):
    world, bodies = make_world()
    with world.view(port=0, title="drop", colors={bodies[0]: (1, 2, 3)}):
        assert screens[0].options == {"port": 0, "title": "drop", "colors": {bodies[0]: (1, 2, 3)}}
    with world.view():
        assert screens[1].options == {"port": 8080, "title": "voxshell", "colors": {}}


@pytest.mark.parametrize("wanted", [False, True])
def test_a_browser_is_opened_only_if_asked_for(
    wanted: bool, monkeypatch: pytest.MonkeyPatch, screens: list[Screen]
):
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    world, _ = make_world()
    with world.view(open_browser=wanted):
        assert opened == [Screen.address] * wanted


def test_a_view_that_was_refused_leaves_room_for_another(screens: list[Screen]):
    world, _ = make_world()
    with pytest.raises(vx.SettingsError):
        world.view(speed=-1.0)
    with world.view(speed=2.0) as view:
        assert view.speed == 2.0


def test_a_page_that_cannot_be_shown_is_closed(
    monkeypatch: pytest.MonkeyPatch, screens: list[Screen]
):
    def fail(*_: object, **__: object) -> None:
        raise RuntimeError("cannot draw")

    monkeypatch.setattr(Screen, "show", fail)
    world, _ = make_world()
    with pytest.raises(RuntimeError, match="cannot draw"):
        world.view()
    assert screens[0].closed
