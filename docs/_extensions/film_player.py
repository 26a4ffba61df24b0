"""Sphinx extension: a picture of the class ``film`` plays the film beside it, a WebM file of the same name.

Without a player, as on GitHub, it is the picture alone.
"""

from __future__ import annotations

import posixpath
from html import escape
from pathlib import PurePosixPath
from typing import Any
from urllib.parse import quote

from docutils import nodes


class film(nodes.image):  # noqa: N801
    """A picture with the file of a film."""


def setup(app: Any) -> dict[str, bool]:
    """Find films once pictures have been collected and sized, and write players for them."""
    app.add_node(film, html=(_write_player, None))
    app.connect("doctree-read", _find_films, priority=900)
    app.connect("doctree-resolved", _take_along)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _find_films(app: Any, tree: nodes.document) -> None:
    for node in list(tree.findall(nodes.image)):
        if "film" in node["classes"]:
            video = str(PurePosixPath(node["uri"]).with_suffix(".webm"))
            app.env.note_dependency(video)
            app.env.images.add_file(app.env.docname, video)
            node.replace_self(film("", video=video, **node.attributes))


def _take_along(app: Any, tree: nodes.document, _docname: str) -> None:
    """Copy films as pictures are copied."""
    for node in tree.findall(film):
        app.builder.images[node["video"]] = app.env.images[node["video"]][1]


def _write_player(writer: Any, node: film) -> None:
    images, folder = writer.builder.images, writer.builder.imgpath
    picture, video = (posixpath.join(folder, quote(images[node[name]])) for name in ("uri", "video"))
    writer.body.append(
        f'<video class="film" controls playsinline preload="none" poster="{picture}" src="{video}" '
        f'aria-label="{escape(node["alt"])}"><a href="{video}">{escape(node["alt"])}</a></video>'
    )
    raise nodes.SkipNode
