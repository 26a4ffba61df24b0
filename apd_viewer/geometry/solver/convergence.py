"""Criteria that end the iterations of a deformation."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import as_float, is_whole_number
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr, trn

# Settled: the last iteration moved no vertex by more than the step tolerance, and the remaining ones together
# will move none by more than _REMAINING times that, extrapolated from how fast the steps have become shorter
# over the last MEMORY iterations. Wrinkles of fine meshes creep on with ever smaller steps for thousands of
# iterations: below _CREEP of the tolerance they are invisible.
_REMAINING = 100.0
_CREEP = 0.5
MEMORY = 10
MOST_ITERATIONS = 10_000_000  # upper limit of the setting
LARGEST_TOLERANCE = 0.1
LARGEST_SEED = 1_000_000
_ROUNDING = 1e-12


class Convergence(NamedTuple):
    """Criteria that end the iterations of a deformation.

    Attributes
    ----------
    most_iterations : int
        Largest number of iterations: wrinkles of fine meshes can creep indefinitely, without convergence.
    energy_tolerance : float
        For methods minimising an energy: converged once ten steps together reduce it by at most this
        fraction, or forty Hessian steps by at most forty times this fraction.
    step_tolerance : float
        For the methods "paper" and "sr-arap": converged once a step moves no vertex by more than this
        fraction of the bounding box's diagonal, and all further steps by at most a hundred times that.
    imperfection : float
        Displacement disturbing a shape at rest on a saddle of its energy, as a fraction of the bounding box's
        diagonal, so that it continues to a minimum; 0 leaves it on the saddle.
    seed : int
        Direction of the disturbance: 0 for steepest descent, any other number for a random combination of all
        descent directions found.

    Examples
    --------
    >>> import apd_viewer
    >>> apd_viewer.Convergence(most_iterations=500).energy_tolerance
    1e-07
    """

    most_iterations: int = 10_000
    energy_tolerance: float = 1e-7
    step_tolerance: float = 1e-5
    imperfection: float = 1e-4
    seed: int = 0


DEFAULT_CONVERGENCE = Convergence()
# Criteria for the disturbance of a shape at a saddle.
DISTURBANCE = ("imperfection", "seed")
# Descriptions of the criteria, for the help of commands.
CRITERIA = {
    "most_iterations": tr("stop after at most N iterations"),
    "energy_tolerance": tr("converged once ten iterations reduce the energy by at most this fraction"),
    "step_tolerance": tr(
        "for 'paper' and 'sr-arap': converged once steps are below this fraction of the mesh size"
    ),
    "imperfection": tr(
        "displacement that disturbs a shape at rest on a saddle of its energy, as a fraction of the mesh "
        "size; 0: none"
    ),
    "seed": tr("direction of the disturbance: 0 for the steepest descent, others at random"),
}


def check_convergence(convergence: Convergence) -> None:
    """Raise InputError unless the criteria can be used."""
    if not isinstance(convergence, Convergence):
        raise InputError(tr("The convergence must be an apd_viewer.Convergence."))
    most = convergence.most_iterations
    if not is_whole_number(most) or not 1 <= most <= MOST_ITERATIONS:
        raise InputError(
            tr("The iteration limit must be a whole number from 1 to {most:,}.").format(most=MOST_ITERATIONS)
        )
    for tolerance in (convergence.energy_tolerance, convergence.step_tolerance):
        if not 0.0 < as_float(tolerance) <= LARGEST_TOLERANCE:
            sentence = tr("The tolerances of convergence must be above 0 and at most {most}, such as 1e-7.")
            raise InputError(sentence.format(most=LARGEST_TOLERANCE))
    if not 0.0 <= as_float(convergence.imperfection) <= LARGEST_TOLERANCE:
        raise InputError(
            tr("The imperfection must be a number from 0 to {most}, such as 1e-4.").format(
                most=LARGEST_TOLERANCE
            )
        )
    if not is_whole_number(convergence.seed) or not 0 <= convergence.seed <= LARGEST_SEED:
        raise InputError(tr("The seed must be a whole number from 0 to {most:,}.").format(most=LARGEST_SEED))


def stability_text(frame: Frame, descends: bool) -> str:
    """Text about the stability of the last shape, or the reason why it is unknown.

    Parameters
    ----------
    frame : Frame
    descends : bool
        The iterations descend in an energy, which plain ones and those of "paper" and "sr-arap" do not.
    """
    if frame.stable:
        left = trn(
            "stable, after leaving {n} saddle of the energy",
            "stable, after leaving {n} saddles of the energy",
            frame.saddle_escapes,
        )
        return left.format(n=frame.saddle_escapes) if frame.saddle_escapes else tr("stable")
    if frame.stable is not None:
        return tr("not stable: a saddle of the energy")
    if not descends:
        return tr("not examined: such iterations minimise no energy")
    if frame.unreached:
        return tr("not examined: targets are out of reach")
    if not frame.settled:
        return tr("not examined: the shape has not converged")
    return tr("not examined")


def step_ratio(steps: Sequence[float], tolerance: float) -> float | None:
    """Larger of the last step and the remaining distance, in step tolerances.

    None before there are enough ``steps``, or while they do not become shorter.
    """
    if len(steps) <= MEMORY or steps[-1] >= steps[0]:
        return None
    last, first = steps[-1], steps[0]
    rate = (last / first) ** (1.0 / MEMORY)
    if rate == 1.0:  # all steps equally long, up to rounding
        return None
    return max(last, min(last / _CREEP, last * rate / (1.0 - rate) / _REMAINING)) / tolerance


class StepConvergence:
    """Convergence by the lengths of recent steps, in bounding-box diagonals."""

    def __init__(self) -> None:
        self._steps: deque[float] = deque(maxlen=MEMORY + 1)

    def append(self, step: float) -> None:
        """Add the length of a step."""
        self._steps.append(step)

    @property
    def has_steps(self) -> bool:
        """True if any step has been added."""
        return len(self._steps) > 0

    @property
    def is_at_rounding_level(self) -> bool:
        """True if the last step consisted of rounding errors."""
        return self.has_steps and self._steps[-1] <= _ROUNDING

    def convergence_ratio(self, convergence: Convergence) -> float | None:
        """Larger of the last step and the remaining distance, in step tolerances."""
        return step_ratio(self._steps, convergence.step_tolerance)

    def has_converged(self, convergence: Convergence) -> bool:
        """True if further iterations would make no significant change."""
        gap = self.convergence_ratio(convergence)
        return self.is_at_rounding_level or (gap is not None and gap <= 1.0)
