"""Walls that a finger pushes in, by the method Wall and by CalculiX from the deck of them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from decks import ReadDeck, computed, reactions
from meshes import grid, sample_bottle

from apd_viewer import Convergence, Deformation
from apd_viewer.files.fe_deck import write_deck
from apd_viewer.files.selections.selection import Selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.deck_setup import deck_of, deck_wall
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText

# Young's modulus times thickness by the method Wall.
_OWN_FIRMNESS = 4.0
_NEAR = 1e-9
# Between the deflections whose energies tell a load, in thicknesses.
_APART = 0.04


@dataclass(frozen=True)
class HeldMesh:
    """Mesh, and the vertices of base and handle."""

    V: np.ndarray
    F: np.ndarray
    base: np.ndarray
    handle: np.ndarray


@dataclass(frozen=True)
class PushedWall:
    """Wall that is pushed in by three equal steps, meshes of it for either program, from coarse to fine.

    A ``linear`` one is pushed in a little by one step, which CalculiX computes without large displacements.
    Finer meshes of either program may change its loads by the fraction ``finer``.
    """

    title: str
    mesh: Callable[[int], HeldMesh]
    way: tuple[float, float, float]  # mm
    ours: tuple[int, int]
    theirs: tuple[int, int]
    thickness: float = 1.0  # mm
    young: float = 3000.0  # N/mm²
    poisson: float = 0.3
    linear: bool = False
    finer: float = 0.02

    @property
    def deflections(self) -> np.ndarray:
        """Way of the handle after each step, mm."""
        steps = 1 if self.linear else 3
        return np.linalg.norm(self.way) * np.arange(1, steps + 1) / steps

    def loads_by_wall(self, n: int) -> np.ndarray:
        """Loads (s,) on the handle, N: differences of the energy between two deflections."""
        held = self.mesh(n)
        solver = Deformation(
            *(held.V, held.F, np.concatenate([held.base, held.handle])),
            handle=held.handle,
            method="wall",
            wall_thickness=self.thickness,
            poisson=self.poisson,
            convergence=Convergence(energy_tolerance=1e-9),
        )
        apart = _APART * self.thickness
        energies = [
            self._energy(solver, held, deflection + side * apart / 2)
            for deflection in self.deflections
            for side in (-1, 1)
        ]
        newtons = self.young * self.thickness / _OWN_FIRMNESS
        return np.diff(np.reshape(energies, (-1, 2)))[:, 0] / apart * newtons

    def _energy(self, solver: Deformation, held: HeldMesh, deflection: float) -> float:
        ahead = held.V[held.handle] + deflection * np.array(self.way) / np.linalg.norm(self.way)
        solver.aim(np.concatenate([held.V[held.base], ahead]))
        frame = solver.step()
        while not frame.settled:
            frame = solver.step()
        assert frame.share_reached == 1.0
        assert frame.stable
        return frame.energy

    def loads_by_calculix(self, n: int, folder) -> np.ndarray:
        """Loads (s,) on the handle, N: the forces at its nodes."""
        held = self.mesh(n)
        labels = np.ones(len(held.V), dtype=np.uint8)
        labels[held.base], labels[held.handle] = 0, 2
        state = initial_state(Mesh(held.V, held.F))
        document = with_selection(state.document, Selection.with_default_names(labels))
        pose = np.eye(4)
        pose[:3, 3] = self.way
        text = WallText(f"{self.thickness} mm", "", f"{self.young} MPa", str(self.poisson))
        path = folder / "wall.inp"
        wall, steps = deck_wall(text, Unit.MILLIMETRE, 1.0), len(self.deflections)
        write_deck(path, deck_of(document.with_pose(0, pose), wall, steps))
        if self.linear:
            path.write_text(path.read_text().replace("*STEP, NLGEOM", "*STEP"))
        computed(path)
        forces = reactions(path, ReadDeck(path.read_text()).sets["HANDLE"])
        return forces @ np.array(self.way) / np.linalg.norm(self.way)

    def loads(self, folder) -> np.ndarray:
        """Loads (s, 4), N: CalculiX on the coarse and the fine mesh, the same of Wall."""
        theirs = [self.loads_by_calculix(n, folder) for n in self.theirs]
        return np.column_stack([*theirs, *(self.loads_by_wall(n) for n in self.ours)])

    def rows(self, loads: np.ndarray) -> list[str]:
        """Rows of the manual's table."""
        rows = []
        for way, row in zip(self.deflections, loads, strict=True):
            words = " | ".join(f"{load:#.4g}" for load in row)
            rows.append(f"| {self.title} | {way:.3g} mm | {words} | {row[3] / row[1]:.3f} |")
        return rows


def _clamped_plate(n: int, width: float = 100.0, finger: float = 20.0) -> HeldMesh:
    """Square of ``n`` by ``n`` cells inside its clamp, halved in both ways in turns."""
    h = width / n
    V, F = grid(n + 2, n + 2, h, h)
    cell = np.arange(len(F) // 2)
    a, b, c, d = *F[: len(cell)].T, F[len(cell) :, 2]
    turned = (cell // (n + 2) + cell) % 2 == 1
    F = np.where(
        np.tile(turned, 2)[:, None], np.vstack([np.column_stack([a, b, d]), np.column_stack([b, c, d])]), F
    )
    from_middle = np.abs(V[:, :2] - h - width / 2).max(axis=1)
    outside, inside = from_middle > width / 2 - _NEAR, from_middle < finger / 2 + _NEAR
    return HeldMesh(V, F, np.flatnonzero(outside), np.flatnonzero(inside))


def _tube(n: int, radius: float = 40.0, width: float = 16.0) -> HeldMesh:
    """Short tube of ``n`` edges around."""
    along = round(width * n / (2 * np.pi * radius))
    V, F = grid(n, along, 2 * np.pi / n, width / along)
    V, F = V[: n * (along + 1)], F % (n * (along + 1))
    V = np.column_stack([radius * np.cos(V[:, 0]), radius * np.sin(V[:, 0]), V[:, 1]])
    return HeldMesh(V, F, np.flatnonzero(V[:, 0] < _NEAR - radius), np.flatnonzero(V[:, 0] > radius - _NEAR))


def _dome(n: int, radius: float = 100.0, half: float = 30.0, finger: float = 5.0) -> HeldMesh:
    """Cap of ``n`` rings of triangles inside its clamp, within ``half`` degrees of its top."""
    rings = np.arange(n + 2)
    start = 3 * rings * (rings - 1) + 1
    start[0] = 0
    angles = [(0.0, 0.0)]
    F = []
    for k in rings[1:]:
        angles += [(half * k / n, 2 * np.pi * j / (6 * k)) for j in range(6 * k)]
        for j in range(6 * k):
            side, at = divmod(j, k)
            within = max(6 * (k - 1), 1)
            a, b = start[k] + j, start[k] + (j + 1) % (6 * k)
            c = start[k - 1] + (side * (k - 1) + at) % within
            F.append((a, b, c))
            if at < k - 1:
                F.append((c, b, start[k - 1] + (side * (k - 1) + at + 1) % within))
    tilt, turn = np.array(angles).T
    base, handle = np.flatnonzero(tilt > half - _NEAR), np.flatnonzero(tilt < finger + _NEAR)
    tilt = np.radians(tilt)
    V = np.column_stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
    return HeldMesh(radius * V, np.array(F), base, handle)


def _bottle(n: int, height: float = 103.5) -> HeldMesh:
    """Sample bottle in mm with ``n`` edges around its body, held by hexagons of a fifteenth of them."""
    V, F, _ = sample_bottle(90 / n)
    V = 10.0 * V
    patches = []
    for side in (-1.0, 1.0):
        patch = np.linalg.norm(V - [side * V[:, 0].max(), height, 0.0], axis=1).argmin()
        for _ in range(n // 30):
            patch = np.unique(F[np.isin(F, patch).any(axis=1)])
        patches.append(patch)
    return HeldMesh(V, F, *patches)


CASES = {
    case.title: case
    for case in (
        PushedWall("plate", _clamped_plate, (0.0, 0.0, 3.0), (40, 60), (20, 30)),
        PushedWall("tube", _tube, (-24.0, 0.0, 0.0), (48, 72), (48, 72)),
        PushedWall("dome", _dome, (0.0, 0.0, -12.0), (24, 36), (12, 18)),
        PushedWall(
            *("bottle", _bottle, (-0.03, 0.0, 0.0), (60, 90), (60, 90), 0.3, 3400.0, 0.38),
            linear=True,
            finer=0.08,  # ribs and beads of the coarse one are a few edges wide
        ),
    )
}
