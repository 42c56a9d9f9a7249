"""What a robot's file lacks, and what of it is faulty or not simulated, in one warning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.base.arguments import show_value
from voxshell.base.user_warnings import shorten_path, warn_user
from voxshell.model.meshes import MeshWarning
from voxshell.robots.description import MIMIC_EFFORT, shorten_names
from voxshell.robots.matter import DENSITY, GHOST_MASS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from voxshell.robots.description import RobotDescription
    from voxshell.robots.matter import Matter

_MOST_FLAWS = 30
"""Number of faulty meshes, or of links with a doubtful inertia, that the warning lists."""


class RobotWarning(UserWarning):
    """A robot's file lacks what a simulation needs, is faulty, or contains what is not simulated.

    The message says what was used instead, which meshes of which links have faults, and lists what is
    not simulated.
    """


def warn_of_robot(robot: RobotDescription, matter: Matter) -> None:
    """Warn once about all that is wrong with a file, and about each mesh whose unit is doubtful."""
    for doubt in robot.doubts:
        warn_user(doubt, MeshWarning)
    said = []
    lacks = "; ".join(
        f"{text} ({shorten_names(names)})" for text, names in _find_lacks(robot, matter)
    )
    if lacks:
        said.append(
            f"lacks values that a simulation needs: {lacks}; complete the file to avoid this warning"
        )
    if robot.unknown:
        shown = [f"{what} ({_cut(places)})" for what, places in robot.unknown.items()]
        said.append(
            f"has unknown elements, which are not read: {_cut(shown)}; correct or remove them"
        )
    if matter.with_large_inertia:
        shown = [
            f"{show_value(name)}: {float(f'{times:.2g}'):,.0f} times"
            for name, times in matter.with_large_inertia.items()
        ]
        said.append(
            "has inertias far beyond the largest that a body of the size of the collision geometry can have "
            f"({_cut(shown)}); pybullet ignores a file's inertias by default: pass "
            "inertia='shape' to take those of the shapes, too, or correct the file"
        )
    if robot.left_out:
        said.append(f"contains what is not simulated: {'; '.join(robot.left_out)}")
    faults = "; ".join(f"{what}: {_list_flaws(it)}" for what, it in robot.flaws.items() if what)
    if faults:
        said.append(
            f"has faulty meshes; {faults}; repair them, or pass mesh_as='hull', to avoid this warning"
        )
    if "" in robot.flaws:
        said.append(
            f"has models that are inaccurate or large: {_list_flaws(robot.flaws[''])}; repair their "
            "meshes, or pass another tolerance="
        )
    if robot.moved_to_limits:
        said.append(
            "has joints that would begin beyond their limits, and begin at the nearest limit "
            f"({shorten_names(list(robot.moved_to_limits))}); pass positions= to begin elsewhere"
        )
    if said:
        warn_user(f"{shorten_path(robot.path)} {', and '.join(said)}", RobotWarning)


def _find_lacks(robot: RobotDescription, matter: Matter) -> Iterator[tuple[str, Sequence[str]]]:
    """Yield what is missing and was used instead, with the names of links or joints."""
    efforts = {joint.name: joint.effort for joint in robot.joints}
    weak = [
        joint.name
        for joint in robot.joints
        if joint.mimic is not None and not (joint.effort or efforts[joint.mimic[0]])
    ]
    hulls = "the convex hulls of their collision geometry"
    thickness = 1e3 * max(robot.flat.values(), default=0.0)
    for text, names in (
        (f"links without a mass got that of {hulls} at {DENSITY:g} kg/m3", matter.without_mass),
        (f"links without a mass and a shape got {GHOST_MASS:g} kg", matter.without_shape),
        (f"links without a valid inertia got that of {hulls}", matter.without_inertia),
        (
            "impossible inertias had their largest moment reduced to the sum of the others",
            matter.with_bounded_inertia,
        ),
        ("links without <collision> touch nothing, although they are visible", robot.intangible),
        (
            "joints without <limit>, or with a lower limit above the upper one, move without limits",
            robot.without_limits,
        ),
        (f"flat collision meshes became sheets {thickness:.3g} mm thick", list(robot.flat)),
        (
            f"joints that mimic others and state no effort follow with {MIMIC_EFFORT:g} N or N m",
            weak,
        ),
    ):
        if names:
            yield text, names


def _list_flaws(flaws: Mapping[str, Sequence[str]]) -> str:
    """Return links with the names of their meshes and the faults: "'a', 'b' (foot.stl: 3 open edges)"."""
    shown = [f"{shorten_names(links)} ({what})" for what, links in flaws.items()]
    return _cut(shown)


def _cut(shown: Sequence[str]) -> str:
    """Return the first of many phrases, and the number of the others."""
    more = len(shown) - _MOST_FLAWS
    return ", ".join(shown[:_MOST_FLAWS]) + (f", and {more} more" if more > 0 else "")
