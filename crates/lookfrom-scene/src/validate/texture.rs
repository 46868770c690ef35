//! Validation of textures and their mappings.

use super::Part;
use crate::error::Result;
use crate::scene::Scene;
use crate::texture::{Mapping, MipFilter, TexelFilter, TextureKind};

/// The octaves that noise may have.
const OCTAVES: std::ops::RangeInclusive<u32> = 1..=16;

pub(super) fn check(scene: &Scene) -> Result<()> {
    for (index, texture) in scene.textures.iter().enumerate() {
        check_texture(
            &Part::new(scene, &texture.at, "texture").numbered(index, Some(&texture.name)),
            &texture.kind,
        )?;
    }
    Ok(())
}

fn check_texture(part: &Part<'_>, kind: &TextureKind) -> Result<()> {
    for color in kind.parts() {
        part.color("a colour", color)?;
    }
    match kind {
        TextureKind::Image { image, scale, mapping, filter, .. } => {
            part.image(*image)?;
            check_filter(part, *filter)?;
            part.finite("scale", &[f64::from(*scale)])?;
            check_mapping(part, mapping)
        }
        TextureKind::Noise { octaves, mapping, .. } => {
            check_octaves(part, *octaves)?;
            check_mapping(part, mapping)
        }
        TextureKind::Marble { octaves, turbulence, mapping, .. } => {
            check_octaves(part, *octaves)?;
            part.finite("turbulence", &[f64::from(*turbulence)])?;
            check_mapping(part, mapping)
        }
        TextureKind::Fbm { octaves, roughness, footprint, mapping }
        | TextureKind::Wrinkled { octaves, roughness, footprint, mapping } => {
            check_octaves(part, *octaves)?;
            check_footprint(part, *footprint)?;
            part.finite("roughness", &[f64::from(*roughness)])?;
            check_mapping(part, mapping)
        }
        TextureKind::PbrtMarble { octaves, roughness, scale, variation, footprint, mapping } => {
            check_octaves(part, *octaves)?;
            check_footprint(part, *footprint)?;
            part.finite("roughness, scale and variation", &[*roughness, *scale, *variation].map(f64::from))?;
            check_mapping(part, mapping)
        }
        TextureKind::Checker { footprint, mapping, .. } | TextureKind::Windy { footprint, mapping } => {
            check_footprint(part, *footprint)?;
            check_mapping(part, mapping)
        }
        TextureKind::Bilinear { mapping, .. } | TextureKind::Dots { mapping, .. } => {
            check_mapping(part, mapping)
        }
        TextureKind::DirectionMix { direction, .. } => {
            part.finite("direction", &direction.to_array().map(f64::from))
        }
        TextureKind::VertexColor { tint } => part.finite("tint", &tint.map(f64::from)),
        TextureKind::Threshold { edge, .. } => part.finite("edge", &[f64::from(*edge)]),
        TextureKind::Scale { .. }
        | TextureKind::Mix { .. }
        | TextureKind::Sides { .. }
        | TextureKind::Product { .. }
        | TextureKind::Quotient { .. }
        | TextureKind::VertexAlpha => Ok(()),
    }
}

fn check_filter(part: &Part<'_>, filter: TexelFilter) -> Result<()> {
    let TexelFilter::Mip { filter, footprint } = filter else { return Ok(()) };
    check_footprint(part, footprint)?;
    match filter {
        MipFilter::Ewa { anisotropy } => {
            let is_known = (1.0..=MipFilter::MOST_ANISOTROPY).contains(&anisotropy);
            part.number("anisotropy", anisotropy.into(), "1 to 64", is_known)
        }
        MipFilter::Nearest | MipFilter::Bilinear | MipFilter::Trilinear => Ok(()),
    }
}

fn check_footprint(part: &Part<'_>, footprint: f32) -> Result<()> {
    part.number("footprint", footprint.into(), "at least 0", footprint >= 0.0 && footprint.is_finite())
}

fn check_octaves(part: &Part<'_>, octaves: u32) -> Result<()> {
    part.number("octaves", octaves.into(), "1 to 16", OCTAVES.contains(&octaves))
}

fn check_mapping(part: &Part<'_>, mapping: &Mapping) -> Result<()> {
    match mapping {
        Mapping::Uv { scale, offset } => {
            part.finite("mapping", &[scale[0], scale[1], offset[0], offset[1]].map(f64::from))
        }
        Mapping::Affine { matrix: [s, t], .. } => {
            part.finite("mapping", &s.map(f64::from))?;
            part.finite("mapping", &t.map(f64::from))
        }
        Mapping::Spherical { texture_from_world }
        | Mapping::Cylindrical { texture_from_world }
        | Mapping::World { texture_from_world } => part.matrix("texture_from_world", texture_from_world),
        Mapping::Planar { texture_from_world, axes: [u, v], offset } => {
            part.matrix("texture_from_world", texture_from_world)?;
            part.finite("axes", &u.to_array().map(f64::from))?;
            part.finite("axes", &v.to_array().map(f64::from))?;
            part.finite("offset", &offset.map(f64::from))
        }
    }
}
