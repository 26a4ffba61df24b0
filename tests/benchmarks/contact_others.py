"""A full turn of the sample bottle in contact: here, by Newton's cloth solver, by IPC Toolkit in a loop.

    python tests/benchmarks/contact_others.py here|newton|ipctk [SECONDS]

``newton`` needs Newton 1.8.0 (``pip install newton==1.8.0 warp-lang==1.19.0``), in an environment of its own
with this project in it. Every shape is checked by ipctk's ``has_intersections``, and its crossing triangles
are counted. SECONDS of the processor, without the checks, are the most that a run may take (1200); the row so
far is printed every 20 of them.
"""

import os
import sys
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

os.environ.setdefault("NUMBA_NUM_THREADS", "2")

import ipctk
import numpy as np
import scipy.sparse as sp
from cholespy import CholeskySolverD, MatrixType
from contact import QUARTER, Bottle

from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.operators import face_areas

TURN = 360.0  # degrees
# Newton's example of a twisted cloth: metres and seconds.
LENGTH = 1.5  # of the sheet along the axis
FRAMES, FPS, SUBSTEPS, ITERATIONS = 300, 60, 10, 4
SPEED = np.pi / 3.0  # of either end, against the other
# The loop with IPC Toolkit: degrees and shares of the diagonal of the bounding box.
STEP = 5.0
RANGE = 1e-3
STILL = 1e-4  # a Newton step is the last one of a pose
MOST = 100  # Newton steps of a pose
KEPT = 0.9  # share of the way to the first touch, as IPC goes


class Shape(NamedTuple):
    """A shape on the way: positions, those asked of the held vertices, degrees reached."""

    U: np.ndarray
    held: np.ndarray
    degrees: float


class Check:
    """Measures of all shapes of a run, by means that none of the three uses to make them."""

    def __init__(self, bottle: Bottle) -> None:
        self.bottle = bottle
        F = np.asfortranarray(bottle.F, dtype=np.int32)
        self._mesh = ipctk.CollisionMesh(np.asfortranarray(bottle.V), ipctk.edges(F), F)
        self._area = float(face_areas(bottle.V, bottle.F).sum())
        self.shapes = self.crossed = self.most = self.last = 0
        self.area = self.last_area = self.held = self.last_held = 0.0

    def add(self, shape: Shape) -> None:
        """Measure another shape."""
        U = np.asfortranarray(shape.U, dtype=float)
        self.shapes += 1
        self.crossed += ipctk.has_intersections(self._mesh, U)
        found = crossings(U, self.bottle.F)
        assert found is not None
        self.last, self.most = len(found), max(self.most, len(found))
        self.last_area = float(face_areas(U, self.bottle.F).sum()) / self._area - 1.0
        self.area = max(self.area, abs(self.last_area))
        self.last_held = float(np.linalg.norm(U[self.bottle.fixed] - shape.held, axis=1).max())
        self.held = max(self.held, self.last_held)

    def __str__(self) -> str:
        return (
            f"{self.crossed} of {self.shapes} shapes crossed, at most {self.most} triangles, at the end "
            f"{self.last} | area at most {self.area:.1e}, at the end {self.last_area:+.1e} | held off by "
            f"at most {self.held:.1e} cm, at the end {self.last_held:.1e}"
        )


def here(bottle: Bottle) -> Iterator[Shape]:
    """The turn in quarters by this project: each until the handle has arrived, the last until settled."""
    solver = bottle.solver(contact=True)
    quarters = np.arange(QUARTER, TURN + 1.0, QUARTER)
    for degrees in quarters:
        targets = bottle.twisted(degrees)
        solver.aim(targets)
        while not solver.settled:
            solver.iterate()
            frame = solver.frame()
            on_its_way = solver.is_on_its_way
            reached = degrees - QUARTER * (1.0 - frame.share_reached)
            yield Shape(frame.U, frame.U[bottle.fixed] if on_its_way else targets, reached)
            if degrees < quarters[-1] and not on_its_way:
                break


def sheet(bottle: Bottle, scale: float, centre: np.ndarray) -> Any:
    """Newton's solver and its model of the bottle, all settings those of its example ``cloth_twist``."""
    import newton as nt  # Here: only one row needs it.
    import warp as wp  # Here: likewise.

    builder = nt.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.add_cloth_mesh(
        pos=wp.vec3(0.0, 0.0, 0.0),
        rot=wp.quat_identity(),
        scale=1.0,
        vertices=[wp.vec3(*map(float, x)) for x in scale * (bottle.V - centre)],
        indices=bottle.F.ravel().tolist(),
        vel=wp.vec3(0.0, 0.0, 0.0),
        density=0.2,
        tri_ke=1.0e3,
        tri_ka=1.0e3,
        tri_kd=2.0e-4,
        edge_ke=1e-3,
        edge_kd=1e-2,
    )
    builder.color()
    model = builder.finalize(device="cpu")
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 1.0e3, 1.0e-1, 0.2
    flags = model.particle_flags.numpy()
    flags[bottle.fixed] &= ~int(nt.ParticleFlags.ACTIVE)
    model.particle_flags = wp.array(flags, device="cpu")
    return nt.solvers.SolverVBD(
        model,
        iterations=ITERATIONS,
        particle_enable_self_contact=True,
        particle_self_contact_margin=0.002,
        particle_self_contact_gap=0.0015,
        particle_vertex_contact_buffer_size=64,
        particle_edge_contact_buffer_size=128,
    )


def say_contacts(frame: int, solver: Any) -> None:
    """Print the most contacts of a vertex and of an edge; those beyond the buffers are dropped."""
    met = solver.trimesh_collision_detector.collision_info
    vertex, edge = met.vertex_colliding_triangles_count.numpy(), met.edge_colliding_edges_count.numpy()
    print(f"frame {frame}, most contacts {vertex.max()} and {edge.max()}", file=sys.stderr)


def newton(bottle: Bottle) -> Iterator[Shape]:
    """The turn by Newton's example, with the bottle, scaled to the length of the sheet, in its place.

    As there, both ends turn, here until they are apart by a full turn; then they rest until the last frame.
    """
    import newton as nt  # Here: only this row needs it.

    scale, centre = LENGTH / bottle.height, bottle.V.mean(axis=0)
    solver = sheet(bottle, scale, centre)
    model = solver.model
    states, control, pipeline = [model.state(), model.state()], model.control(), nt.CollisionPipeline(model)
    contacts = pipeline.contacts()
    for substep in range(FRAMES * SUBSTEPS):
        if substep % SUBSTEPS == 0:
            pipeline.collide(states[0], contacts)
            solver.rebuild_bvh(states[0])
        degrees = min(np.degrees(2.0 * SPEED * (substep + 1) / (FPS * SUBSTEPS)), TURN)
        held = about_axis(bottle.twisted(degrees), -degrees / 2.0)
        for state in states:
            # On the CPU this is the memory of the state itself.
            state.particle_q.numpy()[bottle.fixed] = scale * (held - centre)
        states[0].clear_forces()
        solver.step(states[0], states[1], control, contacts, 1.0 / (FPS * SUBSTEPS))
        states.reverse()
        if substep % SUBSTEPS == SUBSTEPS - 1:
            say_contacts(substep // SUBSTEPS, solver)
            yield Shape(states[0].particle_q.numpy() / scale + centre, held, degrees)


def about_axis(X: np.ndarray, degrees: float) -> np.ndarray:
    """Positions ``X`` (k, 3) turned about the axis of the bottle, as :meth:`Bottle.twisted` turns."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return X @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]).T


class Barrier:
    """IPC Toolkit's barrier, its stiffness adapted as it recommends."""

    def __init__(self, bottle: Bottle, stiffness_of_wall: float) -> None:
        F = np.asfortranarray(bottle.F, dtype=np.int32)
        self.mesh = ipctk.CollisionMesh(np.asfortranarray(bottle.V), ipctk.edges(F), F)
        self.diagonal = float(np.linalg.norm(np.ptp(bottle.V, axis=0)))
        self.range = RANGE * self.diagonal
        self._wall, self._gap = stiffness_of_wall, np.inf
        self.stiffness = self._most = 0.0
        self._collisions = ipctk.NormalCollisions()

    def restart(self, U: np.ndarray, slope: np.ndarray) -> None:
        """Initial stiffness for a pose: ``slope`` (n, 3) of the elastic energy at ``U`` (n, 3)."""
        self.build(U)
        push = ipctk.BarrierPotential(self.range, 1.0).gradient(self._collisions, self.mesh, U)
        self.stiffness, self._most = ipctk.initial_barrier_stiffness(
            self.diagonal, ipctk.ClampedLogBarrier(), self.range, self._wall, slope.ravel(), push
        )

    def adapt(self, U: np.ndarray) -> None:
        """Stiffen where walls are hardly apart and come nearer."""
        gap = self._collisions.compute_minimum_distance(self.mesh, U)
        self.stiffness = ipctk.update_barrier_stiffness(
            self._gap, gap, self._most, self.stiffness, self.diagonal
        )
        self._gap = gap

    def build(self, U: np.ndarray) -> None:
        self._collisions.build(self.mesh, U, self.range)

    @property
    def _potential(self) -> ipctk.BarrierPotential:
        return ipctk.BarrierPotential(self.range, self.stiffness)

    def energy(self, U: np.ndarray) -> float:
        self.build(U)
        return float(self._potential(self._collisions, self.mesh, U))

    def slope(self, U: np.ndarray) -> np.ndarray:
        return self._potential.gradient(self._collisions, self.mesh, U).reshape(-1, 3)

    def hessian(self, U: np.ndarray) -> sp.csc_matrix:
        return self._potential.hessian(self._collisions, self.mesh, U, ipctk.PSDProjectionMethod.CLAMP)

    def free_share(self, U: np.ndarray, W: np.ndarray) -> float:
        """Share of the way from ``U`` to ``W`` that is free, with IPC's margin."""
        share = ipctk.compute_collision_free_stepsize(self.mesh, U, W)
        return 1.0 if share == 1.0 else KEPT * share


class Loop:
    """Projected Newton for the ARAP energy and the barrier."""

    def __init__(self, bottle: Bottle) -> None:
        self.bottle = bottle
        self.surface = ElasticSurface(RestMesh(bottle.V, bottle.F).solve_mesh, bottle.fixed)
        self.K = sp.kron(self.surface.K_ff, sp.eye_array(3)).tocsc()
        free = self.surface.free
        self._unknown = (3 * free[:, None] + np.arange(3)).ravel()
        self.barrier = Barrier(bottle, float(self.surface.K_ff.diagonal().mean()))
        self.U = np.asfortranarray(bottle.V)

    def drive(self, targets: np.ndarray) -> float:
        """Move the held vertices towards ``targets``, the others after them; the share that was free."""
        surface, move = self.surface, np.zeros_like(self.U)
        move[self.bottle.fixed] = targets - self.U[self.bottle.fixed]
        move[surface.free] = -surface.factor.solve(surface.held_contribution(move[self.bottle.fixed]))
        W = np.asfortranarray(self.U + move)
        share = self.barrier.free_share(self.U, W)
        self.go(np.asfortranarray(self.U + share * move))
        return share

    def go(self, U: np.ndarray) -> float:
        """Make ``U`` current; its quarter of an energy, as slopes and matrices have it."""
        self.U = U
        self.surface.local_step(np.ascontiguousarray(U))
        return 0.25 * self.surface.energy + self.barrier.energy(U)

    def slope(self) -> np.ndarray:
        slope = np.zeros_like(self.bottle.V)
        slope[self.surface.free] = self.surface.residual(np.ascontiguousarray(self.U[self.bottle.fixed]))
        return slope

    def step(self) -> float:
        """One step of Newton's method; its length before the line search, largest displacement."""
        U, energy = self.U, self.go(self.U)
        slope = self.slope() + self.barrier.slope(U)
        H = self.K + self.barrier.hessian(U)[self._unknown][:, self._unknown]
        rows, columns = (H := H.tocoo()).row, H.col
        factor = CholeskySolverD(H.shape[0], rows, columns, H.data, MatrixType.COO)
        p = np.zeros((H.shape[0], 1))
        factor.solve(-slope.ravel()[self._unknown, None], p)
        move = np.zeros_like(slope)
        move[self.surface.free] = p.reshape(-1, 3)
        share = self.barrier.free_share(U, np.asfortranarray(U + move))
        while self.go(np.asfortranarray(U + share * move)) > energy and share > 1e-9:
            share *= 0.5
        self.barrier.adapt(self.U)
        return float(np.linalg.norm(move, axis=1).max())


def with_ipctk(bottle: Bottle) -> Iterator[Shape]:
    """The turn in steps by a loop of Newton's method, as IPC's, quasi-static."""
    loop, reached, steps = Loop(bottle), 0.0, 0
    while reached < TURN:
        asked = min(reached + STEP, TURN)
        loop.barrier.restart(loop.U, loop.slope())
        reached += (asked - reached) * loop.drive(bottle.twisted(asked))
        held = loop.U[bottle.fixed]
        for _ in range(MOST):
            length = loop.step()
            steps += 1
            yield Shape(loop.U, held, reached)
            if length < STILL * loop.barrier.diagonal:
                break


RUNS = {"here": here, "newton": newton, "ipctk": with_ipctk}


def run(name: str, most: float) -> str:
    """Row of a run that takes at most so many seconds of the processor."""
    bottle = Bottle()
    check, shapes, said, degrees = Check(bottle), RUNS[name](bottle), 0.0, 0.0
    clock = processor = 0.0
    while processor < most:
        begun, before = time.perf_counter(), time.process_time()
        shape = next(shapes, None)
        clock, processor = clock + time.perf_counter() - begun, processor + time.process_time() - before
        if shape is None:
            break
        check.add(shape)
        degrees = shape.degrees
        row = f"{name} | {degrees:.1f}° | {check} | {clock:.0f} s, of the processor {processor:.0f} s"
        if processor > said + 20.0:
            said = processor
            print(row, file=sys.stderr, flush=True)
    return row


def main() -> None:
    """Run one and print its row."""
    with cores_for(len(Bottle().V)):
        print(run(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 1200.0), flush=True)


if __name__ == "__main__":
    main()
