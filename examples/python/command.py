"""What all examples' commands share: their options, and how they tell their figures."""

import argparse
import json
from pathlib import Path


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
