"""Animation of morph weights in a glTF file, by its keys.

Section 3.11 of the specification of glTF 2.0. Between keys of another node, cubic splines are interpolated
linearly.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.files.gltf import accessors, scene
from apd_viewer.language import tr

_MOST_KEYS = 2000


class _Track(NamedTuple):
    """Weights (k, w) of the morph targets of a node at times (k,) in seconds."""

    node: int
    times: np.ndarray
    weights: np.ndarray
    has_steps: bool

    def weights_at(self, time: float) -> list[float]:
        """Weights (w,) at a time, held before the first key and after the last."""
        if self.has_steps:
            k = int(np.searchsorted(self.times, time, "right")) - 1
            return self.weights[max(k, 0)].tolist()
        return [float(np.interp(time, self.times, column)) for column in self.weights.T]


def keyed_documents(document: dict[str, Any], buffers: list[Any]) -> Iterator[dict[str, Any]]:
    """Documents with the morph weights at each key of their first animation.

    Empty if there is no such animation. Of more than 2,000 keys some are left out, evenly.
    """
    for k in range(len(scene.list_field(document, "animations"))):
        tracks = _tracks(document, buffers, scene.document_entry(document, "animations", k))
        if tracks:
            times = np.unique(np.concatenate([track.times for track in tracks]))
            if len(times) > _MOST_KEYS:
                times = times[np.linspace(0, len(times) - 1, _MOST_KEYS).round().astype(int)]
            for time in times.tolist():
                yield _with_weights(document, {track.node: track.weights_at(time) for track in tracks})
            return


def _with_weights(document: dict[str, Any], weights: dict[int, list[float]]) -> dict[str, Any]:
    nodes = [
        node | {"weights": weights[k]} if k in weights else node for k, node in enumerate(document["nodes"])
    ]
    return document | {"nodes": nodes}


def _tracks(document: dict[str, Any], buffers: list[Any], animation: dict[str, Any]) -> list[_Track]:
    samplers = scene.list_field(animation, "samplers")
    found = []
    for channel in scene.list_field(animation, "channels"):
        target = channel.get("target") if isinstance(channel, dict) else None
        if not isinstance(target, dict) or target.get("path") != "weights" or "node" not in target:
            continue
        number = scene.whole_number(channel, "sampler")
        if number >= len(samplers) or not isinstance(samplers[number], dict):
            raise ValueError(tr("its animation refers to a sampler that is missing"))
        scene.document_entry(document, "nodes", target["node"])
        found.append(_track(document, buffers, target["node"], samplers[number]))
    return found


def _track(document: dict[str, Any], buffers: list[Any], node: int, sampler: dict[str, Any]) -> _Track:
    times = accessors.accessor_numbers(document, buffers, sampler.get("input"), 1)[:, 0]
    values = accessors.accessor_numbers(document, buffers, sampler.get("output"), 1)[:, 0]
    kind = sampler.get("interpolation", "LINEAR")
    rows = 3 * len(times) if kind == "CUBICSPLINE" else len(times)
    is_whole = len(times) and len(values) and len(values) % rows == 0 and np.isfinite(values).all()
    if not is_whole or not (np.diff(times) > 0.0).all():
        raise ValueError(tr("the keys of its animation are damaged"))
    weights = values.reshape(rows, -1)
    if kind == "CUBICSPLINE":  # each value stands between two tangents
        weights = weights[1::3]
    return _Track(node, times, weights, kind == "STEP")
