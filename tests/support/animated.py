"""Animations made of a mesh in code, and the shapes that they consist of."""

import struct

import numpy as np

from apd_viewer.files.animations.animation_shapes import Animation


def animated(mesh, folder, count=4, labels=None, member=None):
    """An animation of ``count`` shapes, the first one that of rest; and the shapes."""
    folder.mkdir(exist_ok=True)
    size = np.ptp(mesh.V, axis=0).max()
    turning = np.random.default_rng(5).normal(size=(count, 3, 3))
    shapes = [mesh.V + k * 0.1 * np.sin(3.0 * mesh.V / size) @ turning[k] * size for k in range(count)]
    files = [folder / f"{k}.npy" for k in range(count)]
    for path, U in zip(files, shapes, strict=True):
        np.save(path, U)
    free = np.ones(len(mesh.V), dtype=np.uint8)
    labels, member = free if labels is None else labels, 0 * free if member is None else member
    return Animation(mesh, labels, member, files, [k / (count - 1) for k in range(count)]), shapes


def read_pc2(path):
    """Shapes (s, k, 3) of a PC2."""
    content = path.read_bytes()
    signature, version, points, first, rate, samples = struct.unpack_from("<12siiffi", content)
    assert (signature, version, first, rate) == (b"POINTCACHE2\0", 1, 0.0, 1.0)
    assert len(content) == 32 + 12 * points * samples
    return np.frombuffer(content, "<f4", offset=32).reshape(samples, points, 3)
