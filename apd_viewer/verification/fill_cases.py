"""Cases of flat bags of film that are filled, as far as they go without stretching.

A bag that is filled a little too much stretches as a spring does: its energy grows as the square of the
volume above the largest one. So the square root of the energy at two such volumes leads to the largest, and
every length on the way there is read off in proportion.
"""

from collections.abc import Callable, Sequence

import numpy as np

from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.language import tr
from apd_viewer.verification.case_meshes import disc, grid, sewn_sheets
from apd_viewer.verification.verification_case import CaseQuantity, CaseResults, ResultPair, VerificationCase

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

    volume, radius, height = filled_to_the_brim(V, F, _BALLOON, read)
    answers = ResultPair(_RIM, radius), ResultPair(_HEIGHT, height), ResultPair(_BALLOON, volume)
    return CaseResults(answers, np.array([[0.0, 0.5 * height], [radius, 0.0]]))


# Teabag and pillow

# Volume of two unit squares: bounds by Kepert.
_TEABAG = 0.2055, 0.217


def rectangular_bag(n: int, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Flat bag of two rectangles 1 wide, with ``n`` edges across."""
    uv, F = grid(n, round(length * n))
    return sewn_sheets(uv * [1.0, length], F, _GAP)


def _bag_volume(n: int, length: float, guess: float) -> float:
    return float(filled_to_the_brim(*rectangular_bag(n, length), guess, lambda _: ())[0])


# Volume of two rectangles twice as long as wide, on the finest mesh tried.
_LONGER = 0.51688


def _bags(n: int, _: bool) -> CaseResults:
    coarse, fine = (_bag_volume(m, 1.0, 0.203) for m in (n // 2, n))
    # The error of the fine mesh is nearly in proportion to the length of its edges.
    square = ResultPair(_TEABAG[0], 2.0 * fine - coarse)
    longer = [_bag_volume(n, length, guess) for length, guess in ((2.0, 0.512), (3.0, 0.828), (4.0, 1.143))]
    pillow = ResultPair(1.0 / np.pi, longer[2] - longer[1])
    points = np.column_stack([[1.0, 2.0, 3.0, 4.0], [fine, *longer]])
    return CaseResults((square, ResultPair(_LONGER, longer[0]), pillow), points)


def paper_bag_rule(length: np.ndarray) -> np.ndarray:
    """Volume of a bag 1 wide by Robin's rule of thumb."""
    found: np.ndarray = length / np.pi - 0.142 * (1.0 - 10.0**-length)
    return found


def _robin_curve() -> np.ndarray:
    lengths = np.linspace(1.0, 4.0, 31)
    return np.column_stack([lengths, paper_bag_rule(lengths)])


def _mylar_curve() -> np.ndarray:
    """Meridian of the balloon, z over r: dz/dr = r^2 / sqrt(R^4 - r^4)."""
    turn = np.linspace(0.0, 0.5 * np.pi, 91)
    # With r^2 = R^2 sin t the slope is dz/dt = R sqrt(sin t) / 2, from the rim inwards.
    slope = 0.5 * _RIM * np.sqrt(np.sin(turn))
    steps = 0.5 * (slope[1:] + slope[:-1]) * np.diff(turn)
    height = np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])
    return np.column_stack([_RIM * np.sqrt(np.sin(turn)), height])


MYLAR_BALLOON = VerificationCase(
    "C",
    tr("Two discs sewn and filled (Mylar balloon)"),
    "W. H. Paulsen, American Mathematical Monthly 101, 953, 1994",
    (
        CaseQuantity(tr("radius of the rim / radius of the discs"), 0.01),
        CaseQuantity(tr("thickness / radius of the discs"), 0.01),
        CaseQuantity(tr("volume / radius of the discs cubed"), 0.01),
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
        CaseQuantity(tr("volume of two unit squares, extrapolated, over its lower bound"), 0.01),
        CaseQuantity(tr("volume of a bag of 1 by 2, over that on the finest mesh"), 0.02),
        CaseQuantity(tr("volume of a long pillow per length"), 0.005),
    ),
    (8, 16),
    _bags,
    axes=(tr("length / width"), tr("volume")),
    curve=_robin_curve,
)
