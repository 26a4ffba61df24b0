"""HTML frame and style sheet of a report page."""

from __future__ import annotations

PAGE = """<!DOCTYPE html>
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
