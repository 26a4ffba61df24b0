"""Build the self-contained program, and the package of this system, into dist/.

Linux: a .deb; Windows: a set-up program by Inno Setup; macOS: a disk image. ``make installer`` makes the
environment that this needs, and the manual.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import contents
import kernels
import licences
import sbom

BUILD = contents.ROOT / "build" / "installer"
DIST = contents.ROOT / "dist"
SPEC = contents.ROOT / "resources" / "installer" / "apd-viewer.spec"


def main() -> None:
    """Build program and package; say where the package is and how large both are."""
    if not (contents.MANUAL / "index.html").is_file():
        sys.exit(f"There is no manual in {contents.MANUAL}; run make docs.")
    program = build_program()
    licences.write(program / "LICENCES.txt")
    DIST.mkdir(exist_ok=True)
    package = PACKERS[sys.platform](program)
    sbom.write(package.with_suffix(".cdx.json"))
    print(f"{package}: {megabytes(package)} MB; installed: {megabytes(program)} MB")


def build_program() -> Path:
    """Folder, or application of macOS, with the program."""
    work = BUILD / "work"
    work.mkdir(parents=True, exist_ok=True)
    if sys.platform != "linux":
        draw_icon(work)
    command = [sys.executable, "-m", "PyInstaller", "--noconfirm", "--log-level", "WARN"]
    subprocess.run([*command, "--workpath", work, "--distpath", BUILD, SPEC], check=True)
    add_kernels(BUILD / "program")
    return BUILD / "program"


def add_kernels(program: Path) -> None:
    """Have the program compile its kernels, and add them to it, where they fit other processors too."""
    inside = program / "_internal"
    number = kernels.compile_kernels([str(program / "apd-viewer")], inside / "apd_viewer", BUILD / "kernels")
    if number:
        shutil.copytree(BUILD / "kernels", inside / "kernels")


def draw_icon(work: Path) -> None:
    """Draw the icon in the format of this system; it is an SVG, which Qt can draw."""
    from PySide6.QtCore import Qt
    from PySide6.QtGui import QGuiApplication, QIcon

    application = QGuiApplication.instance() or QGuiApplication(["icon", "-platform", "offscreen"])
    icon = QIcon(str(contents.ROOT / "resources" / "icons" / "apd-viewer.svg"))
    picture = (
        icon.pixmap(512, 512).toImage().scaled(512, 512, mode=Qt.TransformationMode.SmoothTransformation)
    )
    assert application is not None
    picture.save(str(work / "apd-viewer.png"))
    # Pillow, which the program has, writes both formats in all their sizes.
    from PIL import Image

    with Image.open(work / "apd-viewer.png") as drawn:
        drawn.save(work / "apd-viewer.ico")
        drawn.save(work / "apd-viewer.icns")


def debian_package(program: Path) -> Path:
    """Pack the program for Debian and Ubuntu."""
    import debian

    return debian.package(program, BUILD / "debian", DIST)


def windows_package(program: Path) -> Path:
    """Pack the program by Inno Setup, whose compiler is in the PATH."""
    script = BUILD / "windows.iss"
    script.write_text(contents.windows_script(), encoding="utf-8")
    version = f"/DVersion={contents.version()}"
    found = shutil.which("iscc") or r"C:\Program Files (x86)\Inno Setup 6\ISCC.exe"
    subprocess.run([found, "/Q", version, f"/DProgram={program}", f"/O{DIST}", script], check=True)
    return DIST / f"apd-viewer-{contents.version()}-windows.exe"


def mac_package(program: Path) -> Path:
    """Sign the application ad hoc, as Apple's processors demand, and pack it into a disk image."""
    del program
    application = BUILD / "APD Viewer.app"
    subprocess.run(["codesign", "--force", "--deep", "--sign", "-", application], check=True)
    folder = BUILD / "image"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    shutil.copytree(application, folder / application.name, symlinks=True)
    (folder / "Applications").symlink_to("/Applications")
    image = DIST / f"apd-viewer-{contents.version()}-macos-{contents.machine()}.dmg"
    image.unlink(missing_ok=True)
    command = ["hdiutil", "create", "-volname", "APD Viewer", "-format", "ULFO", "-srcfolder"]
    subprocess.run([*command, folder, image], check=True)
    return image


PACKERS = {"linux": debian_package, "win32": windows_package, "darwin": mac_package}


def megabytes(path: Path) -> int:
    """Size of a file or folder."""
    files = path.rglob("*") if path.is_dir() else [path]
    return round(sum(file.lstat().st_size for file in files if file.is_file() or file.is_symlink()) / 1e6)


if __name__ == "__main__":
    main()
