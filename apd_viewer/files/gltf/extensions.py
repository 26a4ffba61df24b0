"""Version and required extensions of a glTF file: those without other geometry."""

from __future__ import annotations

from typing import Any

from apd_viewer.files.gltf.scene import list_field
from apd_viewer.language import tr

COMPRESSED = (
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "MESHOPT_compression",
)
# Read, or about looks, light and data beside the geometry.
_READ = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing"}
_HARMLESS = {
    "AGI_articulations",
    "AGI_stk_metadata",
    "EXT_instance_features",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_audio_emitter",
    "KHR_lights_punctual",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_techniques_webgl",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
}
_OF_MATERIALS = "KHR_materials_"  # all extensions of this name are


def check_supported(document: dict[str, Any]) -> None:
    """Raise ValueError on an unknown version or required extension."""
    asset = document.get("asset")
    told = asset if isinstance(asset, dict) else {}
    version = str(told.get("minVersion", told.get("version", "2.0")))
    if version.partition(".")[0] != "2" or ("minVersion" in told and version != "2.0"):
        raise ValueError(tr("it is version {version}; only version 2 is supported").format(version=version))
    for name in map(str, list_field(document, "extensionsRequired")):
        if name in COMPRESSED:
            raise compressed_error(name)
        if name not in _READ | _HARMLESS and not name.startswith(_OF_MATERIALS):
            raise ValueError(tr("it requires {extension}, which is not supported").format(extension=name))


def compressed_error(extension: str) -> ValueError:
    """Error for geometry packed by an extension."""
    return ValueError(
        tr("it is compressed ({extension}), which is not supported").format(extension=extension)
    )


def extension_fields(entry: dict[str, Any], name: str) -> dict[str, Any] | None:
    """Fields of an entry in an extension; None without any."""
    extensions = entry.get("extensions")
    found = extensions.get(name) if isinstance(extensions, dict) else None
    return found if isinstance(found, dict) else None
