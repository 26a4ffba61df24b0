"""The bottle of these tests is the sample itself: sessions find their mesh by its file."""

import pytest


@pytest.fixture
def bottle(sample):
    """A window on the sample bottle, painted."""
    return sample
