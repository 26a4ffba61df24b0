"""Material, light and antialiasing of surfaces, and their arrays."""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from PySide6.QtCore import QTimer
from pyvistaqt import QtInteractor
from vtkmodules.vtkRenderingCore import vtkActor, vtkLight, vtkTexture

from apd_viewer.geometry.mesh.mesh import Texture
from apd_viewer.geometry.picking.preview_surface import PreviewSurface
from apd_viewer.presentation.color_maps import ColorMap
from apd_viewer.presentation.palette import FREE_COLOR

if TYPE_CHECKING:
    from apd_viewer.geometry.picking.render_mesh import RenderMesh


class Shading(Enum):
    """Normals of a drawn surface."""

    SMOOTH = "smooth"
    SHARP = "sharp"
    FLAT = "flat"
    FILE = "file"


# The light moves with the camera: a soft key from the upper left, a sky that is brighter than the
# ground, and a thin rim where the surface turns away. VTK's own lights cannot wrap around the shape:
# they leave half of it dark or wash out the painted colours, which here stay true where the surface
# faces the viewer. The rim is light on a dark background, dark on a light one. Triangles of a fine mesh are
# smaller than a pixel, and without a graphics card each costs this sixteen times: hence products for powers.
_SHADING = """
  vec3 n = normalize(normalVCVSOutput);
  vec3 v = normalize(-vertexVC.xyz);
  vec3 key = normalize(vec3(-0.50, 0.62, 0.80));
  float wrapped = clamp((dot(n, key) + 0.35) / 1.35, 0.0, 1.0);
  float sky = 0.5 + 0.5 * n.y;
  float turned = 1.0 - clamp(dot(n, v), 0.0, 1.0);
  float rim = turned * turned * turned;
  float gloss = clamp(dot(n, normalize(key + v)), 0.0, 1.0);
  gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss;
  vec3 shaded = diffuseColor * (0.42 + 0.10 * sky + 0.64 * wrapped);
  shaded += 0.07 * gloss + rim * (rimOnDark * (0.05 + 0.17 * sky) * mix(vec3(1.0), diffuseColor, 0.35)
                                  - (1.0 - rimOnDark) * 0.30 * diffuseColor);
  gl_FragData[0] = vec4(shaded, OPACITY);
"""

# Of the height of the picture: some sixty of them are seen above each other.
_STRIPE = 0.0157

# Measured values come as the opacity of the vertices, so that they are blended over a triangle before they
# are made a colour: between a loss and a gain there is no change, and not the mean of two colours. What is
# painted lies over them in stripes, between which the colours are those of the legend. The place of a pixel
# in the picture would say as well where they are, but a software renderer takes long to tell it.
_HEAT = """
  float heat = opacity * 255.0;
  float place = clamp((heat - 1.0) / 254.0, 0.0, 1.0);
  if (abs(place - 0.5) < 0.5 * heatNeutral) { place = 0.5; }
  vec3 paint = vertexColorVSOutput.rgb;
  float line = LINE;
  vec3 away = paint - FREE;
  float painted = clamp(50.0 * dot(away, away) - 0.125, 0.0, 1.0);
  float stripe = abs(fract((vertexVC.x + vertexVC.y) / (stripeSlope * vertexVC.z)) - 0.5);
  painted *= clamp(16.7 * stripe - 5.5, 0.0, 1.0);
  diffuseColor = heat < 0.5 ? FREE : COLORS;
  diffuseColor = line * mix(diffuseColor, paint, painted);
"""

# Of the file's image; what is painted lies over it.
_TEXTURE = """
  vec3 paint = vertexColorVSOutput.rgb;
  vec3 away = paint - FREE;
  float painted = clamp(50.0 * dot(away, away) - 0.125, 0.0, 1.0);
  diffuseColor = LINE * mix(texture(actortexture, tcoordVCVSOutput).rgb, paint, painted);
"""

# Edges of triangles, by which VTK has darkened the paint, darken the colours too.
_LINE = "clamp(dot(diffuseColor, vec3(1.0)) / max(dot(paint, vec3(1.0)), 0.01), 0.0, 1.0)"

# Seen through from the front, and at its outline.
GLASS_SHADER = """
  float facing = clamp(dot(normalize(normalVCVSOutput), normalize(-vertexVC.xyz)), 0.0, 1.0);
  float rim = pow(1.0 - facing, 2.5);
  gl_FragData[0] = vec4(mix(vec3(0.16, 0.22, 0.33), vec3(0.80, 0.87, 1.0), onDark), 0.07 + 0.63 * rim);
"""

# The same in the colour of the vertices, denser.
TINTED_GLASS_SHADER = """
  float facing = abs(dot(normalize(normalVCVSOutput), normalize(-vertexVC.xyz)));
  float rim = 1.0 - facing;
  gl_FragData[0] = vec4(diffuseColor * (0.75 + 0.35 * facing), 0.45 + 0.35 * rim * rim);
"""
# The same in amber, to tell a target shape from the rest shape.
AMBER_GLASS_SHADER = GLASS_SHADER.replace("0.16, 0.22, 0.33", "0.52, 0.30, 0.02").replace(
    "0.80, 0.87, 1.0", "1.0, 0.80, 0.48"
)

# Of obstacles, in their colour: plates are as clear all over, round ones denser at their outline.
PLATE_SHADER = """
  gl_FragData[0] = vec4(diffuseColor, opacity);
"""
ROUND_OBSTACLE_SHADER = """
  vec3 n = normalize(normalVCVSOutput);
  vec3 v = normalize(-vertexVC.xyz);
  vec3 key = normalize(vec3(-0.50, 0.62, 0.80));
  float rim = 1.0 - abs(dot(n, v));
  float gloss = clamp(dot(n, normalize(key + v)), 0.0, 1.0);
  gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss;
  vec3 shaded = diffuseColor * (0.70 + 0.45 * clamp(dot(n, key), 0.0, 1.0)) + 0.25 * gloss;
  gl_FragData[0] = vec4(shaded, clamp(opacity * (0.85 + 0.9 * rim * rim) + 0.25 * gloss, 0.0, 1.0));
"""

# What is seen of the inside where the surface is cut.
_INSIDE = """
  if (!gl_FrontFacing) { diffuseColor *= 0.62; }
"""


def shade(actor: vtkActor, color_map: ColorMap | None = None, inside: bool = False) -> None:
    """Give ``actor`` its shader, for the given heat colours, its edges and texture.

    With ``color_map`` the opacities of its vertices are values on a scale; with ``inside`` its back
    is darker.
    """
    code = _SHADING.replace("OPACITY", "opacity" if color_map is None else "1.0")
    if inside:
        code = _INSIDE + code
    textured = actor.GetTexture() is not None
    code = (_HEAT if color_map is not None else _TEXTURE if textured else "") + code
    values = {
        "COLORS": "" if color_map is None else color_map.glsl("place"),
        "FREE": "vec3({:.5f}, {:.5f}, {:.5f})".format(*(c / 255.0 for c in FREE_COLOR)),
        "LINE": _LINE if actor.GetProperty().GetEdgeVisibility() else "1.0",
    }
    for name, value in values.items():
        code = code.replace(name, value)
    shader = actor.GetShaderProperty()
    shader.ClearAllFragmentShaderReplacements()
    shader.AddFragmentShaderReplacement("//VTK::Light::Impl", True, code, False)
    if textured:
        # VTK would multiply the light by it, and the paint too.
        shader.AddFragmentShaderReplacement("//VTK::TCoord::Impl", True, "", False)
    match_view(actor, False, math.pi / 6.0)


def texture_of(image: np.ndarray) -> vtkTexture:
    """Texture of an image (h, w, 3) uint8, repeated beyond its border."""
    data = pv.ImageData(dimensions=(image.shape[1], image.shape[0], 1))
    data.point_data["rgb"] = image[::-1].reshape(-1, 3)
    data.set_active_scalars("rgb")
    texture = vtkTexture()
    texture.SetInputData(data)
    texture.InterpolateOn()
    texture.MipmapOn()
    texture.RepeatOn()
    return texture


def set_neutral_band(actor: vtkActor, neutral: float) -> None:
    """Show ``neutral`` of a scale, around its middle, as no change."""
    actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniformf("heatNeutral", neutral)


def match_view(actor: vtkActor, dark: bool, angle: float) -> None:
    """Adapt the shader to the background and the opening angle in radians."""
    uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
    uniforms.SetUniformf("rimOnDark", float(dark))
    uniforms.SetUniformf("stripeSlope", 2.0 * _STRIPE * math.tan(angle / 2.0))


def headlight() -> vtkLight:
    """The light of a scene: without one VTK would not hand normals to the shader."""
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    return light


class SurfaceArrays:
    """Arrays of a drawn mesh, updated in place.

    The first n render vertices are those of the mesh; the others repeat some of them along sharp edges, and
    have their points and colours.

    Parameters
    ----------
    rendered : RenderMesh or PreviewSurface
    rgba : (n, 4) uint8 array
        Of the vertices; see :meth:`Surface.wear` for the opacities.
    texture : Texture, optional
        With seams where vertices of ``rendered`` are repeated.
    """

    def __init__(
        self, rendered: RenderMesh | PreviewSurface, rgba: np.ndarray, texture: Texture | None = None
    ) -> None:
        self._rendered, self._count = rendered, len(rgba)
        copied = rendered.repeated_vertices
        points = np.zeros((self._count + len(copied), 3), dtype=np.float32)
        self.data = pv.PolyData.from_regular_faces(points, rendered.F)
        self.data.point_data["Normals"] = np.zeros_like(self.data.points)
        self.data.point_data["rgba"] = np.vstack([rgba, rgba[copied]]) if len(copied) else rgba.copy()
        self.data.GetPointData().SetActiveNormals("Normals")
        if texture is not None:
            uv = np.zeros((len(points), 2), dtype=np.float32)
            uv[rendered.F] = texture.uv[texture.uv_of]
            self.data.point_data["uv"] = uv
            self.data.GetPointData().SetActiveTCoords("uv")

    def set_points(self, U: np.ndarray, origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Follow the shape ``U`` (n, 3); see :meth:`RenderMesh.drape`."""
        points, normals = self.data.points, self.data.point_data["Normals"]
        box = self._rendered.drape(U, origin, np.asarray(points), np.asarray(normals))
        points.VTKObject.Modified()
        normals.VTKObject.Modified()
        return box

    @property
    def rgba(self) -> np.ndarray:
        """Colours of the vertices, (n, 4)."""
        return np.asarray(self.data.point_data["rgba"])[: self._count]

    def set_colors(self, rgba: np.ndarray, ids: np.ndarray | None) -> None:
        """Colour the vertices ``ids``, or all, and keep their opacities."""
        self.rgba[slice(None) if ids is None else ids, :3] = rgba[:, :3]
        self.update_colors()

    def update_colors(self) -> None:
        """Draw the edited ``rgba`` from the next frame on."""
        colors = self.data.point_data["rgba"]
        np.asarray(colors)[self._count :] = self.rgba[self._rendered.repeated_vertices]
        colors.VTKObject.Modified()

    def normal_at(self, face: int, weights: np.ndarray) -> np.ndarray:
        """Normal (3,) as drawn at a point of a face with barycentric ``weights``."""
        normal: np.ndarray = weights @ np.asarray(self.data.point_data["Normals"])[self._rendered.F[face]]
        return normal

    @property
    def normals(self) -> np.ndarray:
        """Vertex normals (n, 3) as drawn; zero without a face."""
        return np.asarray(self.data.point_data["Normals"])[: self._count]


SOFTWARE_RENDERERS = (
    "llvmpipe",
    "softpipe",
    "swrast",
    "swiftshader",
    "software",
    "gdi generic",
    "basic render",
)
MULTISAMPLES = 8  # on a GPU; each sample costs a software renderer as much as a frame
IDLE_DELAY = 120  # ms without a draw, after which a software renderer draws once more, with smooth edges


class Antialiasing:
    """Multisampling on a GPU; in software, smooth edges once the scene rests.

    Parameters
    ----------
    viewport : QtInteractor

    Attributes
    ----------
    is_software : bool
        Whether OpenGL runs on the processor.
    smooths_next_draw : bool
        Whether a software renderer smooths edges in the next draw.
    idle_timer : QTimer
        Running between a draw without smooth edges and the one with them.
    """

    def __init__(self, viewport: QtInteractor) -> None:
        self._viewport = viewport
        self.is_software = self.smooths_next_draw = False
        self.idle_timer = QTimer(viewport, singleShot=True, interval=IDLE_DELAY)
        self.idle_timer.timeout.connect(self._smooth)

    def choose_samples(self, renderer: str) -> None:
        """Choose the samples by the name of the OpenGL renderer."""
        self.is_software = any(word in renderer.lower() for word in SOFTWARE_RENDERERS)
        self._viewport.ren_win.SetMultiSamples(0 if self.is_software else MULTISAMPLES)

    def begin_draw(self) -> None:
        """Set up the scene for a draw."""
        self._viewport.renderer.SetUseFXAA(self.smooths_next_draw)

    def end_draw(self) -> None:
        """Plan the draw with smooth edges if this one was without."""
        if self.is_software and not self.smooths_next_draw:
            self.idle_timer.start()
        self.smooths_next_draw = False

    def _smooth(self) -> None:
        self.smooths_next_draw = True
        self._viewport.update()
