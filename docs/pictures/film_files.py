"""A film as WebM for the site and as GIF for the read-me; both are encoded from one file without loss."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from film_recorder import RATE
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage

from apd_viewer.files.storage.atomic_file import replacing_file

_QUALITY = 33  # of VP9, from 0 to 63; the smaller, the better
_GIF_WIDTH, _GIF_RATE, _GIF_COLORS = 860, 10, 240


class Part(NamedTuple):
    """Pictures of a film, from the first to the one before ``end``, shown in so many seconds."""

    begin: int
    end: int
    seconds: float


class Reel:
    """Takes pictures into a file without loss.

    Parameters
    ----------
    path : Path
        The file; its ending is ``.mkv``.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._process: subprocess.Popen[bytes] | None = None

    def take(self, picture: QImage, count: int) -> None:
        """Add a picture so many times."""
        if self._process is None:
            self._process = self._begun(picture.size())
        assert self._process.stdin is not None
        for _ in range(count):
            self._process.stdin.write(picture.constBits())

    def _begun(self, size: QSize) -> subprocess.Popen[bytes]:
        raw = ["-f", "rawvideo", "-pix_fmt", "bgra", "-s", f"{size.width()}x{size.height()}", "-r", str(RATE)]
        exact = ["-c:v", "libx264rgb", "-qp", "0", "-preset", "ultrafast"]
        return subprocess.Popen([*_encoder(), *raw, "-i", "-", *exact, str(self.path)], stdin=subprocess.PIPE)

    def close(self) -> None:
        """Write what has been taken."""
        if self._process is not None:
            self._process.communicate()
            if self._process.returncode:
                raise OSError("The encoder has not written the film.")


@contextmanager
def reel(path: Path) -> Iterator[Reel]:
    """A reel that is closed in the end."""
    taken = Reel(path)
    try:
        yield taken
    finally:
        taken.close()


def check_encoder() -> None:
    """Raise OSError unless there is an encoder."""
    _encoder()


def write_webm(film: Path, path: Path) -> None:
    """Write a film as VP9, in two passes."""
    log = film.with_suffix(".log")
    vp9 = ["-c:v", "libvpx-vp9", "-crf", str(_QUALITY), "-b:v", "0", "-pix_fmt", "yuv420p", "-an"]
    best = ["-row-mt", "1", "-g", str(10 * RATE), "-passlogfile", str(log)]
    _run("-i", str(film), *vp9, *best, "-cpu-used", "4", "-pass", "1", "-f", "null", "-")
    with replacing_file(path) as scratch:
        _run("-i", str(film), *vp9, *best, "-cpu-used", "2", "-pass", "2", "-f", "webm", str(scratch))


def write_gif(film: Path, path: Path, parts: Sequence[Part]) -> None:
    """Write parts of a film one after another as GIF, with one palette."""
    cuts = [
        f"[0]trim=start_frame={begin}:end_frame={end},"
        f"setpts=(PTS-STARTPTS)*{seconds * RATE / (end - begin):.5f}[part{k}]"
        for k, (begin, end, seconds) in enumerate(parts)
    ]
    joined = "".join(f"[part{k}]" for k in range(len(parts))) + f"concat=n={len(parts)}"
    small = f"fps={_GIF_RATE},scale={_GIF_WIDTH}:-2:flags=lanczos,split[a][b]"
    palette = f"[a]palettegen=max_colors={_GIF_COLORS}:stats_mode=full[p]"
    drawn = "[b][p]paletteuse=dither=bayer:bayer_scale=5:diff_mode=rectangle"
    graph = ";".join([*cuts, f"{joined},{small}", palette, drawn])
    with replacing_file(path) as scratch:
        _run("-i", str(film), "-filter_complex", graph, "-loop", "0", "-f", "gif", str(scratch))


def _run(*options: str) -> None:
    subprocess.run([*_encoder(), *options], check=True)


def _encoder() -> list[str]:
    """The command of the encoder: that of the extra, or of the system."""
    try:
        import imageio_ffmpeg

        program = imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        program = shutil.which("ffmpeg") or ""
    if not program:
        raise OSError("The film needs an encoder: pip install imageio-ffmpeg.")
    return [program, "-y", "-hide_banner", "-loglevel", "error"]
