"""Finished parts on the disk: a folder each, there whole or not at all."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.errors import MissingExtraError
from voxshell.experiments.files import write_json

if TYPE_CHECKING:
    from voxshell.experiments.part import Outcome, Part, Tables

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
        """Writes each table as Parquet, and the manifest."""
        pyarrow, parquet = _import_pyarrow()
        self.folder.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=self.folder, prefix=".unfinished-"))
        try:
            for name, columns in outcome.tables.items():
                parquet.write_table(
                    pyarrow.table({key: pyarrow.array(v) for key, v in columns.items()}),
                    temporary / f"{name}.parquet",
                )
            write_json(temporary / MANIFEST, outcome.manifest)
            temporary.chmod(0o755)
            if not self.has(part):
                temporary.rename(self.place(part))
        finally:
            shutil.rmtree(temporary, ignore_errors=True)

    def get(self, part: Part) -> Tables:
        """The part's tables.

        Raises:
            OSError: It is not done.
        """
        _, parquet = _import_pyarrow()
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
        """Removes what killed runs left unfinished. Nobody else may be writing."""
        for path in self.folder.glob(".unfinished-*"):
            shutil.rmtree(path, ignore_errors=True)


def _columns(table: Any) -> Any:
    return zip(table.column_names, table.columns, strict=True)


def _import_pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise MissingExtraError(
            "experiments keep their data as Parquet: pip install voxshell[experiments]"
        ) from error
    # Threads of its own would run beside what is timed.
    pyarrow.set_cpu_count(1)
    pyarrow.set_io_thread_count(1)
    return pyarrow, pyarrow.parquet
