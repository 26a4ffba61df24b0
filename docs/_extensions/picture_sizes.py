"""Sphinx extension: pictures are shown at half of their pixels, as they are drawn at scale 2.

They keep their colours in the dark scheme, where the theme would dim them, and are loaded when they come
near.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from docutils import nodes
from PIL import Image

SCALE = 2
FILMS = 1  # films have as many pixels as they are shown at


def setup(app: Any) -> dict[str, bool]:
    """Look at the pictures of each page once it is read."""
    app.connect("doctree-read", lambda app, tree: _size(tree, Path(app.srcdir)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _size(tree: nodes.document, docs: Path) -> None:
    for node in tree.findall(nodes.image):
        path = docs / node["uri"]
        if path.parent.name != "pictures" or not path.is_file():
            continue
        node["classes"] += [name for name in ("dark-light", "picture") if name not in node["classes"]]
        node["loading"] = "lazy"
        if "width" not in node:
            node["width"] = f"{shown_width(path)}px"


def shown_width(path: Path) -> int:
    """Width of a picture on a page, in its own pixels."""
    with Image.open(path) as image:
        return image.width // (FILMS if getattr(image, "is_animated", False) else SCALE)
