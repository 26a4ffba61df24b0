"""Cases of bags and solids of film, filled as far as they do not stretch.

A bag that is filled a little too much stretches as a spring does: its energy grows as the square of the
volume above the largest one. So the square root of the energy at two such volumes leads to the largest, and
every length on the way there is read off in proportion.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.scalars import triangle_stretches
from apd_viewer.geometry.mesh.operators import face_areas, volume
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.language import tr
from apd_viewer.verification.case_meshes import cube, disc, grid, platonic_solid, sewn_sheets
from apd_viewer.verification.verification_case import (
    CaseQuantity,
    CaseResults,
    ResultPair,
    VerificationCase,
    mean_area_change,
)

# Thickness and gap of the sheets, as fractions of the size of the bag, and both fillings above a guess.
_FILM, _GAP, _OVERFULL = 3e-5, 1e-4, (1.01, 1.02)
_MOST_ITERATIONS = 30_000

Reading = Callable[[np.ndarray], Sequence[float]]


def filled_to_the_brim(V: np.ndarray, F: np.ndarray, guess: float, read: Reading) -> np.ndarray:
    """Largest volume of a bag that does not stretch, and readings of its shape then.

    Parameters
    ----------
    V, F : (n, 3) and (m, 3) arrays
        The flat bag.
    guess : float
        Its largest volume, roughly.
    read : callable
        Readings of a shape (n, 3).
    """
    found, roots, U = [], [], None
    for share in _OVERFULL:
        U, energy = filled_film(V, F, share * guess, U)
        roots.append(np.sqrt(energy))
        found.append([share * guess, *read(U)])
    first, second = np.array(found)
    brim: np.ndarray = (first * roots[1] - second * roots[0]) / (roots[1] - roots[0])
    return brim


def filled_film(
    V: np.ndarray, F: np.ndarray, volume: float, start: np.ndarray | None = None
) -> tuple[np.ndarray, float]:
    """Shape (n, 3) of film filled to a volume, and its energy."""
    size = float(np.linalg.norm(np.ptp(V, axis=0)))
    solver = Deformation(
        V,
        F,
        [0],
        method="wall",
        wall_thickness=_FILM * size,
        poisson=0.0,
        tension_field=True,
        filled_volume=volume,
    )
    solver.aim(V[:1], U=start)
    while not (solver.settled or solver.frame().iteration >= _MOST_ITERATIONS):
        solver.iterate()
    frame = solver.frame()
    assert frame.energy is not None
    return frame.U, frame.energy


# Mylar balloon

_RIM, _HEIGHT, _BALLOON = 0.7627598, 0.9138932, 1.2185242


def _mylar(n: int, _: bool) -> CaseResults:
    V, F = sewn_sheets(*disc(n), _GAP)
    inner = 3 * n * (n - 1) + 1
    rim = np.arange(inner, inner + 6 * n)

    def read(U: np.ndarray) -> list[float]:
        from_middle = U - U[rim].mean(axis=0)
        return [
            float(np.linalg.norm(from_middle[rim], axis=1).mean()),
            2.0 * float(np.linalg.norm(from_middle[0])),
        ]

    # Coarse meshes hold less.
    held, radius, height = filled_to_the_brim(V, F, 0.99 * _BALLOON, read)
    answers = ResultPair(_RIM, radius), ResultPair(_HEIGHT, height), ResultPair(_BALLOON, held)
    return CaseResults(answers, np.array([[0.0, 0.5 * height], [radius, 0.0]]))


def _mylar_curve() -> np.ndarray:
    """Meridian of the balloon, z over r: dz/dr = r^2 / sqrt(R^4 - r^4)."""
    turn = np.linspace(0.0, 0.5 * np.pi, 91)
    # With r^2 = R^2 sin t the slope is dz/dt = R sqrt(sin t) / 2, from the rim inwards.
    slope = 0.5 * _RIM * np.sqrt(np.sin(turn))
    steps = 0.5 * (slope[1:] + slope[:-1]) * np.diff(turn)
    height = np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])
    return np.column_stack([_RIM * np.sqrt(np.sin(turn)), height])


# Teabag and pillow

# Volume of two unit squares, amid its bounds by Kepert; of two rectangles twice as long, on the finest mesh
# tried; and of a long pillow per length.
_BOUNDS = 0.2055, 0.217
_TEABAG, _LONGER, _PILLOW = 0.5 * sum(_BOUNDS), 0.51688, 1.0 / np.pi


def rectangular_bag(n: int, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Flat bag of two rectangles 1 wide, with ``n`` edges across."""
    uv, F = grid(n, round(length * n))
    return sewn_sheets(uv * [1.0, length], F, _GAP)


def _bag_volume(n: int, length: float, guess: float) -> float:
    return float(filled_to_the_brim(*rectangular_bag(n, length), guess, lambda _: ())[0])


# Lengths of the bags, and guesses of their volume.
_BAGS = {1.0: 0.203, 2.0: 0.512, 3.0: 0.828, 4.0: 1.143}


def _bags(n: int, _: bool) -> CaseResults:
    fine = [_bag_volume(n, length, guess) for length, guess in _BAGS.items()]
    # The error of the square is nearly in proportion to the length of its edges.
    square, longer = 2.0 * fine[0] - _bag_volume(n // 2, 1.0, _BAGS[1.0]), fine[1]
    answers = ResultPair(_TEABAG, square), ResultPair(_LONGER, longer), ResultPair(_PILLOW, fine[3] - fine[2])
    return CaseResults(answers, np.column_stack([list(_BAGS), fine]))


def paper_bag_rule(length: np.ndarray) -> np.ndarray:
    """Volume of a bag 1 wide by Robin's rule of thumb."""
    found: np.ndarray = length / np.pi - 0.142 * (1.0 - 10.0**-length)
    return found


def _robin_curve() -> np.ndarray:
    lengths = np.linspace(1.0, 4.0, 31)
    return np.column_stack([lengths, paper_bag_rule(lengths)])


# Inflated solids

_INFLATED, _OVERBLOWN = 120.0, 139.0  # percent; the sphere of the same area holds 138.198 %
# A solid is filled to its published bound less this fraction, where it must hardly stretch.
_SHORT = 0.005


class Solid(NamedTuple):
    """Regular solid of film, and how much more it holds unstretched."""

    faces: int
    name: str
    percent: float

    @property
    def bound(self) -> float:
        """Published lower bound of the largest volume, relative to that at rest."""
        return 1.0 + 0.01 * self.percent

    @property
    def is_nearly_round(self) -> bool:
        """True if it wrinkles little."""
        return self.faces > 12


_WRINKLES = tr(
    "Within the bound the film does not stretch, but it shrinks along its edges, where it wrinkles freely."
)
SOLIDS = (
    Solid(4, tr("tetrahedron"), 44.70),
    Solid(6, tr("cube"), 25.12),
    Solid(8, tr("octahedron"), 13.86),
    Solid(12, tr("dodecahedron"), 10.61),
    Solid(20, tr("icosahedron"), 4.36),
)


def _inflated(n: int, _: bool) -> CaseResults:
    V, F = cube(n)
    held = np.array([0])
    full, over = (
        deform(V, F, held, V[held], "local", area=100.0, volume=percent, contact=False)
        for percent in (_INFLATED, _OVERBLOWN)
    )
    change = mean_area_change(V, full.U, F)
    refused = float(not over.converged and len(over.warnings) > 0)
    found = [(solid, *inflated_solid(solid, n // (4 if solid.is_nearly_round else 3))) for solid in SOLIDS]
    answers = [ResultPair(0.0, change), ResultPair(1.0, refused)]
    for solid, stretch, strain, largest in found:
        answers += [ResultPair(0.0, stretch), ResultPair(0.0, strain), ResultPair(solid.bound, largest)]
    points = [(solid.faces, 100.0 * largest - 100.0) for solid, _, _, largest in found]
    return CaseResults(tuple(answers), np.array(points))


def inflated_solid(solid: Solid, cells: int) -> tuple[float, float, float]:
    """Mean stretch and strain near the bound, and the largest volume over rest."""
    V, F = platonic_solid(solid.faces, cells)
    at_rest = volume(V, F)
    U, _ = filled_film(V, F, (1.0 - _SHORT) * solid.bound * at_rest)
    largest = filled_to_the_brim(V, F, solid.bound * at_rest, lambda _: ())[0] / at_rest
    return *mean_strains(V, U, F), float(largest)


def mean_strains(V: np.ndarray, U: np.ndarray, F: np.ndarray) -> tuple[float, float]:
    """Mean stretch of the triangles, and their mean absolute strain.

    Stretch is what is positive of the larger strain. A film wrinkles instead of being compressed, so that it
    has strains even where it has no stretch.
    """
    weights = face_areas(V, F)
    largest, smallest = triangle_stretches(V[F], U[F])
    strains = np.array([largest, smallest]) - 1.0
    stretch = np.average(np.maximum(strains, 0.0).max(axis=0), weights=weights)
    return float(stretch), float(np.average(np.abs(strains).mean(axis=0), weights=weights))


def _solid_quantities(solid: Solid) -> list[CaseQuantity]:
    said = {"solid": solid.name, "percent": f"{100.0 * (1.0 - _SHORT) * solid.bound - 100.0:.2f}"}
    words = (
        tr("{solid} {percent} % fuller: mean stretch"),
        tr("{solid} {percent} % fuller: mean strain, wrinkles included"),
        tr("{solid}: largest volume / at rest, over its lower bound"),
    )
    stretch, strain, largest = (word.format(**said) for word in words)
    reason = "" if solid.is_nearly_round else _WRINKLES
    return [
        CaseQuantity(stretch, 0.001),
        CaseQuantity(strain, 0.001, reason=reason),
        CaseQuantity(largest, _SHORT, is_lower_bound=True),
    ]


def _published_bounds() -> np.ndarray:
    return np.array([(solid.faces, solid.percent) for solid in SOLIDS])


MYLAR_BALLOON = VerificationCase(
    "C",
    tr("Two discs sewn and filled (Mylar balloon)"),
    "W. H. Paulsen, American Mathematical Monthly 101, 953, 1994",
    (
        CaseQuantity(tr("radius of the rim / radius of the discs"), 0.01, is_chaotic=True),
        CaseQuantity(tr("thickness / radius of the discs"), 0.01, is_chaotic=True),
        CaseQuantity(tr("volume / radius of the discs cubed"), 0.01, is_chaotic=True),
    ),
    (7, 14, 20),
    _mylar,
    axes=(tr("radius"), tr("height")),
    curve=_mylar_curve,
)
TEABAG = VerificationCase(
    "D",
    tr("Two squares sewn and filled (teabag)"),
    "A. Robin, Paper bag problem, Mathematics Today 40, 104, 2004",
    (
        CaseQuantity(
            tr("volume of two unit squares, extrapolated, amid its bounds"),
            _BOUNDS[1] / _TEABAG - 1.0,
            is_chaotic=True,
        ),
        CaseQuantity(tr("volume of a bag of 1 by 2, over that on the finest mesh"), 0.02, is_chaotic=True),
        CaseQuantity(tr("volume of a long pillow per length"), 0.005, is_chaotic=True),
    ),
    (8, 16),
    _bags,
    axes=(tr("length / width"), tr("volume")),
    curve=_robin_curve,
)
INFLATED_SOLIDS = VerificationCase(
    "E",
    tr("Inflated Platonic solids"),
    "E. Lengyel, Mathematics 13(4), 645, 2025",
    (
        CaseQuantity(tr("mean area change of a cube at 120 % of the volume"), 0.001),
        CaseQuantity(tr("139 % of the volume of a cube is refused (1: yes)"), 0.0),
        *(quantity for solid in SOLIDS for quantity in _solid_quantities(solid)),
    ),
    (6, 12, 24),
    _inflated,
    axes=(tr("faces"), tr("percent more volume")),
    curve=_published_bounds,
)
