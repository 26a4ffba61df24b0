"""The self-contained program: its contents are complete, and its entry point stands in for Python.

resources/installer/prove.sh installs its package into a bare Debian, which takes minutes and root.
"""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import apd_viewer
from apd_viewer import installation
from apd_viewer.cases import cluster
from apd_viewer.commands.desktop import desktop_command
from apd_viewer.errors import InputError
from apd_viewer.figures import films
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS
from apd_viewer.files.meshes import MESH_FORMATS
from apd_viewer.files.samples import SAMPLES
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.processes.child_process import START_SCRIPT

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "resources" / "installer"
LAUNCH = FOLDER / "launch.py"
SPEC = (FOLDER / "apd-viewer.spec").read_text(encoding="utf-8")


@pytest.fixture
def contents(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import contents

    yield contents
    sys.modules.pop("contents", None)


def test_installer_spec_names_files_and_functions_that_are_there(contents):
    used = set(re.findall(r"\bcontents\.(\w+)", SPEC))
    assert {"modules", "data", "vtk_modules"} <= used
    assert [name for name in used if not hasattr(contents, name)] == []
    assert re.findall(r'SPECPATH\) / "(.*?)"', SPEC) == ["launch.py"]


def test_installer_puts_all_modules_and_data_of_the_package_into_the_program(contents):
    assert {"apd_viewer", "apd_viewer.__main__", "apd_viewer.session.processes.solver_main"} <= set(
        contents.modules()
    )
    packed = {f"{folder}/{Path(path).name}" for path, folder in contents.data()}
    tracked = subprocess.check_output(["git", "ls-files", "apd_viewer"], cwd=ROOT, text=True).split()
    left_out = (".py", ".po", ".pot")
    assert [path for path in tracked if not path.endswith(left_out) and path not in packed] == []
    needed = [f"{name}.{kind}" for name in SAMPLES for kind in ("obj", "sel")] + ["window.qss"]
    needed += [f"icons/{path.name}" for path in (ROOT / "resources" / "icons").iterdir()]
    assert [name for name in needed if f"apd_viewer/resources/{name}" not in packed] == []


def test_installer_packs_a_manual_that_has_been_built(contents, tmp_path, monkeypatch):
    (tmp_path / "howto").mkdir()
    (tmp_path / "howto" / "open.html").write_text("")
    monkeypatch.setattr(contents, "MANUAL", tmp_path)
    assert (str(tmp_path / "howto" / "open.html"), "apd_viewer/manual/howto") in contents.data()


def test_installer_leaves_out_no_module_of_ours(contents):
    """A library that the sources import cannot be one that is never used; Dask is refused with a sentence."""
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "apd_viewer").rglob("*.py"))
    imported = set(re.findall(r"(?m)^\s*(?:from|import) ([\w.]+)", sources))
    optional = {"distributed", "dask", "pyarrow"}
    assert imported & set(contents.UNUSED) <= optional


def test_installer_knows_all_formats(contents):
    assert {f".{name}" for name in contents.MESHES} == set(MESH_FORMATS)
    assert [f".{name}" for name in contents.SESSIONS] == [SESSION_SUFFIX]
    assert set(WRITABLE_FORMATS) <= set(MESH_FORMATS)
    listed = re.findall(r'Subkey: "Software\\Classes\\\.(\w+)', contents.windows_script())
    assert listed == [*contents.SESSIONS, *contents.MESHES]


def test_installer_describes_libraries_that_are_installed(contents):
    assert contents.version() == apd_viewer.__version__
    read = set(
        re.findall(
            r'version\("([\w-]+)"\)',
            "".join(path.read_text(encoding="utf-8") for path in (ROOT / "apd_viewer").rglob("*.py")),
        )
    )
    assert read <= set(contents.DESCRIBED)
    assert len(contents.build_name()) == 12


def test_installer_launch_recognizes_workers_of_multiprocessing_first():
    (main,) = (node for node in ast.parse(LAUNCH.read_text()).body if getattr(node, "name", "") == "main")
    first = next(node for node in main.body if not isinstance(getattr(node, "value", None), ast.Constant))
    assert ast.unparse(first) == "multiprocessing.freeze_support()"


def test_installer_program_has_every_way_in_which_a_process_is_started():
    """It understands `-c`, and neither `-m` nor a script."""
    for path in (ROOT / "apd_viewer").rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.List | ast.Tuple) and node.elts:
                words = [ast.unparse(each) for each in node.elts]
                if words[0] == "sys.executable" and "'-c'" not in words[1:2]:
                    # The command for menus, which a packaged program refuses before.
                    assert path.name == "desktop_command.py", (path, words)
    assert "-m" not in START_SCRIPT


@pytest.fixture
def launched(tmp_path):
    """Run the entry point as the packed program does, with a home of its own."""
    (tmp_path / "build").write_text("abc")

    def launched(*words, **environment):
        run = f"import runpy, sys; sys._MEIPASS = {str(tmp_path)!r}; sys.argv = sys.argv[1:]\n"
        run += f"runpy.run_path({str(LAUNCH)!r}, run_name='__main__')"
        variables = {**os.environ, "HOME": str(tmp_path), "PYTHONPATH": str(ROOT), **environment}
        variables.pop("XDG_CACHE_HOME", None)
        return subprocess.run(
            [sys.executable, "-c", run, "apd-viewer", *words], env=variables, capture_output=True, text=True
        )

    return launched


def test_installer_launch_runs_code_as_python_does(launched):
    done = launched("-c", "import sys; print(__name__, sys.argv[1:]); sys.exit(3)", "a", "-c")
    assert (done.stdout, done.returncode) == ("__main__ ['a', '-c']\n", 3), done.stderr


def test_installer_launch_runs_the_command_line(launched):
    assert launched("--version").stdout.startswith("apd-viewer ")
    assert launched("info", "missing.obj").returncode == 2


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have other folders and variables")
def test_installer_launch_takes_caches_of_the_user_and_variables_of_the_system(launched, tmp_path):
    caches = tmp_path / ".cache" / "apd-viewer"
    old, other = caches / "kernels-old", caches / "apd-viewer-manual.html"
    old.mkdir(parents=True)
    other.touch()
    names = "NUMBA_CACHE_DIR", "MPLCONFIGDIR", "LD_LIBRARY_PATH", "QT_PLUGIN_PATH"
    said = launched(
        *("-c", f"import os; print([os.environ.get(name) for name in {names}])"),
        LD_LIBRARY_PATH="/inside",
        LD_LIBRARY_PATH_ORIG="/before",
        QT_PLUGIN_PATH="/inside",
    )
    assert ast.literal_eval(said.stdout) == [
        str(caches / "kernels-abc"),
        str(caches / "matplotlib"),
        "/before",
        None,
    ]
    assert not old.exists()
    assert other.exists()
    assert not (caches / "kernels-abc").exists(), "no kernel was needed"


KERNEL = """
from apd_viewer.geometry.linalg.kernels import njit


@njit(cache=True)
def twice(number):
    return 2 * number
"""


@pytest.mark.night
def test_kernel_cache_does_not_compile_kernels_again_that_the_program_brings(tmp_path):
    """Compiled in one place, packed, and found in another, where they are only read."""
    packed, program, cache, home = (tmp_path / name for name in ("packed", "program", "cache", "home"))
    for place in (packed, program):
        (place / "apd_viewer" / "inner").mkdir(parents=True)
        (place / "apd_viewer" / "inner" / "module.py").write_text(KERNEL)

    def hits(place, folder, *prepare):
        code = [
            "import sys",
            "from apd_viewer import installation",
            *prepare,
            f"sys.path.insert(0, {str(place / 'apd_viewer' / 'inner')!r})",
            "from module import twice",
            "twice(21); print(len(twice.stats.cache_hits))",
        ]
        variables = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
        return int(subprocess.check_output([sys.executable, "-c", "\n".join(code)], env=variables, text=True))

    assert hits(packed, cache) == 0
    brought = program / "kernels" / "apd_viewer" / "inner"
    shutil.copytree(cache / installation.cache_name(packed / "apd_viewer" / "inner"), brought)
    moved = f"installation.__file__ = {str(program / 'apd_viewer' / 'installation.py')!r}"
    assert hits(program, home, moved, "sys.frozen = True") == 1
    assert not home.exists(), "nothing is copied"
    assert hits(program, home, moved) == 0, "this is no packaged program"


def test_installer_program_says_what_it_cannot_do(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match="Dask is missing here"):
        cluster.connect_cluster("tcp://127.0.0.1:9", None)

    def none():
        raise RuntimeError

    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", SimpleNamespace(get_ffmpeg_exe=none))
    with pytest.raises(InputError, match="install ffmpeg"):
        films.check_film(tmp_path / "film.mp4")
    monkeypatch.setattr(sys, "platform", "linux")
    options = desktop_command.desktop_parser().parse_args(["--install"])
    with pytest.raises(InputError, match="has added menu entry"):
        options.run(options)
