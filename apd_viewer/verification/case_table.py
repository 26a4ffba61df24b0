"""Table of the verification cases, including those not yet possible."""

from apd_viewer.language import tr
from apd_viewer.verification.fill_cases import INFLATED_SOLIDS, MYLAR_BALLOON, TEABAG
from apd_viewer.verification.press_cases import CYLINDER, RING, TUBE
from apd_viewer.verification.shape_cases import CATENOID, ELASTICA, KRESLING, MOEBIUS_BAND, SPINDLE
from apd_viewer.verification.verification_case import VerificationCase

CASES: dict[str, VerificationCase] = {
    case.letter: case
    for case in (
        TUBE,
        ELASTICA,
        MYLAR_BALLOON,
        TEABAG,
        INFLATED_SOLIDS,
        KRESLING,
        SPINDLE,
        CATENOID,
        MOEBIUS_BAND,
        CYLINDER,
        VerificationCase(
            "K",
            tr("Crushed can, full of liquid"),
            "Communications Physics, s42005-026-02589-5, 2026",
            reason=tr("Not yet: it takes half an hour, and the manual compares five runs with the can."),
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
