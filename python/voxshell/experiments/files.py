"""Results as JSON."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from voxshell._outputs import replacing

if TYPE_CHECKING:
    from pathlib import Path


def write_json(path: Path, value: Any) -> None:
    """Writes JSON, whole or not at all; numbers that are not finite become null."""
    with replacing(path) as temporary:
        text = json.dumps(finite(value), indent=2, allow_nan=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def finite(value: Any) -> Any:
    """The same, with None for numbers that JSON does not have."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return value
