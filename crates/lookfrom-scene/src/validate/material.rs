//! Validation of materials.

use super::Part;
use crate::error::Result;
use crate::material::{
    BumpMapping, Coat, Energy, Hair, Ior, MaterialKind, Microfacets, NormalTexture, OpenPbr, Pigment,
    Plastic, Principled, Roughness, Scalar, Subsurface, Tangent, Whitted,
};
use crate::scene::Scene;

pub(super) fn check(scene: &Scene) -> Result<()> {
    for (index, material) in scene.materials.iter().enumerate() {
        let part = Part::new(scene, &material.at, "material").numbered(index, Some(&material.name));
        check_kind(&part, &material.kind)?;
        check_bump_mapping(&part, &material.bump_mapping)?;
        part.medium(material.medium)?;
    }
    Ok(())
}

fn check_kind(part: &Part<'_>, kind: &MaterialKind) -> Result<()> {
    for color in kind.colors() {
        part.color("a colour", color)?;
    }
    match kind {
        MaterialKind::Whitted(whitted) => check_whitted(part, whitted),
        MaterialKind::DiffuseTransmission { scale, .. } => part.finite("scale", &[f64::from(*scale)]),
        MaterialKind::Conductor { roughness, energy, .. } => {
            let is_tabulated = roughness.microfacets == Microfacets::default();
            if *energy == Energy::Conserved && !is_tabulated {
                return Err(part.fault(
                    "has microfacets of which it is not known how much light goes from one to another: its energy is that of \
                     single scattering",
                ));
            }
            check_roughness(part, roughness)
        }
        MaterialKind::Dielectric { eta, roughness, .. } => {
            check_ior(part, *eta)?;
            check_roughness(part, roughness)
        }
        MaterialKind::ThinDielectric { eta, .. } => check_ior(part, *eta),
        MaterialKind::CoatedDiffuse { coat, .. } => check_coat(part, coat),
        MaterialKind::CoatedConductor { roughness, coat, .. } => {
            check_roughness(part, roughness)?;
            check_coat(part, coat)
        }
        MaterialKind::Plastic(plastic) => check_plastic(part, plastic),
        MaterialKind::Mix { materials, amount } => {
            materials.iter().try_for_each(|id| part.material(*id))?;
            part.scalar("amount", *amount)
        }
        MaterialKind::Principled(look) => check_principled(part, look),
        MaterialKind::OpenPbr(look) => check_open_pbr(part, look),
        MaterialKind::Disney(look) => {
            look.scalars().into_iter().try_for_each(|(name, scalar)| part.scalar(name, scalar))?;
            match look.eta {
                Scalar::Value(eta) => part.positive("eta", eta.into()),
                Scalar::Texture(_) => Ok(()),
            }
        }
        MaterialKind::Subsurface(below) => check_subsurface(part, below),
        MaterialKind::Hair(hair) => check_hair(part, hair),
        MaterialKind::Measured(measured) => match measured.is_consistent() {
            true => Ok(()),
            false => Err(part.fault("has tables of other sizes than it says")),
        },
        MaterialKind::ShadowCatcher { normal } => part.finite("normal", &normal.to_array().map(f64::from)),
        MaterialKind::Diffuse { .. } | MaterialKind::Unlit { .. } | MaterialKind::Interface => Ok(()),
    }
}

fn check_bump_mapping(part: &Part<'_>, mapping: &BumpMapping) -> Result<()> {
    match *mapping {
        BumpMapping::None => Ok(()),
        BumpMapping::Bump(heights) => part.scalar("bump", heights),
        BumpMapping::NormalMap(image) => part.image(image),
        BumpMapping::NormalTexture(texture) => check_normal_texture(part, texture),
    }
}

fn check_normal_texture(part: &Part<'_>, NormalTexture { texture, scale }: NormalTexture) -> Result<()> {
    part.texture(texture)?;
    part.finite("scale of normals", &[scale.into()])
}

fn check_whitted(part: &Part<'_>, whitted: &Whitted) -> Result<()> {
    part.at_least_zero("shininess", whitted.shininess.into())?;
    part.positive("ior", whitted.ior.into())?;
    check_absorption(part, whitted.absorption)
}

fn check_absorption(part: &Part<'_>, absorption: [f32; 3]) -> Result<()> {
    absorption.into_iter().try_for_each(|coefficient| part.at_least_zero("absorption", coefficient.into()))
}

fn check_ior(part: &Part<'_>, ior: Ior) -> Result<()> {
    match ior {
        Ior::Value(value) => part.positive("eta", value.into()),
        Ior::Curve(curve) => part.curve(curve),
    }
}

fn check_roughness(part: &Part<'_>, roughness: &Roughness) -> Result<()> {
    part.scalar("roughness", roughness.u)?;
    part.scalar("roughness", roughness.v)
}

fn check_coat(part: &Part<'_>, coat: &Coat) -> Result<()> {
    check_ior(part, coat.eta)?;
    check_roughness(part, &coat.roughness)?;
    part.scalar("thickness", coat.thickness)?;
    part.scalar("g", coat.g)?;
    part.number("max_depth", coat.max_depth.into(), "1 to 1048576", (1..=1 << 20).contains(&coat.max_depth))?;
    part.number("samples", coat.samples.into(), "1 to 65536", (1..=1 << 16).contains(&coat.samples))
}

fn check_plastic(part: &Part<'_>, plastic: &Plastic) -> Result<()> {
    part.positive("eta", plastic.eta.into())?;
    part.at_least_zero("alpha", plastic.alpha.into())
}

fn check_subsurface(part: &Part<'_>, below: &Subsurface) -> Result<()> {
    part.at_least_zero("scale", below.scale.into())?;
    part.number("g", below.g.into(), "between -1 and 1", below.g.abs() < 1.0)?;
    part.positive("eta", below.eta.into())?;
    check_roughness(part, &below.roughness)
}

fn check_hair(part: &Part<'_>, hair: &Hair) -> Result<()> {
    if let Pigment::Melanin { eumelanin, pheomelanin } = hair.pigment {
        part.scalar("eumelanin", eumelanin)?;
        part.scalar("pheomelanin", pheomelanin)?;
    }
    let scalars =
        [("eta", hair.eta), ("beta_m", hair.beta_m), ("beta_n", hair.beta_n), ("alpha", hair.alpha)];
    scalars.into_iter().try_for_each(|(name, scalar)| part.scalar(name, scalar))
}

fn check_principled(part: &Part<'_>, look: &Principled) -> Result<()> {
    let scalars = [
        ("metallic", look.metallic),
        ("roughness", look.roughness),
        ("specular", look.specular),
        ("transmission", look.transmission),
        ("diffuse_transmission", look.diffuse_transmission),
        ("clearcoat", look.clearcoat),
        ("clearcoat_roughness", look.clearcoat_roughness),
        ("sheen_roughness", look.sheen_roughness),
        ("iridescence", look.iridescence),
        ("iridescence_thickness", look.iridescence_thickness),
    ];
    scalars.into_iter().try_for_each(|(name, scalar)| part.scalar(name, scalar))?;
    let numbers =
        [("ior", look.ior), ("dispersion", look.dispersion), ("iridescence_ior", look.iridescence_ior)];
    numbers.into_iter().try_for_each(|(name, number)| part.at_least_zero(name, number.into()))?;
    check_absorption(part, look.absorption)?;
    if let Some(anisotropy) = look.anisotropy {
        part.finite("anisotropy", &[anisotropy.strength, anisotropy.rotation].map(f64::from))?;
        anisotropy.texture.map_or(Ok(()), |texture| part.texture(texture))?;
    }
    look.clearcoat_normal.map_or(Ok(()), |texture| check_normal_texture(part, texture))
}

fn check_open_pbr(part: &Part<'_>, look: &OpenPbr) -> Result<()> {
    look.scalars().into_iter().try_for_each(|(name, scalar)| part.scalar(name, scalar))?;
    let indices = [
        ("specular_ior", look.specular_ior),
        ("coat_ior", look.coat_ior),
        ("thin_film_ior", look.thin_film_ior),
    ];
    indices.into_iter().try_for_each(|(name, index)| part.positive(name, index.into()))?;
    part.at_least_zero("dispersion", look.dispersion.into())?;
    let anisotropy = look.subsurface_scatter_anisotropy;
    part.number("subsurface_scatter_anisotropy", anisotropy.into(), "-1 to 1", anisotropy.abs() <= 1.0)?;
    for tangent in [look.geometry_tangent, look.geometry_coat_tangent] {
        match tangent {
            Tangent::Value(direction) => part.finite("tangent", &direction.map(f64::from))?,
            Tangent::Texture(texture) => part.texture(texture)?,
        }
    }
    look.geometry_coat_normal.map_or(Ok(()), |texture| check_normal_texture(part, texture))
}
