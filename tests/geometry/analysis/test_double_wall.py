"""Double-walled vessels are recognised, by closed forms; what is solid, flat or single-walled is not."""

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.geometry.analysis import double_wall
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.mesh import Mesh

SIDES = 64
PRISM = 0.5 * SIDES * np.sin(2 * np.pi / SIDES)  # area of the regular polygon in a circle of radius 1


def turned(profile, around=SIDES):
    """Closed surface of a profile (k, 2) of radius and height, from axis to axis or closed in itself."""
    closed = profile[0][0] > 0.0
    angle = 2 * np.pi / around * np.arange(around)
    V = np.array([[r * np.cos(a), r * np.sin(a), z] for r, z in profile for a in angle])
    rings, k = len(profile), np.arange(around)
    F = []
    for i in range(rings if closed else rings - 1):
        a, b = around * i + k, around * ((i + 1) % rings) + k
        c, d = around * i + (k + 1) % around, around * ((i + 1) % rings) + (k + 1) % around
        F += [np.column_stack([a, c, d]), np.column_stack([a, d, b])]
    return Mesh(V, np.vstack(F))


def line(a, b, steps):
    return [tuple(x) for x in np.linspace(a, b, steps + 1)[:-1]]


def cup(radius, height, wall, rim=1, steps=20):
    """Cup with a wall; its rim is flat, or rounded in so many steps."""
    inner = radius - wall
    bow = [
        (radius - 0.5 * wall * (1 - np.cos(t)), height + 0.5 * wall * np.sin(t))
        for t in np.linspace(0, np.pi, rim + 1)
    ]
    return turned(
        line((0, 0), (radius, 0), 8)
        + line((radius, 0), (radius, height), steps)
        + (bow if rim > 1 else [(radius, height), (inner, height)])
        + line((inner, height), (inner, wall), steps)[1:]
        + line((inner, wall), (0, wall), 8)
        + [(0.0, wall)]
    )


def wall_of(mesh):
    return inspect(mesh).double_wall


@pytest.mark.parametrize("steps", [3, 40])
@pytest.mark.parametrize("scale", [1.0, 1e-3, 25.4])
def test_double_wall_of_a_cup_holds_what_is_inside_it(scale, steps):
    mesh = cup(30.0, 80.0, 1.0, steps=steps)
    found = wall_of(Mesh(scale * mesh.V, mesh.F))
    content = PRISM * 29.0**2 * 79.0
    assert found.capacity == pytest.approx(scale**3 * content, rel=1e-6)
    assert found.material == pytest.approx(scale**3 * (PRISM * 30.0**2 * 80.0 - content), rel=1e-6)
    assert found.thickness == pytest.approx(scale, rel=0.05)
    assert found.openings == 1


@pytest.mark.parametrize("rim", [2, 4, 9])
def test_double_wall_takes_a_rounded_rim_for_no_third_side(rim):
    found = wall_of(cup(30.0, 80.0, 1.5, rim))
    assert found.capacity == pytest.approx(PRISM * 28.5**2 * 78.5, rel=0.03)
    assert found.openings == 1


@pytest.mark.parametrize(("outer", "inner"), [(1, -1), (1, 1), (-1, 1), (-1, -1)])
def test_double_wall_is_a_ball_in_a_ball_whichever_way_they_face(outer, inner):
    V, F = meshes.sphere(3)
    both = np.vstack([F[:, ::outer], F[:, ::inner] + len(V)])
    found = wall_of(Mesh(np.vstack([V, 0.95 * V]), both))
    content = 0.95**3 * inspect(Mesh(V, F)).volume
    assert found.capacity == pytest.approx(content, rel=1e-9)
    assert found.material == pytest.approx(content * (0.95**-3 - 1.0), rel=1e-9)
    assert found.openings == 0


def test_double_wall_of_a_box_and_of_a_pipe_holds_what_is_inside_it():
    V, F = meshes.box(8, 6, 5)
    inner = 0.1 + V * [7.8 / 8, 5.8 / 6, 4.8 / 5]
    found = wall_of(Mesh(np.vstack([V, inner]), np.vstack([F, F[:, ::-1] + len(V)])))
    assert found.capacity == pytest.approx(7.8 * 5.8 * 4.8, rel=1e-9)
    pipe = turned(
        line((10.0, 0.0), (10.0, 40.0), 20)
        + [(10.0, 40.0)]
        + line((9.5, 40.0), (9.5, 0.0), 20)
        + [(9.5, 0.0)]
    )
    found = wall_of(pipe)
    assert found.capacity == pytest.approx(PRISM * 9.5**2 * 40.0, rel=1e-6)
    assert found.openings == 2


def plate(thick):
    V, F = meshes.box(20, 20, 1)
    return Mesh(V * [1.0, 1.0, thick], F)


def bent_plate():
    """Half of a pipe: a thin solid around nothing that would hold water."""
    V, F = meshes.box(30, 20, 1)
    angle, radius = np.pi * V[:, 0] / 30.0, 10.0 + 0.3 * V[:, 2]
    return Mesh(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), V[:, 1]]), F[:, ::-1])


def rod():
    V, F = meshes.box(2, 2, 60)
    return Mesh(V, F)


@pytest.mark.parametrize(
    "mesh",
    [
        plate(0.3),
        plate(0.01),
        bent_plate(),
        rod(),
        Mesh(*meshes.sphere(3)),
        Mesh(*meshes.box(3, 3, 9)),
        Mesh(*meshes.tube()),
        Mesh(*meshes.rabbit()),
        Mesh(*meshes.character(0.3)),
        Mesh(*meshes.sample_bottle(2.0)[:2]),
    ],
    ids=["plate", "sheet", "half pipe", "rod", "ball", "bar", "tube", "rabbit", "body", "bottle"],
)
def test_double_wall_is_not_found_in_what_is_no_vessel(mesh):
    assert wall_of(mesh) is None


def test_double_wall_is_not_found_in_two_parts_beside_each_other():
    V, F = meshes.sphere(3)
    assert wall_of(Mesh(np.vstack([V, V + [2.1, 0, 0]]), np.vstack([F, F + len(V)]))) is None


def test_double_wall_is_said_and_no_thickness_counts_twice():
    mesh = cup(30.0, 80.0, 1.0)
    wall = wall_of(mesh)
    said = [each.sentence for each in inspect(mesh).findings if each.kind == "double wall"]
    assert f"{wall.capacity:,.6g}" in said[0]
    assert f"{wall.material:,.6g}" in said[0]
    for thickness in (None, 1.0):
        found = apd_viewer.volume_readings(mesh.V, mesh.F, thickness=thickness)
        assert found.material == pytest.approx(wall.material)
        assert found.capacity == pytest.approx(wall.capacity)


def test_inspect_says_where_too_many_triangles_hide_a_second_wall(monkeypatch):
    mesh = cup(3.0, 8.0, 0.1)
    assert [each.kind for each in inspect(mesh).findings if "double" in each.kind] == ["double wall"]
    monkeypatch.setattr(double_wall, "MOST_TRIANGLES", len(mesh.F) - 1)
    found = inspect(mesh)
    assert found.double_wall is None
    assert [each.kind for each in found.findings if "double" in each.kind] == ["double wall unknown"]
    assert not [each for each in inspect(Mesh(*meshes.sphere(4))).findings if "double" in each.kind]
