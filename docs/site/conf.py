"""The documentation as a site: sphinx-build -c docs/site -b html . OUT, which `./puckloop docs` does.

The pages are those of the sources, read where they are, so that links between them and files beside them hold."""

import pathlib
import re

root = pathlib.Path(__file__).resolve().parents[2]
project = "puckloop"
version = release = re.search(r"^project\(puckloop VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
copyright = "the puckloop authors, MIT licence"

root_doc = "docs/site/index"
extensions = ["myst_parser"]
myst_heading_anchors = 4
exclude_patterns = ["build*", "out", "experiments", ".git", "**/node_modules", "**/__pycache__"]
html_theme = "sphinx_rtd_theme"
html_title = f"puckloop {version}"
html_theme_options = {"collapse_navigation": False, "navigation_depth": 2}
html_show_sphinx = False
html_copy_source = False


def lead_to_first_page(app, failed):
    """A folder is opened by its index.html."""
    if failed is None and app.builder.format == "html":
        (pathlib.Path(app.outdir) / "index.html").write_text(
            f'<!DOCTYPE html><meta charset="utf-8"><title>puckloop</title><meta http-equiv="refresh" content="0; url={root_doc}.html">\n'
            f'<a href="{root_doc}.html">puckloop</a>\n', encoding="utf-8")


def setup(app):
    app.connect("build-finished", lead_to_first_page)
