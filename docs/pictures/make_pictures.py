"""Make the pictures of the site, each by its script in a process of its own.

    python docs/pictures/make_pictures.py            # all of them; some take a minute
    python docs/pictures/make_pictures.py tutorial_ring gallery_twist
    python docs/pictures/make_pictures.py film       # made only where it is named; needs imageio-ffmpeg

It needs Xvfb, and no display. ``scripts/NAME.py`` makes ``NAME.webp`` by a function ``draw(stage)``.
``film.py`` makes the film, ``film.webm``, the picture that stands for it, and a part of it as GIF.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SCRIPTS = HERE / "scripts"
FILM = "film"
SHARED = "APD_PICTURES_SHARED"  # names a folder that the scripts of one run share
SCALE = 2  # pixels of a picture for one of the window
_SCREEN = "3200x2400x24"


def names() -> list[str]:
    """Names of all pictures, which are those of their scripts; the film is none of them."""
    from gallery_pictures import gallery_names

    return sorted(path.stem for path in SCRIPTS.glob("*.py")) + gallery_names()


def files(name: str, folder: Path = HERE) -> list[Path]:
    """Paths of the files of a picture, or of the film."""
    return [
        folder / f"{name}{ending}" for ending in ([".webp", ".webm", ".gif"] if name == FILM else [".webp"])
    ]


def drawer(name: str) -> Callable[[Any], Any]:
    """What draws a picture on a stage: the function of a script, or that of an entry of the gallery."""
    if name.startswith("gallery_"):
        from gallery_pictures import gallery_drawer

        return gallery_drawer(name)
    spec = importlib.util.spec_from_file_location(f"picture_{name}", SCRIPTS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    draw: Callable[[Any], Any] = module.draw
    return draw


def make_one(name: str, folder: Path) -> None:
    """Draw a picture in this process and write it into a folder."""
    from picture_files import write_picture
    from stage import Stage

    with tempfile.TemporaryDirectory(prefix="apd-pictures-") as scratch:
        stage = Stage(Path(scratch))
        if name == FILM:
            from film import write_film

            write_film(stage, folder)
        else:
            write_picture(drawer(name)(stage), folder / f"{name}.webp")
        sys.stdout.flush()
        stage.close()
    os._exit(0)  # threads of the window may still be about to end


def environment(display: str) -> dict[str, str]:
    """What is the same for all pictures."""
    own = {
        "DISPLAY": display,
        "XDG_SESSION_TYPE": "x11",
        "QT_QPA_PLATFORM": "xcb",
        "QT_SCALE_FACTOR": str(SCALE),
        "QT_FONT_DPI": "96",
        "QT_LOGGING_RULES": "*.warning=false",
        "APD_VIEWER_LANGUAGE": "en",
        "LC_ALL": "C.UTF-8",
        "LIBGL_ALWAYS_SOFTWARE": "1",
        "PYTHONPATH": os.pathsep.join([str(HERE.parents[1]), str(HERE), os.environ.get("PYTHONPATH", "")]),
    }
    return {name: value for name, value in os.environ.items() if name != "WAYLAND_DISPLAY"} | own


def main(wanted: list[str], folder: Path = HERE) -> int:
    """Make the pictures of these names, or all; the number of those that failed."""
    wanted = wanted or names()
    with tempfile.TemporaryDirectory(prefix="apd-pictures-") as shared, _display() as display:
        own = environment(display) | {SHARED: shared}
        failed = [
            name for k, name in enumerate(wanted, 1) if not _made(name, f"{k:2}/{len(wanted)}", own, folder)
        ]
    if failed:
        print(f"These failed: {' '.join(failed)}")
    return len(failed)


@contextlib.contextmanager
def _display() -> Iterator[str]:
    """A display of its own; its name."""
    reading, writing = os.pipe()
    screen = ["Xvfb", "-displayfd", str(writing), "-screen", "0", _SCREEN, "-nolisten", "tcp"]
    with subprocess.Popen(screen, pass_fds=[writing], stderr=subprocess.DEVNULL) as server:
        try:
            os.close(writing)
            yield f":{os.read(reading, 20).decode().strip()}"
        finally:
            server.terminate()


def _made(name: str, place: str, own: dict[str, str], folder: Path) -> bool:
    """Make a picture in a process, and say so."""
    began = time.monotonic()
    print(f"[{place}] {name:<28}", end="", flush=True)
    command = [sys.executable, str(HERE / "make_pictures.py"), "--one", name, str(folder)]
    done = subprocess.run(command, env=own, check=False)
    if done.returncode:
        print(" failed")
        return False
    size = sum(path.stat().st_size for path in files(name, folder))
    print(f"{size / 1000:6.0f} kB  {time.monotonic() - began:4.0f} s")
    return True


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        make_one(sys.argv[2], Path(sys.argv[3]))
    else:
        sys.exit(bool(main(sys.argv[1:])))
