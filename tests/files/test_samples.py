"""What travels with the program is found in a checkout and in an installed package."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from apd_viewer.files import samples
from apd_viewer.files.samples import SAMPLES, open_sample, resource_path

CHECKOUT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["bottle.obj", "bottle-twist-60.def", "window.qss", "icons/apd-viewer.svg"])
def test_resource_path_finds_what_is_in_a_checkout(name):
    assert resource_path(name) == CHECKOUT / "resources" / name
    assert resource_path(name).is_file()


def test_resource_path_finds_what_is_in_an_installed_package(tmp_path, monkeypatch):
    package = tmp_path / "site-packages" / "apd_viewer"
    (package / "files").mkdir(parents=True)
    (package / "resources").mkdir()
    (tmp_path / "site-packages" / "resources").mkdir()  # another package's
    monkeypatch.setattr(samples, "__file__", str(package / "files" / "samples.py"))
    assert resource_path.__wrapped__("bottle.obj") == package / "resources" / "bottle.obj"


def test_resource_path_looks_where_the_wheel_puts_resources():
    project = (CHECKOUT / "pyproject.toml").read_text(encoding="utf-8")
    included = project.partition("[tool.hatch.build.targets.wheel.force-include]")[2].partition("\n[")[0]
    assert re.findall(r'(?m)^"(.*)" = "(.*)"', included) == [("resources", "apd_viewer/resources")]


@pytest.mark.parametrize("name", SAMPLES)
def test_open_sample_gives_a_sample_with_its_labels(name):
    mesh, labels = open_sample(name)
    other = trimesh.load(resource_path(f"{name}.obj"), process=False, maintain_order=True)
    np.testing.assert_array_equal(mesh.F, other.faces)
    np.testing.assert_allclose(mesh.V, other.vertices)
    np.testing.assert_array_equal(labels, np.loadtxt(resource_path(f"{name}.sel")))
    assert len(labels) == len(mesh.V)
    assert mesh.name == f"{name}.obj"
