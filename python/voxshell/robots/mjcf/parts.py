"""Parts: a model, or one attached to it, with everything that its elements refer to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell.robots.mjcf.compiler import Compiler, read_compiler
from voxshell.robots.mjcf.defaults import MAIN, Defaults
from voxshell.robots.mjcf.meshes import Meshes
from voxshell.robots.mjcf.names import check_names

if TYPE_CHECKING:
    from voxshell.robots.mjcf.model_file import ModelFile
    from voxshell.robots.xml_elements import Element


@dataclass(frozen=True, eq=False)
class Part:
    """A model on its own.

    Attributes:
        file: Its elements.
        prefix: The prefix of its names.
        compiler: Its settings.
        defaults: Its default classes.
        meshes: Its meshes.
        materials: Its materials, by name.
    """

    file: ModelFile
    prefix: str
    compiler: Compiler
    defaults: Defaults
    meshes: Meshes
    materials: dict[str, Element]

    def attach(self, element: Element) -> tuple[Part, list[Element]]:
        """Return the model that an ``<attach>`` names, and the elements that replace it.

        Raises:
            RobotError: There is no such model or body, or its file cannot be read or has unknown names.
        """
        name = element.text("model")
        named = [
            model
            for section in self.file.sections("asset")
            for model in section.all("model")
            if model.attributes.get("name") == name
        ]
        if not named:
            element.refuse(f"attaches the model {name[:60]!r}, but <asset> has no such model")
        file = self.file.attach(named[0])
        check_names(file.root)
        part = open_part(file, self.prefix + element.attributes.get("prefix", ""))
        sections = part.file.sections("worldbody")
        body = element.attributes.get("body")
        if body is None:
            return part, [child for section in sections for child in section.children]
        waiting = sections
        for it in waiting:
            if it.tag == "body" and it.attributes.get("name") == body:
                return part, [it]
            waiting += it.children
        return element.refuse(f"attaches the body {body[:60]!r}, but the model has no such body")


def open_part(file: ModelFile, prefix: str) -> Part:
    """Return a file as a part.

    Raises:
        RobotError: A setting or a class is invalid.
    """
    compiler = read_compiler(file.sections("compiler"))
    defaults = Defaults(file.sections("default"))
    materials = {
        material.attributes.get("name", ""): defaults.complete(material, MAIN)
        for section in file.sections("asset")
        for material in section.all("material")
    }
    return Part(file, prefix, compiler, defaults, Meshes(file, compiler, defaults), materials)
