"""How Sphinx makes the site: `./dev docs`."""

import sys
from importlib.metadata import version as installed_version
from pathlib import Path

from voxshell.base.near_names import Absent

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))

project = "voxshell"
author = "voxshell contributors"
copyright = "voxshell contributors"
version = release = installed_version("voxshell")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "matplotlib.sphinxext.plot_directive",
    "cpp_headers",
    "gallery",
    "mathml",
]
exclude_patterns = ["_ext", "_static", "figures", "pictures"]
html_theme = "furo"
html_title = f"voxshell {version}"
html_static_path = ["_static", "pictures"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
# No page asks another server for anything.
html_math_renderer = "mathml"

# Links to headings work on the repository's pages, too.
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
# Texts of attributes give shapes and types; an annotation such as np.bool_ would read as a link.
napoleon_attr_annotations = False


def hide_made_elsewhere(app, what, name, obj, options, signature, annotation):
    """Classes that only the library makes are shown without what it makes them of."""
    inside = signature and signature.startswith(("(core:", "(simulation:", "(world:"))
    return ("", annotation) if what == "class" and inside else None


def skip_absent(app, what, name, member, skip, options):
    """Leave out names that a class does not have and whose use explains itself."""
    return True if isinstance(member, Absent) else None


def setup(app):
    app.connect("autodoc-process-signature", hide_made_elsewhere)
    app.connect("autodoc-skip-member", skip_absent)


plot_formats = [("png", 160)]
plot_html_show_formats = False
plot_html_show_source_link = False
plot_rcparams = {
    "figure.figsize": (8.0, 3.6),
    "figure.constrained_layout.use": True,
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
}
plot_apply_rcparams = True
