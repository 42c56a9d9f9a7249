"""``voxshell view``: a page to inspect a model, and to drag two bodies against each other."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console

from voxshell.base.outputs import check_output_file, check_suffix
from voxshell.cli.bodies import DEFAULTS, ModelOptions, read_body, refuse_unused
from voxshell.cli.progress import open_progress, tracked
from voxshell.errors import SettingsError
from voxshell.model.meshes import name_of
from voxshell.model.model import Model
from voxshell.viewer.guard import make_token
from voxshell.viewer.inspector import Inspector, Layer
from voxshell.viewer.page import plain_head
from voxshell.viewer.server import import_viser, make_address, silent_server

if TYPE_CHECKING:
    from voxshell.query.pairs import Collidable


def view(
    body: str,
    other: str | None = None,
    /,
    *,
    show: Annotated[tuple[Layer, ...], Parameter(consume_multiple=True, negative="")] = (
        "surface",
    ),
    export: Path | None = None,
    port: int = 8080,
    options: ModelOptions = DEFAULTS,
) -> None:
    """Show a model in the browser: surface, distance field, points and tree; Ctrl-C ends it.

    With two bodies, drag and turn each by its arrows and rings; the contacts follow.

    For example:

        voxshell view part.stl --scale 0.001
        voxshell view bunny.vxs plane
        voxshell view bunny.vxs --show slice points --export bunny.html

    Args:
        body: A model file (.vxs), or a mesh file.
        other: A second body, or a shape such as plane, sphere:0.1 or box:0.1,0.1,0.05.
        show: The layers to show at first: surface, slice, level, points, normals, spheres.
        export: Write the scene as an offline page (.html) without controls, instead of serving it.
        options: How to build models from meshes.
        port: Port of the page on this machine, or the next free one. The address contains a
            secret, so that other pages in the browser cannot read the scene.
    """
    if not show:
        raise SettingsError("show must name at least one layer, as in --show slice points")
    if export is not None:
        check_output_file(export)
        check_suffix(export, (".html", ".htm"), "a page")
    refuse_unused(options, *((body,) if other is None else (body, other)))
    import_viser()  # fail before models are built, which may take long
    bodies: dict[str, Collidable] = {}
    with open_progress(Console(stderr=True)) as progress:
        # If both arguments are equal, the body is read once.
        for text in dict.fromkeys((body,) if other is None else (body, other)):
            with tracked(progress, f"read {Path(text).name}") as track:
                bodies[text] = read_body(text, options, track.update)
    model = bodies[body]
    if not isinstance(model, Model):
        raise SettingsError(f"{body} has no field and no points: name a mesh or a model file first")
    partner = None if other is None else bodies[other]
    token = make_token()
    with silent_server(port if export is None else 0, token=token, head=plain_head()) as server:
        inspector = Inspector(server, model, partner, name=name_of(body), show=show)
        if export is not None:
            inspector.save_html(export)
            print(f"wrote {export}")
            return
        print(f"{make_address(server, token)}  (Ctrl-C ends it)", flush=True)
        server.sleep_forever()
