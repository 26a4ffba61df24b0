"""One calm material and one soft light, for the window and for pictures."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkActor, vtkLight

# The light moves with the camera: a soft key from the upper left, a sky that is brighter than the
# ground, and a thin rim where the surface turns away. VTK's own lights cannot wrap around the shape:
# they leave half of it dark or wash out the painted colours, which here stay true where the surface
# faces the viewer. The rim is light on a dark background and dark on a light one.
_SHADING = """
  vec3 n = normalize(normalVCVSOutput);
  vec3 v = normalize(-vertexVC.xyz);
  vec3 key = normalize(vec3(-0.50, 0.62, 0.80));
  float wrapped = clamp((dot(n, key) + 0.35) / 1.35, 0.0, 1.0);
  float sky = 0.5 + 0.5 * n.y;
  float rim = pow(1.0 - clamp(dot(n, v), 0.0, 1.0), 3.0);
  float gloss = pow(clamp(dot(n, normalize(key + v)), 0.0, 1.0), 36.0);
  vec3 shaded = diffuseColor * (0.42 + 0.10 * sky + 0.64 * wrapped);
  shaded += 0.07 * gloss + rim * (rimOnDark * (0.05 + 0.17 * sky) * mix(vec3(1.0), diffuseColor, 0.35)
                                  - (1.0 - rimOnDark) * 0.30 * diffuseColor);
  gl_FragData[0] = vec4(shaded, opacity);
"""


def shade(actor: vtkActor) -> None:
    """Give ``actor`` the material, on a light background."""
    actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Light::Impl", True, _SHADING, False)
    match_background(actor, dark=False)


def match_background(actor: vtkActor, dark: bool) -> None:
    """Make the rim of ``actor`` stand out from a dark or a light background."""
    actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniformf("rimOnDark", float(dark))


def headlight() -> vtkLight:
    """The light of a scene: without one VTK would not hand normals to the shader."""
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    return light
