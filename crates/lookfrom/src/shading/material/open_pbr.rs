//! The parameters of OpenPBR's surface at a point.
//!
//! Formulas and their order are those of the specification (version 1.1): the index of refraction beneath the coat and its modulation by
//! the specular weight, the roughness beneath a rough coat, the colours of thin walls. Where it leaves a choice:
//! - **Fresnel's reflectance** of the coat, and of the dielectric over a diffuse base, is Schlick's, between the one at normal incidence and
//!   one at grazing incidence with which the mean is right, so that tables of albedo divide the energy. Glass has Fresnel's
//!   equations.
//! - **Glass beneath a coat** refracts as without it: a thin coat does not change the direction of light.
//! - **Subsurface scattering in depth** is a material of its own; here its part has the colour of diffuse light.

use glam::Vec3;
use lookfrom_scene::material as written;

use super::compile::Compiler;
use super::kind::NormalTexture;
use super::principled::Refraction;
use super::{Evaluator, Frame, bump};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::open_pbr::OpenPbrSurface;
use crate::shading::bsdf::principled::Principled;
use crate::shading::bsdf::principled::film::ThinFilm;
use crate::shading::bsdf::principled::open_pbr::{
    OpenPbr, base_reflectance, grazing_reflectance, index_of_reflectance, modulated_index, roughness_below,
};
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{FloatTexture, SpectrumTexture};

/// OpenPBR's surface, see [`lookfrom_scene::material::OpenPbr`].
#[derive(Clone, Debug)]
pub struct OpenPbrMaterial {
    pub(crate) base_weight: FloatTexture,
    pub(crate) base_color: SpectrumTexture,
    pub(crate) base_diffuse_roughness: FloatTexture,
    pub(crate) base_metalness: FloatTexture,
    pub(crate) specular_weight: FloatTexture,
    pub(crate) specular_color: SpectrumTexture,
    pub(crate) specular_roughness: FloatTexture,
    pub(crate) specular_roughness_anisotropy: FloatTexture,
    pub(crate) specular_ior: f32,
    pub(crate) transmission_weight: FloatTexture,
    pub(crate) transmission_color: SpectrumTexture,
    pub(crate) dispersion: f32,
    pub(crate) subsurface_weight: FloatTexture,
    pub(crate) subsurface_color: SpectrumTexture,
    pub(crate) subsurface_scatter_anisotropy: f32,
    pub(crate) coat_weight: FloatTexture,
    pub(crate) coat_color: SpectrumTexture,
    pub(crate) coat_roughness: FloatTexture,
    pub(crate) coat_roughness_anisotropy: FloatTexture,
    pub(crate) coat_ior: f32,
    /// The coat's reflectance at grazing incidence.
    pub(crate) coat_f90: f32,
    pub(crate) coat_darkening: FloatTexture,
    pub(crate) fuzz_weight: FloatTexture,
    pub(crate) fuzz_color: SpectrumTexture,
    pub(crate) fuzz_roughness: FloatTexture,
    pub(crate) thin_film_weight: FloatTexture,
    /// In µm.
    pub(crate) thin_film_thickness: FloatTexture,
    pub(crate) thin_film_ior: f32,
    /// True if the surface bounds a body that light may enter.
    pub(crate) is_solid: bool,
    /// True if it is a sheet without an inside.
    pub(crate) is_thin: bool,
    pub(crate) coat_normal: Option<NormalTexture>,
    pub(crate) tangent: Tangent,
    pub(crate) coat_tangent: Tangent,
}

/// A direction in the tangent frame.
#[derive(Clone, Copy, Debug)]
pub enum Tangent {
    /// Along u and v.
    Value([f32; 2]),
    /// Along u and v: twice red and green, less one.
    Texture(SpectrumTexture),
}

impl OpenPbrMaterial {
    #[inline]
    pub(super) fn refraction(&self) -> Refraction {
        Refraction { ior: self.specular_ior, dispersion: self.dispersion, is_solid: self.is_solid }
    }
}

impl Compiler<'_> {
    pub(super) fn open_pbr(&self, look: &written::OpenPbr) -> OpenPbrMaterial {
        let tangent = |tangent| match tangent {
            written::Tangent::Value(direction) => Tangent::Value(direction),
            written::Tangent::Texture(texture) => Tangent::Texture(self.directions(texture)),
        };
        OpenPbrMaterial {
            base_weight: look.base_weight.into(),
            base_color: self.albedo(look.base_color),
            base_diffuse_roughness: look.base_diffuse_roughness.into(),
            base_metalness: look.base_metalness.into(),
            specular_weight: look.specular_weight.into(),
            specular_color: self.albedo(look.specular_color),
            specular_roughness: look.specular_roughness.into(),
            specular_roughness_anisotropy: look.specular_roughness_anisotropy.into(),
            specular_ior: look.specular_ior,
            transmission_weight: look.transmission_weight.into(),
            transmission_color: self.albedo(look.transmission_color),
            dispersion: look.dispersion,
            subsurface_weight: look.subsurface_weight.into(),
            subsurface_color: self.albedo(look.subsurface_color),
            subsurface_scatter_anisotropy: look.subsurface_scatter_anisotropy,
            coat_weight: look.coat_weight.into(),
            coat_color: self.albedo(look.coat_color),
            coat_roughness: look.coat_roughness.into(),
            coat_roughness_anisotropy: look.coat_roughness_anisotropy.into(),
            coat_ior: look.coat_ior.max(1.0),
            coat_f90: grazing_reflectance(look.coat_ior.max(1.0)),
            coat_darkening: look.coat_darkening.into(),
            fuzz_weight: look.fuzz_weight.into(),
            fuzz_color: self.albedo(look.fuzz_color),
            fuzz_roughness: look.fuzz_roughness.into(),
            thin_film_weight: look.thin_film_weight.into(),
            thin_film_thickness: look.thin_film_thickness.into(),
            thin_film_ior: look.thin_film_ior,
            is_solid: look.is_body(),
            is_thin: look.geometry_thin_walled,
            coat_normal: look.geometry_coat_normal.as_ref().map(|map| self.normals(map)),
            tangent: tangent(look.geometry_tangent),
            coat_tangent: tangent(look.geometry_coat_tangent),
        }
    }
}

impl Evaluator<'_> {
    /// The BSDF, and the frame rotated to the direction of the grain.
    pub(super) fn open_pbr(
        &mut self,
        look: &OpenPbrMaterial,
        material: u32,
        surface: &ShadingGeometry,
        mut frame: Frame,
    ) -> (OpenPbrSurface, Frame) {
        let transmission = self.share(look.transmission_weight);
        let metallic = self.share(look.base_metalness);
        let ior = self.index(look.refraction(), transmission * (1.0 - metallic));
        let around = self.around(look.is_solid, material, surface.front);
        // A body that was entered later is on both sides.
        let is_hidden = around.is_none();
        let eta = around.map_or(1.0, |around| ior / around);
        let unless_hidden = |weight: f32| if is_hidden { 0.0 } else { weight };

        let coat = unless_hidden(self.share(look.coat_weight));
        let coat_roughness = self.share(look.coat_roughness);
        let roughness = roughness_below(coat, coat_roughness, self.share(look.specular_roughness));
        let anisotropy = self.share(look.specular_roughness_anisotropy);
        let coat_anisotropy = self.share(look.coat_roughness_anisotropy);
        if anisotropy > 0.0 {
            frame = frame.along(self.tangent(&look.tangent, surface));
        }
        let (mut coat_normal, mut coat_tangent) = (Vec3::Z, Vec3::X);
        if coat > 0.0 {
            let bent = look.coat_normal.map(|map| bump::mapped(&map, self.textures, surface, self.point));
            coat_normal = frame.local(bump::valid(bent.unwrap_or(surface.ns), surface));
            if coat_anisotropy > 0.0 {
                coat_tangent = frame.local(self.tangent(&look.coat_tangent, surface));
            }
        }

        let weight = self.float(look.specular_weight).max(0.0);
        let f0 = unless_hidden(base_reflectance(eta, coat, look.coat_ior, weight));
        let grazing = grazing_reflectance(index_of_reflectance(f0));
        let f90 = unless_hidden(grazing + transmission * (1.0 - grazing));
        // Tinted is only what is reflected outside.
        let is_inside = look.is_solid && !surface.front;
        let specular_color = if is_inside { Spectrum([1.0; 4]) } else { self.albedo(&look.specular_color) };

        let base = self.albedo(&look.base_color) * self.share(look.base_weight);
        let below = self.share(look.subsurface_weight) * (1.0 - metallic);
        let (mut base_color, mut through, mut through_color) = (base, 0.0, Spectrum::BLACK);
        if below > 0.0 {
            let color = self.albedo(&look.subsurface_color);
            let forward = 0.5 * (1.0 + look.subsurface_scatter_anisotropy);
            through = if look.is_thin { below * forward } else { 0.0 };
            if through < 1.0 {
                base_color = (base * (1.0 - below) + color * (below - through)) / (1.0 - through);
            }
            through_color = color;
        }
        let fuzz = unless_hidden(self.share(look.fuzz_weight));
        let fuzz_color = if fuzz > 0.0 { self.albedo(&look.fuzz_color) * fuzz } else { Spectrum::BLACK };
        let [along, across] = written::OpenPbr::alphas(roughness, anisotropy);
        let [coat_along, coat_across] = written::OpenPbr::alphas(coat_roughness, coat_anisotropy);
        let layers = Principled {
            base_color,
            metallic,
            roughness: TrowbridgeReitz::new(along, across),
            eta: modulated_index(eta, weight),
            f0: specular_color * f0,
            f0_greatest: f0,
            f90,
            transmission,
            is_solid: look.is_solid,
            diffuse_transmission: through,
            diffuse_transmission_color: through_color,
            clearcoat: coat,
            clearcoat_roughness: TrowbridgeReitz::new(coat_along, coat_across),
            clearcoat_normal: coat_normal.into(),
            sheen_color: fuzz_color,
            sheen_greatest: fuzz,
            sheen_roughness: self.share(look.fuzz_roughness),
            iridescence: unless_hidden(self.share(look.thin_film_weight)),
            film: ThinFilm {
                eta: look.thin_film_ior,
                thickness: self.float(look.thin_film_thickness) * 1000.0,
                wavelengths: self.wavelengths(),
            },
            lane_weights: self.lane_weights(),
            model: OpenPbr {
                specular_color,
                specular_weight: weight.min(1.0),
                transmission_color: self.albedo(&look.transmission_color),
                diffuse_roughness: self.share(look.base_diffuse_roughness),
                coat_color: self.albedo(&look.coat_color),
                coat_eta: look.coat_ior,
                coat_f90: look.coat_f90,
                coat_tangent: coat_tangent.into(),
                coat_darkening: self.share(look.coat_darkening),
                ..OpenPbr::default()
            },
        };
        (OpenPbrSurface::new(&layers), frame)
    }

    /// A direction in the tangent frame, in render space.
    fn tangent(&self, tangent: &Tangent, surface: &ShadingGeometry) -> Vec3 {
        let [x, y] = match tangent {
            Tangent::Value(direction) => *direction,
            Tangent::Texture(texture) => {
                let [r, g, _] = self.textures.rgb(texture, self.point);
                [2.0 * r - 1.0, 2.0 * g - 1.0]
            }
        };
        let [s, t] = bump::tangents(surface);
        x * s + y * t
    }
}
