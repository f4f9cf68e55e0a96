"""The documentation site: `make docs` builds it without a warning."""

import sys
from importlib.metadata import version as installed
from pathlib import Path

from sphinx_gallery.sorting import FileNameSortKey

sys.path.insert(0, str(Path(__file__).parent / "_ext"))


class MeasuredFirst(FileNameSortKey):
    """Measured legs come first in the gallery, then all examples by number."""

    def __call__(self, filename: str) -> str:
        """What a file is sorted by."""
        return ("" if "measured" in filename else "z") + str(super().__call__(filename))


project = "surae"
author = "The surae developers"
copyright = "The surae developers"
release = installed("surae")
version = release

extensions = [
    "mathml",
    "reproduction_table",
    "tables",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "_build",
    "images",
    "reproduction-table.md",
    "how-to/mapping-table.md",
    "how-to/option-table.md",
    "how-to/quality-codes.md",
    "methods/constants-table.md",
    "methods/measure-table.md",
    "methods/source-table.md",
    "models/parameters-*.md",
]
root_doc = "index"

html_theme = "pydata_sphinx_theme"
html_title = f"surae {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_sidebars = {page: [] for page in ("index", "start", "reproduction", "glossary")}
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 8,
    "show_toc_level": 2,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
# Everything a reader's browser needs is in the site: it is read offline, beside patients' data.
html_math_renderer = "mathml"

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

default_role = "literal"  # `name` in a docstring
autosummary_generate = True
autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "default_thumb_file": str(Path(__file__).parent / "_static" / "thumbnail.svg"),
    "filename_pattern": r"/[0-9]+_",
    "within_subsection_order": MeasuredFirst,
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "write_computation_times": False,  # that page asks outside hosts for its table
    "min_reported_time": 1e9,
    "image_scrapers": ("matplotlib",),
    "remove_config_comments": True,
    "reset_modules": ("matplotlib",),
}
suppress_warnings = ["config.cache"]
