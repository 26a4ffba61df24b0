"""Turns of the handles of a document in a shape."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.turns.held_turn import HeldTurn
from apd_viewer.geometry.turns.held_turns import held_turns
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import handle_pose_sequences


def document_turns(document: Document, U: np.ndarray) -> tuple[HeldTurn, ...]:
    """Turns of the handles from rest, asked and held by the shape ``U`` (n, 3)."""
    document = document.relative_to_rest
    return held_turns(
        document.grip, U, document.mesh.joined_F, document.labels, handle_pose_sequences(document)
    )
