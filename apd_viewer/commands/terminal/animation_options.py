"""The ``--animation`` option and checks of its files."""

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.files.animations.animation_files import ANIMATION_FORMATS, check_animation
from apd_viewer.files.mesh_writing import check_distinct
from apd_viewer.files.storage.atomic_file import resolved_path, staging_folder
from apd_viewer.language import tr


def add_animation_option(parser: Parser, films: bool = True) -> None:
    """Add the ``--animation`` option; it can be given several times."""
    about = tr(
        "write the shapes for Blender (.pc2, .mdd), with morph targets (.glb), as USD (.usda, .usdc, .usdz) "
        "or for ParaView (.pvd); may be given several times"
    )
    if films:
        about = tr(
            "write the shapes as a film (.gif, or .mp4 with an encoder), for Blender (.pc2, .mdd), with "
            "morph targets (.glb), as USD (.usda, .usdc, .usdz) or for ParaView (.pvd); may be given several "
            "times"
        )
    words = f"--animation A{'.gif' if films else '.glb'}"
    add_option(parser, words, about, type=Path, action="append", default=[])


def is_film(path: Path) -> bool:
    """True if a path has the suffix of a film, made of pictures."""
    return path.suffix.lower() not in ANIMATION_FORMATS


class AnimationTargets:
    """Requested animation files of a command.

    Parameters
    ----------
    options : Namespace
        With ``animation`` and ``output``.
    versions : sequence of str
        Names of the versions of the motion: with several of them each has a file of its own, but for films,
        which show all of them.

    Raises
    ------
    InputError
        If one cannot be written.
    """

    def __init__(self, options: argparse.Namespace, versions: Sequence[str]) -> None:
        self._asked: list[Path] = options.animation
        self._folder: Path = resolved_path(options.output)
        self._versions = versions
        self._check()

    def _check(self) -> None:
        # Imported here: Pillow is slow to import, and only films need it.
        from apd_viewer.figures.films import check_film

        for path in filter(is_film, self._asked):
            check_film(path, ANIMATION_FORMATS)
        named = [*self.films(), *self.files_of_all_versions()]
        check_distinct(named)
        for path in named:
            if path.parent.exists() or not self._is_in_output(path):
                check_animation(path)

    def __bool__(self) -> bool:
        return bool(self._asked)

    def films(self) -> list[Path]:
        """Film files, each showing all versions of the motion."""
        return [path for path in self._asked if is_film(path)]

    def files(self, version: str) -> list[Path]:
        """Animation files of one version, without the films."""
        paths = [path for path in self._asked if not is_film(path)]
        if len(self._versions) == 1:
            return paths
        return [path.with_stem(f"{path.stem}-{version}") for path in paths]

    def files_of_all_versions(self) -> list[Path]:
        """Animation files of all versions of the motion, without the films."""
        return [path for version in self._versions for path in self.files(version)]

    def _is_in_output(self, path: Path) -> bool:
        """True if a path is in the output folder, whether or not that exists yet."""
        return resolved_path(path).parent == self._folder

    def scratch_path(self, path: Path, scratch: Path, stack: ExitStack) -> Path:
        """Scratch path of an animation until all files are written.

        In ``scratch`` for a file in the output folder; otherwise it is moved when ``stack`` closes.
        """
        return scratch / path.name if self._is_in_output(path) else scratch_path_beside(path, stack)


def scratch_path_beside(path: Path, stack: ExitStack) -> Path:
    """Scratch path of an animation, moved to ``path`` when ``stack`` closes."""
    return stack.enter_context(staging_folder(path.parent)) / path.name
