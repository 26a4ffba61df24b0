"""The tool that looks at the pages of the site sees what is wrong with them."""

import subprocess
import sys
from pathlib import Path

import pytest
from site_pages import browser, looked_at

pytestmark = pytest.mark.night  # tools of the tests and the site

DOCS = Path(__file__).parents[1] / "docs"
PAGE = "<!doctype html><body style='margin: 0; background: white'><main>{}</main></body>"


needs_browser = pytest.mark.skipif(
    browser() is None, reason="Ubuntu has Chromium as a snap only, other systems by hand"
)


@needs_browser
def test_site_pages_names_wide_pages_broken_pictures_and_pale_text(tmp_path):
    for name, inside in {
        "good": "<p style='color: #333'>legible</p>",
        "wide": "<div style='width: 500px; color: #333'>wide</div>",
        "broken": "<img src='gone.png' alt=''>",
        "pale": "<p style='color: #aaa'>pale</p>",
    }.items():
        (tmp_path / f"{name}.html").write_text(PAGE.format(inside), encoding="utf-8")
    found = looked_at(tmp_path)
    assert [line.split(":")[0] for line in found] == [
        "broken.html",
        "pale.html, light",
        "pale.html, dark",
        "wide.html",
        "wide.html",
    ]
    assert found[3] == "wide.html: 500 wide at 390, light"


@pytest.mark.night
@needs_browser
def test_site_pages_all_fit(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-q", "-d", str(tmp_path / "trees")]
    subprocess.run([*command, str(DOCS), str(tmp_path / "site")], cwd=DOCS.parent, check=True)
    assert looked_at(tmp_path / "site") == []
