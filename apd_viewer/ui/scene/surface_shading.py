"""Materials, light, antialiasing and vertex arrays of surfaces."""

from __future__ import annotations

import math
import re
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from PySide6.QtCore import QTimer
from pyvistaqt import QtInteractor
from vtkmodules.vtkRenderingCore import vtkActor, vtkLight, vtkRenderer, vtkTexture

from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.geometry.picking.preview_surface import PreviewSurface
from apd_viewer.presentation.color_maps import ColorMap
from apd_viewer.presentation.palette import FREE_COLOR, paint_classes

if TYPE_CHECKING:
    from apd_viewer.geometry.picking.render_mesh import RenderMesh


class Finish(Enum):
    """Finish of a surface: the material that it resembles."""

    CLAY = "clay"
    PET = "pet"  # clear, so that its inside is seen as well
    FOIL = "foil"
    FABRIC = "fabric"


class Shading(Enum):
    """Kind of normals used to shade a surface."""

    SMOOTH = "smooth"
    SHARP = "sharp"
    FLAT = "flat"
    FILE = "file"


# The light moves with the camera: a soft key light from the upper left, a sky brighter than the
# ground, and a thin rim where the surface turns away. VTK's own lights cannot wrap around the shape:
# they leave half of it dark or wash out the painted colours, which here stay true where the surface
# faces the viewer. The rim is light on a dark background and dark on a light one. Fine triangles are smaller
# than a pixel and cost a software renderer 16 evaluations each: hence products instead of powers.
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
  float cover = OPACITY;
  FINISH
  gl_FragData[0] = vec4(shaded, cover);
"""

# Foil mirrors a studio of a dark floor, a bright sky and windows on both sides; fabric scatters light at its
# outline; PET is clear where it faces the viewer, mirrors the lamp, and keeps paint and
# texture.
_FINISHES = {
    Finish.CLAY: """
  shaded += 0.07 * gloss + rim * (rimOnDark * (0.05 + 0.17 * sky) * mix(vec3(1.0), diffuseColor, 0.35)
                                  - (1.0 - rimOnDark) * 0.30 * diffuseColor);
""",
    Finish.PET: """
  float kept = max(SHARE(diffuseColor), PRINTED);
  vec3 clear = mix(vec3(0.30, 0.36, 0.44), vec3(0.86, 0.92, 1.0), rimOnDark);
  float mirrored = smoothstep(0.55, 0.75, dot(reflect(-v, n), normalize(vec3(-0.35, 0.75, 0.55))));
  gloss *= 1.0 - 0.7 * PRINTED; mirrored *= 1.0 - 0.7 * PRINTED;
  shaded = mix(clear * (0.75 + 0.25 * sky), shaded, kept) + 0.8 * gloss + 0.45 * mirrored;
  cover = mix(mix(0.14 + 0.07 * rimOnDark + 0.62 * rim, 0.62 + 0.3 * rim, kept), 1.0, PRINTED);
  cover = clamp(cover + 0.7 * gloss + 0.28 * mirrored, 0.0, 1.0);
""",
    Finish.FOIL: """
  vec3 seen = reflect(-v, n);
  float aside = abs(seen.x + 0.15);
  float studio = 0.38 + 0.34 * smoothstep(-0.35, 0.25, seen.y) + 0.30 * smoothstep(0.45, 0.6, seen.y)
               + 0.42 * smoothstep(0.38, 0.52, aside) * (1.0 - smoothstep(0.74, 0.90, aside));
  shaded = diffuseColor * (0.16 + 0.92 * studio) + vec3(0.9 * gloss + 0.25 * rim);
""",
    Finish.FABRIC: """
  shaded = diffuseColor * (0.50 + 0.12 * sky + 0.46 * wrapped);
  shaded += 0.34 * turned * turned * (0.4 + 0.6 * sky) * mix(vec3(1.0), diffuseColor, 0.5);
""",
}

# A painted part ends in a straight line through the middles of a triangle's edges, instead of a blend over
# all of it. Each vertex has the class of its colour as one of four weights, or none: see `paint_classes`. The
# colour of one corner is known; whatever else is in the blend belongs to the others. In meshes finer than
# MOST_SHARP triangles are a few pixels, and drawn as a blend: the weights would cost more than a tenth.
MOST_SHARP = 30_000  # vertices
_CLASS_TAGS = "//VTK::Color::Dec", "//VTK::Color::Impl"
_CLASS_VERTEX = (
    """
in float paintClass;
out vec4 classVSOutput;
flat out vec4 cornerVSOutput;
""",
    """
  classVSOutput = vec4(equal(vec4(paintClass), vec4(1.0, 2.0, 3.0, 4.0)));
  cornerVSOutput = vec4(scalarColor.rgb, paintClass);
""",
)
# Edges are drawn by a geometry shader.
_CLASS_GEOMETRY = (
    """
in vec4 classVSOutput[];
flat in vec4 cornerVSOutput[];
out vec4 classGSOutput;
flat out vec4 cornerGSOutput;
""",
    """
  classGSOutput = classVSOutput[i];
  cornerGSOutput = cornerVSOutput[0];
""",
)
_CLASS_FRAGMENT = """
in vec4 classVSOutput;
flat in vec4 cornerVSOutput;
"""
_BLENDED = """
  vec3 paint = vertexColorVSOutput.rgb;
"""
_SHARP = """
  vec4 own = vec4(equal(vec4(cornerVSOutput.a), vec4(1.0, 2.0, 3.0, 4.0)));
  float isFree = 1.0 - dot(own, vec4(1.0));
  float freeShare = 1.0 - dot(classVSOutput, vec4(1.0));
  float ownShare = dot(classVSOutput, own) + isFree * freeShare;
  vec4 others = classVSOutput * (1.0 - own);
  float most = max(max(max(others.x, others.y), max(others.z, others.w)), (1.0 - isFree) * freeShare);
  float rest = 1.0 - ownShare, within = ownShare - most;
  float blend = clamp(0.5 + within / max(fwidth(within), 1e-5), 0.0, 1.0);
  vec3 paint = vertexColorVSOutput.rgb;
  if (rest > 0.002) {
    vec3 other = cornerVSOutput.rgb + (paint - cornerVSOutput.rgb) / max(rest, 0.4);
    paint = mix(other, cornerVSOutput.rgb, blend);
  }
"""

# Stripe period, as a fraction of the picture height: about sixty stripes fit above each other.
_STRIPE = 0.0157

# Measured values are stored as vertex opacities, so that they are interpolated before the colour lookup:
# halfway between loss and gain lies the neutral colour, not the mean of two colours. The paint is drawn over
# them in stripes, which leave the legend's colours visible in between. Stripes could also be placed by
# fragment coordinates, but those are slow with a software renderer.
_HEAT = """
  float heat = opacity * 255.0;
  float place = clamp((heat - 1.0) / 254.0, 0.0, 1.0);
  if (abs(place - 0.5) < 0.5 * heatNeutral) { place = 0.5; }
  float line = LINE;
  float painted = SHARE(paint);
  float stripe = abs(fract((vertexVC.x + vertexVC.y) / (stripeSlope * vertexVC.z)) - 0.5);
  painted *= clamp(16.7 * stripe - 5.5, 0.0, 1.0);
  diffuseColor = heat < 0.5 ? FREE : COLORS;
  diffuseColor = line * mix(diffuseColor, paint, painted);
"""

# Texture image of the file, with the paint drawn over it.
_TEXTURE = """
  float painted = SHARE(paint);
  diffuseColor = LINE * mix(texture(actortexture, tcoordVCVSOutput).rgb, paint, painted);
"""

# Picture on a part of the mesh, not repeated, with smooth borders and the paint drawn over it. Its colours
# are multiplied by its opacity. Its gradients are taken before a turn is subtracted: a jump shows as a line.
_PICTURE = """
  float painted = SHARE(paint);
  vec2 place = tcoordVCVSOutput, along = dFdx(place), down = dFdy(place);
  place.x -= TURN * floor((place.x - 0.5) / TURN + 0.5);
  vec2 shown = clamp(0.5 + (0.5 - abs(place - 0.5)) / max(abs(along) + abs(down), 1e-6), 0.0, 1.0);
  vec4 ink = textureGrad(actortexture, place, along, down) * shown.y * (TURN < 1.001 ? 1.0 : shown.x);
  float printed = ink.a * (1.0 - painted);
  diffuseColor = LINE * mix(ink.rgb + (1.0 - ink.a) * paint, paint, painted);
"""

_PAINT = """
  diffuseColor = LINE * paint;
"""

# Factor by which VTK darkens the paint along triangle edges, applied to the other colours as well.
_LINE = "clamp(dot(diffuseColor, vec3(1.0)) / max(dot(vertexColorVSOutput.rgb, vec3(1.0)), 0.01), 0.0, 1.0)"

# How far a colour is from that of what is not painted, 0 to 1.
_SHARE = re.compile(r"SHARE\((\w+)\)")
_SHARE_CODE = r"clamp(50.0 * dot(\1 - FREE, \1 - FREE) - 0.125, 0.0, 1.0)"

# Glass: nearly clear where it faces the viewer, denser towards its outline.
GLASS_SHADER = """
  float facing = clamp(dot(normalize(normalVCVSOutput), normalize(-vertexVC.xyz)), 0.0, 1.0);
  float rim = pow(1.0 - facing, 2.5);
  gl_FragData[0] = vec4(mix(vec3(0.16, 0.22, 0.33), vec3(0.80, 0.87, 1.0), onDark), 0.07 + 0.63 * rim);
"""

# Denser glass in the vertex colours.
TINTED_GLASS_SHADER = """
  float facing = abs(dot(normalize(normalVCVSOutput), normalize(-vertexVC.xyz)));
  float rim = 1.0 - facing;
  gl_FragData[0] = vec4(diffuseColor * (0.75 + 0.35 * facing), 0.45 + 0.35 * rim * rim);
"""
# Amber glass, to distinguish a target shape from the rest shape.
AMBER_GLASS_SHADER = GLASS_SHADER.replace("0.16, 0.22, 0.33", "0.52, 0.30, 0.02").replace(
    "0.80, 0.87, 1.0", "1.0, 0.80, 0.48"
)

# Obstacle shaders: plates are uniformly translucent, round obstacles denser towards their outline.
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

# Darkens the inside of the surface, visible where it is cut open.
_INSIDE = """
  if (!gl_FrontFacing) { diffuseColor *= 0.62; }
"""


def shade(
    actor: vtkActor,
    color_map: ColorMap | None = None,
    inside: bool = False,
    finish: Finish = Finish.CLAY,
    turn: float = 0.0,
) -> None:
    """Set the shader of ``actor`` for its mesh, colour map, edges, texture and finish.

    With ``color_map`` the opacities of its vertices are values on a scale; with ``inside`` its back
    is darker. ``turn`` is that of its texture.
    """
    code = _SHADING.replace("OPACITY", "opacity" if color_map is None else "1.0")
    code = code.replace("FINISH", _FINISHES[finish])
    if inside:
        code = _INSIDE + code
    textured = actor.GetTexture() is not None
    drawn = actor.GetMapper().GetInput()
    is_painted = drawn is not None and drawn.GetPointData().HasArray("paintClass")
    sharp = is_painted and drawn.GetNumberOfPoints() <= MOST_SHARP
    if is_painted:
        image = _PICTURE if turn else _TEXTURE
        over = _HEAT if color_map is not None else image if textured else _PAINT
        code = (_SHARP if sharp else _BLENDED) + over + code
    code = _SHARE.sub(_SHARE_CODE, code)
    values = {
        "COLORS": "" if color_map is None else color_map.glsl("place"),
        "FREE": "vec3({:.5f}, {:.5f}, {:.5f})".format(*(c / 255.0 for c in FREE_COLOR)),
        "TURN": f"{turn:#.9g}",
        "PRINTED": "printed" if turn else "0.0",
        "LINE": _LINE if actor.GetProperty().GetEdgeVisibility() else "1.0",
    }
    for name, value in values.items():
        code = code.replace(name, value)
    shader = actor.GetShaderProperty()
    shader.ClearAllShaderReplacements()
    shader.AddFragmentShaderReplacement("//VTK::Light::Impl", True, code, False)
    if sharp:
        for tag, vertex, triangle in zip(_CLASS_TAGS, _CLASS_VERTEX, _CLASS_GEOMETRY, strict=True):
            shader.AddVertexShaderReplacement(tag, True, tag + vertex, False)
            shader.AddGeometryShaderReplacement(tag, True, tag + triangle, False)
        shader.AddFragmentShaderReplacement(_CLASS_TAGS[0], True, _CLASS_TAGS[0] + _CLASS_FRAGMENT, False)
    if textured:
        # Omit VTK's own texturing, which would multiply both the light and the paint by the texture.
        shader.AddFragmentShaderReplacement("//VTK::TCoord::Impl", True, "", False)
    match_view(actor, False, math.pi / 6.0)


class InsideActor:
    """Inside of a surface in a clear finish, drawn before its outside.

    Parameters
    ----------
    renderer : vtkRenderer
    outside : vtkActor
    """

    def __init__(self, renderer: vtkRenderer, outside: vtkActor) -> None:
        self._renderer, self._outside = renderer, outside
        self._actor = vtkActor()
        self._actor.SetMapper(outside.GetMapper())
        self._actor.ForceTranslucentOn()

    def set_finish(self, finish: Finish, turn: float = 0.0) -> None:
        """Draw the inside if the finish is translucent; see :func:`shade`."""
        clear, look = finish is Finish.PET, self._outside.GetProperty()
        self._outside.SetForceOpaque(not clear)
        self._outside.SetForceTranslucent(clear)
        look.SetBackfaceCulling(clear)
        self._renderer.RemoveActor(self._actor)
        if clear:
            self._actor.SetTexture(self._outside.GetTexture())
            self._actor.GetProperty().DeepCopy(look)
            self._actor.GetProperty().SetBackfaceCulling(False)
            self._actor.GetProperty().SetFrontfaceCulling(True)
            shade(self._actor, finish=finish, turn=turn)
            self._renderer.RemoveActor(self._outside)  # translucent actors are drawn in their order
            self._renderer.AddActor(self._actor)
            self._renderer.AddActor(self._outside)

    def match_view(self, dark: bool, angle: float) -> None:
        """Adapt the shader to the background and the view angle in radians."""
        match_view(self._actor, dark, angle)
        self._actor.SetPosition(*self._outside.GetPosition())
        self._actor.SetVisibility(self._outside.GetVisibility())


def make_texture(image: np.ndarray, is_software: bool) -> vtkTexture:
    """Texture of an image (h, w, 3) uint8, repeated, or of a picture (h, w, 4).

    ``is_software`` is whether OpenGL runs on the processor.
    """
    data = pv.ImageData(dimensions=(image.shape[1], image.shape[0], 1))
    is_picture = image.shape[2] == 4
    if is_picture:  # blends with what is transparent would have its colour
        opacity = image[:, :, 3:].astype(np.uint16)
        image = np.concatenate([(image[:, :, :3] * opacity + 127) // 255, opacity], axis=2).astype(np.uint8)
    data.point_data["rgb"] = image[::-1].reshape(-1, image.shape[2])
    data.set_active_scalars("rgb")
    texture = vtkTexture()
    texture.SetInputData(data)
    texture.InterpolateOn()
    texture.MipmapOn()
    if is_software:  # filtering along the line of sight needs 3 s for a frame, all else 0.07 s
        texture.SetMaximumAnisotropicFiltering(1.0)
    texture.SetRepeat(not is_picture)
    texture.SetEdgeClamp(is_picture)
    return texture


def set_neutral_band(actor: vtkActor, neutral: float) -> None:
    """Show the middle fraction ``neutral`` of a scale as no change."""
    actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniformf("heatNeutral", neutral)


def match_view(actor: vtkActor, dark: bool, angle: float) -> None:
    """Adapt the shader to the background and the view angle in radians."""
    uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
    uniforms.SetUniformf("rimOnDark", float(dark))
    uniforms.SetUniformf("stripeSlope", 2.0 * _STRIPE * math.tan(angle / 2.0))


def headlight() -> vtkLight:
    """Headlight of a scene; without a light, VTK omits normals from the shader."""
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    return light


class SurfaceArrays:
    """Arrays of a drawn mesh, updated in place.

    The first n render vertices are those of the mesh; the others repeat some of them along sharp edges, and
    have their points and colours.

    Parameters
    ----------
    rgba : (n, 4) uint8 array
        Of the vertices; see :attr:`Surface.shades` for the opacities.
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
        self.data.point_data["paintClass"] = paint_classes(self.data.point_data["rgba"])
        self.data.GetPointData().SetActiveNormals("Normals")
        if texture is not None:
            uv = np.zeros((len(points), 2), dtype=np.float32)
            uv[rendered.F] = texture.uv[texture.uv_of]
            self.data.point_data["uv"] = uv
            self.data.GetPointData().SetActiveTCoords("uv")

    def set_points(self, U: np.ndarray, origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Update points and normals to the shape ``U`` (n, 3), relative to ``origin``."""
        points, normals = self.data.points, self.data.point_data["Normals"]
        box = self._rendered.write_render_arrays(U, origin, np.asarray(points), np.asarray(normals))
        points.VTKObject.Modified()
        normals.VTKObject.Modified()
        return box

    @property
    def rgba(self) -> np.ndarray:
        """Colours of the vertices, (n, 4)."""
        return np.asarray(self.data.point_data["rgba"])[: self._count]

    def set_colors(self, rgba: np.ndarray, ids: np.ndarray | None) -> None:
        """Set the RGB of the vertices ``ids``, or of all; opacities are kept."""
        some = slice(None) if ids is None else ids
        classes = self.data.point_data["paintClass"]
        self.rgba[some, :3] = rgba[:, :3]
        np.asarray(classes)[: self._count][some] = paint_classes(rgba)
        np.asarray(classes)[self._count :] = np.asarray(classes)[self._rendered.repeated_vertices]
        classes.VTKObject.Modified()
        self.update_colors()

    def update_colors(self) -> None:
        """Draw edits of ``rgba`` in the next frame."""
        colors = self.data.point_data["rgba"]
        np.asarray(colors)[self._count :] = self.rgba[self._rendered.repeated_vertices]
        colors.VTKObject.Modified()

    def normal_at(self, face: int, weights: np.ndarray) -> np.ndarray:
        """Drawn normal (3,) on a face at barycentric ``weights``."""
        normal: np.ndarray = weights @ np.asarray(self.data.point_data["Normals"])[self._rendered.F[face]]
        return normal

    @property
    def normals(self) -> np.ndarray:
        """Drawn vertex normals (n, 3); zero at vertices without a face."""
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
MULTISAMPLES = 8  # samples on a GPU; a software renderer needs as long for each sample as for a frame
IDLE_DELAY = 200  # ms without a draw before a software renderer redraws with smooth edges
SOFTWARE_FRAME_PAUSE = 0.1  # s between frames of the solver, to leave the processor to it


class Antialiasing:
    """Multisampling on a GPU; with software OpenGL, FXAA on an idle scene.

    Attributes
    ----------
    is_software : bool
        Whether OpenGL runs on the processor.
    frame_pause : float
        Least seconds between two frames of the solver.
    smooths_next_draw : bool
        Whether a software renderer smooths edges in the next draw.
    idle_timer : QTimer
        Running between a draw without smooth edges and the one with them.
    """

    def __init__(self, viewport: QtInteractor) -> None:
        self._viewport = viewport
        self.is_software = self.smooths_next_draw = False
        self.frame_pause = 0.0
        self.idle_timer = QTimer(viewport, singleShot=True, interval=IDLE_DELAY, timeout=self._smooth)

    def choose_samples(self, renderer: str) -> None:
        """Set the number of samples for an OpenGL renderer, by its name."""
        self.is_software = any(word in renderer.lower() for word in SOFTWARE_RENDERERS)
        self.frame_pause = SOFTWARE_FRAME_PAUSE if self.is_software else 0.0
        self._viewport.ren_win.SetMultiSamples(0 if self.is_software else MULTISAMPLES)

    def begin_draw(self) -> None:
        """Enable FXAA if due in the next draw."""
        self._viewport.renderer.SetUseFXAA(self.smooths_next_draw)

    def end_draw(self) -> None:
        """Schedule a draw with FXAA if this one lacked it."""
        if self.is_software and not self.smooths_next_draw:
            self.idle_timer.start()
        self.smooths_next_draw = False

    def _smooth(self) -> None:
        self.smooths_next_draw = True
        self._viewport.update()
