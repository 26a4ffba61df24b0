"""Assemble the Blender add-on, and build its archive.

    python resources/blender/build.py FOLDER              the files, into FOLDER/apd_live
    python resources/blender/build.py FOLDER --archive    also checked and packed by Blender's own tool
    python resources/blender/build.py FOLDER --archive --wheels    with the solver, for this kind of computer

Both archives need the Python that Blender's module ``bpy`` is installed for. The first is for users who have
the program. Blender's platform for extensions takes only what needs nothing else: there it is the second.
"""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
NAME = "apd_live"
# Of the program, under its own licence, which fits that of the add-on.
_SHARED = ("apd_viewer/commands/message_stream.py",)
# Of the window and of curves, none of which the solver needs.
_WINDOW = ("PySide6", "pyvista", "matplotlib", "Pillow", "pillow")


def assembled_addon(folder):
    """Folder of the add-on in ``folder``, made anew."""
    place = Path(folder) / NAME
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(
        ROOT / "resources" / "blender" / NAME, place, ignore=shutil.ignore_patterns("__pycache__")
    )
    for path in _SHARED:
        shutil.copy(ROOT / path, place)
    shutil.copy(ROOT / "LICENSE", place / "LICENSE-message_stream")
    return place


def add_wheels(place):
    """Put the program and its libraries but the window's beside the add-on, for this Python and system."""
    import tomllib  # only here: Python 3.10 has none, and can assemble the files

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    libraries = [each for each in project["dependencies"] if not each.startswith(_WINDOW)]
    wheels = place / "wheels"
    pip = [sys.executable, "-m", "pip"]
    subprocess.run([*pip, "wheel", "--quiet", "--no-deps", "--wheel-dir", wheels, ROOT], check=True)
    words = [*pip, "download", "--quiet", "--only-binary", ":all:", "--dest", wheels]
    subprocess.run([*words, *libraries], check=True)
    for file in wheels.glob("numpy-*.whl"):  # Blender has its own
        file.unlink()
    names = sorted(f"./wheels/{file.name}" for file in wheels.iterdir())
    manifest = place / "blender_manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    listed = ",\n".join(f'    "{name}"' for name in names)
    manifest.write_text(
        text.replace("\n[permissions]", f"wheels = [\n{listed},\n]\n\n[permissions]"), encoding="utf-8"
    )


def archive(place):
    """Check the add-on in ``place`` and pack it beside; returns the archive."""
    import bpy  # only here: the files alone can be assembled without it

    tool = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    run = [sys.executable, tool]
    subprocess.run([*run, "validate", place], check=True)
    subprocess.run([*run, "build", "--source-dir", place, "--output-dir", place.parent], check=True)
    (found,) = place.parent.glob(f"{NAME}-*.zip")
    return found


if __name__ == "__main__":
    built = assembled_addon(sys.argv[1])
    if "--wheels" in sys.argv:
        add_wheels(built)
    if "--archive" in sys.argv:
        archive(built)
