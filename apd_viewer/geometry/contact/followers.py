"""Vertices that a surface carries along: what contact has to know of them."""

from __future__ import annotations

from typing import Protocol

import numpy as np


class Followers(Protocol):
    """Vertices that have no motion of their own, but follow the others."""

    @property
    def exempt_groups(self) -> np.ndarray:
        """Rows (z, n) of groups that nothing keeps apart; see :class:`PairSearch`."""

    def with_followers(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) with the followers where they follow to."""

    def transfer_gradient(self, g: np.ndarray) -> None:
        """Add the gradient (n, 3) of followers to that of what they follow."""

    def limit_shares(self, shares: np.ndarray) -> None:
        """Let what they follow go no farther than they do, by shares (n,)."""


class NoFollowers:
    """No followers.

    Parameters
    ----------
    n : int
        Number of the vertices.
    """

    def __init__(self, n: int) -> None:
        self.exempt_groups = np.zeros((0, n), np.int64)

    def with_followers(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) itself."""
        return U

    def transfer_gradient(self, g: np.ndarray) -> None:
        """Leave the gradient (n, 3) as it is."""

    def limit_shares(self, shares: np.ndarray) -> None:
        """Leave the shares (n,) as they are."""
