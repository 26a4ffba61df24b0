"""Vertices that a surface carries along: what contact has to know of them."""

from __future__ import annotations

from typing import Protocol

import numpy as np


class Followers(Protocol):
    """Vertices that have no motion of their own, but follow the others."""

    @property
    def together(self) -> np.ndarray:
        """Rows (z, n) of groups that nothing keeps apart; see :class:`PairSearch`."""

    def carried(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) with the followers where they follow to."""

    def pass_on(self, g: np.ndarray) -> None:
        """Add the gradient (n, 3) of followers to that of what they follow."""

    def limit(self, shares: np.ndarray) -> None:
        """Let what they follow go no farther than they do, by shares (n,)."""


class Nobody:
    """No followers.

    Parameters
    ----------
    n : int
        Number of the vertices.
    """

    def __init__(self, n: int) -> None:
        self.together = np.zeros((0, n), np.int64)

    def carried(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) itself."""
        return U

    def pass_on(self, g: np.ndarray) -> None:
        """Leave the gradient (n, 3) as it is."""

    def limit(self, shares: np.ndarray) -> None:
        """Leave the shares (n,) as they are."""
