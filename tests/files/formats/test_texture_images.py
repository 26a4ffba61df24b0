"""Pictures of any usual kind are read upright with their opacity; large ones are scaled down."""

import numpy as np
import pytest
from PIL import Image

from apd_viewer.errors import InputError
from apd_viewer.files.formats.texture_images import read_picture

# Red, half transparent green over blue, and a hole; rows from top to bottom.
PIXELS = np.array([[[255, 0, 0, 255], [0, 255, 0, 128]], [[0, 0, 255, 255], [9, 9, 9, 0]]], dtype=np.uint8)
LARGE = PIXELS.repeat(16, axis=0).repeat(24, axis=1)


def quarters(found):
    """Colours in the middle of the quarters of a picture."""
    high, wide = found.shape[:2]
    return found[[high // 4, 3 * high // 4]][:, [wide // 4, 3 * wide // 4]].astype(int)


@pytest.mark.parametrize("suffix", ["png", "webp", "tif"])
def test_read_picture_keeps_colors_and_opacity(tmp_path, suffix):
    path = tmp_path / f"label.{suffix}"
    Image.fromarray(LARGE).save(path, **({"lossless": True, "exact": True} if suffix == "webp" else {}))
    np.testing.assert_array_equal(read_picture(path.read_bytes(), path.name), LARGE)


@pytest.mark.parametrize("mode", ["RGB", "CMYK", "L", "P", "LA", "1", "I;16"])
def test_read_picture_takes_every_color_space(tmp_path, mode):
    """Only the brightness survives in some; CMYK is what printers send."""
    light = Image.fromarray(np.array([[255, 255], [0, 0]], dtype=np.uint8).repeat(20, 0).repeat(20, 1))
    if mode == "I;16":
        light = Image.fromarray(np.asarray(light).astype(np.uint16) * 257)
    path = tmp_path / ("label.tif" if mode in ("CMYK", "I;16") else "label.png")
    (light if mode == "I;16" else light.convert(mode)).save(path)
    found = quarters(read_picture(path.read_bytes(), path.name))
    assert (found[0, :, :3] > 250).all()
    assert (found[1, :, :3] < 5).all()
    assert (found[..., 3] == 255).all()


@pytest.mark.parametrize("mode", ["RGB", "CMYK"])
def test_read_picture_takes_jpeg_upright_as_the_camera_says(tmp_path, mode):
    path, exif = tmp_path / "photo.jpg", Image.Exif()
    exif[0x0112] = 6  # to be turned right by 90 degrees
    Image.fromarray(LARGE[..., :3]).convert(mode).save(path, exif=exif, quality=95)
    found = read_picture(path.read_bytes(), path.name)
    assert found.shape == (48, 32, 4)
    corner = quarters(found)[0]  # what was lower left is upper left, beside what was upper left
    assert corner[0, 2] > 150 > corner[0, 0]
    assert corner[1, 0] > 150 > corner[1, 2]


@pytest.mark.parametrize("suffix", ["png", "jpg"])
def test_read_picture_scales_down_what_is_too_large(tmp_path, suffix):
    path = tmp_path / f"large.{suffix}"
    Image.fromarray(np.full((1000, 6000, 3), 90, dtype=np.uint8)).save(path)
    assert read_picture(path.read_bytes(), path.name).shape == (683, 4096, 4)


@pytest.mark.parametrize("content", [b"", b"no image", b"\x89PNG\r\n\x1a\n" + bytes(40), b"%PDF-1.7"])
def test_read_picture_says_in_a_sentence_what_is_no_image(tmp_path, content):
    path = tmp_path / "bad.png"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"^bad\.png is no image that can be read; choose a PNG"):
        read_picture(path.read_bytes(), path.name)
