"""What all examples' commands share: options, how they tell their figures, and what they say if a package is missing."""

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
"""What to install for the modules that voxshell does without."""


def tell_missing(kind, error, trace):
    """Ends the program in one line if a package is missing; it is Python's hook for errors."""
    name = (getattr(error, "name", None) or "").partition(".")[0]
    if isinstance(error, ModuleNotFoundError) and name in PACKAGES:
        print(f"this example needs {name}: pip install {PACKAGES[name]}", file=sys.stderr)
    elif isinstance(error, vx.MissingExtraError):
        print(error, file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


sys.excepthook = tell_missing


def parse_command(text, **more):
    """Reads `--out DIR` and `--quick`, and an option for each of ``more`` with its default."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=Path("build/examples"), help="folder for results"
    )
    parser.add_argument("--quick", action="store_true", help="a form that takes seconds")
    for name, default in more.items():
        parser.add_argument(f"--{name}", default=default, help=f"default: {default}")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    return options


def tell(out, figures):
    """Prints figures, with their units in their names, and writes them to figures.json."""
    for name, value in figures.items():
        shown = f"{value:.4g}" if isinstance(value, float) else value
        print(f"{name.replace('_', ' ')}: {shown}")
    (out / "figures.json").write_text(json.dumps(figures, indent=1))
