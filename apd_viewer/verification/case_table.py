"""Table of the verification cases, including those not yet possible."""

from apd_viewer.language import tr
from apd_viewer.verification.press_cases import CYLINDER, RING, TUBE
from apd_viewer.verification.shape_cases import (
    CATENOID,
    ELASTICA,
    INFLATED_CUBE,
    KRESLING,
    MOEBIUS_BAND,
    SPINDLE,
)
from apd_viewer.verification.verification_case import VerificationCase

_FLAT_BAG = tr("Not yet: volume targets are in percent of that at rest, which is 0 in a flat bag.")

CASES: dict[str, VerificationCase] = {
    case.letter: case
    for case in (
        TUBE,
        ELASTICA,
        VerificationCase(
            "C",
            tr("Two discs sewn and filled (Mylar balloon)"),
            "W. H. Paulsen, American Mathematical Monthly 101, 953, 1994",
            reason=_FLAT_BAG,
        ),
        VerificationCase(
            "D",
            tr("Two squares sewn and filled (teabag)"),
            "A. Robin, Paper bag problem, Mathematics Today 40, 104, 2004",
            reason=_FLAT_BAG,
        ),
        INFLATED_CUBE,
        KRESLING,
        SPINDLE,
        CATENOID,
        MOEBIUS_BAND,
        CYLINDER,
        VerificationCase(
            "K",
            tr("Crushed can, full of liquid"),
            "Communications Physics, s42005-026-02589-5, 2026",
            reason=tr("Not yet: a wall of 1/265 of the radius needs hours on a mesh that resolves it."),
        ),
        VerificationCase(
            "L",
            tr("Disc with an inserted wedge"),
            "arXiv:1410.3531, 2014",
            reason=tr("Not yet: no mesh here is a disc of more than 360 degrees."),
        ),
        VerificationCase(
            "M",
            tr("Disc pushed into a ring (developable cone)"),
            "E. Cerda, L. Mahadevan, Physical Review Letters 80, 2358, 1998",
            reason=tr("Not yet: obstacles are plates, spheres and cylinders, and none is a ring."),
        ),
        RING,
    )
}
