"""Compiled kernels, cached in files across starts of the program.

Numba's own cache ends the program where a file of it is damaged, or where none can be written. Here a file
counts only if it is whole, and made from the same sources for the same processor by the
same numba and Python; otherwise the kernel is compiled. What is found and done is noted in the log.
"""

import hashlib
import inspect
import logging
import pickle
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from apd_viewer.geometry.signals import kernel_signals  # imported before the first kernel is compiled
from apd_viewer.installation import kernel_folders

_LOGGER = logging.getLogger(__name__)
# All imported kernels, by the dotted names of their functions.
KERNELS: dict[str, Any] = {}
_DIGEST = hashlib.sha256().digest_size


def njit(cache: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a kernel as :func:`numba.njit` does; keep it on disk if ``cache``."""

    def compiled(function: Callable[..., Any]) -> Any:
        # Digest of the running code, since an update may replace the file at any time.
        _source_digest(inspect.getfile(function))
        kernel = numba.njit(**options)(function)
        KERNELS[f"{function.__module__}.{function.__qualname__}"] = kernel
        if cache:
            # As in numba's enable_caching, which supports no cache but its own.
            kernel._cache = KernelCache(function)
        return kernel

    return compiled


class KernelCache(_Cache):
    """Cache files of a kernel, one for each combination of argument types.

    They are read from the first of the folders that has a whole one, and written to the first that takes it.

    Attributes
    ----------
    function : callable
        What is compiled.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self._name = f"{Path(inspect.getfile(function)).stem}.{function.__qualname__}"

    @property
    def cache_path(self) -> str:
        """First of the folders searched for cache files."""
        return str(self._folders()[0])

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """Load the kernel for types ``sig``; None if it must be compiled."""
        target_context.refresh()
        made_for = self._made_for(sig, target_context.codegen())
        for folder in self._folders():
            file = folder / self._file_name(made_for)
            try:
                return CompileResult._rebuild(target_context, *_payload(file, self._stamp(made_for)))
            except (OSError, _OtherSourcesError):  # missing, outdated, or not readable by this user
                continue
            except Exception as error:  # for example, an argument's class has moved to another module
                _LOGGER.warning("%s is compiled again: %s", file, error)
        return None

    def save_overload(self, sig: Any, data: CompileResult) -> None:
        """Save the kernel for types ``sig`` in the first writable folder."""
        if data.library.has_dynamic_globals:  # contains addresses of this process
            return
        made_for = self._made_for(sig, data.codegen)
        refused = ""
        for folder in self._folders():
            file = folder / self._file_name(made_for)
            try:
                _write(file, _sealed_content(self._stamp(made_for) + dumps(data._reduce())))
            except OSError as error:
                refused = error.strerror or str(error)
                continue
            _LOGGER.info("Compiled %s", file)
            return
        _say_that_none_is_kept(refused)

    def enable(self) -> None:
        """Do nothing; the cache is always enabled."""

    def disable(self) -> None:
        """Do nothing; the cache is always enabled."""

    def flush(self) -> None:
        """Keep all files; outdated ones are overwritten at the next compilation."""

    def _folders(self) -> list[Path]:
        return kernel_folders(Path(inspect.getfile(self.function)).parent)

    def _made_for(self, sig: Any, codegen: Any) -> str:
        return repr((str(sig), codegen.magic_tuple(), sys.implementation.cache_tag, numba.__version__))

    def _file_name(self, made_for: str) -> str:
        return f"{self._name}-{hashlib.sha256(made_for.encode()).hexdigest()[:16]}.nbc"

    def _stamp(self, made_for: str) -> bytes:
        """Digest of all sources of the machine code, called kernels included."""
        told = hashlib.sha256(f"{self._name} {made_for}".encode())
        for file in sorted(_sources(self.function)):
            told.update(_source_digest(file))
        return told.digest()


class _OtherSourcesError(Exception):
    """Cache file compiled from other sources."""


def _sources(function: Callable[..., Any]) -> set[str]:
    """Source files of a function and of the kernels it calls."""
    known = [function]
    for each in known:
        called = (getattr(each.__globals__.get(name), "py_func", None) for name in each.__code__.co_names)
        known.extend(inner for inner in called if inner is not None and inner not in known)
    return {kernel_signals.__file__, *(inspect.getfile(each) for each in known)}


@cache
def _source_digest(file: str) -> bytes:
    try:
        return hashlib.sha256(Path(file).read_bytes()).digest()
    except OSError:  # without sources, cache files never match at another start
        return uuid4().bytes


def _sealed_content(content: bytes) -> bytes:
    return hashlib.sha256(content).digest() + content


def _payload(file: Path, stamp: bytes) -> Any:
    """Contents of a cache file, with its seal and stamp checked."""
    sealed = file.read_bytes()
    content = sealed[_DIGEST:]
    if sealed != _sealed_content(content):
        raise ValueError("the file is damaged")
    if content[:_DIGEST] != stamp:
        raise _OtherSourcesError
    return pickle.loads(content[_DIGEST:])


def _write(file: Path, content: bytes) -> None:
    """Write a file atomically."""
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_name(f"{file.name}.{uuid4().hex[:8]}.part")
    try:
        unfinished.write_bytes(content)
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)


@cache
def _say_that_none_is_kept(reason: str) -> None:
    _LOGGER.warning(
        "Compiled kernels are not kept (%s); name a folder in NUMBA_CACHE_DIR, or wait at each start.",
        reason,
    )
