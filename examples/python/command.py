"""What the commands of all examples share: options, printed figures, and the message about a missing package."""

import argparse
import json
import sys
from pathlib import Path

import voxshell as vx

PACKAGES = {
    "PIL": "pillow",
    "distributed": "distributed",
    "manifold3d": "'voxshell[viewer]'",
    "matplotlib": "'voxshell[report]'",
}
"""What to install for each module that voxshell itself does not need."""


def tell_missing(kind, error, trace):
    """Prints one line if a package is missing, instead of a traceback; it is set as ``sys.excepthook``."""
    name = (getattr(error, "name", None) or "").partition(".")[0]
    if isinstance(error, ModuleNotFoundError) and name in PACKAGES:
        print(f"this example needs {name}: pip install {PACKAGES[name]}", file=sys.stderr)
    elif isinstance(error, vx.MissingExtraError):
        print(error, file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


sys.excepthook = tell_missing


def parse_command(text, **more):
    """Parses `--out DIR`, `--quick` and one option for each name in ``more``, with its default."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=Path("build/examples"), help="folder for results"
    )
    parser.add_argument("--quick", action="store_true", help="a smaller run, in seconds")
    for name, default in more.items():
        parser.add_argument(f"--{name}", default=default, help=f"default: {default}")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    return options


def tell(out, figures):
    """Prints the figures, whose names contain their units, and writes them to figures.json."""
    for name, value in figures.items():
        shown = f"{value:.4g}" if isinstance(value, float) else value
        print(f"{name.replace('_', ' ')}: {shown}")
    (out / "figures.json").write_text(json.dumps(figures, indent=1))
