"""``voxshell query``: contacts, collision, distance or force of two bodies."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from voxshell.cli.bodies import DEFAULTS, ModelOptions, read_body, refuse_unused
from voxshell.cli.pose_input import make_pose, read_poses
from voxshell.cli.progress import open_progress, tracked
from voxshell.cli.tables import new_table
from voxshell.errors import PoseError, SettingsError
from voxshell.measuring.files import finite
from voxshell.measuring.units import format_length
from voxshell.query.batch import collide_batch, contacts_batch
from voxshell.query.distances import distance
from voxshell.query.pairs import Shell
from voxshell.query.scratch import QueryScratch
from voxshell.query.wrenches import wrench

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from voxshell.cli.progress import Track
    from voxshell.query.contact_set import Contacts
    from voxshell.query.distances import Distance
    from voxshell.query.pairs import Collidable
    from voxshell.query.wrenches import Wrench

Question: TypeAlias = Literal["contacts", "collide", "distance", "wrench"]
Numbers: TypeAlias = Annotated[
    tuple[float, ...] | None, Parameter(consume_multiple=True, negative="")
]

_MOST_POSES, _MOST_CONTACTS = 20, 8
"""Largest number of lines in a table."""


def query(
    a: str,
    b: str,
    /,
    *,
    pose: Numbers = None,
    a_pose: Numbers = None,
    poses: Path | None = None,
    ask: Annotated[tuple[Question, ...], Parameter(consume_multiple=True, negative="")] = (
        "contacts",
        "collide",
        "distance",
    ),
    shell: Shell = "auto",
    margin: float = 0.0,
    max_points: int | None = None,
    stiffness: float | None = None,
    options: ModelOptions = DEFAULTS,
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Query two bodies for contacts, collision (yes or no), distance or force.

    A body is a model file, a mesh, or a shape: plane, plane:NX,NY,NZ,OFFSET, box:HX,HY,HZ (half
    extents), sphere:RADIUS, capsule:RADIUS,LENGTH, cylinder:RADIUS,LENGTH, cone:RADIUS,HEIGHT. One
    of the two must be a mesh or a model.

    A pose is 3 numbers (x y z), 7 (x y z and a quaternion x y z w) or 16 (a 4x4 matrix, row by
    row), world from body, in meters. A body without a pose is at the origin.

    For example, a part 10 mm above another, the force on a part in the ground, and many poses:

        voxshell query part.vxs other.stl --scale 0.001 --pose 0 0 0.01
        voxshell query part.vxs plane --a-pose 0 0 0.02 --ask wrench --stiffness 1e6
        voxshell query part.vxs part.vxs --poses poses.csv --json

    Args:
        a: The first body.
        b: The second body. Normals point from it toward the first.
        pose: Pose of b.
        a_pose: Pose of a.
        poses: Many poses of b: a .csv file with one pose per line, or a .npy file with an array of
            shape (n, 4, 4), (n, 3), (n, 7) or (n, 16).
        ask: What to compute; wrench needs --stiffness.
        shell: The body whose points are tested. auto chooses the body, or both, that misses least;
            fewest chooses the body with fewer points.
        margin: Distance in meters up to which points count as contacts.
        max_points: Return only this many contacts, the deepest.
        stiffness: Pressure per meter of depth for wrench, in newtons per cubic meter.
        options: How to build models from meshes.
        json_only: Print only JSON: all contacts and answers.
    """
    if poses is not None and pose is not None:
        raise SettingsError("give either pose or poses, not both")
    if not ask:
        raise SettingsError("ask must name a question: contacts, collide, distance or wrench")
    if "wrench" in ask and stiffness is None:
        raise SettingsError("wrench needs a stiffness, as in --stiffness 1e6")
    refuse_unused(options, a, b)
    world_from_a = np.eye(4) if a_pose is None else make_pose(a_pose, "a_pose")
    if poses is not None:
        world_from_b = read_poses(poses)
    else:
        world_from_b = (np.eye(4) if pose is None else make_pose(pose, "pose"))[None]
    with open_progress(Console(quiet=json_only, stderr=True)) as progress:
        bodies: dict[str, Collidable] = {}
        # If both arguments are equal, the body is read once.
        for text in dict.fromkeys((a, b)):
            with tracked(progress, f"read {Path(text).name}") as track:
                bodies[text] = read_body(text, options, track.update)
        with tracked(progress, "ask") as track:
            try:
                answers = _ask(
                    bodies[a],
                    bodies[b],
                    world_from_a,
                    world_from_b,
                    ask,
                    shell,
                    margin,
                    max_points,
                    stiffness,
                    track,
                )
            except PoseError as error:
                text = str(error)
                text = text.removeprefix("b_poses[0]: ") if poses is None else f"{poses}: {text}"
                raise PoseError(text) from None
    if json_only:
        print(json.dumps(finite(answers)))
        return
    console = Console(highlight=False)
    for table in _make_tables(answers):
        console.print(table)


def _ask(
    a: Collidable,
    b: Collidable,
    a_pose: NDArray[np.float64],
    b_poses: NDArray[np.float64],
    ask: tuple[Question, ...],
    shell: Shell,
    margin: float,
    max_points: int | None,
    stiffness: float | None,
    track: Track,
) -> list[dict[str, Any]]:
    """Return the result for each pose, ready for JSON."""
    answers: list[dict[str, Any]] = [
        {"pose": index, "b_pose": pose.tolist()} for index, pose in enumerate(b_poses)
    ]
    if "contacts" in ask:
        found = contacts_batch(
            a,
            b,
            a_pose,
            b_poses,
            shell=shell,
            margin=margin,
            max_points=max_points,
            progress=track.update,
        )
        for answer, each in zip(answers, found, strict=True):
            answer["contacts"] = _describe_contacts(each)
    if "collide" in ask:
        touching = collide_batch(a, b, a_pose, b_poses, shell=shell, margin=margin)
        for answer, touches in zip(answers, touching.tolist(), strict=True):
            answer["collide"] = touches
    scratch = QueryScratch()
    for index, (answer, pose) in enumerate(zip(answers, b_poses, strict=True)):
        if "distance" in ask:
            answer["distance"] = _describe_distance(
                distance(a, b, a_pose, pose, shell=shell, scratch=scratch)
            )
        if "wrench" in ask and stiffness is not None and shell != "both":
            answer["wrench"] = _describe_wrench(
                wrench(a, b, a_pose, pose, stiffness=stiffness, shell=shell, scratch=scratch)
            )
        track.update("", (index + 1) / len(answers))
    return answers


def _describe_contacts(found: Contacts) -> dict[str, Any]:
    return {
        "count": len(found),
        "shells": found.shells.tolist(),
        "ids": found.ids.tolist(),
        "depths": found.depths.tolist(),
        "points_a": found.points_a.tolist(),
        "points_b": found.points_b.tolist(),
        "normals": found.normals.tolist(),
    }


def _describe_distance(found: Distance) -> dict[str, Any]:
    return {
        "distance": found.distance,
        "point_a": found.point_a.tolist(),
        "point_b": found.point_b.tolist(),
        "normal": found.normal.tolist(),
        "shell": found.shell,
    }


def _describe_wrench(found: Wrench) -> dict[str, Any]:
    return {"force": found.force.tolist(), "torque": found.torque.tolist()}


def _make_tables(answers: list[dict[str, Any]]) -> Iterable[Any]:
    """Yield a table with a line for each pose; for a single pose, also its deepest contacts."""
    single = len(answers) == 1
    names = [key for key in ("contacts", "collide", "distance", "wrench") if key in answers[0]]
    headings = {
        "contacts": ("contacts", "deepest"),
        "collide": ("touch",),
        "distance": ("distance",),
        "wrench": ("force, N", "torque, N m"),
    }
    table = new_table("pose", *(word for name in names for word in headings[name]))
    for answer in answers[:_MOST_POSES]:
        cells = [cell for name in names for cell in _format_answer(name, answer[name])]
        table.add_row(str(answer["pose"]), *cells)
    yield table
    if len(answers) > _MOST_POSES:
        yield f"and {len(answers) - _MOST_POSES} more poses: --json lists all"
    if single and answers[0].get("contacts", {}).get("count"):
        yield _make_contact_table(answers[0]["contacts"])
    if single and "distance" in answers[0] and math.isfinite(answers[0]["distance"]["distance"]):
        nearest = answers[0]["distance"]
        for body in ("a", "b"):
            yield escape(f"measured on {body} at {_format_vector(nearest[f'point_{body}'])} m")


def _make_contact_table(found: dict[str, Any]) -> Any:
    order = np.argsort(-np.array(found["depths"]), kind="stable")[:_MOST_CONTACTS]
    title = "Contacts" if len(order) == found["count"] else f"The {len(order)} deepest contacts"
    table = new_table("point", "depth", "on b, m", "normal", title=title)
    for index in order:
        table.add_row(
            f"{found['shells'][index]} {found['ids'][index]}",
            format_length(found["depths"][index]),
            _format_vector(found["points_b"][index]),
            " ".join(f"{round(x, 3) + 0.0:.3f}" for x in found["normals"][index]),
        )
    return table


def _format_answer(name: str, answer: Any) -> tuple[str, ...]:
    if name == "contacts":
        deepest = format_length(max(answer["depths"])) if answer["count"] else "-"
        return f"{answer['count']:,}", deepest
    if name == "collide":
        return ("yes" if answer else "no",)
    if name == "distance":
        return (format_length(answer["distance"]),)
    return tuple(_format_vector(answer[key]) for key in ("force", "torque"))


def _format_vector(vector: Any) -> str:
    # Numbers far below a nanometer or a nanonewton are rounding errors.
    return " ".join(f"{0.0 if abs(x) < 1e-10 else float(x):.4g}" for x in vector)
