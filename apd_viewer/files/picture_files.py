"""PNG encoding and decoding of small pictures."""

import io
import warnings

import numpy as np

from apd_viewer.language import tr

_LARGEST = 1024  # largest accepted side in pixels


def png_content(pixels: np.ndarray) -> bytes:
    """PNG file of RGBA (h, w, 4) uint8; the same pixels give the same bytes."""
    from PIL import Image  # imported on demand: loading takes a tenth of a second

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()


def read_png(content: bytes, size: int) -> np.ndarray:
    """RGBA (h, w, 4) uint8 of a PNG file, scaled down to ``size`` pixels at most.

    Raises
    ------
    ValueError
        If it is damaged, or too large to be a small picture.
    """
    from PIL import Image  # imported on demand: loading takes a tenth of a second

    bombs = Image.DecompressionBombWarning, Image.DecompressionBombError
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", bombs[0])  # Pillow would print the warning
            with Image.open(io.BytesIO(content), formats=["PNG"]) as image:
                if max(image.size) > _LARGEST:
                    raise ValueError
                found = image.convert("RGBA")
        found.thumbnail((size, size))
        return np.array(found)
    except (OSError, ValueError, SyntaxError, *bombs):
        raise ValueError(tr("its picture is damaged")) from None
