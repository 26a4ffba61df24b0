"""Columns of a terminal: Chinese characters take two, and lines break between them."""

import os
import subprocess
import sys

import pytest
from hypothesis import given, strategies as st

from apd_viewer.commands.terminal.columns import column_count, padded_text, shortened_text, wrapped_lines
from apd_viewer.commands.volumes_command import volume_lines
from apd_viewer.presentation.volume_text import VolumeName, VolumeRow

TEXTS = st.text("a1 中文，。（）“”…", max_size=60)


@pytest.mark.parametrize(
    ("text", "columns"), [("", 0), ("area", 4), ("面积", 4), ("面积 1 %", 8), ("（ARAP）", 8), ("π × ³…", 6)]
)
def test_column_count_counts_two_for_a_wide_character(text, columns):
    assert column_count(text) == columns


@given(TEXTS, st.integers(0, 40))
def test_padded_text_ends_at_one_column(text, columns):
    assert column_count(padded_text(text, columns)) == max(columns, column_count(text))
    assert padded_text(text, columns).rstrip() == text.rstrip()


@given(TEXTS, st.integers(0, 40))
def test_shortened_text_fits_and_leaves_no_room(text, columns):
    begun = shortened_text(text, columns)
    assert text.startswith(begun)
    assert column_count(begun) <= columns
    assert begun == text or column_count(text[: len(begun) + 1]) > columns


@given(TEXTS, st.integers(2, 40))
def test_wrapped_lines_loses_nothing_but_spaces(text, columns):
    assert "".join("".join(wrapped_lines(text, columns)).split()) == "".join(text.split())


@given(st.text("中文字", min_size=1, max_size=60), st.integers(2, 40))
def test_wrapped_lines_fills_lines_of_wide_characters(text, columns):
    lines = wrapped_lines(text, columns)
    assert {column_count(line) for line in lines[:-1]} <= {columns - columns % 2}
    assert column_count(lines[-1]) <= columns


def test_wrapped_lines_begins_and_ends_no_line_with_the_wrong_sign():
    text = "移动控制区的 4x4 矩阵；每个控制区（重复一次）。“默认”：关闭，“另一个”"
    for columns in range(8, 40):
        for line in wrapped_lines(text, columns):
            assert line[0] not in "，。；：）”", (columns, line)
            assert line[-1] not in "（“", (columns, line)


def test_volumes_output_stands_below_each_other_whatever_the_names():
    readings = ("", ""), ("12 cm³", ""), "", ()
    rows = [
        VolumeRow(name, title, "", *readings)
        for name, title in zip(VolumeName, ("volume", "封闭体积", "45 l 袋中的物体数"), strict=False)
    ]
    _, *lines = volume_lines("bottle.obj", rows, False).splitlines()
    assert len({column_count(line) for line in lines}) == 1


@pytest.mark.parametrize("words", [pytest.param(["deform"], marks=pytest.mark.night), ["study", "design"]])
def test_parser_fits_chinese_help_into_the_terminal(words):
    environment = os.environ | {"APD_VIEWER_LANGUAGE": "zh_CN", "COLUMNS": "80", "PYTHONIOENCODING": "utf-8"}
    command = [sys.executable, "-m", "apd_viewer", *words, "--help"]
    done = subprocess.run(
        command, env=environment, capture_output=True, encoding="utf-8", check=True, timeout=60
    )
    lines = done.stdout.splitlines()
    assert any("控制区" in line for line in lines)
    assert [line for line in lines if column_count(line) > 80] == []
