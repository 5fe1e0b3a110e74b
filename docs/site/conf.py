"""Configuration of Sphinx for the pages that stage.py writes; tools/docs runs both."""

import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["RAYSHEAF_DOCS"])
sys.path.insert(0, str(ROOT / "python"))

project = "raysheaf"
release = re.search(r"project\(raysheaf VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[
    1
]
version = release
copyright = "the raysheaf developers"

extensions = [
    "myst_parser",
    "breathe",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
]
myst_heading_anchors = 6
myst_enable_extensions = ["colon_fence"]
default_role = "py:obj"
highlight_language = "text"
nitpicky = False

# The extension need not be built, because the documented interface is written in Python.
autodoc_mock_imports = ["raysheaf._core", "mujoco", "trimesh"]
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
autodoc_typehints_format = "short"
autodoc_type_aliases = {
    "NDArray": "NDArray",
    "ArrayLike": "ArrayLike",
    "Floats": "Floats",
    "Ints": "Ints",
}
autodoc_preserve_defaults = True
napoleon_use_rtype = False
napoleon_use_param = False  # types are words, not links
python_use_unqualified_type_names = True

breathe_projects = {"raysheaf": str(BUILD / "cpp" / "xml")}
breathe_default_project = "raysheaf"
breathe_default_members = ("members",)
suppress_warnings = ["duplicate_declaration.cpp"]  # the namespace is declared in every header
cpp_index_common_prefix = ["raysheaf::"]

copybutton_prompt_text = r">>> |\.\.\. "
copybutton_prompt_is_regexp = True

html_theme = "furo"
html_title = f"raysheaf {release}"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}


def plain_names(app, what, name, obj, options, signature, returned):
    """Replaces autodoc's internal form of type aliases by their names."""
    plain = [
        s and re.sub(r"TypeAliasForwardRef\('(\w+)'\)", r"\1", s) for s in (signature, returned)
    ]
    return tuple(plain)


def setup(app):
    app.connect("autodoc-process-signature", plain_names)
