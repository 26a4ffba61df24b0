"""Self-contained HTML page with tables and pictures, for light, dark and print.

It refers to no other files: pictures are embedded as PNG or SVG, files as data links.
"""

import base64
import hashlib
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TypeAlias

from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.language import LANGUAGE

GridCell: TypeAlias = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class PageTable:
    """Table of rows with a name, a value and a remark in small print."""

    rows: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class PageGrid:
    """Table with column headings; the first column holds the row names.

    A cell consists of lines, each with a remark in small print.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[GridCell, ...], ...]


@dataclass(frozen=True)
class PageNote:
    """Paragraph, emphasised if ``is_warning``."""

    text: str
    is_warning: bool = False


@dataclass(frozen=True)
class PageCommand:
    """Command line for the user to run."""

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
    """SVG drawing in a light and a dark version."""

    light: str
    dark: str
    caption: str


@dataclass(frozen=True, eq=False)
class PageAttachment:
    """File embedded in the page for download."""

    name: str
    content: bytes
    text: str


@dataclass(frozen=True)
class PageView:
    """Part of a page with a style and a script of its own; both are there once.

    Attributes
    ----------
    html, style : str
        Well-formed HTML, and CSS.
    script : str
        ES module, the only one that the page may run.
    """

    html: str
    style: str
    script: str


PageBlock: TypeAlias = (
    PageTable | PageGrid | PageNote | PageCommand | PagePictureRow | PageDrawing | PageAttachment | PageView
)


@dataclass(frozen=True)
class PageSection:
    """Blocks under a heading; spans all columns if ``is_wide``."""

    heading: str
    blocks: tuple[PageBlock, ...]
    is_wide: bool = False


@dataclass(frozen=True)
class Page:
    """Page with a headline value, the ``hero``."""

    title: str
    subtitle: str
    hero: tuple[str, str]
    sections: tuple[PageSection, ...]
    footer: str = ""


def write_page(path: Path, page: Page) -> None:
    """Write a page to a file atomically; raises InputError."""
    with replacing_file(path) as scratch:
        # Unencodable characters, such as lone surrogates in file names, become question marks.
        scratch.write_text(page_html(page), encoding="utf-8", errors="replace", newline="\n")


def page_html(page: Page) -> str:
    """HTML text of a page."""
    parts = "\n".join(_section(part) for part in page.sections)
    blocks = (block for section in page.sections for block in section.blocks)
    view = next((block for block in blocks if isinstance(block, PageView)), None)
    allowed, element = ("", "") if view is None else _inline_script(view.script)
    return PAGE.format(
        allowed=allowed,
        script=element,
        language=escape(LANGUAGE.replace("_", "-")),
        title=escape(page.title),
        subtitle=escape(page.subtitle),
        style=STYLE if view is None else STYLE + view.style,
        hero=escape(page.hero[0]),
        said=escape(page.hero[1]),
        parts=parts,
        foot=escape(page.footer),
    )


def _inline_script(script: str) -> tuple[str, str]:
    """Source for the policy of a page that allows this script alone, and its element."""
    if "</script" in script.lower():
        raise ValueError("the script ends its own element")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return f"; script-src 'sha256-{digest}'", f'<script type="module">{script}</script>\n'


def _section(section: PageSection) -> str:
    blocks = "\n".join(block_html(block) for block in section.blocks)
    kind = ' class="wide"' if section.is_wide else ""
    return f"<section{kind}>\n<h2>{escape(section.heading)}</h2>\n{blocks}\n</section>"


def block_html(block: PageBlock) -> str:
    """HTML text of a block."""
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
    if isinstance(block, PageView):
        return block.html
    held = _data_uri(block.content, "application/octet-stream")
    link = f'<a download="{escape(block.name)}" href="{held}">{escape(block.name)}</a>'
    return f"<p>{link} <small>{escape(block.text)}</small></p>"


def _grid_row(head: tuple[str, ...], row: tuple[GridCell, ...]) -> str:
    first, *others = row
    cells = [f'<th scope="row">{_lines(first)}</th>']
    for name, cell in zip(head[1:], others, strict=True):
        cells.append(f'<td data-head="{escape(name)}">{_lines(cell)}</td>')
    return f"<tr>{''.join(cells)}</tr>"


def _lines(cell: GridCell) -> str:
    """HTML of the lines of a cell, each a text with a remark."""
    return "".join(f"<div>{_with_remark(*line)}</div>" for line in cell)


def _with_remark(text: str, more: str) -> str:
    return escape(text) + (f" <small>{escape(more)}</small>" if more else "")


def _row(name: str, value: str, more: str) -> str:
    return f'<tr><th scope="row">{escape(name)}</th><td>{_with_remark(value, more)}</td></tr>'


def _picture(picture: PagePicture) -> str:
    caption, held = escape(picture.caption), _data_uri(picture.png, "image/png")
    image = f'<img alt="{caption}" src="{held}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


PAGE = """<!DOCTYPE html>
<html lang="{language}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; img-src data:; style-src 'unsafe-inline'{allowed}">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<header>
<div><h1>{title}</h1><p>{subtitle}</p></div>
<div class="hero"><strong>{hero}</strong><span>{said}</span></div>
</header>
<main>
{parts}
</main>
<footer>{foot}</footer>
{script}</body>
</html>
"""


STYLE = """:root {
  color-scheme: light dark;
  --paper: #ffffff; --field: #f4f5f8; --line: #dcdfe4; --ink: #1d2129; --quiet: #5a6270; --accent: #2f6fde;
  --warm: #b45309; --warm-soft: #fdf0df;
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --paper: #1c1f25; --field: #262a31; --line: #3a3f49; --ink: #eceef2; --quiet: #a6adba; --accent: #6ea2ff;
    --warm: #f5a54a; --warm-soft: #40311d;
  }
  .on-light { display: none; }
  .on-dark { display: block !important; }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 40px 32px; max-width: 1080px; background: var(--paper); color: var(--ink);
  font: 14px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", Helvetica, Arial, sans-serif;
  font-variant-numeric: tabular-nums; overflow-wrap: break-word;
}
header { display: flex; justify-content: space-between; align-items: end; gap: 16px 32px; flex-wrap: wrap; }
header > div { min-width: 0; }
h1 { margin: 0; font-size: 26px; line-height: 1.25; font-weight: 650; }
header p { margin: 4px 0 0; color: var(--quiet); }
.hero { text-align: right; }
.hero strong { display: block; font-size: 34px; line-height: 1.1; font-weight: 650; }
.hero span, small, figcaption, .note, footer { color: var(--quiet); }
main { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 40px; margin-top: 24px; }
section { border-top: 1px solid var(--line); padding: 16px 0 20px; }
.wide { grid-column: 1 / -1; }
h2 { margin: 0 0 8px; font-size: 15px; font-weight: 650; }
p { margin: 0 0 8px; }
table { border-collapse: collapse; table-layout: fixed; width: 100%; max-width: 520px; }
th { width: 42%; text-align: left; font-weight: 400; color: var(--quiet); }
th, td { padding: 3px 0; vertical-align: top; overflow-wrap: anywhere; }
th { padding-right: 12px; }
small { font-size: 12.5px; }
td small { display: block; }
.grid { max-width: none; table-layout: auto; }
.grid th, .grid td { width: auto; padding: 5px 14px 5px 0; border-top: 1px solid var(--line); }
.grid thead th { border-top: none; font-size: 12.5px; }
.grid tbody th { width: 19%; color: var(--ink); }
.grid td:last-child { width: 36%; padding-right: 0; }
.grid thead th, .grid td:nth-child(4) { white-space: nowrap; }
.grid small { display: block; font-weight: 400; }
.grid div + div { margin-top: 4px; }
.warns { padding: 8px 12px; border-radius: 6px; background: var(--warm-soft); color: var(--warm); }
pre { margin: 0 0 8px; padding: 8px 12px; border-radius: 6px; background: var(--field); }
pre { white-space: pre-wrap; }
code { font: 13px/1.5 ui-monospace, "Cascadia Mono", Menlo, Consolas, monospace; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(240px, 1fr)); gap: 16px; }
figure { margin: 0; }
.pictures figure { padding: 8px; border-radius: 8px; background: var(--field); }
img, svg { display: block; width: 100%; height: auto; }
figcaption { padding-top: 6px; font-size: 12.5px; }
.pictures figcaption { padding: 6px 4px 2px; }
figure + table { margin-top: 12px; }
.legend { max-width: 272px; margin: 8px 0 0 auto; }
.on-dark { display: none; }
a { color: var(--accent); }
footer { border-top: 1px solid var(--line); padding-top: 12px; font-size: 12.5px; }
@media screen and (max-width: 720px) { main { display: block; } .hero { text-align: left; } }
@media screen and (max-width: 720px) {
  .grid thead { display: none; }
  .grid tbody th, .grid td, .grid td:last-child { display: block; width: auto; padding: 2px 0; border: none; }
  .grid tbody th { padding-top: 8px; border-top: 1px solid var(--line); font-weight: 650; }
  .grid td, .grid td:last-child { display: grid; grid-template-columns: 9em minmax(0, 1fr); }
  .grid td:empty { display: none; }
  .grid td > div { grid-column: 2; }
  .grid td::before { content: attr(data-head); grid-column: 1; grid-row: 1; color: var(--quiet); }
}
@media print {
  @page { margin: 14mm; }
  body { padding: 0; max-width: none; font-size: 10pt; }
  section, figure, tr { break-inside: avoid; }
  section:has(.grid) { break-inside: auto; }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
"""
