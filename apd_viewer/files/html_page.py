"""Self-contained HTML page: tables, pictures, light and dark, print.

It names nothing outside itself: pictures are in it as PNG or SVG, files as links that hold them.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TypeAlias

from apd_viewer.files.html_template import PAGE, STYLE
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.language import LANGUAGE

GridCell: TypeAlias = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class PageTable:
    """Rows of name, value and remark in smaller letters."""

    rows: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class PageGrid:
    """Table with a heading over each column, the first of which names the rows.

    A cell is some lines, each with a remark in smaller letters.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[GridCell, ...], ...]


@dataclass(frozen=True)
class PageNote:
    """A paragraph, emphasised if it ``is_warning``."""

    text: str
    is_warning: bool = False


@dataclass(frozen=True)
class PageCommand:
    """Command line to type."""

    text: str


@dataclass(frozen=True, eq=False)
class PagePicture:
    """PNG picture with a caption."""

    png: bytes
    caption: str


@dataclass(frozen=True)
class PagePictureRow:
    """Pictures side by side, with an SVG legend below."""

    pictures: tuple[PagePicture, ...]
    legend: str = ""


@dataclass(frozen=True)
class PageDrawing:
    """An SVG drawing for light paper, and the same for dark."""

    light: str
    dark: str
    caption: str


@dataclass(frozen=True, eq=False)
class PageAttachment:
    """File embedded in the page for download."""

    name: str
    content: bytes
    text: str


PageBlock: TypeAlias = (
    PageTable | PageGrid | PageNote | PageCommand | PagePictureRow | PageDrawing | PageAttachment
)


@dataclass(frozen=True)
class PageSection:
    """Some blocks under a heading; a ``is_wide`` one stands in no column."""

    heading: str
    blocks: tuple[PageBlock, ...]
    is_wide: bool = False


@dataclass(frozen=True)
class Page:
    """Page with one leading reading, the ``hero``."""

    title: str
    subtitle: str
    hero: tuple[str, str]
    sections: tuple[PageSection, ...]
    footer: str = ""


def write_page(path: Path, page: Page) -> None:
    """Write a page to a file, whole or not at all; raises InputError."""
    with replacing_file(path) as scratch:
        # Characters without an encoding, such as lone surrogates in file names, become question marks.
        scratch.write_text(page_html(page), encoding="utf-8", errors="replace", newline="\n")


def page_html(page: Page) -> str:
    """The page as HTML."""
    parts = "\n".join(_section(part) for part in page.sections)
    return PAGE.format(
        language=escape(LANGUAGE.replace("_", "-")),
        title=escape(page.title),
        subtitle=escape(page.subtitle),
        style=STYLE,
        hero=escape(page.hero[0]),
        said=escape(page.hero[1]),
        parts=parts,
        foot=escape(page.footer),
    )


def _section(section: PageSection) -> str:
    blocks = "\n".join(_block(block) for block in section.blocks)
    kind = ' class="wide"' if section.is_wide else ""
    return f"<section{kind}>\n<h2>{escape(section.heading)}</h2>\n{blocks}\n</section>"


def _block(block: PageBlock) -> str:
    if isinstance(block, PageTable):
        return "<table>\n" + "\n".join(_row(*row) for row in block.rows) + "\n</table>"
    if isinstance(block, PageGrid):
        head = "".join(f'<th scope="col">{escape(name)}</th>' for name in block.head)
        rows = "\n".join(_grid_row(block.head, row) for row in block.rows)
        return f'<table class="grid">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>'
    if isinstance(block, PageNote):
        return f'<p class="{"warns" if block.is_warning else "note"}">{escape(block.text)}</p>'
    if isinstance(block, PageCommand):
        return f"<pre><code>{escape(block.text)}</code></pre>"
    if isinstance(block, PagePictureRow):
        legend = f'\n<div class="legend">{block.legend}</div>' if block.legend else ""
        return '<div class="pictures">\n' + "\n".join(map(_picture, block.pictures)) + "\n</div>" + legend
    if isinstance(block, PageDrawing):
        both = f'<div class="on-light">{block.light}</div><div class="on-dark">{block.dark}</div>'
        return f"<figure>{both}<figcaption>{escape(block.caption)}</figcaption></figure>"
    held = _held(block.content, "application/octet-stream")
    link = f'<a download="{escape(block.name)}" href="{held}">{escape(block.name)}</a>'
    return f"<p>{link} <small>{escape(block.text)}</small></p>"


def _grid_row(head: tuple[str, ...], row: tuple[GridCell, ...]) -> str:
    first, *others = row
    cells = [f'<th scope="row">{_lines(first)}</th>']
    for name, cell in zip(head[1:], others, strict=True):
        cells.append(f'<td data-head="{escape(name)}">{_lines(cell)}</td>')
    return f"<tr>{''.join(cells)}</tr>"


def _lines(cell: GridCell) -> str:
    """Lines of a cell, each a text with a remark."""
    return "".join(f"<div>{_remarked(*line)}</div>" for line in cell)


def _remarked(text: str, more: str) -> str:
    return escape(text) + (f" <small>{escape(more)}</small>" if more else "")


def _row(name: str, value: str, more: str) -> str:
    return f'<tr><th scope="row">{escape(name)}</th><td>{_remarked(value, more)}</td></tr>'


def _picture(picture: PagePicture) -> str:
    caption, held = escape(picture.caption), _held(picture.png, "image/png")
    image = f'<img alt="{caption}" src="{held}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _held(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"
