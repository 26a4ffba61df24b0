"""Small pictures as PNG: the same pixels again, and nothing else is read."""

import io
import zlib

import numpy as np
import pytest
from PIL import Image

from apd_viewer.files.picture_files import png_content, read_png


@pytest.fixture
def pixels():
    return np.random.default_rng(0).integers(0, 256, (30, 60, 4), dtype=np.uint8)


def test_png_content_brings_the_same_pixels_back_and_gives_the_same_bytes(pixels):
    content = png_content(pixels)
    assert content == png_content(pixels.copy())
    np.testing.assert_array_equal(read_png(content, 60), pixels)


def test_read_png_makes_a_picture_smaller_but_not_larger(pixels):
    assert read_png(png_content(pixels), 20).shape == (10, 20, 4)
    assert read_png(png_content(pixels), 200).shape == (30, 60, 4)


def test_read_png_refuses_what_is_no_small_picture(pixels):
    content, other = png_content(pixels), io.BytesIO()
    Image.fromarray(pixels[..., :3]).save(other, "GIF")
    large = png_content(np.zeros((1, 1025, 4), dtype=np.uint8))
    for bad in (b"", b"nonsense", content[:200], other.getvalue(), large):
        with pytest.raises(ValueError, match="its picture is damaged"):
            read_png(bad, 64)


@pytest.mark.parametrize("side", [10_000, 50_000])
def test_read_png_refuses_without_a_warning_a_picture_that_only_says_that_it_is_huge(side, pixels):
    content = bytearray(png_content(pixels))
    content[16:24] = 2 * side.to_bytes(4, "big")
    content[29:33] = zlib.crc32(content[12:29]).to_bytes(4, "big")
    with pytest.raises(ValueError, match="its picture is damaged"):
        read_png(bytes(content), 64)
