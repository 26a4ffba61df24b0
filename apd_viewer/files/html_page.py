"""Self-contained HTML page: tables, pictures, light and dark, print.

It names nothing outside itself: pictures are in it as PNG or SVG, files as links that hold them.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, TypeAlias

from apd_viewer.files.storage.atomic_file import replacing
from apd_viewer.language import LANGUAGE

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True)
class Table:
    """Rows of name, value and remark in smaller letters."""

    rows: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Note:
    """A paragraph, emphasised if it ``warns``."""

    text: str
    warns: bool = False


@dataclass(frozen=True)
class Command:
    """Command line to type."""

    text: str


@dataclass(frozen=True, eq=False)
class Picture:
    """PNG picture with a caption."""

    png: bytes
    caption: str


@dataclass(frozen=True)
class Pictures:
    """Pictures side by side, with an SVG legend below."""

    pictures: tuple[Picture, ...]
    legend: str = ""


@dataclass(frozen=True)
class Drawing:
    """An SVG drawing for light paper, and the same for dark."""

    light: str
    dark: str
    caption: str


@dataclass(frozen=True, eq=False)
class Attached:
    """File embedded in the page for download."""

    name: str
    content: bytes
    text: str


Block: TypeAlias = Table | Note | Command | Pictures | Drawing | Attached


@dataclass(frozen=True)
class Part:
    """Some blocks under a heading; a ``wide`` one stands in no column."""

    heading: str
    blocks: tuple[Block, ...]
    wide: bool = False


@dataclass(frozen=True)
class Page:
    """Page with one leading reading, the ``hero``."""

    title: str
    subtitle: str
    hero: tuple[str, str]
    parts: tuple[Part, ...]
    foot: str = ""


def write_page(path: Path, page: Page) -> None:
    """Write a page to a file, whole or not at all; raises InputError."""
    with replacing(path) as scratch:
        # What no encoding knows, such as half of a character in the name of a file, is a question mark.
        scratch.write_text(html_of(page), encoding="utf-8", errors="replace", newline="\n")


def html_of(page: Page) -> str:
    """The page as HTML."""
    parts = "\n".join(_part(part) for part in page.parts)
    return _PAGE.format(
        language=escape(LANGUAGE.replace("_", "-")),
        title=escape(page.title),
        subtitle=escape(page.subtitle),
        style=_STYLE,
        hero=escape(page.hero[0]),
        said=escape(page.hero[1]),
        parts=parts,
        foot=escape(page.foot),
    )


def _part(part: Part) -> str:
    blocks = "\n".join(_block(block) for block in part.blocks)
    kind = ' class="wide"' if part.wide else ""
    return f"<section{kind}>\n<h2>{escape(part.heading)}</h2>\n{blocks}\n</section>"


def _block(block: Block) -> str:
    if isinstance(block, Table):
        return "<table>\n" + "\n".join(_row(*row) for row in block.rows) + "\n</table>"
    if isinstance(block, Note):
        return f'<p class="{"warns" if block.warns else "note"}">{escape(block.text)}</p>'
    if isinstance(block, Command):
        return f"<pre><code>{escape(block.text)}</code></pre>"
    if isinstance(block, Pictures):
        legend = f'\n<div class="legend">{block.legend}</div>' if block.legend else ""
        return '<div class="pictures">\n' + "\n".join(map(_picture, block.pictures)) + "\n</div>" + legend
    if isinstance(block, Drawing):
        both = f'<div class="on-light">{block.light}</div><div class="on-dark">{block.dark}</div>'
        return f"<figure>{both}<figcaption>{escape(block.caption)}</figcaption></figure>"
    held = _held(block.content, "application/octet-stream")
    link = f'<a download="{escape(block.name)}" href="{held}">{escape(block.name)}</a>'
    return f"<p>{link} <small>{escape(block.text)}</small></p>"


def _row(name: str, value: str, more: str) -> str:
    small = f" <small>{escape(more)}</small>" if more else ""
    return f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}{small}</td></tr>'


def _picture(picture: Picture) -> str:
    caption, held = escape(picture.caption), _held(picture.png, "image/png")
    image = f'<img alt="{caption}" src="{held}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _held(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


_PAGE = """<!DOCTYPE html>
<html lang="{language}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
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
</body>
</html>
"""

_STYLE = """:root {
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
@media print {
  @page { margin: 14mm; }
  body { padding: 0; max-width: none; font-size: 10pt; }
  section, figure, tr { break-inside: avoid; }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
"""
