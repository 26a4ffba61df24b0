"""The methods by name, and the material that each is made of."""

from __future__ import annotations

from numbers import Real

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.elastic import Material
from apd_viewer.language import tr

SHORT_NAMES = {
    "exact": tr("Exact"),
    "local": tr("Local"),
    "paper": tr("Paper"),
    "arap": tr("ARAP"),
    "sr-arap": tr("SR-ARAP"),
}
METHODS = tuple(SHORT_NAMES)
DEFAULT_METHOD = "exact"
DEFAULT_TOLERANCE = 1e-3
# Against a stiffness of 1 of each cell of Eq. 1, of which "local" keeps a tenth to hold the corners together.
DEFAULT_AREA_STIFFNESS = 20.0
DEFAULT_SHEAR_STIFFNESS = 0.1
_LOCAL_RIGIDITY = 0.1
# These two are about the total area; the others leave it free unless asked.
KEEP_THE_AREA = ("exact", "paper")
# These have no energy of their own to go down in: only plain iterations are theirs.
PLAIN_ONLY = ("paper", "sr-arap")


def check_method(method: str, handle_of: np.ndarray) -> None:
    """Raise InputError unless there is such a method, and enough is held for it."""
    if method not in METHODS:
        raise InputError(
            tr("There is no method {method!r}; choose one of {methods}.").format(
                method=method, methods=", ".join(METHODS)
            )
        )
    if len(handle_of) == 0:
        raise InputError(tr("Nothing is held; name the vertices that stay or move as given."))
    if method == "paper" and ((handle_of > 0).all() or not (handle_of > 0).any()):
        raise InputError(
            tr("The method 'paper' needs base and handle; name the handle's vertices among the held ones.")
        )


def check_tolerance(tolerance: float) -> None:
    """Raise InputError unless the tolerance is greater than zero."""
    if not isinstance(tolerance, Real) or not tolerance > 0.0:
        raise InputError(tr("The tolerance must be greater than zero, such as 0.001 for 0.1 %."))


def material_of(method: str, stiffness: float, area_stiffness: float, shear_stiffness: float) -> Material:
    """The weights of the energy that a method minimises."""
    for weight, otherwise in (
        (stiffness, tr("The stiffness must be a number of at least zero.")),
        (area_stiffness, tr("The area stiffness must be a number of at least zero.")),
        (shear_stiffness, tr("The shear stiffness must be a number of at least zero.")),
    ):
        if not isinstance(weight, Real) or isinstance(weight, bool) or not 0.0 <= weight < np.inf:
            raise InputError(otherwise)
    if method == "sr-arap":
        return Material(coupling=stiffness)
    if method == "local":
        return Material(_LOCAL_RIGIDITY, shear_stiffness, area_stiffness, stiffness)
    return Material(bending=stiffness)
