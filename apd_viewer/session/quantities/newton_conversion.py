"""Conversion of model loads into newtons for a wall with little stretching.

The model's energy of bending is ``stiffness * area * integral(k1² + k2²)``, that of a wall with the bending
rigidity ``D = 2 stiffness area`` (a squared length) and no Poisson's ratio; the wall's own is
``D = E t³ / (12 (1 - nu²))``. Where a wall bends and hardly stretches, shapes under given plates do not
depend on D, and loads are in proportion to it:

    load in newtons = load of the model * D of the wall / (D of the model * metres in a mesh unit).

A thin wall of the model, of its own thickness and Poisson's ratio, resists both as the real one does, and its
loads are in proportion to ``E t``.

A shape that cannot bend without stretching resists by both, and its load is in proportion to
``D^(1 - p) (E t)^p``, where p is the share of the energy in stretching (the derivative of the least energy by
the logarithm of a modulus is the energy that the modulus has). A wall that is thinner than that of the model
resists stretching more, against bending, so that the newtons above are too low; see
:meth:`NewtonConversion.underestimate_factor`.
"""

import math
from dataclasses import dataclass

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.operators import total_curvature
from apd_viewer.geometry.solver.methods import wall_material
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall, WallText, parse_wall

# Limit of total curvature: 4 pi for a sphere, up to 1 for a tube with noise of 1 % of its radius.
_CURVED = 1.5
# Fractions of stretching energy: 0.2 to 0.5 for spheres and bottles between plates, less for bends.
_STRETCHED, _ROOT = 0.05, 0.5


@dataclass(frozen=True)
class NewtonConversion:
    """Conversion of the model's loads into newtons.

    Attributes
    ----------
    newtons_per_load : float
        Newtons of a load of 1.
    metres_per_unit : float
        Metres in a mesh unit.
    stiffness, pressed_stiffness : float
        Stiffness of the wall, and the one used for pressing.
    curvature : float
        Total curvature at rest: what can be unrolled can also bend without stretching.
    """

    newtons_per_load: float
    metres_per_unit: float
    stiffness: float
    pressed_stiffness: float
    curvature: float

    @property
    def matches_wall(self) -> bool:
        """True if the model bends and stretches like the wall itself."""
        return math.isclose(self.pressed_stiffness, self.stiffness, rel_tol=1e-6)

    def underestimate_factor(self, stretching: float = _ROOT) -> float:
        """Largest factor by which newtons may be too low; less than 1 if too high.

        It is 1 where a shape need not stretch. Where it has to, loads are in proportion to the root of
        ``D E t`` or so: that of a sphere is [Reissner 1946]; sharp folds stretch less, and a tube along its
        axis, while it is straight, more. So the power of the ratio of the two stiffnesses is a half, or the
        share ``stretching`` of the energy, at the stiffness of the model, if that is more. Where the share is
        not known, what cannot be unrolled counts as stretched.
        """
        forced = self.curvature > _CURVED and stretching > _STRETCHED
        if not (forced or stretching > _ROOT):
            return 1.0
        return (self.pressed_stiffness / self.stiffness) ** max(_ROOT, stretching)

    @property
    def joules_per_work(self) -> float:
        """Joules per unit of work in the model."""
        return self.newtons_per_load * self.metres_per_unit

    @property
    def newtons_per_millimetre(self) -> float:
        """N/mm per unit of apparent stiffness in the model."""
        return 1e-3 * self.newtons_per_load / self.metres_per_unit

    def gas_amount(self, pascals: float, rest: RestMesh) -> float:
        """Pressure times volume of a gas at rest over the surface area, model units."""
        volume = (rest.volume if rest.caps is None else rest.volume_capped) or 0.0
        return pascals / self.pascals_per_pressure * abs(volume) / rest.area

    @property
    def pascals_per_pressure(self) -> float:
        """Pascals of a pressure of 1 in the model."""
        return self.newtons_per_load / self.metres_per_unit**2


def wall_pascals(young: float, diagonal: float, thickness: float | None, poisson: float) -> float:
    """Pascals of a pressure of 1 on a thin wall, by its Young's modulus in Pa.

    ``diagonal`` and ``thickness`` are as of :func:`wall_material`; raises InputError unless the wall is thin.
    """
    wall = wall_material(diagonal, thickness, poisson)
    return young * wall.thickness / wall.tensile_stiffness


def settings_pascals(settings: Settings, diagonal: float, text: WallText, unit: Unit) -> float | None:
    """Pascals of a pressure of 1 in settings; None without a modulus of the wall."""
    try:
        young = parse_wall(text, unit).young
        own = settings.wall_thickness, settings.poisson
        return None if young is None else wall_pascals(young, diagonal, *own)
    except InputError:
        return None


def newton_conversion(wall: Wall, material: Material, rest: RestMesh) -> NewtonConversion | None:
    """Load conversion for a wall and a model material; None if newtons are unknown."""
    metre, rigidity = wall.unit.metres, wall.rigidity
    own = wall.model_stiffness(rest.area, material.tensile_stiffness)
    stiffness = 0.5 * material.plate_rigidity / rest.area if material.thickness else material.bending
    if metre is None or rigidity is None or own is None or not stiffness > 0.0:
        return None
    per_load = rigidity / (2.0 * stiffness * rest.area * metre)
    curvature = total_curvature(rest.solve_mesh.V, rest.solve_mesh.F)
    return NewtonConversion(per_load, metre, own, stiffness, curvature)
