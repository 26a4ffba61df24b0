"""A mesh pressed by moving obstacles, one iteration at a time.

Nothing needs to be held. Obstacles push without friction, so where nothing holds the mesh it slides as far as
forces that are not balanced push it, and comes to rest where they are. It does not turn as a whole, as if
guided: a tall one would topple under the least load.

A wall that is pressed evenly would stay straight beyond the load at which it buckles: nothing would tell it
to which side. So it is disturbed a little before every way of the obstacles, always in the same manner: it
gives to small random forces as its stiffness has it, most where it is about to buckle.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.contact.mesh_contact import mesh_contact
from apd_viewer.geometry.energy.cell_bending import cell_stiffness, load_excess
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.enclosed_gas import EnclosedGas
from apd_viewer.geometry.energy.membrane import Membrane
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.pose.held_path import HeldPath
from apd_viewer.geometry.pressing.press_options import (
    DEFAULT_OPTIONS,
    PressOptions,
    press_material,
    start_positions,
)
from apd_viewer.geometry.solver.constrained_descent import ENERGY_TOLERANCE
from apd_viewer.geometry.solver.goal_set import GoalSet
from apd_viewer.geometry.solver.held_vertices import vertex_ids
from apd_viewer.geometry.solver.methods import DEFAULT_TOLERANCE, method_named
from apd_viewer.geometry.solver.touching_descent import TouchingDescent
from apd_viewer.geometry.solver.touching_surface import TouchingSurface
from apd_viewer.language import tr

# Of the area: less energy is rounding, strains of a millionth.
_NO_ENERGY = 1e-12


class PressSolver:
    """A mesh between obstacles that move.

    Parameters
    ----------
    rest : RestMesh
    obstacles, shifts
        See :meth:`replace_obstacles`.
    options : PressOptions

    Attributes
    ----------
    iterations : int
        Since :meth:`aim`.
    gas : EnclosedGas or None

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.
    """

    def __init__(
        self,
        rest: RestMesh,
        obstacles: Sequence[Obstacle],
        shifts: np.ndarray,
        options: PressOptions = DEFAULT_OPTIONS,
    ) -> None:
        traits = method_named(options.method)
        if not traits.may_use_contact:
            raise InputError(tr("Only the methods Exact, Local and ARAP press; choose one of them."))
        self.rest, self._thickness = rest, options.thickness
        self._held = np.unique(rest.weld.inverse[vertex_ids(options.fixed, len(rest.V))])
        start = start_positions(rest, options.start)
        with cores_for(len(start)):
            goals = GoalSet(rest, options.method, traits, DEFAULT_TOLERANCE, lambda: np.zeros((0, 0)))
            goals.set_targets(options.area, options.volume, (), calm=False)
            self._goals = goals.goals
            self._elastic = ElasticSurface(rest.solve_mesh, self._held, press_material(traits, options))
            self._elastic.restart(start)
            self.gas = None if options.gas is None else EnclosedGas(rest, options.gas)
        self.replace_obstacles(obstacles, shifts)

    def replace_obstacles(self, obstacles: Sequence[Obstacle], shifts: np.ndarray) -> None:
        """Put obstacles around the current shape, in the place of those before.

        Parameters
        ----------
        obstacles : sequence of Obstacle
            Where they are at first, in local positions; the shape must be clear of them.
        shifts : (o, 3) float array
            How far each goes in the end, mesh units.
        """
        shape, elastic, held = self.rest.solve_mesh, self._elastic, self._held
        handle_of = np.zeros(len(held), np.int64)
        with cores_for(len(shape.V)):
            apart = self.rest.diagonal, self._thickness
            contact = mesh_contact(shape, held, handle_of, *apart, obstacles=obstacles)
            if elastic.U is not shape.V:
                if not contact.can_start_at(elastic.U):
                    raise InputError(
                        tr("The shape to begin from crosses itself; deform it with walls kept apart.")
                    )
                contact.start_at(elastic.U)
            self._surface = TouchingSurface(elastic, contact, self.gas)
            targets = elastic.U[held]
            self._descent = TouchingDescent(self._surface, elastic.U, targets, self._goals, ENERGY_TOLERANCE)
        self._shifts = np.asarray(shifts, dtype=float)
        self._path_of = targets, handle_of
        self._from = self._to = 0.0
        self.aim(0.0)

    @property
    def U(self) -> np.ndarray:
        """Current shape, (n, 3) float array."""
        return self.rest.from_local(self.rest.weld.to_file(self._descent.U))

    @property
    def solve_positions(self) -> np.ndarray:
        """Current local shape of the solve, (k, 3) float array."""
        return self._descent.U

    @property
    def share(self) -> float:
        """Share of their way that the obstacles have gone."""
        return self._from + self._descent.share * (self._to - self._from)

    @property
    def is_stopped(self) -> bool:
        """True if the obstacles can go no farther."""
        return self._descent.is_stopped

    @property
    def has_met_goals(self) -> bool:
        """True if area and volume are as asked for."""
        return self._descent.has_met_goals

    @property
    def settled(self) -> bool:
        """True if iterating further changes nothing."""
        return self._descent.converged

    @property
    def energy(self) -> float:
        """The energy of the shape, with that of the gaps."""
        return self._surface.energy

    @property
    def load_excess(self) -> float | None:
        """Expected excess of the loads, see :func:`load_excess`."""
        return load_excess(
            self._elastic.material, cell_stiffness(self.rest.solve_mesh.V, self.rest.solve_mesh.F)
        )

    @property
    def stretching(self) -> float:
        """Share of the wall's energy in its stretching, 0 to 1."""
        energy = self._elastic.energy
        if energy <= _NO_ENERGY * self.rest.area:
            return 0.0
        self._membrane.local_step(self._elastic.U)
        return min(1.0, self._membrane.energy / energy)

    @cached_property
    def _membrane(self) -> Membrane:
        """Stretching alone: cells without bending are triangles of a membrane."""
        shape, material = self.rest.solve_mesh, self._elastic.material
        return Membrane(shape.V, shape.all_triangles, 2.0 * material.rigidity + material.shear, material.area)

    @property
    def loads(self) -> np.ndarray:
        """Forces (o, 3) on the obstacles, energy per length.

        At rest they are the derivatives of the energy by the places of the obstacles, with the sign changed.
        """
        self._surface.contact.gradient(self._descent.U)
        return self._surface.contact.loads

    @property
    def load_imbalance(self) -> float:
        """Length of the sum of all loads in that of their lengths; 0 if held."""
        return self._descent.load_imbalance

    def aim(self, share: float) -> None:
        """Start moving the obstacles to a share of their path; commit creases so far."""
        self._elastic.commit_creases()
        self._from = self.share
        self._to, self.iterations = share, 0
        targets, handle_of = self._path_of
        shifts = np.array([self._from * self._shifts, share * self._shifts])
        path = HeldPath(targets, targets, handle_of, shifts)
        if path.length:
            self._descent.disturb_shape()
        self._descent.follow_path(path, 0.0 if path.length else 1.0)

    def iterate(self) -> None:
        """One iteration."""
        with cores_for(len(self.rest.solve_mesh.V)):
            self._descent.step()
            self.iterations += 1
