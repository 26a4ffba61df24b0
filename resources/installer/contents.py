"""Contents of the self-contained program, for its spec file and the tests."""

from __future__ import annotations

import hashlib
import importlib.metadata
import platform
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))  # modules of the program come from the checkout
from apd_viewer.files.mesh_formats import MESH_FORMATS  # noqa: E402

PACKAGE = ROOT / "apd_viewer"
MANUAL = ROOT / "build" / "docs"  # where `make docs` writes it

# Read by importlib.metadata: for the log, reports, sessions and studies.
DESCRIBED = (
    *("apd-viewer", "PySide6_Essentials", "vtk", "pyvista", "pyvistaqt", "numpy", "scipy", "numba"),
    *("cholespy", "matplotlib", "trimesh"),
)
# The spec leaves pictures of the documentation, scripts and its own folder behind.
RESOURCES = ("*.obj", "*.sel", "*.def", "*.qss", "icons/*.svg", "desktop/*")
# Imported by compiled modules, or by name: PyInstaller cannot see it.
HIDDEN = (
    "cholespy._cholespy_core",
    *(f"matplotlib.backends.backend_{kind}" for kind in ("agg", "mixed", "pdf", "svg")),
)
# Imported by libraries where it is there, and never used by the program; `vtk` imports all of VTK.
UNUSED = (
    *("IPython", "certifi", "dask", "distributed", "fsspec", "ipywidgets", "jinja2", "numba.tests", "pandas"),
    *("pip", "pyarrow", "pygments", "pytest", "readline", "requests", "rich", "setuptools"),
    *(
        "tkinter",
        "trame",
        "urllib3",
        "vtk",
        *(f"PySide6.Qt{name}" for name in ("Designer", "Qml", "Quick", "Test")),
    ),
)
# pyvista imports VTK's modules by name, when it needs a class of theirs.
_VTK = re.compile(
    "vtk(Common.*|Filters(Core|Extraction|General|Geometry|Hybrid|Modeling|Points|Python|Sources|Statistics|Texture)"
    "|IO(Core|Geometry|Image|Legacy|PLY|XML|XMLParser)|Imaging.*|Interaction.*"
    "|Rendering(Annotation|Context2D|ContextOpenGL2|Core|FreeType|HyperTreeGrid|Label|Matplotlib|OpenGL2|UI"
    "|Volume|VolumeOpenGL2)|ChartsCore|ParallelCore|PythonContext2D|Views(Core|Context2D))"
)
# Plugins of Qt for devices without a desktop.
_DEVICES = re.compile(
    r"plugins/(egldeviceintegrations|generic)/|platforms/libq(eglfs|linuxfb|minimal.*|vkkhr.*|vnc)\."
)
_DEVICE_LIBRARIES = re.compile(r"libQt6EglF[Ss]")

# Endings of the files that it opens; on Linux resources/desktop/apd-viewer.xml has them.
SESSIONS = ["apd"]
MESHES = [suffix[1:] for suffix in MESH_FORMATS]


def modules() -> list[str]:
    """Names of all modules of the package."""
    names = (".".join(path.relative_to(ROOT).with_suffix("").parts) for path in PACKAGE.rglob("*.py"))
    return sorted(name.removesuffix(".__init__") for name in names)


def data() -> list[tuple[str, str]]:
    """Files beside the modules, such as translations and the manual, and their folders in the program."""
    found = [path for path in PACKAGE.rglob("*") if path.is_file() and path.suffix not in _NO_DATA]
    pairs = [(str(path), path.parent.relative_to(ROOT).as_posix()) for path in found]
    for path in MANUAL.rglob("*"):
        if path.is_file() and path.name not in {".buildinfo", "objects.inv"}:
            pairs.append((str(path), f"apd_viewer/manual/{path.parent.relative_to(MANUAL).as_posix()}"))
    for pattern in RESOURCES:
        for path in (ROOT / "resources").glob(pattern):
            pairs.append((str(path), f"apd_viewer/{path.parent.relative_to(ROOT).as_posix()}"))
    return sorted(pairs)


_NO_DATA = {".py", ".pyc", ".po", ".pot"}


def version() -> str:
    """Version of the program."""
    return re.findall(r'(?m)^version = "(.*)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))[0]


def windows_script() -> str:
    """Script of Inno Setup, with a line for each ending of a mesh."""
    script = (ROOT / "resources" / "installer" / "windows.iss").read_text(encoding="utf-8")
    (line,) = (line for line in script.splitlines(keepends=True) if "{ending}" in line)
    return script.replace(line, "".join(line.replace("{ending}", ending) for ending in MESHES))


def machine() -> str:
    """Kind of processor, such as arm64."""
    return platform.machine().lower()


def vtk_modules() -> list[str]:
    """Names of the modules of VTK that pyvista may import for the program."""
    import vtkmodules

    folder = Path(vtkmodules.__path__[0])
    found = {path.name.partition(".")[0] for path in folder.glob("vtk*") if path.suffix in {".so", ".pyd"}}
    scripts = (path for part in ("numpy_interface", "util") for path in folder.glob(f"{part}/*.py"))
    names = [*filter(_VTK.fullmatch, found), *(f"{path.parent.name}.{path.stem}" for path in scripts)]
    return [f"vtkmodules.{name}" for name in sorted(names)]


def is_left_out(place: str, source: str) -> bool:
    """True of a library or plugin without a use in the program.

    On Linux the libraries of the system stay with the system, which keeps them up to date; a package depends
    on them.

    Parameters
    ----------
    place : str
        Path in the program.
    source : str
        Path on this machine.
    """
    if _DEVICES.search(place) or _DEVICE_LIBRARIES.match(Path(place).name):
        return True
    system = sys.platform == "linux" and Path(source).resolve().is_relative_to("/usr/lib")
    return system or place.startswith("imageio_ffmpeg/binaries")


def build_name() -> str:
    """Name of this build's cached kernels: the same sources and compiler, the same name."""
    told = hashlib.sha256(sys.version.encode())
    for name in ("numba", "llvmlite", "numpy"):
        told.update(importlib.metadata.version(name).encode())
    for path in sorted(PACKAGE.rglob("*.py")):
        told.update(path.read_bytes())
    return told.hexdigest()[:12]
