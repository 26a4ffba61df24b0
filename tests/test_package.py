"""What the package promises to scripts: names, parameters, fields, the version and the command."""

import dataclasses
import inspect
import re
import shutil
import subprocess
import sys
import zipfile
from importlib.metadata import entry_points, version
from pathlib import Path

import numpy as np
import packaging.tags
import pytest
import trimesh
from meshes import box, ends

import apd_viewer

ROOT = Path(__file__).parents[1]


def test_package_has_one_version():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    stated = re.findall(r'(?m)^version = "(.*)"', project)
    assert stated == [apd_viewer.__version__]
    assert version("apd-viewer") == apd_viewer.__version__


def test_main_is_the_function_of_the_command():
    from apd_viewer.__main__ import main

    (script,) = entry_points(group="console_scripts", name="apd-viewer")
    assert script.load() is main


def test_package_has_all_its_names():
    assert {"open_mesh", "deform", "Deformation", "save_mesh", "view", "InputError"} <= set(
        apd_viewer.__all__
    )
    assert all(hasattr(apd_viewer, name) for name in apd_viewer.__all__)
    assert len(set(apd_viewer.__all__)) == len(apd_viewer.__all__)


@pytest.mark.parametrize(
    ("function", "positional", "named"),
    [
        (apd_viewer.open_mesh, ["path"], []),
        (apd_viewer.save_mesh, ["mesh", "U", "path"], []),
        (apd_viewer.deform, ["V", "F", "fixed", "targets"], ["method", "iterations", "tolerance", "handle"]),
        (apd_viewer.Deformation, ["V", "F", "fixed"], ["method", "handle", "tolerance"]),
        (apd_viewer.Deformation.aim, ["self", "targets"], []),
        (apd_viewer.Deformation.step, ["self"], []),
        (apd_viewer.view, ["mesh"], []),
    ],
    ids=lambda value: getattr(value, "__qualname__", ""),
)
def test_package_has_the_promised_parameters(function, positional, named):
    parameters = inspect.signature(function).parameters
    assert list(parameters)[: len(positional)] == positional
    for name in positional:
        assert parameters[name].kind is inspect.Parameter.POSITIONAL_OR_KEYWORD
    assert set(named) <= set(parameters)
    # A call with the promised arguments alone is enough.
    assert all(p.default is not p.empty for name, p in parameters.items() if name not in positional)


def test_deform_has_the_promised_defaults():
    parameters = inspect.signature(apd_viewer.deform).parameters
    assert parameters["tolerance"].default == 1e-3
    assert parameters["iterations"].default is None


def test_result_has_the_promised_fields():
    fields = {field.name for field in dataclasses.fields(apd_viewer.Result)}
    assert fields >= {"U", "area", "area_error", "energy", "iterations", "converged", "warnings"}


def test_input_error_is_a_value_error():
    assert issubclass(apd_viewer.InputError, ValueError)


def test_package_does_what_the_example_of_the_interfaces_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    V, F = box(1, 1, 4)
    trimesh.Trimesh(V, F, process=False).export("bar.off")

    mesh = apd_viewer.open_mesh("bar.off")
    np.testing.assert_array_equal(mesh.V, V)
    np.testing.assert_array_equal(mesh.F, F)
    base, handle = ends(mesh.V)
    fixed = np.concatenate([base, handle])
    targets = mesh.V[fixed] + np.where(np.isin(fixed, handle)[:, None], [0.5, 0, 0], 0)

    result = apd_viewer.deform(
        mesh.V, mesh.F, fixed, targets, method="arap", iterations=None, tolerance=1e-3, handle=handle
    )
    assert isinstance(result, apd_viewer.Result)
    assert result.U.shape == V.shape
    assert result.converged is True
    assert isinstance(result.iterations, int)
    assert result.iterations >= 1
    assert result.area == pytest.approx(trimesh.Trimesh(result.U, F, process=False).area)
    assert result.area_error == pytest.approx(result.area / trimesh.Trimesh(V, F).area - 1, abs=1e-12)
    assert result.energy > 0
    assert tuple(result.warnings) == ()

    solver = apd_viewer.Deformation(mesh.V, mesh.F, fixed, method="arap", contact=True)
    solver.aim(targets)
    for _ in range(result.iterations):
        frame = solver.step()
    assert isinstance(frame, apd_viewer.Frame)
    np.testing.assert_array_equal(frame.U, result.U)

    apd_viewer.save_mesh(mesh, result.U, "out.off")
    np.testing.assert_allclose(apd_viewer.open_mesh("out.off").V, result.U, rtol=0, atol=1e-13)


def test_mesh_or_path_takes_an_animation_for_the_window(tmp_path):
    from apd_viewer.ui.application import mesh_or_path

    (tmp_path / "a.pvd").write_text("<VTKFile/>")
    assert mesh_or_path(tmp_path / "a.pvd") == tmp_path / "a.pvd"
    with pytest.raises(apd_viewer.InputError, match="refers to other files"):
        apd_viewer.open_mesh(tmp_path / "a.pvd")


def test_mesh_or_path_takes_meshes_of_other_libraries_for_the_window():
    import pyvista

    from apd_viewer.ui.application import mesh_or_path

    V, F = box(1, 1, 1)
    for other in (
        trimesh.Trimesh(V, F, process=False),
        pyvista.PolyData.from_regular_faces(V, F),
        apd_viewer.Mesh(V, F),
    ):
        mesh = mesh_or_path(other)
        assert isinstance(mesh, apd_viewer.Mesh)
        np.testing.assert_array_equal(mesh.V, V)
        np.testing.assert_array_equal(mesh.F, F)
    with pytest.raises(apd_viewer.InputError, match="A dict cannot be shown"):
        mesh_or_path({})
    with pytest.raises(apd_viewer.InputError, match="There is no file"):
        mesh_or_path("gone.obj")


@pytest.fixture
def wheel(tmp_path):
    """Build a wheel by the project's own settings, from a folder with little else in it."""
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path)
    for folder in ("apd_viewer", "resources", "docs"):
        (tmp_path / folder).mkdir()
    (tmp_path / "apd_viewer" / "__init__.py").touch()

    def wheel(built):
        for name in built:
            place = tmp_path / "build" / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(name, encoding="utf-8")
        command = [
            sys.executable,
            "-c",
            "from hatchling.build import build_wheel; print(build_wheel('dist'))",
        ]
        done = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
        return tmp_path / "dist" / done.stdout.split()[-1]

    return wheel


@pytest.mark.parametrize("pages", [("index.html", "reference/keys.html", "_static/site.css"), ()], ids=len)
def test_package_takes_the_manual_along_in_its_wheel_where_it_is_built(wheel, pages):
    built = [f"docs/{page}" for page in (*pages, *(["_static/site.css.map", ".buildinfo"] if pages else []))]
    path = wheel(built)
    assert path.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(path) as archive:
        inside = [name for name in archive.namelist() if name.startswith("apd_viewer/manual/")]
        assert sorted(inside) == sorted(f"apd_viewer/manual/{page}" for page in pages)
        assert all(archive.read(name).decode() == f"docs/{name.split('/', 2)[2]}" for name in inside)


def test_package_takes_the_completions_of_shells_along_in_its_wheel(wheel):
    with zipfile.ZipFile(wheel(["completions/bash", "completions/zsh", "completions/fish"])) as archive:
        inside = {name.partition(".data/data/")[2] for name in archive.namelist() if ".data/" in name}
    assert inside == {
        "share/bash-completion/completions/apd-viewer",
        "share/zsh/site-functions/_apd-viewer",
        "share/fish/vendor_completions.d/apd-viewer.fish",
    }


def test_package_with_kernels_has_a_wheel_of_this_system(wheel):
    compiled = [
        f"kernels/apd_viewer/geometry/{name}" for name in ("a-1.py311.nbi", "b/c-2.py311.1.nbc", "d.tmp")
    ]
    path = wheel(compiled)
    tag = path.stem.rpartition("-")[2]
    assert tag != "any"
    assert tag in {each.platform for each in packaging.tags.sys_tags()}
    with zipfile.ZipFile(path) as archive:
        inside = [name for name in archive.namelist() if "__pycache__" in name]
    assert inside == [
        "apd_viewer/geometry/__pycache__/a-1.py311.nbi",
        "apd_viewer/geometry/b/__pycache__/c-2.py311.1.nbc",
    ]
