"""The rooms import in one direction and without circles; only the window's room knows Qt and VTK."""

import ast
import re
import subprocess
import sys
import textwrap
from functools import cache
from pathlib import Path

import pytest
from structure import called

import apd_viewer

ROOT = Path(__file__).parents[1]
PACKAGE = "apd_viewer"

# Places of each room. It may import those below it, and none above: so there is no circle of rooms either.
ROOMS = {
    "__main__": ("__init__.py", "__main__.py", "api.py"),
    "commands": ("commands",),
    "figures": ("figures",),
    "ui": ("ui",),
    "presentation": ("presentation",),
    "cases": ("cases",),
    "verification": ("verification",),
    "session": ("session",),
    "files": ("files",),
    "geometry, what moves": (
        *("geometry/__init__.py", "geometry/processor.py", "geometry/warmup.py"),
        *("geometry/solver", "geometry/goals", "geometry/contact", "geometry/energy"),
    ),
    "geometry, what is true": (
        *("geometry/measuring", "geometry/analysis", "geometry/picking", "geometry/pose"),
        *("geometry/mesh", "geometry/linalg", "geometry/signals"),
    ),
    "log": ("log.py",),
    "language": ("installation.py", "language.py", "notation.py", "errors.py"),
}
LEVEL = {place: level for level, places in enumerate(ROOMS.values()) for place in places}
MOST_LINES = 500
SCREEN = {"PySide6", "pyvista", "pyvistaqt", "vtk", "vtkmodules", "qtpy"}
LIBRARIES = {
    "__main__": set(),
    "commands": {"numpy"},
    "figures": {"numpy", "matplotlib", "PIL", "imageio_ffmpeg", "pyvista"},
    "ui": SCREEN | {"numpy"},
    "presentation": {"numpy", "anywidget"},
    "cases": {"numpy", "scipy", "distributed", "pyarrow", "threadpoolctl"},
    "verification": {"numpy", "scipy"},
    "session": {"numpy"},
    "files": {"numpy", "trimesh", "PIL", "vtkmodules", "cascadio", "mmgpy", "pxr"},
    "geometry, what moves": {"numpy", "scipy", "numba", "llvmlite"},
    "geometry, what is true": {
        *("numpy", "scipy", "numba", "threadpoolctl", "llvmlite", "cholespy", "fast_simplification"),
        *("ipctk", "potpourri3d"),
    },
    "log": {"platformdirs"},
    "language": {"platformdirs"},
}
# Libraries that only the named files may touch.
DRAWS = {
    "figures/drawing.py",
    "ui/scene/scene_picture.py",
    "ui/scene/ghost.py",
    "ui/obstacles/obstacle_scene.py",
    "ui/scene/ground.py",
    "ui/scene/surface_shading.py",
    "ui/scene/surface.py",
    "ui/scene/viewport.py",
    "ui/scene/camera_controller.py",
}
CONFINED = {
    "cholespy": {"geometry/linalg/linear_solver.py"},
    "PIL": {"figures/films.py", "files/formats/texture_images.py", "files/picture_files.py"},
    "imageio_ffmpeg": {"figures/films.py"},
    "fast_simplification": {"geometry/mesh/decimation.py"},
    "ipctk": {"geometry/analysis/self_intersections.py"},
    "potpourri3d": {"geometry/measuring/geodesics.py"},
    "pyvista": DRAWS,
    "pyvistaqt": DRAWS,
    "vtk": DRAWS,
    "vtkmodules": DRAWS | {"files/animations/paraview_series.py"},  # which writes without a picture
    "distributed": {"cases/cluster.py"},
    "pyarrow": {"cases/results.py"},
    "threadpoolctl": {"geometry/linalg/threads.py", "cases/case_worker.py"},
    "anywidget": {"presentation/live_view.py"},
    "cascadio": {"files/formats/cad.py"},
    "mmgpy": {"files/formats/cad.py"},
    "qtpy": set(),  # the binding that pyvistaqt chooses is its own affair
}
MEANINGLESS = {"utils", "util", "common", "helpers", "helper", "manager", "base", "misc", "core"}


def modules(root):
    """Every module of the package under ``root``: its dotted name and its path."""
    return {
        ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
        for path in sorted((root / PACKAGE).rglob("*.py"))
    }


@cache
def nodes(path):
    """The nodes of a file's syntax tree that may import something."""
    found = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return [node for node in found if isinstance(node, ast.Import | ast.ImportFrom | ast.Call)]


def imports(name, path, known):
    """Dotted names that a module imports, at any indentation; submodules before names in modules."""
    found = set()
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in nodes(path):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
            module = ".".join([*start, *([node.module] if node.module else [])])
            dotted = {f"{module}.{alias.name}" for alias in node.names}
            found |= {d if d in known else module for d in dotted}
        elif isinstance(node, ast.Call) and called(node) in ("__import__", "import_module"):
            found.add("an import that hides in a call")
    return found


def level(where):
    """The number of a file's room, from the top; None outside all rooms."""
    parts = where.split("/")
    places = ("/".join(parts[:count]) for count in range(len(parts), 0, -1))
    return next((LEVEL[place] for place in places if place in LEVEL), None)


def circles(edges):
    """Modules from which a walk along the imports leads back to themselves."""
    found = set()
    for start in edges:
        reached, todo = set(), list(edges[start])
        while todo:
            name = todo.pop()
            if name not in reached:
                reached.add(name)
                todo += edges.get(name, ())
        if start in reached:
            found.add(start)
    return found


def violations(root):
    """What is against the rules in the package under ``root``, a line each."""
    known, said, edges = modules(root), [], {}
    places = {name: path.relative_to(root / PACKAGE).as_posix() for name, path in known.items()}
    for name, path in known.items():
        here, where = places[name], level(places[name])
        if where is None:
            said.append(f"{here}: is in no room")
            continue
        edges[name] = set()
        for target in imports(name, path, known):
            library = target.partition(".")[0]
            if library == PACKAGE:
                edges[name].add(target)
                if target not in known:
                    said.append(f"{here}: there is no {target}")
                elif level(places[target]) is not None and level(places[target]) < where:
                    said.append(f"{here}: imports {target}, against the direction")
            elif not allowed(library, where):
                said.append(f"{here}: imports {library}")
            elif here not in CONFINED.get(library, {here}):
                said.append(f"{here}: imports {library}, which others do")
        if path.stem in MEANINGLESS:
            said.append(f"{here}: says nothing by its name")
        if len(path.read_text(encoding="utf-8").splitlines()) > MOST_LINES:
            said.append(f"{here}: is too long")
    return said + [f"{name} imports itself in a circle" for name in sorted(circles(edges))]


def allowed(library, where):
    """Whether modules of the room at a level may import a library."""
    own = list(LIBRARIES.values())[where]
    return library in own | sys.stdlib_module_names | {"__future__"}


def test_architecture_rules_are_kept_by_the_program():
    assert violations(ROOT) == []


# The window has a core, features above it, and a frame of panel, menus and help that puts them together.
CORE = {"widgets", "preferences", "scene", "tools", "filing", "overlays", "plots"}
FEATURES = {
    *("measuring", "posing", "target", "obstacles", "compare", "sharing"),
    *("simulate", "studies", "settings_page"),
}
# Features that another one knows: the ends of a range are shown as ghosts.
NEIGHBOURS = {"studies": {"posing"}, "compare": {"obstacles"}}


def test_architecture_lets_a_feature_of_the_window_know_only_the_core():
    known = modules(ROOT)
    folders = {name: name.split(".")[2] for name in known if name.count(".") > 2 and ".ui." in name}
    assert set(folders.values()) >= CORE | FEATURES, "the test is blind"
    layers = dict.fromkeys(CORE, CORE) | {one: CORE | NEIGHBOURS.get(one, set()) | {one} for one in FEATURES}
    against = [
        f"{name} imports {target}"
        for name, folder in folders.items()
        for target in imports(name, known[name], known)
        if folder in layers and folders.get(target, folder) not in layers[folder]
    ]
    assert against == []


def test_architecture_rules_look_at_the_whole_program():
    """An empty tree would keep all rules too."""
    known = modules(ROOT)
    levels = {level(path.relative_to(ROOT / PACKAGE).as_posix()) for path in known.values()}
    assert levels == set(range(len(ROOMS)))
    assert len(ROOMS) <= 14
    assert list(LIBRARIES) == list(ROOMS)
    targets = {target for name, path in known.items() for target in imports(name, path, known)}
    assert set(CONFINED) - {"qtpy", "vtk"} <= {target.partition(".")[0] for target in targets}
    # Each room is imported by another, within functions and for type checking too.
    assert {
        f"{PACKAGE}.ui.application",
        f"{PACKAGE}.geometry.solver.deformation",
        f"{PACKAGE}.session.session",
    } <= targets


GOOD = {
    "__init__.py": "from apd_viewer.files.reading import read\ndef view():\n  import apd_viewer.ui.window\n",
    "__main__.py": "import apd_viewer, json\n",
    "errors.py": "",
    "geometry/__init__.py": "",
    "geometry/mesh/__init__.py": "",
    "geometry/linalg/__init__.py": "",
    "geometry/mesh/shape.py": "import numpy as np\nfrom ...errors import E\n",
    "geometry/mesh/edges.py": "from . import shape\n",
    "geometry/solver/__init__.py": "",
    "geometry/solver/descent.py": "from ..mesh import shape\ndef step(): ...\n",
    "geometry/linalg/linear_solver.py": "import cholespy\nimport numpy\n",
    "files/__init__.py": "",
    "files/reading.py": "def read():\n    import trimesh\n    from apd_viewer.geometry.mesh import shape\n",
    "session/__init__.py": "",
    "session/session.py": "import threading\nfrom apd_viewer.files.reading import read\n",
    "ui/__init__.py": "",
    "ui/scene/__init__.py": "",
    "ui/window.py": "from PySide6.QtCore import Qt\nfrom apd_viewer.session import session\n",
    "ui/scene/viewport.py": "import pyvista\n",
}
BAD = {
    "a room imports back": (
        "geometry/mesh/shape.py",
        "import apd_viewer.files.reading",
        "against the direction",
    ),
    "from its package": (
        "geometry/mesh/shape.py",
        "from apd_viewer.files import reading",
        "against the direction",
    ),
    "relatively": ("files/reading.py", "from ..session import session", "against the direction"),
    "two levels up": ("files/reading.py", "from .. import ui", "against the direction"),
    "in a function": (
        "session/session.py",
        "def f():\n  import apd_viewer.ui.window",
        "against the direction",
    ),
    "for types": (
        "files/reading.py",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n  from apd_viewer.session.session import S",
        "against the direction",
    ),
    "the top from a room": ("files/reading.py", "import apd_viewer", "against the direction"),
    "errors know a room": (
        "errors.py",
        "from apd_viewer.geometry.mesh import shape",
        "against the direction",
    ),
    "a circle": (
        "geometry/mesh/shape.py",
        "def f():\n  from apd_viewer.geometry.mesh.edges import g",
        "geometry.mesh.shape imports itself in a circle",
    ),
    "itself": ("ui/window.py", "from . import window", "ui.window imports itself in a circle"),
    "Qt in the session": ("session/session.py", "from PySide6.QtCore import QObject", "imports PySide6"),
    "VTK in the files": ("files/reading.py", "def f():\n  import vtkmodules.all", "imports vtkmodules"),
    "pyvista at the top": ("__main__.py", "import pyvista as pv", "imports pyvista"),
    "VTK in a panel": ("ui/window.py", "import vtkmodules.vtkRenderingCore", "which others do"),
    "a second solver": ("geometry/mesh/shape.py", "from cholespy import CholeskySolverD", "which others do"),
    "trimesh in geometry": ("geometry/mesh/shape.py", "import trimesh.creation", "imports trimesh"),
    "a new library": ("ui/window.py", "import matplotlib", "imports matplotlib"),
    "hidden": ("files/reading.py", "import importlib\nimportlib.import_module('PySide6')", "hides in a call"),
    "a name that says nothing": ("files/utils.py", "", "says nothing by its name"),
    "a new room": ("plugins/registry.py", "", "is in no room"),
    "half a room imports the other": (
        "geometry/mesh/shape.py",
        "from apd_viewer.geometry.solver.descent import step",
        "against the direction",
    ),
    "a folder in neither half": ("geometry/gadgets/knob.py", "", "is in no room"),
    "a long file": ("ui/window.py", "\n" * MOST_LINES, "is too long"),
}


def build(root, tree):
    for name, content in tree.items():
        path = root / PACKAGE / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)


def test_architecture_rules_accept_a_tree_that_keeps_them(tmp_path):
    build(tmp_path, GOOD)
    assert violations(tmp_path) == []


@pytest.mark.parametrize("case", BAD)
def test_architecture_rules_notice_a_violation(case, tmp_path):
    where, source, words = BAD[case]
    build(tmp_path, GOOD | {where: GOOD.get(where, "") + source + "\n"})
    said = violations(tmp_path)
    assert said
    assert all(words in line or "imports itself in a circle" in line for line in said), said
    assert any(words in line for line in said)


def test_architecture_lets_links_in_a_circle_raise_no_error_of_python_s():
    """Path.resolve does, before Python 3.13; only the program's own place is known to be none."""
    source = {path: path.read_text(encoding="utf-8") for path in modules(ROOT).values()}
    assert [path for path, text in source.items() if re.search(r"(?<!__file__\))\.resolve\(", text)] == []


def test_architecture_has_every_kernel_kept_by_the_program_s_own_cache():
    """Numba's ends the program where a file is damaged or none can be written."""
    own = ROOT / PACKAGE / "geometry" / "linalg" / "kernels.py"
    source = {path: path.read_text(encoding="utf-8") for path in modules(ROOT).values()}
    users = [
        path for path, text in source.items() if re.search(r"from numba import.*jit|numba\.n?jit\(", text)
    ]
    assert users == [own]


HEADLESS = """
    import sys
    from pathlib import Path
    import apd_viewer
    import apd_viewer.__main__
    import apd_viewer.session.session

    def screen():
        return sorted({name.partition(".")[0] for name in sys.modules} & set(sys.argv[2:]))

    assert not screen(), f"importing loads {screen()}"
    folder = Path(sys.argv[1])
    V = [[x, y, z] for z in (0, 1, 2) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = [(a + k, b + k, c + k) for k in (0, 4) for i in range(4)
             for a, b, c in ((i, (i + 1) % 4, i + 4), ((i + 1) % 4, (i + 1) % 4 + 4, i + 4))]
    text = "".join("v {} {} {}\\n".format(*v) for v in V)
    text += "".join("f {} {} {}\\n".format(*(i + 1 for i in f)) for f in faces)
    (folder / "a.obj").write_text(text)
    mesh = apd_viewer.open_mesh(folder / "a.obj")
    fixed = [0, 1, 2, 3, 8, 9, 10, 11]
    result = apd_viewer.deform(mesh.V, mesh.F, fixed, mesh.V[fixed] * 1.1, handle=fixed[4:], iterations=2)
    for suffix in ("obj", "ply", "stl", "off", "glb"):
        apd_viewer.save_mesh(mesh, result.U, folder / f"out.{suffix}")
        apd_viewer.open_mesh(folder / f"out.{suffix}")
    assert apd_viewer.__main__.main(["info", str(folder / "a.obj")]) == 0
    from apd_viewer.session.model.state import initial_state
    from apd_viewer.session.model.view import View
    from apd_viewer.session.storage.session_file import save_session
    save_session(folder / "a.apd", initial_state(mesh, mesh.V[:, 2].astype("uint8")), View())
    words = "replay", folder / "a.apd", "-o", folder / "again.obj"
    assert apd_viewer.__main__.main([str(word) for word in words]) == 0
    assert not screen(), f"working loads {screen()}"
    import apd_viewer.ui.application
    assert screen() == ["PySide6"], "the test is blind"
"""


def test_architecture_loads_no_qt_or_vtk_by_importing_or_working_without_a_window(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(HEADLESS), str(tmp_path), *sorted(SCREEN)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""


FIRST_PICTURE = """
import sys
import apd_viewer.__main__
print(*sys.modules)
import apd_viewer.ui.application
import apd_viewer.ui.shell
print(*sys.modules)
"""
COMMANDS = """
import sys
import apd_viewer.commands.parsers
print(*sys.modules)
"""


def test_architecture_lets_commands_begin_without_libraries_that_draw():
    """Each command loads the parsers of all, and a drawing library takes a quarter of a second."""
    words = [sys.executable, "-c", COMMANDS]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True, timeout=60)
    libraries = {name.partition(".")[0] for name in done.stdout.split()}
    assert "argparse" in libraries, "the test is blind"
    assert libraries & {"matplotlib", "PIL", "PySide6", "pyvista", "trimesh", "vtkmodules"} == set()


@pytest.fixture(scope="module")
def loaded():
    """The modules that the command line loads to read its words, and then those of a first picture."""
    done = subprocess.run(
        [sys.executable, "-c", FIRST_PICTURE],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return [set(line.split()) for line in done.stdout.splitlines()]


def test_architecture_lets_a_first_picture_wait_for_nothing_that_only_work_needs(loaded):
    words, picture = loaded
    assert "numpy" not in words
    libraries = {name.partition(".")[0] for name in picture}
    assert "pyvistaqt" in libraries, "the test is blind"
    assert libraries & {"numba", "llvmlite", "scipy", "cholespy", "trimesh", "ipctk"} == set()


def test_package_names_are_there_before_they_are_imported():
    assert "Deformation" in dir(apd_viewer)
    assert apd_viewer.Deformation.__name__ == "Deformation"
    assert not hasattr(apd_viewer, "nonsense")


# Each would load much for a type that is seldom needed: the API, the solver for a mesh check.
TYPES_ALONE = {"apd_viewer", "apd_viewer.files.report"}


def test_architecture_imports_for_types_alone_only_where_the_first_picture_waits(loaded):
    alone = {
        name for name, path in modules(ROOT).items() if "\nif TYPE_CHECKING:\n" in path.read_text("utf-8")
    }
    assert len(alone) > 10, "the test is blind"
    assert alone - (loaded[1] - TYPES_ALONE) == TYPES_ALONE
