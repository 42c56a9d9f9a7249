"""Files of results: each is written completely or not at all."""

from __future__ import annotations

import csv
import io
import json
import math
from typing import TYPE_CHECKING, Any

from voxshell.base.extras import explain_import
from voxshell.base.outputs import write_bytes, write_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path


def write_json(path: Path, value: Any) -> None:
    """Write JSON; numbers that are not finite become null."""
    write_text(path, json.dumps(finite(value), indent=2, allow_nan=False) + "\n")


def write_csv(path: Path, heading: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Write a table as CSV."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(heading)
    writer.writerows(rows)
    write_text(path, text.getvalue())


def write_parquet(path: Path, columns: Mapping[str, Any]) -> None:
    """Write a table as Parquet.

    Raises:
        MissingExtraError: pyarrow is not installed.
    """
    pyarrow, parquet = import_pyarrow()
    content = pyarrow.BufferOutputStream()
    arrays = {name: pyarrow.array(column) for name, column in columns.items()}
    parquet.write_table(pyarrow.table(arrays), content)
    write_bytes(path, memoryview(content.getvalue()))


def write_figure(path: Path, figure: Any) -> None:
    """Write a matplotlib figure as PNG."""
    content = io.BytesIO()
    # Without matplotlib's version, equal data gives equal bytes everywhere.
    figure.savefig(content, format="png", metadata={"Software": None})
    write_bytes(path, content.getbuffer())


def import_pyarrow() -> tuple[Any, Any]:
    """Return pyarrow and its Parquet module.

    Raises:
        MissingExtraError: pyarrow is not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise explain_import(
            error, "Parquet files need pyarrow: pip install voxshell[report]"
        ) from error
    # pyarrow's own threads would disturb timed code.
    pyarrow.set_cpu_count(1)
    pyarrow.set_io_thread_count(1)
    return pyarrow, pyarrow.parquet


def finite(value: Any) -> Any:
    """Replace numbers that JSON does not support by None."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return value
