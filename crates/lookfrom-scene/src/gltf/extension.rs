//! The list of supported extensions, and warnings and errors for others.

use super::file::Document;
use crate::files::LoadContext;

/// Supported extensions.
const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Extensions that do not affect the rendered image.
const WITHOUT_A_LOOK: &[&str] = &[
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "KHR_node_selectability",
    "KHR_node_hoverability",
    "EXT_mesh_features",
    "EXT_structural_metadata",
];

/// Whether an extension is supported or safe to ignore.
fn is_known(name: &str) -> bool {
    READ.contains(&name) || WITHOUT_A_LOOK.contains(&name)
}

/// Warns of unknown extensions.
pub(super) fn warn(document: &Document, context: &mut LoadContext<'_>) {
    let root = &document.root;
    for (index, name) in root.extensions_required.iter().enumerate().filter(|(_, name)| !is_known(name)) {
        let at = document.at(&format!("/extensionsRequired/{index}"));
        let message = format!(
            "the file requires the extension {name}, which is not known: it is read without the extension, and may look \
             wrong"
        );
        context.warn(&at, message);
    }
    for (index, name) in root.extensions_used.iter().enumerate() {
        if !is_known(name) && !root.extensions_required.contains(name) {
            let at = document.at(&format!("/extensionsUsed/{index}"));
            context.warn(&at, format!("the extension {name} is not known and is ignored"));
        }
    }
}
