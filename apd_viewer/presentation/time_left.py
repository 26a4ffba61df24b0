"""Estimate of the time until convergence, from the decay of the solver's measure.

The measure falls geometrically, except for bumps when the surface buckles: a line fitted to its logarithm in
the recent half of a descent predicts the time at which it reaches its tolerance. If the line does not clearly
fall, the time is unknown, unless the solver itself gave an estimate before its descent.
"""

import math

import numpy as np

from apd_viewer.language import tr

_FEWEST = 8
_MOST = 256  # maximum number of samples; beyond it every other one is dropped
# Minimum drop of the fitted line, absolute and in standard deviations of its residuals.
_LEAST_FALL, _CLEARLY = math.log(3.0), 4.5
_FARTHEST = 10.0  # longest extrapolation, as a multiple of the fitted interval
_TOLD = 3.0  # s: least time so far to be told
_INERTIA = 0.1  # time constant of the smoothing, as a fraction of the time left
# Rounding steps in seconds, each after its upper limit in seconds.
_STEPS = ((60.0, 5.0), (120.0, 15.0), (3600.0, 60.0))


class TimeLeftEstimate:
    """Smoothed estimate of the time of convergence.

    Moments are seconds of one clock. Each motion needs a new estimate.

    Parameters
    ----------
    moment : float
        Start of the solver.
    """

    def __init__(self, moment: float) -> None:
        self.start_moment = self._fitted = moment
        self._samples: list[tuple[float, float]] = []
        self._end: float | None = None
        self._has_measure = False

    def add_sample(self, moment: float, gap: float | None, expected: float | None = None) -> None:
        """Add a sample of the solver's distance from convergence.

        Parameters
        ----------
        gap : float or None
            Measure of convergence in multiples of its tolerance; None while it is not known.
        expected : float or None
            Seconds left that the solver expects; they count until the measure has told.
        """
        if gap is None or gap <= 0.0:
            self._samples, self._has_measure = [], False
            self._set_end(moment, expected)
            return
        self._samples.append((moment, math.log(gap)))
        if len(self._samples) > _MOST:
            del self._samples[1:-1:2]
        end = _zero_crossing(np.array(self._samples))
        if end is not None:
            self._adjust_end(moment, max(end, moment))
            self._has_measure = True
        elif not self._has_measure:
            self._set_end(moment, expected)
        elif self._end is not None and moment - self._fitted > _INERTIA * (self._end - moment):
            self._end = None  # no sample has confirmed the expected end for too long

    def _set_end(self, moment: float, seconds: float | None) -> None:
        self._end = None if seconds is None else moment + seconds
        self._fitted = moment

    def _adjust_end(self, moment: float, end: float) -> None:
        """Move the expected end towards a new estimate."""
        if self._end is None or self._end <= moment:
            self._end = end
        else:
            fraction = (moment - self._fitted) / max(1.0, _INERTIA * (self._end - moment))
            self._end += min(1.0, fraction) * (end - self._end)
        self._fitted = moment

    def seconds_left(self, moment: float) -> float | None:
        """Seconds left at ``moment``; None if unknown."""
        return None if self._end is None or self._end <= moment else self._end - moment

    def elapsed_fraction(self, moment: float) -> float:
        """Fraction of the total time elapsed at ``moment``; 0 if unknown."""
        left, passed = self.seconds_left(moment), moment - self.start_moment
        return 0.0 if left is None else passed / (passed + left)


def _zero_crossing(samples: np.ndarray) -> float | None:
    """Time at which a line fitted to the recent half of ``samples`` (k, 2) reaches 0."""
    recent = samples[samples[:, 0] >= 0.5 * (samples[0, 0] + samples[-1, 0])]
    if len(samples) < _FEWEST or np.ptp(recent[:, 0]) <= 0.0:
        return None
    (t, y), (T, Y) = recent.mean(axis=0), recent.T
    slope = float((T - t) @ (Y - y) / ((T - t) @ (T - t)))
    beside = float(np.std(Y - y - slope * (T - t)))
    if -slope * np.ptp(T) < max(_LEAST_FALL, _CLEARLY * beside):
        return None
    crossing = float(t - y / slope)
    return crossing if crossing - T[-1] <= _FARTHEST * np.ptp(T) else None


def time_left_text(seconds: float) -> str:
    """Rounded text of a remaining time."""
    step = next((step for most, step in _STEPS if seconds <= most), None)
    if step is None:
        return tr("more than an hour left")
    rounded = round(max(step, step * round(seconds / step)))
    if rounded < 120:
        return tr("about {n} s left").format(n=rounded)
    return tr("about {n} min left").format(n=round(rounded / 60))


def progress_text(said: str, seconds: float, done: int, count: int) -> str:
    """Sentence about the progress of equal steps, with the time left after the first.

    During the first step, it tells the time so far once that is worth telling.

    Parameters
    ----------
    said : str
        What is under way.
    seconds : float
        Since it began.
    """
    if done:
        return f"{said}, {time_left_text(seconds * (count - done) / done)}"
    if seconds < _TOLD:
        return said
    return tr("{progress}, {duration} so far").format(progress=said, duration=duration_text(seconds))


def duration_text(seconds: float) -> str:
    """Text of a duration, rounded to about one percent."""
    if seconds < 100.0:
        return tr("{n:.0f} s").format(n=seconds)
    minutes = round(seconds / 60.0)
    if minutes < 100:
        return tr("{n:.0f} min").format(n=minutes)
    return tr("{hours:.0f} h {minutes:.0f} min").format(hours=minutes // 60, minutes=minutes % 60)
