"""Metric of quasi-Newton steps: K at first, a projected Hessian near the minimum.

K is the Hessian while all projections are held. It is factored already, and far from the minimum nothing
better is known; near it a membrane that turns or shears is much softer than that, and steps by K creep. A
Hessian of some steps ago still serves, since the quasi-Newton memory learns the difference [Liu, Bouaziz &
Kavan 2017]; the global step keeps K.
"""

from __future__ import annotations

from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.solver.goal_projection import Projection

# With more free vertices a frame waits too long for a factorization: 0.9 to 1.2 s at 31,000 (160 MB in all), up
# to 1.6 s at 40,000, 12 s (750 MB) at 125,000.
_MOST = 40_000
# Steps between two Hessians; they take about twice as long as to factor one.
_PERIOD = 50


class LateMetric:
    """Choice of the metric of an elastic surface.

    Parameters
    ----------
    elastic : Elastic
    """

    def __init__(self, elastic: Elastic) -> None:
        self._elastic = elastic
        self._age = 0

    @property
    def is_hessian(self) -> bool:
        """True if it is not K."""
        return self._elastic.metric is not self._elastic.factor

    @property
    def may_be_hessian(self) -> bool:
        """True if there is a Hessian other than K, and not too large a one."""
        return self._elastic.membrane is not None and len(self._elastic.free) <= _MOST

    def follow(self, projection: Projection) -> None:
        """Take the Hessian, or a new one, at the current shape, if it is due."""
        elastic = self._elastic
        if self.is_hessian and self._age < _PERIOD:
            self._age += 1
            return
        elastic.metric, self._age = elastic.hessian.factored_at(elastic.U), 1
        projection.refresh(elastic.U)

    def reset(self) -> None:
        """Take K."""
        self._elastic.metric = self._elastic.factor
