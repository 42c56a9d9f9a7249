from __future__ import annotations

import pytest
import voxshell as vx
from voxshell.base.extras import explain_import


def raise_from(cause: BaseException) -> ImportError:
    error = ImportError("viser cannot be imported")
    error.__cause__ = cause
    return error


@pytest.mark.parametrize(
    ("error", "kind", "message"),
    [
        (ImportError("No module named 'viser'"), vx.MissingExtraError, "pip install"),
        (raise_from(ValueError("a bug")), vx.MissingExtraError, "pip install"),
        (
            ImportError("a.so: failed to map segment from shared object"),
            vx.MemoryLimitError,
            "a.so",
        ),
        (raise_from(MemoryError()), vx.MemoryLimitError, "no memory left to import a library"),
        (
            raise_from(OSError("[Errno 12] Cannot allocate memory")),
            vx.MemoryLimitError,
            "viser cannot be imported",
        ),
    ],
)
def test_a_library_is_not_installed_or_finds_no_memory(
    error: ImportError, kind: type[vx.VoxshellError], message: str
):
    explained = explain_import(error, "pip install viser")
    assert type(explained) is kind
    assert message in str(explained)
