"""Files of a ParaView series that a shorter one no longer needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from xml.etree import ElementTree


@contextmanager
def replacing_series(paths: Sequence[Path]) -> Iterator[None]:
    """Delete files that series at ``paths`` list before, and no longer at the end.

    Only those in the folder of its name: a series of another program may list anything.
    """
    before = _listed(paths)
    yield
    for path in before - _listed(paths):
        with suppress(OSError):  # nothing is wrong with what was written
            path.unlink()


def _listed(paths: Sequence[Path]) -> set[Path]:
    series = [path for path in paths if path.suffix.lower() == ".pvd" and path.is_file()]
    return {file for path in series for file in _files(path)}


def _files(path: Path) -> list[Path]:
    try:
        rows = list(ElementTree.parse(path).iter("DataSet"))
    except (OSError, ElementTree.ParseError):
        return []
    files = [path.parent / row.get("file", "") for row in rows]
    return [file for file in files if file.parent == path.with_suffix("") and file.suffix == ".vtu"]
