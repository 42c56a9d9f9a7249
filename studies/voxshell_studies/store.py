"""Finished parts on the disk: a folder each, there whole or not at all."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.base.outputs import filling, make_folder
from voxshell.base.unfinished import sweep
from voxshell.measuring.files import import_pyarrow, write_json, write_parquet

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.part import Outcome, Part, Tables

MANIFEST = "manifest.json"


class Store:
    """The parts of one experiment that are done, below a folder.

    A part's folder is named after the part and its address, and appears by one rename: what a killed
    run leaves behind is either finished or ignored.

    Args:
        folder: Is made where there is none.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def place(self, part: Part) -> Path:
        """Where the part's data is, once it is done."""
        return self.folder / f"{part.name}-{part.address}"

    def has(self, part: Part) -> bool:
        """Whether it is done."""
        return (self.place(part) / MANIFEST).is_file()

    def put(self, part: Part, outcome: Outcome) -> None:
        """Writes each table as Parquet, and the manifest.

        Raises:
            FileAccessError: The system does not let them be written.
        """
        make_folder(self.folder)
        with filling(self.place(part)) as folder:
            for name, columns in outcome.tables.items():
                write_parquet(folder / f"{name}.parquet", columns)
            write_json(folder / MANIFEST, outcome.manifest)

    def get(self, part: Part) -> Tables:
        """The part's tables.

        Raises:
            OSError: It is not done.
        """
        _, parquet = import_pyarrow()
        return {
            path.stem: {
                name: np.asarray(column.to_numpy())
                for name, column in _columns(parquet.ParquetFile(path).read())
            }
            for path in sorted(self.place(part).glob("*.parquet"))
        }

    def manifest(self, part: Part) -> dict[str, Any]:
        """What the part was made with."""
        return json.loads((self.place(part) / MANIFEST).read_text(encoding="utf-8"))

    def sweep(self) -> None:
        """Removes what killed runs left unfinished."""
        sweep(self.folder)


def _columns(table: Any) -> Any:
    return zip(table.column_names, table.columns, strict=True)
