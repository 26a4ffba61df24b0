"""What "exact" holds and what it costs in energy, move by move, against rest-scaled ARAP.

    python tests/benchmarks/exact_table.py [--iterations N] [MESH ...]

Without a mesh: the sample bottle. In other meshes the lowest and the highest 8 % along the longest axis (y,
if that is nearly as long) are held. Rest-scaled ARAP scales the edges at rest until the area is right: the
same area, from the same start, with as many iterations.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import rotation

from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.operators import area
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.deformation import Deformation

MOVES = ("twist 60", "twist 120", "bend 90", "stretch 45 %", "compress 45 %", "shear 60 %")


def held(mesh, labels=None):
    """Base ids, handle ids and the axis from one to the other."""
    extent = np.ptp(mesh.V, axis=0)
    axis = 1 if extent[1] > 0.7 * extent.max() else int(np.argmax(extent))
    if labels is not None:
        return np.flatnonzero(labels == BASE), np.flatnonzero(labels == HANDLE), axis
    t = (mesh.V[:, axis] - mesh.V[:, axis].min()) / extent[axis]
    return np.flatnonzero(t < 0.08), np.flatnonzero(t > 0.92), axis


def moved(X, move, axis, height):
    """Where a handle at ``X`` is put."""
    up, side = np.eye(3)[axis], np.eye(3)[(axis + 1) % 3]
    kind, amount = move.split()[0], float(move.split()[1])
    if kind == "twist":
        centre = X.mean(axis=0)
        return (X - centre) @ rotation(up, np.radians(amount)).T + centre
    if kind == "bend":
        pivot = X.mean(axis=0) - 0.5 * height * up
        return (X - pivot) @ rotation(side, np.radians(amount)).T + pivot
    way = {"stretch": up, "compress": -up, "shear": side}[kind]
    return X + amount / 100 * height * way


def rest_scaled(rest, fixed, targets, iterations):
    """Positions of rest-scaled ARAP."""
    surface = ElasticSurface(rest.solve_mesh, fixed)
    still = surface.all_positions(-surface.solve(surface.held_contribution(targets)), targets)
    for _ in range(iterations):
        grown = surface.global_step(targets) - still
        excess = lambda s, grown=grown: area(still + s * grown, rest.solve_mesh.F) - rest.area  # noqa: E731
        surface.local_step(still + brentq(excess, 0.05, 3.0, xtol=1e-12) * grown)
    return surface.U


def row(name, rest, base, handle, axis, move, iterations):
    """One line of the table."""
    fixed, height = np.concatenate([base, handle]), float(np.ptp(rest.V[:, axis]))
    targets = np.vstack([rest.V[base], moved(rest.V[handle], move, axis, height)])
    solver = Deformation(rest.V, rest.F, fixed, method="exact", handle=handle, plain=True, rest=rest)
    solver.aim(targets)
    worst, in_place, finite = 0.0, True, True
    for k in range(iterations):
        frame = solver.step()
        worst = max(worst, abs(frame.area_error)) if k else worst
        in_place &= np.array_equal(frame.U[fixed], targets)
        finite &= bool(np.isfinite(frame.U).all())
    plain = ElasticSurface(rest.solve_mesh, fixed)
    for _ in range(iterations):
        plain.iterate(targets)
    exact, rival = rest.energy(frame.U), rest.solve_mesh.energy(rest_scaled(rest, fixed, targets, iterations))
    kept = "yes" if in_place and finite else "NO"
    lost = f"{area(plain.U, rest.F) / rest.area - 1:+.2%}"
    energies = f"{rest.solve_mesh.energy(plain.U):.5g} | {exact:.5g} | {rival:.5g}"
    return f"| {name} | {move} | {lost} | {worst:.0e} | {kept} | {energies} |"


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--iterations", type=int, default=1000)
    parser.add_argument("meshes", nargs="*", type=Path)
    options = parser.parse_args()
    print("| mesh | move | area, ARAP | worst error, exact | in place | E ARAP | E exact | E rest-scaled |")
    print("|---|---|---|---|---|---|---|---|")
    for mesh, labels in [(open_mesh(path), None) for path in options.meshes] or [open_sample("bottle")]:
        rest = RestMesh(mesh.V, mesh.F)
        if len(rest.weld.first) < len(mesh.V):
            sys.exit(f"{mesh.name} has repeated vertices; this table is for meshes without.")
        for move in MOVES:
            print(row(mesh.name, rest, *held(mesh, labels), move, options.iterations), flush=True)


if __name__ == "__main__":
    main()
