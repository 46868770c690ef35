//! Compilation of materials.

use std::sync::Arc;

use lookfrom_scene::material as written;
use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::scene::{TextureId, VertexNormals};

use super::kind::{
    Anisotropy, BumpMapping, CoatMaterial, Ior, MaterialKind, Metal, NormalTexture, PlasticMaterial,
    PrincipledMaterial, Roughness, SubsurfaceMaterial, SubsurfaceMedium, TintTextures, WhittedMaterial,
};
use super::{Material, albedo, approximate, measured, pictures, principled};
use crate::shading::bsdf::layered::CoatInterior;
use crate::shading::bsdf::microfacet::{Microfacets, TrowbridgeReitz};
use crate::shading::bsdf::normalized_fresnel::NormalizedFresnel;
use crate::shading::bsdf::plastic::Interface;
use crate::shading::bssrdf::table::ProfileTable;
use crate::shading::texture::{SpectrumTexture, SpectrumType, Textures};

/// Whether a path sees nothing of Whitted's model but diffuse reflection.
fn is_matte(whitted: &written::Whitted) -> bool {
    let written::Whitted { ambient, specular, mirror, transmission, .. } = *whitted;
    ambient.is_none() && [specular, mirror, transmission] == [Color::BLACK; 3]
}

/// Compiles materials. A mix may only refer to earlier ones.
pub(crate) struct Compiler<'a> {
    textures: &'a Textures,
    vertex_normals: VertexNormals,
    /// By material: its nearest equivalent in Whitted's model.
    whitted: Vec<written::Whitted>,
    /// Tables of profiles, by phase function and index of refraction: materials share them.
    profiles: Vec<((f32, f32), Arc<ProfileTable>)>,
}

impl<'a> Compiler<'a> {
    pub(crate) fn new(textures: &'a Textures, vertex_normals: VertexNormals) -> Self {
        Self { textures, vertex_normals, whitted: Vec::new(), profiles: Vec::new() }
    }

    /// The next material, and the absorption coefficient of a body of it per unit of length, by primary,
    /// 0 for none.
    pub(crate) fn compile(&mut self, material: &written::Material) -> (Material, [f32; 3]) {
        let (kind, bump_mapping) = (self.kind(&material.kind), self.bump_mapping(&material.bump_mapping));
        let albedo = albedo::constant(&kind, self.textures);
        let whitted = approximate::in_whitteds_model(&material.kind, albedo, &self.whitted, self.textures);
        let is_principled = matches!(kind, MaterialKind::Principled(_) | MaterialKind::OpenPbr(_));
        let (pictures, varies) = pictures::of(&kind, &bump_mapping, self.textures);
        let compiled = Material {
            albedo,
            needs_footprint: false,
            pictures,
            varies,
            kind,
            bump_mapping,
            bump_guard: material.bump_guard.filter(|_| material.bump_mapping != written::BumpMapping::None),
            back_face: material.back_face,
            reflects_outside: is_principled || self.vertex_normals == VertexNormals::Smooth,
            medium: None,
            whitted: self.whitted(&whitted),
        };
        let absorption = whitted.absorption;
        self.whitted.push(whitted);
        (compiled, absorption)
    }

    pub(super) fn albedo(&self, color: Color) -> SpectrumTexture {
        self.textures.spectrum_texture(color, SpectrumType::Albedo)
    }

    pub(super) fn unbounded(&self, color: Color) -> SpectrumTexture {
        self.textures.spectrum_texture(color, SpectrumType::Unbounded)
    }

    fn kind(&mut self, kind: &written::MaterialKind) -> MaterialKind {
        use written::MaterialKind as Written;
        match kind {
            // In lanes, with the same light.
            Written::Whitted(whitted) if is_matte(whitted) => {
                MaterialKind::Diffuse { reflectance: self.unbounded(whitted.diffuse) }
            }
            Written::Whitted(whitted) => MaterialKind::Whitted(Box::new(self.whitted(whitted))),
            Written::Diffuse { reflectance } => {
                MaterialKind::Diffuse { reflectance: self.albedo(*reflectance) }
            }
            Written::DiffuseTransmission { reflectance, transmittance, scale } => {
                MaterialKind::DiffuseTransmission {
                    reflectance: self.albedo(*reflectance),
                    transmittance: self.albedo(*transmittance),
                    scale: *scale,
                }
            }
            &Written::Conductor { ref metal, ref roughness, energy, specular_reflectance } => {
                MaterialKind::Conductor {
                    metal: self.metal(metal),
                    roughness: rough(roughness),
                    energy,
                    specular_reflectance: self.albedo(specular_reflectance),
                }
            }
            &Written::Dielectric { eta, ref roughness, energy, ref tint } => {
                let (eta, roughness) = (index(eta), rough(roughness));
                match self.tint(tint) {
                    Some(tint) => MaterialKind::TintedDielectric { eta, roughness, energy, tint },
                    None => MaterialKind::Dielectric { eta, roughness, energy },
                }
            }
            Written::ThinDielectric { eta, tint } => {
                MaterialKind::ThinDielectric { eta: index(*eta), tint: self.tint(tint) }
            }
            Written::CoatedDiffuse { reflectance, coat } => MaterialKind::CoatedDiffuse {
                reflectance: self.albedo(*reflectance),
                coat: Box::new(self.coat(coat)),
            },
            Written::CoatedConductor { metal, roughness, coat } => MaterialKind::CoatedConductor {
                metal: self.metal(metal),
                roughness: rough(roughness),
                coat: Box::new(self.coat(coat)),
            },
            Written::Plastic(plastic) => MaterialKind::Plastic(Box::new(self.plastic(plastic))),
            Written::Mix { materials, amount } => {
                MaterialKind::Mix { materials: materials.map(|id| id.0), amount: (*amount).into() }
            }
            Written::Hair(hair) => MaterialKind::Hair(Box::new(self.hair(hair))),
            Written::Measured(measured) => MaterialKind::Measured(measured::tables(measured)),
            Written::Subsurface(below) => MaterialKind::Subsurface(Box::new(self.subsurface(below))),
            Written::Principled(look) => MaterialKind::Principled(Box::new(self.principled(look))),
            Written::OpenPbr(look) => MaterialKind::OpenPbr(Box::new(self.open_pbr(look))),
            Written::Disney(look) => MaterialKind::Disney(Box::new(self.disney(look))),
            Written::Unlit { color } => MaterialKind::Unlit {
                color: self.textures.spectrum_texture(*color, SpectrumType::Illuminant),
                albedo: self.albedo(*color),
            },
            Written::ShadowCatcher { normal } => MaterialKind::ShadowCatcher { normal: *normal },
            Written::Interface => MaterialKind::Interface,
        }
    }

    fn whitted(&self, whitted: &written::Whitted) -> WhittedMaterial {
        let written::Whitted { ambient, diffuse, specular, shininess, mirror, transmission, .. } = whitted;
        WhittedMaterial {
            ambient: ambient.map(|color| self.unbounded(color)),
            diffuse: self.unbounded(*diffuse),
            specular: self.unbounded(*specular),
            shininess: *shininess,
            mirror: self.unbounded(*mirror),
            transmission: self.unbounded(*transmission),
            ior: whitted.ior,
            fresnel: whitted.fresnel,
        }
    }

    fn tint(&self, tint: &written::Tint) -> Option<Box<TintTextures>> {
        (*tint != written::Tint::default()).then(|| {
            Box::new(TintTextures {
                reflectance: self.albedo(tint.reflectance),
                transmittance: self.albedo(tint.transmittance),
            })
        })
    }

    fn metal(&self, metal: &written::Metal) -> Metal {
        match *metal {
            written::Metal::Indices { eta, k, illuminant } => {
                let [eta, k] = [eta, k].map(|color| self.textures.index_of_refraction(color, illuminant));
                Metal::Indices { eta, k }
            }
            written::Metal::Reflectance(color) => Metal::Reflectance(self.albedo(color)),
        }
    }

    fn coat(&self, coat: &written::Coat) -> CoatMaterial {
        let roughness = rough(&coat.roughness);
        let interior = match (coat.eta, &roughness, coat.thickness) {
            (written::Ior::Value(eta), Roughness::Constant(microfacets), Scalar::Value(thickness))
                if coat.albedo == Color::BLACK && coat.estimate == written::CoatEstimate::Unbiased =>
            {
                Some(CoatInterior::new(eta, *microfacets, thickness))
            }
            _ => None,
        };
        CoatMaterial {
            eta: index(coat.eta),
            roughness,
            interior,
            thickness: coat.thickness.into(),
            albedo: self.albedo(coat.albedo),
            g: coat.g.into(),
            max_depth: coat.max_depth.min(u16::MAX.into()) as u16,
            samples: coat.samples.min(u16::MAX.into()) as u16,
            estimate: coat.estimate,
        }
    }

    fn plastic(&self, plastic: &written::Plastic) -> PlasticMaterial {
        let roughness = TrowbridgeReitz::new(plastic.alpha, plastic.alpha);
        PlasticMaterial {
            reflectance: self.albedo(plastic.reflectance),
            specular_reflectance: self.albedo(plastic.specular_reflectance),
            is_nonlinear: plastic.is_nonlinear,
            interface: Interface::kept(plastic.eta, Microfacets::new(roughness, plastic.microfacets)),
        }
    }

    fn subsurface(&mut self, below: &written::Subsurface) -> SubsurfaceMaterial {
        let medium = match below.medium {
            written::SubsurfaceMedium::Coefficients { absorption, scattering } => {
                let [absorption, scattering] = [absorption, scattering].map(|color| self.unbounded(color));
                SubsurfaceMedium::Coefficients { absorption, scattering }
            }
            written::SubsurfaceMedium::Reflectance { reflectance, mean_free_path } => {
                let (reflectance, mean_free_path) =
                    (self.albedo(reflectance), self.unbounded(mean_free_path));
                SubsurfaceMedium::Reflectance { reflectance, mean_free_path }
            }
        };
        SubsurfaceMaterial {
            medium,
            scale: below.scale,
            eta: below.eta,
            roughness: rough(&below.roughness),
            exit: NormalizedFresnel::new(below.eta),
            profiles: self.profiles_of(below.g, below.eta),
        }
    }

    fn profiles_of(&mut self, g: f32, eta: f32) -> Arc<ProfileTable> {
        let known = self.profiles.iter().find(|(key, _)| *key == (g, eta));
        if let Some((_, profiles)) = known {
            return profiles.clone();
        }
        let profiles = Arc::new(ProfileTable::new(g, eta));
        self.profiles.push(((g, eta), profiles.clone()));
        profiles
    }

    fn bump_mapping(&self, written: &written::BumpMapping) -> BumpMapping {
        match written {
            written::BumpMapping::None => BumpMapping::None,
            written::BumpMapping::Bump(height) => BumpMapping::Bump(self.textures.pictured((*height).into())),
            written::BumpMapping::NormalMap(image) => BumpMapping::NormalMap(image.index()),
            written::BumpMapping::NormalTexture(map) => BumpMapping::NormalTexture(self.normals(map)),
        }
    }

    pub(super) fn normals(&self, map: &written::NormalTexture) -> NormalTexture {
        NormalTexture { texture: self.directions(map.texture), scale: map.scale }
    }

    /// A texture of directions, evaluated as linear RGB.
    pub(super) fn directions(&self, texture: TextureId) -> SpectrumTexture {
        self.unbounded(Color::Texture(texture))
    }

    fn principled(&self, look: &written::Principled) -> PrincipledMaterial {
        let anisotropy = look.anisotropy.map(|grain| Anisotropy {
            strength: grain.strength,
            sin_cos: libm::sincosf(grain.rotation).into(),
            texture: grain.texture.map(|texture| self.directions(texture)),
        });
        let compiled = PrincipledMaterial {
            base_color: self.albedo(look.base_color),
            metallic: look.metallic.into(),
            roughness: look.roughness.into(),
            anisotropy,
            ior: look.ior,
            dispersion: look.dispersion,
            specular: look.specular.into(),
            specular_color: self.unbounded(look.specular_color),
            transmission: look.transmission.into(),
            is_solid: look.is_solid,
            diffuse_transmission: look.diffuse_transmission.into(),
            diffuse_transmission_color: self.albedo(look.diffuse_transmission_color),
            clearcoat: look.clearcoat.into(),
            clearcoat_roughness: look.clearcoat_roughness.into(),
            clearcoat_normal: look.clearcoat_normal.as_ref().map(|map| self.normals(map)),
            sheen_color: self.unbounded(look.sheen_color),
            sheen_roughness: look.sheen_roughness.into(),
            iridescence: look.iridescence.into(),
            iridescence_ior: look.iridescence_ior,
            iridescence_thickness: look.iridescence_thickness.into(),
            template: None,
        };
        PrincipledMaterial { template: principled::template(&compiled, self.textures), ..compiled }
    }
}

fn rough(roughness: &written::Roughness) -> Roughness {
    let written::Roughness { u, v, remap, microfacets } = *roughness;
    match (u, v) {
        (Scalar::Value(u), Scalar::Value(v)) => {
            Roughness::Constant(Microfacets::new(TrowbridgeReitz::from_roughness([u, v], remap), microfacets))
        }
        _ => Roughness::Varying { along: [u.into(), v.into()], remap, microfacets },
    }
}

fn index(ior: written::Ior) -> Ior {
    match ior {
        written::Ior::Value(eta) => Ior::Value(eta),
        written::Ior::Curve(curve) => Ior::Curve(curve),
    }
}
