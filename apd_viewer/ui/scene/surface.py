"""Drawn mesh, with points, normals and colours updated in place."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PySide6.QtCore import QPointF
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPlane
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.geometry.picking.preview_surface import PreviewSurface
from apd_viewer.presentation.color_maps import ColorMap
from apd_viewer.ui.scene import surface_shading
from apd_viewer.ui.scene.surface_shading import Finish, Shading, SurfaceArrays
from apd_viewer.ui.scene.viewport import Viewport

if TYPE_CHECKING:
    from apd_viewer.geometry.picking.surface_index import SurfaceIndex

# Placeholder before the first mesh; it gets one vertex, as PyVista rejects empty arrays.
_NOTHING = PreviewSurface(np.empty((0, 3), dtype=np.int32))


class Hit(NamedTuple):
    """Ray hit: face, point (3,), unit normal (3,) towards the viewer."""

    face: int
    point: np.ndarray
    normal: np.ndarray


class Surface:
    """Triangle mesh drawn in a viewport.

    Attributes
    ----------
    surface_index : SurfaceIndex, PreviewSurface or None
        Of the mesh that is shown.
    U : (n, 3) float64 array
        Positions as shown, read-only; what picking uses.
    color_map : ColorMap or None
        In which values are shown instead of the paint.
    finish : Finish
        In which the paint is shown.
    revision : int
        Counts changes of ``surface_index`` and ``U``.
    shape_revision : int
        Counts changes of ``shape``.
    arrays : SurfaceArrays
        Arrays of the drawn mesh.
    """

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self.surface_index: SurfaceIndex | PreviewSurface | None = None
        self.U: np.ndarray = np.empty((0, 3))
        self.revision = self.shape_revision = 0
        self._given = self.U
        self._blend: tuple[np.ndarray, float] | None = None
        self._cut: tuple[np.ndarray, np.ndarray] | None = None
        self._plane = vtkPlane()
        self._origin = np.zeros(3)
        self._box: tuple[float, ...] = ()
        self._boxes: np.ndarray | None = None  # boxes for picking, computed at the first ray
        self.arrays = SurfaceArrays(_NOTHING, np.zeros((1, 4), dtype=np.uint8))
        self._shading, self.finish = Shading.FILE, Finish.CLAY
        self._texture: Texture | None = None
        self._mapper = vtkPolyDataMapper()
        self._mapper.SetScalarModeToUsePointFieldData()
        self._mapper.SelectColorArray("rgba")
        self._mapper.SetColorModeToDirectScalars()
        points = vtkDataObject.FIELD_ASSOCIATION_POINTS
        self._mapper.MapDataArrayToVertexAttribute("paintClass", "paintClass", points, -1)
        self._actor = vtkActor()
        self._actor.SetMapper(self._mapper)
        self._actor.ForceOpaqueOn()
        self._actor.SetVisibility(False)
        prop = self._actor.GetProperty()
        prop.SetInterpolationToPhong()
        prop.SetLineWidth(1.0)
        self.color_map: ColorMap | None = None
        surface_shading.shade(self._actor)
        viewport.pre_draw.append(self._match_view)
        self._inside = surface_shading.InsideActor(viewport.renderer, self._actor)
        viewport.renderer.AddActor(self._actor)
        viewport.renderer.AddLight(surface_shading.headlight())
        viewport.pick_point = self.point_under
        viewport.box = lambda: self._box

    def set_mesh(self, surface_index: SurfaceIndex | PreviewSurface, U: np.ndarray, rgba: np.ndarray) -> None:
        """Replace the mesh by one with the shape ``U`` and the colours ``rgba``.

        Parameters
        ----------
        U : (n, 3) float array
        rgba : (n, 4) uint8 array
        """
        if surface_index is not self.surface_index:
            self.surface_index = self.texture = None
        self.surface_index, self._blend = surface_index, None
        # Far from the origin, single precision is too coarse for the mesh.
        self._origin = np.array([x.mean() for x in U.T])
        self._actor.SetPosition(*self._origin)
        self._actor.SetVisibility(True)
        self._arrange(surface_index, rgba)
        self.set_points(U)

    def _arrange(self, skin: SurfaceIndex | PreviewSurface, rgba: np.ndarray) -> None:
        texture = self._texture
        sharp = self._shading in (Shading.SHARP, Shading.FILE)
        drawn = skin.render_mesh(sharp, self._shading is Shading.FILE)
        if texture is not None and not isinstance(drawn, PreviewSurface):
            drawn = drawn.with_seams(texture.uv_of)
        self.arrays = SurfaceArrays(drawn, rgba, texture)
        self._mapper.SetInputData(self.arrays.data)
        self._shade()

    def set_points(self, U: np.ndarray) -> None:
        """Move the vertices to ``U`` (n, 3) and update the normals.

        The array is kept without a copy, and must not be modified afterwards.
        """
        if U is not self._given:
            self._given = U
            self.shape_revision += 1
        if self._blend is not None:
            rest, fraction = self._blend
            U = rest + fraction * (U - rest)
        self.U = np.ascontiguousarray(U, dtype=np.float64).view()
        self.U.flags.writeable = False
        low, high = self.arrays.set_points(self.U, self._origin)
        # Bounds from VTK would need another pass over all triangles, on one core.
        self._box = tuple(np.column_stack([low, high]).ravel() + np.repeat(self._origin, 2))
        self._boxes = None
        self.revision += 1
        self._viewport.update()

    @property
    def shape(self) -> np.ndarray:
        """Deformed vertex positions (n, 3), also during a :meth:`blend`."""
        return self._given

    @property
    def is_blended(self) -> bool:
        """True during a :meth:`blend`."""
        return self._blend is not None

    def blend(self, rest: np.ndarray | None, fraction: float = 1.0) -> None:
        """Show the interpolation at ``fraction`` from ``rest`` (n, 3) to the shape."""
        self._blend = None if rest is None or len(rest) != len(self._given) else (rest, fraction)
        if self.surface_index is not None:
            self.set_points(self._given)

    def cut(self, point: np.ndarray | None, normal: np.ndarray | None = None) -> None:
        """Hide the surface behind a plane given by (3,) arrays; None removes the cut."""
        was_cut, self._cut = self._cut is not None, None
        self._mapper.RemoveAllClippingPlanes()
        if point is not None and normal is not None:
            self._cut = point, normal
            self._plane.SetOrigin(*point)
            self._plane.SetNormal(*normal)
            self._mapper.AddClippingPlane(self._plane)
        if was_cut != (self._cut is not None):
            self._shade()
        self._viewport.update()

    def set_colors(self, rgba: np.ndarray, ids: np.ndarray | None = None) -> None:
        """Colour the vertices ``ids``, or all, by ``rgba`` (k, 4) uint8."""
        # Opacities stay unchanged, as they encode the measured values: see `shades`.
        if self.surface_index is not None:
            self.arrays.set_colors(rgba, ids)
            self._viewport.update()

    def set_color_map(self, color_map: ColorMap | None, neutral: float = 0.0) -> None:
        """Set the colours for values under striped paint; None shows only the paint.

        ``neutral`` is the fraction of the scale, around its middle, displayed as no change. The values are
        written to :attr:`shades`, before or after. No draw is requested, so that it can be called during the
        preparation of one.
        """
        if color_map is not self.color_map:
            self.color_map = color_map
            self._shade()
        if color_map is not None:
            surface_shading.set_neutral_band(self._actor, neutral)
        elif self.surface_index is not None:
            self.shades[:] = 255
            self.update_shades()

    @property
    def shades(self) -> np.ndarray:
        """Overlay values (n,) uint8: 1 to 255 on the colour scale, 0 for none.

        They are a view of the opacities, to be edited in place.
        """
        return self.arrays.rgba[:, 3]

    def update_shades(self) -> None:
        """Draw edits of ``shades`` in the next frame."""
        self.arrays.update_colors()

    @property
    def shows_edges(self) -> bool:
        """True if edges are drawn."""
        return bool(self._actor.GetProperty().GetEdgeVisibility())

    @shows_edges.setter
    def shows_edges(self, on: bool) -> None:
        prop = self._actor.GetProperty()
        prop.SetEdgeVisibility(on)
        prop.SetEdgeColor(0.12, 0.13, 0.15)
        prop.SetEdgeOpacity(0.35)
        self._shade()
        self._viewport.update()

    def set_finish(self, finish: Finish) -> None:
        """Show the surface in a finish, unless values are shown."""
        self.finish = finish
        self._shade()
        self._viewport.update()

    def _shade(self) -> None:
        finish = self.finish if self.color_map is None else Finish.CLAY
        turn = 0.0 if self._texture is None else self._texture.turn
        surface_shading.shade(self._actor, self.color_map, self._cut is not None, finish, turn)
        self._inside.set_finish(finish, turn)

    @property
    def has_normals(self) -> bool:
        """True if the file of the mesh has normals."""
        return self.picking_index is not None and self.picking_index.file_shaded is not None

    @property
    def shading(self) -> Shading:
        """Kind of normals; SHARP if the file's are chosen but missing."""
        if self._shading is Shading.FILE and not self.has_normals:
            return Shading.SHARP
        return self._shading

    @shading.setter
    def shading(self, shading: Shading) -> None:
        self._shading, prop = shading, self._actor.GetProperty()
        if shading is Shading.FLAT:
            prop.SetInterpolationToFlat()
        else:
            prop.SetInterpolationToPhong()
        if self.surface_index is not None:
            self._arrange(self.surface_index, self.arrays.rgba)
            self.set_points(self._given)

    @property
    def texture(self) -> Texture | None:
        """Texture under the paint."""
        return self._texture

    @texture.setter
    def texture(self, texture: Texture | None) -> None:
        if texture is self._texture:
            return
        self._texture = texture
        slow = self._viewport.antialiasing.is_software
        image = None if texture is None else surface_shading.make_texture(texture.image, slow)
        self._actor.SetTexture(image)  # type: ignore[arg-type]
        self._shade()
        if self.surface_index is not None and self.arrays is not None:
            self._arrange(self.surface_index, self.arrays.rgba)
            self.set_points(self._given)

    def _match_view(self) -> None:
        camera = self._viewport.renderer.GetActiveCamera()
        angle = np.deg2rad(camera.GetViewAngle())
        surface_shading.match_view(self._actor, self._viewport.is_dark, angle)
        self._inside.match_view(self._viewport.is_dark, angle)

    @property
    def picking_index(self) -> SurfaceIndex | None:
        """Surface index for picking; None until it is built."""
        return None if isinstance(self.surface_index, PreviewSurface) else self.surface_index

    def hit(self, position: QPointF) -> Hit | None:
        """Ray hit at a position in the viewport; None if the ray misses."""
        skin = self.picking_index
        if skin is None:
            return None
        origin, direction = self._viewport.camera_controller.camera.ray(position.x(), position.y())
        near, far = _uncut_interval(self._cut, origin, direction)
        origin = origin + near * direction
        face, distance, b1, b2 = skin.ray_hit(origin, direction, self.U, self.boxes)
        if face < 0 or distance > far - near:
            return None
        weights = np.array([1.0 - b1 - b2, b1, b2])
        normal = self.arrays.normal_at(face, weights)
        length = float(np.linalg.norm(normal))
        normal = normal / length if length > 0 else -direction
        return Hit(face, origin + distance * direction, -normal if normal @ direction > 0 else normal)

    def barycentric_weights(self, hit: Hit) -> np.ndarray:
        """Barycentric weights (3,) of a hit."""
        assert self.surface_index is not None
        a, b, c = self.U[self.surface_index.F[hit.face]]
        weights = np.linalg.lstsq(np.column_stack([b - a, c - a]), hit.point - a, rcond=None)[0]
        fractions: np.ndarray = np.clip([1.0 - weights.sum(), *weights], 0.0, 1.0)
        return fractions / fractions.sum()

    def distances(self, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Distances (k,) of rays to the surface; infinite for misses.

        Origins and unit directions are (k, 3) arrays.
        """
        skin = self.picking_index
        if skin is None:
            return np.full(len(origins), np.inf)
        hits = [skin.ray_hit(*ray, self.U, self.boxes) for ray in zip(origins, directions, strict=True)]
        return np.array([distance if face >= 0 else np.inf for face, distance, _, _ in hits])

    @property
    def boxes(self) -> np.ndarray:
        """Bounding boxes of the triangles; see :func:`picking.boxes`."""
        if self._boxes is None:
            skin = self.picking_index
            assert skin is not None
            self._boxes = skin.block_boxes(self.U)
        return self._boxes

    def point_under(self, position: QPointF) -> np.ndarray | None:
        """Visible surface point (3,) at a position in the viewport, or None."""
        hit = self.hit(position)
        return None if hit is None else hit.point


def _uncut_interval(
    plane: tuple[np.ndarray, np.ndarray] | None, origin: np.ndarray, direction: np.ndarray
) -> tuple[float, float]:
    """Interval of ray parameters in front of a cutting plane."""
    if plane is None:
        return 0.0, np.inf
    point, normal = plane
    height, slope = float((origin - point) @ normal), float(direction @ normal)
    if slope == 0.0:
        return (0.0, np.inf) if height >= 0.0 else (0.0, -1.0)
    meets = -height / slope
    return (max(meets, 0.0), np.inf) if slope > 0.0 else (0.0, meets)
