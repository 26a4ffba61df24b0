"""Cases under load: elastic tube, cylinder along its axis, plastic ring."""

import numpy as np
from scipy.special import beta

from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.linear_buckling import classical_load
from apd_viewer.geometry.solver.plate_press import PressStep
from apd_viewer.geometry.solver.pressed_mesh import press
from apd_viewer.language import tr
from apd_viewer.verification.case_meshes import tube
from apd_viewer.verification.verification_case import CaseQuantity, CaseResults, ResultPair, VerificationCase

_PLATE_GAP = 0.0005  # distance kept between plates and walls, in radii
_ACROSS = np.array([1.0, 0.0, 0.0])


def _extent(step: PressStep) -> float:
    """Width of the wall across its axis."""
    return float(np.ptp(step.U @ _ACROSS))


# Elastic tube

# Integrals of sin(t)^(-1/2) and of sin(t)^(1/2) from 0 to pi / 2.
_I, _J = 0.5 * beta(0.25, 0.5), 0.5 * beta(0.75, 0.5)
LIFT_OFF = float(np.pi * _J / _I)  # gap in radii below which the wall lifts off the plates
_GAPS = (0.65, 0.475, 0.3)  # fractions of the diameter
_THICKNESS = 0.01  # wall thickness of tube and cylinder, in radii


def flattened_volume(gap: float) -> float:
    """Volume of an inextensible tube relative to rest, at a ``gap`` below lift-off."""
    return float(gap - (_I / _J - 2.0 / _J**2) * gap**2 / np.pi)


def flattened_load(gap: float) -> float:
    """Load of an inextensible tube per rigidity and width, ``gap`` below lift-off."""
    return float(4.0 * _J**2 / gap**2)


def _section_area(ring: np.ndarray) -> float:
    """Area of a closed planar polygon (n, 3)."""
    return float(np.linalg.norm(np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0))) / 2.0


def _tube(n: int, _: bool) -> CaseResults:
    V, F = tube(n, 22.0 / n)  # a few rows of triangles
    end = 2.0 * _GAPS[-1]
    wall = Material(thickness=_THICKNESS)
    found = press(
        *(V, F, _ACROSS, end, 4),
        method="wall",
        wall_thickness=_THICKNESS,
        poisson=0.0,
        thickness=_PLATE_GAP,
        convergence=Convergence(energy_tolerance=1e-9),
    )
    steps = found.steps[-len(_GAPS) :]
    ring = slice(2 * n, 3 * n)
    gaps = [_extent(step) for step in steps]
    shares = [_section_area(step.U[ring]) / _section_area(V[ring]) for step in steps]
    loads = [step.load / (wall.plate_rigidity * np.ptp(V[:, 1])) for step in steps]
    answers = [ResultPair(flattened_volume(gap), share) for gap, share in zip(gaps, shares, strict=True)]
    answers += [ResultPair(flattened_load(gap), load) for gap, load in zip(gaps, loads, strict=True)]
    return CaseResults(tuple(answers), np.column_stack([np.array(gaps) / 2.0, shares]))


def _tube_curve() -> np.ndarray:
    gaps = np.linspace(0.2, LIFT_OFF / 2.0, 60)
    return np.column_stack([gaps, [flattened_volume(2.0 * gap) for gap in gaps]])


# Cylinder along its axis

_LENGTH, _POISSON = 0.52, 0.3  # radii: three half waves
# Fractions of the classical strain.
_STRAINS = np.concatenate([np.arange(0.1, 0.75, 0.1), np.arange(0.8, 1.2, 0.0125)])


def _cylinder(n: int, _: bool) -> CaseResults:
    V, F = tube(n, _LENGTH)
    height, material = float(np.ptp(V[:, 1])), Material(thickness=_THICKNESS, poisson=_POISSON)
    base, top = np.flatnonzero(V[:, 1] == 0.0), np.flatnonzero(V[:, 1] == V[:, 1].max())
    solver = Deformation(
        *(V, F, np.concatenate([base, top])),
        handle=top,
        method="wall",
        wall_thickness=_THICKNESS,
        poisson=_POISSON,
        convergence=Convergence(energy_tolerance=1e-10, imperfection=0.0),
    )
    classical = classical_load(material)
    shortening = classical / (2.0 * np.pi * material.tensile_stiffness) * height
    strains, energies = [0.0], [0.0]
    for strain in _STRAINS:
        solver.aim(V[solver.fixed] * [1.0, 1.0 - strain * shortening / height, 1.0])
        while not solver.settled:
            solver.iterate()
        frame = solver.frame()
        strains.append(float(strain))
        energies.append(frame.energy or 0.0)
        loads = np.diff(energies) / (np.diff(strains) * shortening * classical)
        # Beyond the bifurcation, rounding may trigger a snap to a lower load.
        if not frame.stable or (loads[1:] < loads[:-1]).any():
            break
    points = np.column_stack([0.5 * (np.array(strains[1:]) + strains[:-1]), loads])
    return CaseResults((ResultPair(1.0, strains[-1]),), points)


# Plastic ring

_HINGED = (0.2, 0.4, 0.6)  # deflections over the diameter
_YIELD_RADIUS = 5.0


def hinged_load(deflection: float) -> float:
    """Load of a rigid-plastic ring, in plastic moments over its radius.

    Parameters
    ----------
    deflection : float
        Relative to the diameter.
    """
    return float(4.0 / np.sqrt(1.0 - deflection**2))


def _ring(n: int, _: bool) -> CaseResults:
    V, F = tube(n, 22.0 / n)
    wall = Material(thickness=_THICKNESS)
    found = press(
        *(V, F, _ACROSS, 2.0 * (1.0 - _HINGED[-1]), 2 * len(_HINGED)),
        method="wall",
        wall_thickness=_THICKNESS,
        poisson=0.0,
        yield_radius=_YIELD_RADIUS,
        thickness=_PLATE_GAP,
    )
    steps = found.steps[2::2]
    moment = wall.plate_rigidity * float(np.ptp(V[:, 1])) / _YIELD_RADIUS
    deflections = [1.0 - _extent(step) / 2.0 for step in steps]
    loads = [step.load / moment for step in steps]
    answers = [ResultPair(hinged_load(x), load) for x, load in zip(deflections, loads, strict=True)]
    return CaseResults(tuple(answers), np.column_stack([deflections, loads]))


def _ring_curve() -> np.ndarray:
    deflections = np.linspace(0.0, 0.7, 71)
    return np.column_stack([deflections, [hinged_load(x) for x in deflections]])


TUBE = VerificationCase(
    "A",
    tr("Tube pressed flat (elastica)"),
    "A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., 1927, § 262",
    tuple(CaseQuantity(tr("volume / at rest, gap {gap:g}").format(gap=gap), 0.0025) for gap in _GAPS)
    + tuple(CaseQuantity(tr("load / rigidity / width, gap {gap:g}").format(gap=gap), 0.01) for gap in _GAPS),
    (50, 100),
    _tube,
    axes=(tr("gap / diameter"), tr("volume / at rest")),
    curve=_tube_curve,
)
CYLINDER = VerificationCase(
    "J",
    tr("Cylinder pressed along its axis"),
    "S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability, 2nd ed., 1961, § 11.1",
    # Held rims bulge before buckling, which lowers the strain by up to 15 %.
    (CaseQuantity(tr("strain at the first bifurcation / classical one"), 0.15),),
    (110, 220),
    _cylinder,
    axes=(tr("strain / classical one"), tr("load / classical load")),
    curve=lambda: np.array([[0.0, 0.0], [1.0, 1.0]]),
)
RING = VerificationCase(
    "N",
    tr("Plastic ring pressed between plates"),
    "J. A. DeRuntz, P. G. Hodge, J. Appl. Mech. 30, 391, 1963",
    tuple(CaseQuantity(tr("load, deflection {share:g}").format(share=share), 0.03) for share in _HINGED),
    (96, 192),
    _ring,
    axes=(tr("deflection / diameter"), tr("load × radius / plastic moment")),
    curve=_ring_curve,
)
