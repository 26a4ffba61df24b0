"""Pictures of the scene or of given shapes, at any size."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import cast

import numpy as np
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QPoint, QRect, QSize, Qt
from PySide6.QtGui import QImage
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer, vtkRenderWindow
from vtkmodules.vtkRenderingOpenGL2 import vtkTextureObject

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import tr
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.model.state import State
from apd_viewer.ui.scene.camera_controller import place_camera
from apd_viewer.ui.scene.coloring import colors_of
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.surface_shading import Shading
from apd_viewer.ui.scene.viewport import Viewport

# Largest number of supersampled pixels; a software renderer needs seconds for more.
_MOST_DRAWN = 24_000_000
# Largest number of pixels in a picture, since several copies of it are held in memory.
_MOST = 200_000_000


def scene_picture(
    viewport: Viewport, size: QSize, transparent: bool = False, renderer: vtkRenderer | None = None
) -> QImage:
    """Render the viewport's scene without tools, complete at any aspect ratio.

    Parameters
    ----------
    size : QSize
        Pixels.
    transparent : bool
        Whether to leave the background out.
    renderer : vtkRenderer or None
        Another scene than that of the viewport, with a camera of its own that shows all there is.

    Raises
    ------
    InputError
        If so many pixels cannot be drawn.
    """
    viewport.prepare_scene()
    scene = viewport.renderer if renderer is None else renderer
    with viewport.offscreen_window() as window:
        if window is None:
            raise InputError(tr("Nothing can be drawn: OpenGL is not available; update the graphics driver."))
        finer = _supersampling(window, size)
        seen = viewport.size() if renderer is None else size
        with (
            _draw_only(window, scene),
            _widened_view(scene, seen, size),
            _transparent_background(window, scene, viewport.backdrop if transparent else None),
            _thicker_lines(scene, finer * picture_scale(seen, size)),
        ):
            # FXAA would blend the outline of a transparent picture with the omitted background.
            scene.SetUseFXAA(finer == 1 and not transparent and window.GetMultiSamples() == 0)
            image = _rendered_image(window, size * finer, transparent)
            scene.SetUseFXAA(False)
    if finer > 1:
        smooth = Qt.TransformationMode.SmoothTransformation
        image = image.scaled(size, Qt.AspectRatioMode.IgnoreAspectRatio, smooth)
    return image


def small_picture(viewport: Viewport, side: int) -> bytes:
    """PNG bytes of the cropped scene; its longer side has at most ``side`` pixels.

    Empty where nothing can be drawn.
    """
    keep, smooth = Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
    try:
        size = viewport.size().scaled(2 * side, 2 * side, keep).expandedTo(QSize(1, 1))
        image = _cropped_image(scene_picture(viewport, size, transparent=True))
        if max(image.width(), image.height()) > side:
            image = image.scaled(side, side, keep, smooth)
        return encode_png(image)
    except InputError:
        return b""


def _cropped_image(image: QImage) -> QImage:
    """Image without transparent margins; a fully transparent one is unchanged."""
    alpha = image.convertToFormat(QImage.Format.Format_Alpha8)
    lines = np.frombuffer(alpha.constBits(), dtype=np.uint8).reshape(alpha.height(), -1)
    covered = lines[:, : alpha.width()] > 0
    rows, columns = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered.any(axis=0))
    if not len(rows):
        return image
    corners = QPoint(int(columns[0]), int(rows[0])), QPoint(int(columns[-1]), int(rows[-1]))
    return image.copy(QRect(*corners))


def encode_png(image: QImage) -> bytes:
    """Encode an image as PNG bytes."""
    content = QByteArray()
    buffer = QBuffer(content)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    if not image.save(buffer, "PNG"):
        raise InputError(tr("The picture could not be encoded; choose a smaller one."))
    return bytes(content.data())


def check_picture_size(viewport: Viewport, size: QSize) -> None:
    """Raise InputError if a picture of this size cannot be drawn."""
    with viewport.offscreen_window() as window:
        if window is not None:
            _supersampling(window, size)


def picture_scale(view_size: QSize, size: QSize) -> float:
    """Scale factor from a view of ``view_size`` to a picture of ``size``."""
    return min(size.width() / max(view_size.width(), 1), size.height() / max(view_size.height(), 1))


def _supersampling(window: vtkRenderWindow, size: QSize) -> int:
    """Supersampling factor: 2 if affordable and without multisampling, else 1."""
    most, longest = int(vtkTextureObject.GetMaximumTextureSize(window)), max(size.width(), size.height())
    if longest > most:
        said = tr("A picture can have up to {most:,} pixels per side on this computer; choose a smaller one.")
        raise InputError(said.format(most=most))
    pixels = size.width() * size.height()
    if pixels > _MOST:
        said = tr("A picture can have up to {most:,} million pixels; choose a smaller one.")
        raise InputError(said.format(most=_MOST // 1_000_000))
    rough = window.GetMultiSamples() == 0
    return 2 if rough and 2 * longest <= most and 4 * pixels <= _MOST_DRAWN else 1


def _rendered_image(window: vtkRenderWindow, size: QSize, transparent: bool) -> QImage:
    width, height = size.width(), size.height()
    window.GetInteractor().UpdateSize(width, height)
    window.Render()
    pixels = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, pixels)
    rows = vtk_to_numpy(pixels).reshape(height, width, 4)[::-1].copy()
    # A transparent background gives premultiplied colours; an opaque one wrongly reports zero alpha.
    kind = QImage.Format.Format_RGBA8888_Premultiplied
    if not transparent:
        rows[:, :, 3], kind = 255, QImage.Format.Format_RGBX8888
    return QImage(rows.data, width, height, 4 * width, kind).copy()


@contextmanager
def _draw_only(window: vtkRenderWindow, scene: vtkRenderer) -> Iterator[None]:
    """Draw only one renderer of the window within the context."""
    others = [other for other in window.GetRenderers() if other is not scene and other.GetDraw()]
    guest = not window.HasRenderer(scene)
    for other in others:
        other.DrawOff()
    if guest:
        window.AddRenderer(scene)
    try:
        yield
    finally:
        if guest:
            window.RemoveRenderer(scene)
        for other in others:
            other.DrawOn()


@contextmanager
def _widened_view(scene: vtkRenderer, seen: QSize, size: QSize) -> Iterator[None]:
    """Widen the camera angle for a narrower picture within the context.

    What is in the middle of the view's free part comes into the middle of the picture.
    """
    camera = scene.GetActiveCamera()
    angle, centre = camera.GetViewAngle(), camera.GetWindowCenter()
    camera.SetWindowCenter(0.0, 0.0)
    narrower = (seen.width() * size.height()) / max(seen.height() * size.width(), 1)
    if narrower > 1.0:
        camera.SetViewAngle(math.degrees(2.0 * math.atan(narrower * math.tan(math.radians(angle) / 2.0))))
    try:
        yield
    finally:
        camera.SetViewAngle(angle)
        camera.SetWindowCenter(*centre)


@contextmanager
def _transparent_background(
    window: vtkRenderWindow, scene: vtkRenderer, backdrop: Sequence[vtkActor] | None
) -> Iterator[None]:
    """Leave out the background and its actors within the context; nothing if None."""
    if backdrop is None:
        yield
        return
    hidden = [actor for actor in backdrop if actor.GetVisibility()]
    for actor in hidden:
        actor.SetVisibility(False)
    color, blended = scene.GetBackground(), scene.GetGradientBackground()
    alpha, bits = scene.GetBackgroundAlpha(), window.GetAlphaBitPlanes()
    scene.SetBackground(0.0, 0.0, 0.0)
    scene.GradientBackgroundOff()
    scene.SetBackgroundAlpha(0.0)
    window.SetAlphaBitPlanes(1)
    try:
        yield
    finally:
        for actor in hidden:
            actor.SetVisibility(True)
        scene.SetBackground(*color)
        scene.SetGradientBackground(blended)
        scene.SetBackgroundAlpha(alpha)
        window.SetAlphaBitPlanes(bits)


@contextmanager
def _thicker_lines(scene: vtkRenderer, factor: float) -> Iterator[None]:
    """Scale line widths by ``factor`` within the context."""
    _scale_line_widths(scene, factor)
    try:
        yield
    finally:
        _scale_line_widths(scene, 1.0 / factor)


def _scale_line_widths(scene: vtkRenderer, factor: float) -> None:
    for actor in scene.GetActors():
        look = actor.GetProperty()
        look.SetLineWidth(factor * look.GetLineWidth())


_LONGER = 1000  # px
_ROOM = 0.02  # margin around the shapes, as a fraction of the picture


class _OffscreenViewport:
    """Stand-in with the viewport attributes needed by a surface."""

    is_dark = False

    def __init__(self, viewport: Viewport) -> None:
        self.renderer, self.antialiasing = vtkRenderer(), viewport.antialiasing
        self.pre_draw: list[Callable[[], None]] = []
        self.box: Callable[[], tuple[float, ...]] | None = None
        self.pick_point: object = None

    def update(self) -> None:
        """Do nothing, as there is no screen."""


class OffscreenScene:
    """Renders the shapes of a state from the user's view direction, at one scale.

    Parameters
    ----------
    viewport : Viewport
        Draws the pictures, which have no background.
    shading : Shading
        See :class:`apd_viewer.ui.scene.surface.Surface`.
    texture : Texture or None
        Under the paint.
    """

    def __init__(
        self, viewport: Viewport, state: State, edges: bool, shading: Shading, texture: Texture | None = None
    ) -> None:
        self._viewport, self._set = viewport, _OffscreenViewport(viewport)
        self._surface = Surface(cast("Viewport", self._set))
        self._surface.set_mesh(state.surface_index, state.frame.U, colors_of(state.document))
        self._surface.shows_edges, self._surface.shading, self._texture = edges, shading, texture
        used = used_vertices(state.surface_index.F)
        self.size = self._frame_points(np.concatenate([state.document.mesh.V[used], state.frame.U[used]]))

    def _frame_points(self, points: np.ndarray) -> QSize:
        """Frame all points, and return a fitting picture size."""
        eye = self._viewport.camera_controller.camera
        right, up, _ = eye.axes
        wide, high = float(np.ptp(points @ right)), float(np.ptp(points @ up))
        ratio = min(max(wide / high if high > 0.0 else 2.0, 0.7), 4.0 / 3.0)
        size = (
            QSize(_LONGER, round(_LONGER / ratio)) if ratio > 1.0 else QSize(round(_LONGER * ratio), _LONGER)
        )
        eye = replace(eye, width=size.width(), height=size.height(), left=0.0)
        eye = eye.framed(points, np.full(len(points), _ROOM * _LONGER))
        place_camera(self._set.renderer.GetActiveCamera(), eye)
        return size

    def painted_picture(self, U: np.ndarray) -> QImage:
        """Picture of the shape ``U`` (n, 3) with its paint."""
        self._surface.set_color_map(None)
        self._surface.texture = self._texture
        return self._take_picture(U)

    def colored_picture(self, U: np.ndarray, shades: np.ndarray, scale: Scale) -> QImage:
        """Picture of ``U`` coloured by scalars on a ``scale``."""
        neutral = scale.neutral_fraction if scale.measure.is_signed else -1.0
        self._surface.texture = None
        self._surface.set_color_map(scale.measure.colors, neutral)
        self._surface.shades[:] = shades
        self._surface.update_shades()
        return self._take_picture(U)

    def _take_picture(self, U: np.ndarray) -> QImage:
        self._surface.set_points(U)
        if self._set.box is not None:
            self._set.renderer.ResetCameraClippingRange(list(self._set.box()))
        for prepare in self._set.pre_draw:
            prepare()
        return scene_picture(self._viewport, self.size, transparent=True, renderer=self._set.renderer)
