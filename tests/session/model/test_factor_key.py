"""Whatever a factorization depends on is in its key: a stale one is a wrong shape without a word."""

from dataclasses import dataclass, field, fields, replace

import numpy as np
import pytest
from driven_session import BENT, document

from apd_viewer.files.mesh_location import MissingMesh
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.geometry.measuring.measurement import Measurement
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import with_next_region
from apd_viewer.session.model.handles_and_regions import (
    FACTORED,
    Handle,
    NamedPose,
    NamedRegion,
    PartFlags,
    factored_fields,
)
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.processes.document_deformation import deformation_of
from apd_viewer.session.processes.request_and_reply import are_same_keys, factor_key

METHODS = ["arap", "paper", "exact", "local"]


def of_handle(said: Document, **what: object) -> Document:
    return said.with_handle(0, replace(said.handles[0], **what))


BELOW = NamedObstacle("Plate 1", ObstacleKind.PLATE, frozen(np.array([0.0, 0.0, -1.0])), frozen(np.eye(3)[2]))
# Another value for every field.
OF_DOCUMENT = {
    "mesh": lambda said: replace(said, mesh=said.mesh.baked(frozen(said.mesh.V * [1.0, 1.0, 2.0]))),
    "labels": lambda said: said.with_label(np.flatnonzero(said.mesh.V[:, 2] == 1.0), 0),
    "initial_positions": lambda said: replace(said, initial_positions=frozen(said.initial_positions + 0.25)),
    "member": lambda said: said.with_region_number(np.flatnonzero(said.mesh.V[:, 2] < 5.0), 1),
    "handles": lambda said: said.with_pose(0, BENT @ BENT),
    "regions": lambda said: said.with_region(0, NamedRegion("Waist", 90.0)),
    "obstacles": lambda said: replace(said.with_settings(contact=True), obstacles=(BELOW,)),
    "immobile_components": lambda said: replace(said, immobile_components=(0,)),
    "base": lambda said: replace(said, base=PartFlags(hidden=True)),
    "mirror_axis": lambda said: replace(said, mirror_axis=0),
    "closed_openings": lambda said: replace(said, closed_openings=(0,)),
    "poses": lambda said: replace(said, poses=(NamedPose("Open", ()),)),
    "measurements": lambda said: replace(
        said, measurements=(Measurement("Width", MeasurementKind.DISTANCE),)
    ),
    "target_shape": lambda said: replace(said, target_shape=TargetShape(said.mesh)),
    "missing_target_shape": lambda said: replace(said, missing_target_shape=MissingMesh({}, "It is gone.")),
}
OF_SETTINGS = {
    "method": lambda said: said.with_settings(method="exact" if said.settings.method == "local" else "local"),
    "tolerance": lambda said: said.with_settings(tolerance=0.1),
    "stiffness": lambda said: said.with_settings(stiffness=0.5),
    "area_stiffness": lambda said: said.with_settings(area_stiffness=7.0),
    "shear_stiffness": lambda said: said.with_settings(shear_stiffness=7.0),
    "wall_thickness": lambda said: said.with_settings(method="wall", wall_thickness=0.1),
    "poisson": lambda said: said.with_settings(method="wall", poisson=0.25),
    "tension_field": lambda said: said.with_settings(method="wall", tension_field=True),
    "area": lambda said: said.with_settings(area=120.0),
    "hold_area": lambda said: said.with_settings(hold_area=True),
    "volume": lambda said: said.with_settings(volume=80.0),
    "filled_volume": lambda said: said.with_settings(filled_volume=7.0),
    "calm": lambda said: said.with_settings(calm=False),
    "contact": lambda said: said.with_settings(contact=True),
    "thickness": lambda said: said.with_settings(contact=True, thickness=0.125),
    "yield_radius": lambda said: said.with_settings(contact=True, stiffness=0.5, yield_radius=2.0),
    "hardening": lambda said: said.with_settings(
        method="wall", contact=True, yield_radius=2.0, hardening=0.1
    ),
    "pressure": lambda said: said.with_settings(method="wall", pressure=0.5),
    "gas": lambda said: said.with_settings(contact=True, gas=0.5),
    "convergence": lambda said: said.with_settings(convergence=Convergence(100)),
}
OF_HANDLE = {
    "name": lambda said: of_handle(said, name="Neck"),
    "pose": lambda said: of_handle(said, pose=frozen(BENT @ BENT)),
    "pivot": lambda said: of_handle(said, pivot=np.ones(3)),
    "waypoints": lambda said: of_handle(said, waypoints=(frozen(BENT.copy()),)),
    "falloff": lambda said: of_handle(said, falloff=2.0),
    "flags": lambda said: of_handle(said, flags=PartFlags(locked=True)),
    "former_twist_axis": lambda said: of_handle(said, former_twist_axis=frozen(np.ones(3))),
    "earlier_poses": lambda said: of_handle(said, earlier_poses=(frozen(BENT.copy()),)),
}
CHANGES = OF_DOCUMENT | OF_SETTINGS | OF_HANDLE


def start(method: str) -> Document:
    said = document(method)
    said = with_next_region(said).with_region_number(np.flatnonzero(said.mesh.V[:, 2] < 3.0), 1)
    return said.with_region(0, NamedRegion("Waist", 105.0))


def matrices(said: Document) -> list[np.ndarray]:
    """Every matrix that is factored on the way to the first shape, and what is held."""
    found = []

    def factored(matrix, V):
        found.append(matrix().toarray())
        return LinearSolver(matrix(), V)

    held = said.constraints()
    deformation = deformation_of(said, held, factored=factored)
    deformation.aim(held.targets, None, held.soft_targets)
    deformation.iterate()
    return [*found, held.fixed]


def same_matrices(one: Document, other: Document) -> bool:
    a, b = matrices(one), matrices(other)
    return len(a) == len(b) and all(map(np.array_equal, a, b))


def test_factored_fields_finds_declared_of_every_field_whether_it_matters():
    assert set(OF_DOCUMENT) == {each.name for each in fields(Document)} - {"settings"}
    assert set(OF_SETTINGS) == set(SETTINGS)
    assert set(OF_HANDLE) == {each.name for each in fields(Handle)}
    factored_fields(Document)
    factored_fields(Handle)


def test_factored_fields_notices_a_field_that_declares_nothing():
    @dataclass(frozen=True, eq=False)
    class Longer(Document):
        gravity: float = 0.0

    @dataclass(frozen=True, eq=False)
    class Declared(Document):
        gravity: float = field(default=0.0, metadata=FACTORED)

    with pytest.raises(TypeError, match=r"Longer\.gravity is neither"):
        factored_fields(Longer)
    assert "gravity" in factored_fields(Declared)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", CHANGES)
def test_factor_key_gives_the_same_key_only_for_the_same_matrices(name, method):
    before = start(method)
    after = CHANGES[name](before)
    assert not are_same_keys(factor_key(before), factor_key(after)) or same_matrices(before, after)


@pytest.mark.parametrize("name", [name for each in (Document, Handle) for name in factored_fields(each)])
def test_factored_fields_names_only_fields_that_change_a_matrix(name):
    """So the test before would notice if one of them were declared not to matter."""
    before = start("local")
    assert not same_matrices(before, CHANGES[name](before))
