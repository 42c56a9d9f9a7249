"""What a robot's file lacks, and what of it is faulty or not simulated, in one warning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.base.arguments import show_value
from voxshell.base.user_warnings import shorten_path, warn_user
from voxshell.model.meshes import MeshWarning
from voxshell.robots.description import MIMIC_EFFORT, shorten_names
from voxshell.robots.matter import DENSITY, GHOST_MASS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from voxshell.robots.description import RobotDescription
    from voxshell.robots.matter import Matter

_MOST_FLAWS = 30
"""Number of faulty meshes, or of links with a doubtful inertia, that a line of the warning lists."""


class RobotWarning(UserWarning):
    """A robot's file lacks what a simulation needs, is faulty, or contains what is not simulated.

    The message has one line for each cause. It says what was used instead, which meshes of which links have
    faults, and what is not simulated. Of many links or meshes, it names the first ones and counts the others.
    """


def warn_of_robot(robot: RobotDescription, matter: Matter) -> None:
    """Warn once about all that is wrong with a file, and about each mesh whose unit is doubtful."""
    for doubt in robot.doubts:
        warn_user(doubt, MeshWarning)
    causes = [
        f"{text} ({shorten_names(names)}); complete the file to avoid this warning"
        for text, names in _find_lacks(robot, matter)
    ]
    if robot.unknown:
        shown = [f"{what} ({_cut(places)})" for what, places in robot.unknown.items()]
        causes.append(
            f"has unknown elements, which are not read: {_cut(shown)}; correct or remove them"
        )
    if matter.with_large_inertia:
        worst = sorted(matter.with_large_inertia.items(), key=lambda link: -link[1])
        shown = [f"{show_value(name)}: {float(f'{times:.2g}'):,.0f} times" for name, times in worst]
        causes.append(
            f"has inertias far beyond the largest that a body of the size of the collision geometry can have "
            f"({_cut(shown)}); pybullet ignores a file's inertias by default: pass inertia='shape' to take "
            "those of the shapes, too, or correct the file"
        )
    causes.extend(_describe_flaws(robot.flaws))
    if robot.moved_to_limits:
        causes.append(
            "has joints that would begin beyond their limits, and begin at the nearest limit "
            f"({shorten_names(list(robot.moved_to_limits))}); pass positions= to begin elsewhere"
        )
    if robot.left_out:
        causes.append(f"contains what is not simulated: {'; '.join(robot.left_out)}")
    if causes:
        only = causes[0] if len(causes) == 1 else ""
        between = " " if only[:1].isalpha() else ": "
        said = f"{between}{only}" if only else ":" + "".join(f"\n- {each}" for each in causes)
        warn_user(f"{shorten_path(robot.path)}{said}", RobotWarning)


def _find_lacks(robot: RobotDescription, matter: Matter) -> Iterator[tuple[str, Sequence[str]]]:
    """Yield what is missing and was used instead, with the names of links or joints."""
    efforts = {joint.name: joint.effort for joint in robot.joints}
    weak = [
        joint.name
        for joint in robot.joints
        if joint.mimic is not None and not (joint.effort or efforts[joint.mimic[0]])
    ]
    hulls = "the convex hulls of the collision geometry"
    thickness = 1e3 * max(robot.flat.values(), default=0.0)
    for thing, text, names in (
        ("link", f"without a mass got that of {hulls} at {DENSITY:g} kg/m3", matter.without_mass),
        ("link", f"without a mass and a shape got {GHOST_MASS:g} kg", matter.without_shape),
        ("link", f"without a valid inertia got that of {hulls}", matter.without_inertia),
        (
            "link",
            "with an impossible inertia had its largest moment reduced to the sum of the others",
            matter.with_bounded_inertia,
        ),
        (
            "link",
            "without <collision> cannot be touched, although visible",
            robot.intangible,
        ),
        (
            "joint",
            "without <limit>, or with a lower limit above the upper one, got no limits",
            robot.without_limits,
        ),
        (
            "link",
            f"with flat collision meshes became sheets {thickness:.3g} mm thick",
            list(robot.flat),
        ),
        (
            "joint",
            f"with <mimic> and without an effort got one of {MIMIC_EFFORT:g} N or N m",
            weak,
        ),
    ):
        if names:
            yield f"{len(names)} {thing}{'' if len(names) == 1 else 's'} {text}", names


def _describe_flaws(flaws: Mapping[str, Mapping[str, Sequence[str]]]) -> Iterator[str]:
    """Yield what is wrong with the meshes, for each way in which it was handled."""
    for handling, found in flaws.items():
        if handling:
            of_openings = "open='solid', open='sheet' or " if _have_openings(found) else ""
            yield (
                f"has faulty meshes; {handling}: {_list_flaws(found)}; repair them, or pass "
                f"{of_openings}mesh_as='hull', to avoid this warning"
            )
        else:
            yield (
                f"has models that are inaccurate or large: {_list_flaws(found)}; repair their "
                "meshes, or pass another tolerance="
            )


def _have_openings(flaws: Iterable[str]) -> bool:
    """Return whether a mesh is open only where it could be closed, or be a sheet."""
    return any(" opening" in what for what in flaws)


def _list_flaws(flaws: Mapping[str, Sequence[str]]) -> str:
    """Return links with the names of their meshes and the faults: "'a', 'b' (foot.stl: 3 open edges)"."""
    shown = [f"{shorten_names(links)} ({what})" for what, links in flaws.items()]
    return _cut(shown)


def _cut(shown: Sequence[str]) -> str:
    """Return the first of many phrases, and the number of the others."""
    more = len(shown) - _MOST_FLAWS
    return ", ".join(shown[:_MOST_FLAWS]) + (f", and {more} more" if more > 0 else "")
