"""Reading and checking MJCF files."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from voxshell.base.near_names import find_closest
from voxshell.errors import RobotError
from voxshell.robots.description import Inertial, RobotDescription
from voxshell.robots.mjcf.bodies import BodyReader
from voxshell.robots.mjcf.filters import Filters
from voxshell.robots.mjcf.left_out import LeftOut
from voxshell.robots.mjcf.model_file import read_model
from voxshell.robots.mjcf.names import check_names
from voxshell.robots.mjcf.parts import open_part

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.robots.xml_elements import Element


@dataclass(frozen=True, eq=False)
class Model:
    """The content of a file.

    Attributes:
        robot: Links and joints.
        filters: Rules for which bodies collide.
        carriers: The body of each link between joints, by name.
        root: Its elements.
    """

    robot: RobotDescription
    filters: Filters
    carriers: dict[str, str]
    root: Element


def read_mjcf(path: str | os.PathLike[str], gravity: Iterable[float], time_step: float) -> Model:
    """Read and check a file.

    Args:
        path: The file's path.
        gravity: The world's gravity, m/s2; if the file's differs, it is noted as not simulated.
        time_step: The world's time step, seconds; as above.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The file cannot be read.
        RobotError: The file cannot be simulated; the message names the file, the line, the body or
            geom, and a remedy.
    """
    try:
        return _read(path, gravity, time_step)
    except RobotError as error:
        name = os.fsdecode(path)
        if name in str(error):
            raise
        raise RobotError(f"{error} (while reading {name})") from None


def _read(path: str | os.PathLike[str], gravity: Iterable[float], time_step: float) -> Model:
    file = read_model(path)
    name = file.root.attributes.get("model")
    stem = os.path.splitext(os.path.basename(file.path))[0]
    robot = RobotDescription(file.path, name or stem, {}, {})
    tags = {child.tag for child in file.root.children} - {"body"}  # which parts have there
    if not any(find_closest(tag, ("worldbody",)) for tag in tags):
        robot.refuse(
            "it has no <worldbody>: it is empty, or meant for <include>; load a model that includes it"
        )
    check_names(file.root)
    filters = Filters(file.root)
    left_out = LeftOut()
    part = open_part(file, "")
    bodies = BodyReader(part, robot, filters, left_out)
    if part.compiler.total_mass is not None:
        _scale_masses(robot, part.compiler.total_mass)
    left_out.note_option(file.root, gravity, time_step)
    robot.left_out.extend(left_out.list())
    return Model(robot, filters, bodies.carriers, file.root)


def _scale_masses(robot: RobotDescription, total: float) -> None:
    own = sum(link.inertial.mass for link in robot.links.values() if link.inertial is not None)
    for name, link in robot.links.items():
        it = link.inertial
        if it is not None:
            ratio = total / own
            inertia = None if it.inertia is None else it.inertia * ratio
            scaled = Inertial(it.mass * ratio, it.center, inertia)
            robot.links[name] = replace(link, inertial=scaled)
