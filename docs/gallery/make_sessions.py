"""Make the sessions of the gallery: run the code of each entry, and save what comes of it.

    python docs/gallery/make_sessions.py            # all of them
    python docs/gallery/make_sessions.py scan large

The sessions are small, so meshes have fewer vertices than the samples.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "pictures")]

from entries import ENTRIES  # noqa: E402

SESSIONS = HERE / "sessions"
VERTICES = 3000


def main(wanted: list[str]) -> None:
    """Make the sessions of these names, or all."""
    SESSIONS.mkdir(exist_ok=True)
    wanted = wanted or list(ENTRIES)
    for number, name in enumerate(wanted, 1):
        began = time.monotonic()
        print(f"[{number:2}/{len(wanted)}] {name:<20}", end="", flush=True)
        with tempfile.TemporaryDirectory(prefix="apd-gallery-") as folder:
            path = ENTRIES[name].save(ENTRIES[name].run(Path(folder), VERTICES), SESSIONS)
        print(f"{path.stat().st_size / 1000:6.0f} kB  {time.monotonic() - began:4.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
