"""Metric of quasi-Newton steps: K at first, a projected Hessian near the minimum.

K is the Hessian for fixed projections. It is already factored, and far from the minimum no better metric is
known; near it, a rotating or shearing membrane is much softer than K, so that steps by K creep. A Hessian of
an earlier step suffices, since the quasi-Newton memory corrects the difference [Liu, Bouaziz & Kavan 2017];
the global step keeps K.
"""

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.goals.goal_projection import GoalProjection
from apd_viewer.geometry.linalg.linear_solver import Metric

# Largest number of free vertices with a tolerable factorization time: 0.9 to 1.2 s with 31,000 (160 MB), up
# to 1.6 s with 40,000, 12 s (750 MB) with 125,000.
MOST_HESSIAN_VERTICES = 40_000
# Largest number of free vertices for a Hessian that only the stability search needs: 0.1 s of 2 s.
_MOST_SEARCH_VERTICES = 5_000
# Steps between two Hessians; together they take about twice as long as a factorization.
_PERIOD = 50


def gains_from_hessian(surface: ElasticSurface) -> bool:
    """True if a surface converges sooner with its Hessian and is not too large for it.

    With bending K is nearly as good a metric, and the Hessian takes seven times as long to factor.
    """
    soft = surface.membrane is not None and surface.material.bending == 0.0
    return soft and len(surface.free) <= MOST_HESSIAN_VERTICES


class AdaptiveMetric:
    """Metric of an elastic surface: K or its projected Hessian.

    Parameters
    ----------
    surface : ElasticSurface
    """

    def __init__(self, surface: ElasticSurface) -> None:
        self._elastic = surface
        self._age = 0

    @property
    def is_hessian(self) -> bool:
        """True if the metric is a Hessian instead of K."""
        return self._elastic.metric is not self._elastic.factor

    @property
    def search_metric(self) -> Metric:
        """Metric of the stability search: the Hessian for a small membrane.

        Relative to K, a membrane is extremely soft against lateral displacement.
        """
        surface = self._elastic
        if self.is_hessian or surface.membrane is None or len(surface.free) > _MOST_SEARCH_VERTICES:
            return surface.metric
        return surface.hessian.factor_at(surface.U)

    def update(self, projection: GoalProjection) -> None:
        """Switch to the Hessian at the current shape; renew it every few iterations."""
        surface = self._elastic
        if self.is_hessian and self._age < _PERIOD:
            self._age += 1
            return
        surface.metric, self._age = surface.hessian.factor_at(surface.U), 1
        projection.refresh_directions(surface.U)

    def reset(self) -> None:
        """Switch back to K."""
        self._elastic.metric = self._elastic.factor
