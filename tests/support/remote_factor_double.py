"""A factor that is made elsewhere, and ready when a test says so."""

from apd_viewer.geometry.linalg.linear_solver import LinearSolver


class Elsewhere:
    """A factor that is there once the test says so."""

    is_in_other_process = True
    there = False
    seconds = 0.0

    def __init__(self, matrix, V):
        self._matrix, self._V = matrix, V

    @property
    def ready(self):
        return self.there

    def solve(self, B):
        assert self.there, "nobody can solve yet"
        return LinearSolver(self._matrix(), self._V).solve(B)

    def solve_refined(self, B):
        assert self.there, "nobody can solve yet"
        return LinearSolver(self._matrix(), self._V).solve_refined(B)
