//! The nearest equivalent of a physical material in Whitted's model; an approximation.

use lookfrom_scene::material::{
    Color, Disney, Ior, MaterialKind, Metal, OpenPbr, Pigment, Principled, Roughness, Scalar,
    SubsurfaceMedium, Tint, Whitted,
};

use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::fresnel;
use crate::shading::texture::{SpectralMode, TexturePoint, Textures};

/// Reflectance of a dielectric coat at most angles.
const COAT: f32 = 0.04;

/// The nearest equivalent in Whitted's model. `before` holds those of the preceding materials: a mixture takes the
/// part of larger weight, if that is already known. `albedo` is that of the material, where it is the same everywhere.
pub(super) fn in_whitteds_model(
    kind: &MaterialKind,
    albedo: Option<[f32; 3]>,
    before: &[Whitted],
    textures: &Textures,
) -> Whitted {
    let plain = Whitted { diffuse: Color::BLACK, ..Whitted::default() };
    match kind {
        MaterialKind::Whitted(whitted) => whitted.clone(),
        MaterialKind::Diffuse { reflectance } => Whitted { diffuse: *reflectance, ..plain },
        MaterialKind::DiffuseTransmission { reflectance, .. } => Whitted { diffuse: *reflectance, ..plain },
        MaterialKind::Conductor { metal, roughness, specular_reflectance, .. } => {
            metallic(metal, *specular_reflectance, roughness, textures)
        }
        MaterialKind::Dielectric { eta, tint, .. } => {
            Whitted { transmission: tint.transmittance, fresnel: true, ior: ior(eta, textures), ..plain }
        }
        MaterialKind::ThinDielectric { eta, tint } => pane(ior(eta, textures), tint),
        MaterialKind::CoatedDiffuse { reflectance, coat } => coated(*reflectance, &coat.roughness),
        MaterialKind::Plastic(plastic) => {
            let alpha = Scalar::Value(plastic.alpha);
            coated(plastic.reflectance, &Roughness::of_alphas(alpha, alpha))
        }
        MaterialKind::Subsurface(below) => {
            let reflectance = match below.medium {
                SubsurfaceMedium::Reflectance { reflectance, .. } => reflectance,
                SubsurfaceMedium::Coefficients { .. } => albedo.map_or(Color::gray(0.5), Color::Value),
            };
            coated(reflectance, &below.roughness)
        }
        MaterialKind::Hair(hair) => {
            let reflectance = match hair.pigment {
                Pigment::Reflectance(reflectance) => reflectance,
                _ => albedo.map_or(Color::gray(0.1), Color::Value),
            };
            Whitted { diffuse: reflectance, specular: Color::gray(0.1), shininess: 50.0, ..plain }
        }
        MaterialKind::Measured(_) => Whitted {
            diffuse: albedo.map_or(Color::gray(0.5), Color::Value),
            specular: Color::gray(0.2),
            shininess: 50.0,
            ..plain
        },
        MaterialKind::CoatedConductor { metal, roughness, .. } => {
            metallic(metal, Color::gray(1.0), roughness, textures)
        }
        MaterialKind::Mix { materials: [first, second], amount } => {
            let greater = match amount {
                Scalar::Value(amount) if *amount > 0.5 => second,
                _ => first,
            };
            before.get(greater.index()).cloned().unwrap_or_default()
        }
        MaterialKind::Principled(look) => principled(look, textures),
        MaterialKind::OpenPbr(look) => principled(&as_principled(look), textures),
        MaterialKind::Disney(look) => principled(&of_disney(look), textures),
        // Its emission is all that is visible.
        MaterialKind::Unlit { .. } => plain,
        MaterialKind::ShadowCatcher { .. } => Whitted { diffuse: Color::gray(0.5), ..plain },
        MaterialKind::Interface => Whitted { transmission: Color::gray(1.0), ior: 1.0, ..plain },
    }
}

/// A pane as it is straight on: its two surfaces reflect 2R / (1 + R), with all that goes to and fro between them. Of a tint by a
/// texture only that of the transmitted light counts.
fn pane(ior: f32, tint: &Tint) -> Whitted {
    let of_one = fresnel::dielectric(1.0, ior);
    let reflected = 2.0 * of_one / (1.0 + of_one);
    let scaled = |[r, g, b]: [f32; 3], by: f32| Color::Value([r * by, g * by, b * by]);
    let mirror = match tint.reflectance {
        Color::Value(color) => scaled(color, reflected),
        _ => Color::gray(reflected),
    };
    let transmission = match tint.transmittance {
        Color::Value(color) => scaled(color, 1.0 - reflected),
        texture => texture,
    };
    Whitted { diffuse: Color::BLACK, transmission, mirror, ior: 1.0, ..Whitted::default() }
}

/// A diffuse surface under a dielectric one.
fn coated(reflectance: Color, roughness: &Roughness) -> Whitted {
    let shininess = shininess(roughness);
    let mirror = if shininess > 1e4 { Color::gray(COAT) } else { Color::BLACK };
    Whitted { diffuse: reflectance, specular: Color::gray(0.2), shininess, mirror, ..Whitted::default() }
}

/// The nearest material of glTF.
fn of_disney(look: &Disney) -> Principled {
    Principled {
        base_color: look.base_color,
        metallic: look.metallic,
        roughness: look.roughness,
        ior: match look.eta {
            Scalar::Value(eta) => eta,
            Scalar::Texture(_) => 1.5,
        },
        transmission: look.spec_trans,
        is_solid: !look.is_thin,
        clearcoat: look.clearcoat,
        ..Principled::default()
    }
}

/// The nearest material of glTF.
fn as_principled(look: &OpenPbr) -> Principled {
    Principled {
        base_color: match look.transmission_weight {
            Scalar::Value(weight) if weight > 0.5 => look.transmission_color,
            _ => look.base_color,
        },
        metallic: look.base_metalness,
        roughness: look.specular_roughness,
        ior: look.specular_ior,
        specular: look.specular_weight,
        transmission: look.transmission_weight,
        is_solid: look.is_body(),
        clearcoat: look.coat_weight,
        clearcoat_roughness: look.coat_roughness,
        ..Principled::default()
    }
}

/// Metal, glass or plastic, whichever has the largest weight; a texture is evaluated at its corner.
fn principled(look: &Principled, textures: &Textures) -> Whitted {
    let number = |scalar: Scalar| textures.float(scalar.into(), &TexturePoint::NOWHERE);
    let roughness = look.roughness;
    // A body absorbs light wherever a path is in it, also if its surface is metal at that corner.
    let absorption = if look.is_solid { look.absorption } else { [0.0; 3] };
    if number(look.metallic) > 0.5 {
        let roughness = Roughness::of_alphas(squared(roughness), squared(roughness));
        let metal = metallic(&Metal::Reflectance(look.base_color), Color::gray(1.0), &roughness, textures);
        return Whitted { absorption, ..metal };
    }
    let plain = Whitted {
        diffuse: Color::BLACK,
        ior: if look.ior > 0.0 { look.ior } else { 1.0 },
        ..Whitted::default()
    };
    if number(look.transmission) > 0.5 {
        let transmission = look.base_color;
        return match look.is_solid {
            true => Whitted { transmission, fresnel: true, absorption, ..plain },
            false => Whitted { transmission, mirror: Color::gray(COAT), ior: 1.0, ..plain },
        };
    }
    let is_coated = number(look.clearcoat) > 0.5;
    let above = if is_coated { look.clearcoat_roughness } else { roughness };
    let shininess = shininess(&Roughness::of_alphas(squared(above), squared(above)));
    let mirror = if shininess > 1e4 { Color::gray(COAT) } else { Color::BLACK };
    // A broad highlight is also faint.
    let specular = Color::gray(0.2 * number(look.specular).min(1.0) * (shininess / 50.0).min(1.0));
    Whitted { diffuse: look.base_color, specular, shininess, mirror, absorption, ..plain }
}

/// α of glTF's roughness, where it is a number.
fn squared(roughness: Scalar) -> Scalar {
    match roughness {
        Scalar::Value(value) => Scalar::Value(value * value),
        texture @ Scalar::Texture(_) => texture,
    }
}

/// A metal, whose reflectance is multiplied by another where both are constant.
fn metallic(
    metal: &Metal,
    specular_reflectance: Color,
    roughness: &Roughness,
    textures: &Textures,
) -> Whitted {
    let color = match metal {
        Metal::Reflectance(color) => *color,
        Metal::Indices { eta, k, illuminant } => {
            let of = |color| {
                let texture = textures.index_of_refraction(color, *illuminant);
                Spectrum::from_rgb(textures.rgb(&texture, &TexturePoint::NOWHERE))
            };
            Color::Value(fresnel::conductor(1.0, of(*eta), of(*k)).rgb())
        }
    };
    let color = match (color, specular_reflectance) {
        (Color::Value(color), Color::Value(factor)) => {
            Color::Value([0, 1, 2].map(|channel| color[channel] * factor[channel]))
        }
        _ => color,
    };
    let shininess = shininess(roughness);
    // A rough metal reflects lights only, as highlights; a smooth one reflects everything.
    let (mirror, specular) = if shininess > 200.0 { (color, Color::BLACK) } else { (Color::BLACK, color) };
    Whitted { diffuse: Color::BLACK, specular, shininess, mirror, ..Whitted::default() }
}

/// Exponent of Blinn's model for a Trowbridge–Reitz surface: 2/α² − 2.
fn shininess(roughness: &Roughness) -> f32 {
    let Scalar::Value(value) = roughness.u else { return 50.0 };
    let alpha = if roughness.remap { value.max(0.0).sqrt() } else { value }.max(1e-3);
    (2.0 / (alpha * alpha) - 2.0).max(1.0)
}

fn ior(ior: &Ior, textures: &Textures) -> f32 {
    match ior {
        Ior::Value(eta) => *eta,
        Ior::Curve(curve) => super::evaluator::ior_at(*curve, textures, &mut SpectralMode::Rgb),
    }
}
