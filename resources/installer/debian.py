"""The package for Debian and Ubuntu."""

from __future__ import annotations

import gzip
import os
import re
import shutil
import subprocess
from pathlib import Path

import contents
import licences

from apd_viewer.__main__ import _USAGE  # of the checkout, by the path that contents.py adds

_RESOURCES = contents.ROOT / "resources"
# Where files of the desktop belong; the triggers of the system's own packages collect them.
_DESKTOP = {
    "desktop/apd-viewer.desktop": "usr/share/applications",
    "desktop/apd-viewer.thumbnailer": "usr/share/thumbnailers",
    "desktop/apd-viewer.xml": "usr/share/mime/packages",
    "icons/apd-viewer.svg": "usr/share/icons/hicolor/scalable/apps",
}
# Completions for shells below build, and where they belong.
_COMPLETIONS = {
    "completions/bash": "usr/share/bash-completion/completions/apd-viewer",
    "completions/zsh": "usr/share/zsh/vendor-completions/_apd-viewer",
    "completions/fish": "usr/share/fish/vendor_completions.d/apd-viewer.fish",
}
_WITHOUT = {"libtbb.so.12"}  # numba's other way to use threads
_OPTIONAL = "/platformthemes/libqgtk3.so"  # the looks of GTK, where it is installed
_CONTROL = """\
Package: apd-viewer
Version: {version}
Architecture: {architecture}
Maintainer: The apd_viewer developers <nobody@invalid>
Installed-Size: {kilobytes}
Depends: {depends}
Recommends: desktop-file-utils, shared-mime-info, xdg-utils
Suggests: ffmpeg, {suggests}
Section: graphics
Priority: optional
Description: Area-preserving deformation of 3D objects
 Grip a mesh at its base and its handles, move them, and watch it deform while
 its surface area stays what it was.
 .
 Opens {formats}.
 .
 The package brings its own Python and libraries.
"""
_MANUAL_PAGE = """\
.TH APD-VIEWER 1 "" "apd-viewer {version}"
.SH NAME
apd-viewer \\- area-preserving deformation of 3D objects
.SH SYNOPSIS
.nf
{usage}
.fi
.SH DESCRIPTION
Each command describes its options after \\fB--help\\fR. The manual is in {manual}.
.SH FILES
.TP
.I ~/.config/apd-viewer
settings
.TP
.I ~/.local/share/apd-viewer
autosaves
.TP
.I ~/.local/state/apd-viewer/log
logs
.TP
.I ~/.cache/apd-viewer
compiled kernels
.SH ENVIRONMENT
.TP
.B APD_VIEWER_LANGUAGE
language of the program, such as de
.TP
.B APD_VIEWER_LOGS
another folder for logs
"""
_COPYRIGHT = """\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: apd-viewer
Comment: The texts of all licences are in /usr/lib/apd-viewer/LICENCES.txt.

Files: *
Copyright: {owner}
License: MIT
{mit}

Files: usr/lib/apd-viewer/_internal/*
Copyright: the authors of Python and of the libraries
License: various
 Python (PSF-2.0)
{libraries}
"""


def package(program: Path, tree: Path, place: Path) -> Path:
    """Pack the program into a .deb in the folder ``place``; ``tree`` is laid out before."""
    shutil.rmtree(tree, ignore_errors=True)
    inside = tree / "usr/lib/apd-viewer"
    shutil.copytree(program, inside, symlinks=True)
    strip(inside)
    (tree / "usr/bin").mkdir(parents=True)
    (tree / "usr/bin/apd-viewer").symlink_to("../lib/apd-viewer/apd-viewer")
    for source, folder in _DESKTOP.items():
        (tree / folder).mkdir(parents=True, exist_ok=True)
        shutil.copyfile(_RESOURCES / source, tree / folder / Path(source).name)
    for source, place_of_shell in _COMPLETIONS.items():
        (tree / place_of_shell).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(contents.ROOT / "build" / source, tree / place_of_shell)
    _write_texts(tree)
    _write_control(tree)
    for path in [tree, *tree.rglob("*")]:  # whatever the umask of the builder
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() or os.access(path, os.X_OK) else 0o644)
    result = place / f"apd-viewer_{contents.version()}_{architecture()}.deb"
    # xz takes many times as long, here and at each installation.
    pack = ["dpkg-deb", "--root-owner-group", "-Zzstd", "-z9", "--build"]
    subprocess.run([*pack, tree, result], check=True)
    return result


def strip(folder: Path) -> None:
    """Remove symbols for debuggers, as all packages do; NumPy's and SciPy's wheels do not stand it."""
    heavy = [path for path in binaries(folder) if path.stat().st_size > 1_000_000]
    for path in heavy:
        if path.parent.name in {"_internal", "vtkmodules"} and path.name.startswith("lib"):
            subprocess.run(["strip", "--strip-unneeded", path], check=True)


def binaries(folder: Path) -> list[Path]:
    """Programs and libraries in the format of Linux."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink())
    return [path for path in files if path.open("rb").read(4) == b"\x7fELF"]


def _write_control(tree: Path) -> None:
    size = sum(path.lstat().st_size for path in tree.rglob("*") if path.is_file())
    found = dependencies(tree)
    (tree / "DEBIAN").mkdir()
    control = _CONTROL.format(
        version=contents.version(),
        formats=", ".join(each.name for each in contents.MESH_FORMATS.values()),
        architecture=architecture(),
        kilobytes=size // 1024,
        depends=", ".join(found["Depends"]),
        suggests=", ".join(found["Suggests"]),
    )
    (tree / "DEBIAN/control").write_text(control, encoding="utf-8")


def dependencies(tree: Path) -> dict[str, list[str]]:
    """Packages with the system's libraries: those that are linked, and those that are opened by name.

    dpkg-shlibdeps takes minutes for so many libraries, and stops at names without a version, as VTK's.
    """
    found = binaries(tree / "usr/lib/apd-viewer")
    own = {path.name for path in (tree / "usr/lib/apd-viewer").rglob("*.so*")}
    optional = [path for path in found if str(path).endswith(_OPTIONAL)]
    depends = _packages_of(_linked([path for path in found if path not in optional]) - own)
    suggests = _packages_of(_linked(optional) - own) - depends
    return {
        "Depends": [f"libc6 (>= {_glibc(found)})", *sorted(depends.union(window_packages()) - {"libc6"})],
        "Suggests": sorted(suggests & {"libgtk-3-0"}),  # which needs the others
    }


def _linked(files: list[Path]) -> set[str]:
    said = subprocess.check_output(["readelf", "-d", *files], text=True, stderr=subprocess.DEVNULL)
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", said))


def _packages_of(names: set[str]) -> set[str]:
    """Packages of this system with the named libraries; stops if one is in none."""
    known = subprocess.check_output(["ldconfig", "-p"], text=True)
    places = {Path(path).name: Path(path) for path in re.findall(r"(?m)\(libc6.*\) => (.*)$", known)}
    # numba asks for the file itself, libgomp.so.1.0.0, and not by its name libgomp.so.1.
    places = {path.resolve().name: path for path in places.values()} | places
    found = set()
    for name in names - _WITHOUT:
        # The real file, wherever it was installed: dpkg knows neither links to it nor that /lib is one.
        real = str(places[name].resolve()).removeprefix("/usr")
        said = subprocess.check_output(["dpkg", "-S", f"*{real}"], text=True)
        found.add(said.partition(":")[0])
    return found


def _glibc(files: list[Path]) -> str:
    """Version of the C library that the binaries were linked with."""
    versions = {match for path in files for match in re.findall(rb"\0GLIBC_2\.(\d+)\0", path.read_bytes())}
    return f"2.{max(map(int, versions))}"


def window_packages() -> list[str]:
    """Packages that the Makefile lists for a window."""
    makefile = (contents.ROOT / "Makefile").read_text(encoding="utf-8")
    (listed,) = re.findall(r"(?m)^packages = ((?:.*\\\n)*.*)$", makefile)
    return listed.replace("\\\n", " ").split()


def _write_texts(tree: Path) -> None:
    manual = "/usr/lib/apd-viewer/_internal/apd_viewer/manual/index.html"
    usage = _USAGE.replace("\\", "\\\\").replace("-", "\\-")
    page = _MANUAL_PAGE.format(version=contents.version(), usage=usage.strip(), manual=manual)
    pages = tree / "usr/share/man/man1"
    pages.mkdir(parents=True)
    (pages / "apd-viewer.1.gz").write_bytes(gzip.compress(page.encode(), mtime=0))
    about = tree / "usr/share/doc/apd-viewer"
    about.mkdir(parents=True)
    mit = (contents.ROOT / "LICENSE").read_text(encoding="utf-8")
    owner = re.search(r"Copyright \(c\) (.*)", mit)
    shown = "\n".join(f" {line}" if line.strip() else " ." for line in mit.strip().splitlines())
    brought = "\n".join(
        f" {each.metadata['Name']} ({licences.licence(each)})" for each in licences.libraries()
    )
    text = _COPYRIGHT.format(owner=owner[1] if owner else "", mit=shown, libraries=brought)
    (about / "copyright").write_text(text, encoding="utf-8")
    (about / "changelog.gz").write_bytes(
        gzip.compress((contents.ROOT / "CHANGELOG.md").read_bytes(), mtime=0)
    )


def architecture() -> str:
    """Debian's name of this machine, such as amd64."""
    return subprocess.check_output(["dpkg", "--print-architecture"], text=True).strip()
