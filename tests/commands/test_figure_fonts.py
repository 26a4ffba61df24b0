"""Fonts of figures: a second one for Chinese, if the system has any."""

import shutil
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib import font_manager

from apd_viewer.figures.fonts import font_families, font_file
from apd_viewer.figures.style import draw_figure


@pytest.fixture
def system(monkeypatch):
    """Sets the fonts of the system."""

    def fonts(*paths):
        monkeypatch.setattr(font_manager, "findSystemFonts", lambda: list(map(str, paths)))
        font_file.cache_clear()
        font_families.cache_clear()

    yield fonts
    font_file.cache_clear()
    font_families.cache_clear()


@pytest.fixture
def font(tmp_path):
    """A font of another family, by the name of one with Chinese letters."""
    own = Path(mpl.get_data_path()) / "fonts" / "ttf" / "DejaVuSerif.ttf"
    return Path(shutil.copy(own, tmp_path / "msyh.ttf"))


def test_font_families_are_the_same_everywhere_for_languages_in_latin_letters(system, font):
    system(font)
    for language in ("en", "de"):
        assert font_file(language) is None
        assert font_families(language) == ["DejaVu Sans"]


def test_font_families_of_chinese_take_what_is_missing_from_a_font_of_the_system(system, font):
    system(font.with_name("arial.ttf"), font)
    assert font_file("zh_CN") == font
    assert font_families("zh_CN") == ["DejaVu Sans", "DejaVu Serif"]


def test_font_file_is_the_best_of_several(system, font):
    best = Path(shutil.copy(font, font.with_name("NotoSansSC-Regular.otf")))
    system(font, best)
    assert font_file("zh_CN") == best


def test_font_families_of_chinese_are_those_of_all_on_a_system_without_chinese_fonts(system):
    system()
    assert font_file("zh_CN") is None
    assert font_families("zh_CN") == ["DejaVu Sans"]


@pytest.mark.parametrize("name", [r"$\frac{$", r"a $ \b $"])
def test_draw_figure_takes_a_name_with_dollars_for_no_formula(name, tmp_path):
    def fill(figure):
        figure.subplots().set_title(name)

    draw_figure(fill, (3.0, 2.0), tmp_path, "figure")
    assert (tmp_path / "figure.svg").stat().st_size > 1000
