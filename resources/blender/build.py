"""Assemble the Blender add-on, and build its archive.

    python resources/blender/build.py FOLDER              the files, into FOLDER/apd_live
    python resources/blender/build.py FOLDER --archive    also checked and packed by Blender's own tool

The second needs the Python that Blender's module ``bpy`` is installed for.
"""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
NAME = "apd_live"
# Of the program, under its own licence, which fits that of the add-on.
_SHARED = ("apd_viewer/commands/message_stream.py",)


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
    if "--archive" in sys.argv:
        archive(built)
