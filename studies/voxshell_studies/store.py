"""Finished parts on the disk: a folder for each, which is complete or missing."""

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
    """The finished parts of an experiment, below a folder.

    A part's folder is named after the part and its address, and appears by one rename. A killed run
    therefore leaves either a finished part or something that is ignored.

    Args:
        folder: The folder; it is made if it does not exist.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def place(self, part: Part) -> Path:
        """Return the folder of a finished part's data."""
        return self.folder / f"{part.name}-{part.address}"

    def has(self, part: Part) -> bool:
        """Return whether a part is finished."""
        return (self.place(part) / MANIFEST).is_file()

    def put(self, part: Part, outcome: Outcome) -> None:
        """Write each table as Parquet, and the manifest.

        Raises:
            FileAccessError: The system refuses to write them.
        """
        make_folder(self.folder)
        with filling(self.place(part)) as folder:
            for name, columns in outcome.tables.items():
                write_parquet(folder / f"{name}.parquet", columns)
            write_json(folder / MANIFEST, outcome.manifest)

    def get(self, part: Part) -> Tables:
        """Return the part's tables.

        Raises:
            OSError: The part is not finished.
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
        """Return how the part was made."""
        return json.loads((self.place(part) / MANIFEST).read_text(encoding="utf-8"))

    def sweep(self) -> None:
        """Remove what killed runs left behind."""
        sweep(self.folder)


def _columns(table: Any) -> Any:
    return zip(table.column_names, table.columns, strict=True)
