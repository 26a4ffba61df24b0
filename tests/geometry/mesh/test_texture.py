"""Coordinates of a picture on a part: angle and height around an axis, upright and never mirrored."""

import numpy as np
import pytest
from meshes import grid, tube

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.texture import laid_picture
from apd_viewer.session.model.up_axis import UpAxis

FRAME = UpAxis.PLUS_Y.frame
WHOLE = 2.0 * np.pi


def picture(ratio, high=64):
    return np.zeros((high, round(ratio * high), 4), dtype=np.uint8)


def standing(frame=FRAME, radius=1.5, shift=(0.0, 0.0, 0.0), around=24):
    """Cylinder about the up axis of a frame: vertices, triangles, angle from the front, height."""
    V, F = tube(around, 12, height=3.0)
    angle, height = np.arctan2(V[:, 1], V[:, 0]), V[:, 2] - 1.5
    V = np.column_stack([radius * np.sin(angle), height, radius * np.cos(angle)])
    if np.einsum("ij,ij->", *_normals_and_places(V, F)) < 0:
        F = F[:, ::-1]
    return V @ frame + np.array(shift), F, angle, height


def _normals_and_places(V, F):
    A, B, C = V[F].transpose(1, 0, 2)
    flat = np.diag([1.0, 0.0, 1.0])
    return np.cross(B - A, C - A) @ flat, ((A + B + C) / 3) @ flat


def corners(V, F, inside, ratio=2.0, frame=FRAME):
    """Triangles with a vertex inside, the coordinates of their corners, and the texture."""
    texture = laid_picture(V, F, inside, frame, picture(ratio))
    touched = inside[F].any(axis=1)
    assert (texture.uv[texture.uv_of[~touched]][..., 1] < 0.0).all()  # seen nowhere else
    return F[touched], texture.uv[texture.uv_of[touched]], texture


def check_upright_and_not_mirrored(V, F, uv, right_of, up_of):
    """Seen from outside, u grows to the right and v upwards, in the proportions of the surface."""
    A, B = V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0.0).all()
    N = np.cross(A, B)
    for k, direction in enumerate((right_of, up_of)):
        wanted = np.column_stack([(A * direction(N)).sum(axis=1), (B * direction(N)).sum(axis=1)])
        found = np.column_stack([a[:, k], b[:, k]])
        assert (wanted * found).sum() > 0.99 * np.linalg.norm(wanted) * np.linalg.norm(found)


@pytest.mark.parametrize("axis", UpAxis)
def test_laid_picture_has_coordinates_of_angle_and_height_on_a_cylinder(axis):
    V, F, angle, height = standing(axis.frame, shift=(3.0, -5.0, 7.0))
    inside = np.abs(height) < 1.1
    high = np.ptp(height[inside])
    image = picture(WHOLE * 1.5 / high, 4000)
    scale = min(1.0, high * image.shape[1] / image.shape[0] / (WHOLE * 1.5))  # whole pixels
    texture = laid_picture(V, F, inside, axis.frame, image)
    touched = inside[F].any(axis=1)
    uv, vertex = texture.uv[texture.uv_of[touched]], F[touched]
    turns = (uv[..., 0] - 0.5) * scale - angle[vertex] / WHOLE
    np.testing.assert_allclose(turns, np.rint(turns), atol=1e-12)
    assert np.ptp(uv[..., 0], axis=1).max() < 2.0 / 24 / scale  # no triangle runs back around
    middle = (height[inside].min() + height[inside].max()) / 2
    ratio = image.shape[0] / image.shape[1] * WHOLE * 1.5 * scale
    np.testing.assert_allclose(uv[..., 1] - 0.5, (height[vertex] - middle) / ratio, atol=1e-12)
    np.testing.assert_allclose(texture.turn, 1.0 / scale, rtol=1e-12)


def test_laid_picture_is_upright_and_not_mirrored_on_a_cylinder_also_seen_from_inside():
    V, F, _, height = standing()
    inside = np.abs(height) < 1.1
    up = np.array([0.0, 1.0, 0.0])
    for faces in (F, F[:, ::-1]):
        chosen, uv, _ = corners(V, faces, inside)
        check_upright_and_not_mirrored(V, chosen, uv, lambda N: np.cross(up, N), lambda _: up)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 3.0, 20.0])
def test_laid_picture_keeps_its_proportions_and_fits_into_the_part(ratio):
    V, F, _, height = standing(radius=2.0)
    inside = np.abs(height) < 1.1
    chosen, uv, texture = corners(V, F, inside, ratio)
    high, tall = np.ptp(height[inside]), np.ptp(height[chosen]) / np.ptp(uv[..., 1])
    wide = WHOLE * 2.0 / texture.turn
    ratio = texture.image.shape[1] / texture.image.shape[0]
    np.testing.assert_allclose(wide / tall, ratio, rtol=1e-12)
    np.testing.assert_allclose(max(wide / (WHOLE * 2.0), tall / high), 1.0, rtol=1e-12)


@pytest.mark.parametrize("towards", [0.3, 1.9, np.pi])
def test_laid_picture_is_in_the_middle_of_a_part_that_does_not_go_around(towards):
    V, F, angle, height = standing(around=48, shift=(9.0, 0.0, -4.0))
    away = (angle - towards + np.pi) % WHOLE - np.pi
    inside = (np.abs(away) < 1.0) & (np.abs(height) < 1.1)
    chosen, uv, _ = corners(V, F, inside)
    np.testing.assert_allclose(uv.mean(axis=(0, 1)), 0.5, atol=0.05)
    own = uv[inside[chosen]]
    np.testing.assert_allclose(own.min(axis=0) + own.max(axis=0), 1.0, atol=1e-12)
    # Angles are those about the axis of the whole cylinder, known from the part alone.
    relative = away[chosen] - (away[inside].min() + away[inside].max()) / 2
    share = (uv[..., 0] - 0.5)[np.abs(relative) > 0.1] / relative[np.abs(relative) > 0.1]
    np.testing.assert_allclose(share, share.mean(), rtol=1e-9)


@pytest.mark.parametrize("ratio", [0.5, 2.0])
@pytest.mark.parametrize(
    ("normal", "up"),
    [((0, 0, 1), (0, 1, 0)), ((1, 0, 0), (0, 1, 0)), ((0, 1, 0), (0, 0, -1)), ((0, -1, 0), (0, 0, 1))],
)
def test_laid_picture_lies_flat_on_what_is_flat(normal, up, ratio):
    """A wall is seen from its front, a lid from above and a bottom from below, as the standard views are."""
    normal, up = np.array(normal, float), np.array(up, float)
    right = np.cross(up, normal)
    X, F = grid(12, 8, 0.5, 0.5)
    V = X[:, :1] * right + X[:, 1:2] * up + 2.0 * normal
    inside = (np.abs(X[:, 0] - 3.0) < 2.1) & (np.abs(X[:, 1] - 2.0) < 1.1)
    chosen, uv, texture = corners(V, F, inside, ratio)
    check_upright_and_not_mirrored(V, chosen, uv, lambda _: right, lambda _: up)
    size = np.ptp(X[inside][:, :2], axis=0)
    width = min(size[0], size[1] * ratio)
    low, high = X[inside][:, :2].min(axis=0), X[inside][:, :2].max(axis=0)
    expected = 0.5 + (X[chosen][..., :2] - (low + high) / 2) / (width, width / ratio)
    np.testing.assert_allclose(uv, expected, atol=1e-12)
    assert texture.turn > 1e3


def test_laid_picture_asks_for_more_than_single_vertices():
    V, F, _, _ = standing()
    alone = np.zeros(len(V), dtype=bool)
    alone[5] = True
    with pytest.raises(InputError, match="too small"):
        laid_picture(V, F, alone, FRAME, picture(1.0))
