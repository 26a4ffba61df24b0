"""Films made from pictures, as GIF or MP4."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.language import tr

FILM_SUFFIXES = (".gif", ".mp4")
_LENGTH = 3.0  # duration of the forward run in seconds; the backward run is as long
_SHORTEST, _LONGEST = 0.04, 0.25  # least and greatest seconds per picture
_REST = 0.7  # seconds of standstill at either end
_COLORS = 128


def check_film(path: Path, other_suffixes: Sequence[str] = ()) -> None:
    """Raise InputError unless a film can be written to ``path``.

    ``other_suffixes`` are listed in the error besides those of films.
    """
    kinds = *FILM_SUFFIXES, *other_suffixes
    if path.suffix.lower() not in FILM_SUFFIXES:
        raise InputError(
            tr("{name} does not have the ending of an animation; use {kinds} or {last}.").format(
                name=path.name, kinds=", ".join(kinds[:-1]), last=kinds[-1]
            )
        )
    if path.suffix.lower() == ".mp4":
        try:
            # Imported here: an optional library, needed only for MP4.
            import imageio_ffmpeg

            imageio_ffmpeg.get_ffmpeg_exe()
        except ImportError:
            raise InputError(
                tr("MP4 needs an encoder: install apd-viewer[video], or use the ending .gif.")
            ) from None
        except RuntimeError:  # no encoder found: a packaged program relies on one in the system
            raise InputError(tr("MP4 needs an encoder: install ffmpeg, or use the ending .gif.")) from None


def write_film(pictures: Sequence[Path], path: Path) -> None:
    """Write a film of the pictures, played forwards and then backwards.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    each = min(max(_LENGTH / len(pictures), _SHORTEST), _LONGEST)
    seconds = [each] * len(pictures)
    seconds[0] = seconds[-1] = _REST
    order = [*range(len(pictures)), *range(len(pictures) - 2, 0, -1)]
    write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
    with replacing_file(path) as scratch:
        write([pictures[k] for k in order], [seconds[k] for k in order], scratch)


def _write_gif(pictures: list[Path], seconds: list[float], path: Path) -> None:
    frames = []
    for picture in pictures:
        with Image.open(picture) as image:
            frames.append(image.convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE))
    # GIF durations are multiples of a hundredth of a second.
    times = [10 * round(100 * second) for second in seconds]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=times, loop=0)


def _write_mp4(pictures: list[Path], seconds: list[float], path: Path) -> None:
    # Imported here: an optional library, needed only for MP4.
    import imageio_ffmpeg

    rate = 25
    with Image.open(pictures[0]) as first:
        size = first.size
    writer = imageio_ffmpeg.write_frames(str(path), size, fps=rate, quality=7, macro_block_size=2)
    writer.send(None)
    for picture, second in zip(pictures, seconds, strict=True):
        with Image.open(picture) as image:
            frame = np.ascontiguousarray(image.convert("RGB"))
        for _ in range(max(1, round(rate * second))):
            writer.send(frame)
    writer.close()
