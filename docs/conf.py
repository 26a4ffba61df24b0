"""Settings of the site; ``make docs`` builds it."""

import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))
os.environ["APD_VIEWER_LANGUAGE"] = "en"

import apd_viewer

project = "APD Viewer"
version = release = apd_viewer.__version__
html_show_copyright = False
extensions = [
    "sphinx.ext.autodoc",
    "numpydoc",
    "myst_parser",
    "sphinx_design",
    "generated_pages",
    "mathml",
    "picture_sizes",
    "film_player",
]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_extensions", "pictures", "gallery"]
nitpicky = True
smartquotes = False  # they would make one dash of the two of an option

myst_enable_extensions = ["attrs_inline", "colon_fence", "dollarmath"]
myst_heading_anchors = 4

autodoc_typehints = "none"  # the sections Parameters and Returns have them
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
autosummary_generate = False

html_theme = "pydata_sphinx_theme"
html_title = "APD Viewer"
html_logo = "../resources/icons/apd-viewer.svg"
html_favicon = html_logo
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {
    page: [] for page in ("index", "tutorial", "gallery", "methods", "results")
}  # without pages below
html_theme_options = {
    "show_prev_next": False,
    "navbar_end": ["theme-switcher"],
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["sphinx-version"],
    "footer_end": [],
}
