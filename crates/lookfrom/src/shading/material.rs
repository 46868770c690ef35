//! Materials: from their parameters at a point to a BSDF in a shading frame.
//!
//! [`Shading`] is the scattering function of a material at a point, in the frame of the shading normal (with bump
//! mapping): for path tracing. The coefficients of Whitted's model, which ray casting and Whitted ray tracing use for every
//! material, are [`WhittedCoefficients`](crate::shading::bsdf::whitted::WhittedCoefficients).

mod albedo;
mod approximate;
mod bump;
mod compile;
mod disney;
mod hair;
mod interior;
mod kind;
mod measured;
mod open_pbr;
mod pictures;
mod principled;
mod rows;
mod subsurface;
mod whitted;

use glam::Vec3;
use lookfrom_scene::material::{BackFace, BumpGuard, Energy};
use lookfrom_scene::scene::CurveId;

use crate::core::points::Lift;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::dielectric::{Dielectric, ThinDielectric};
use crate::shading::bsdf::diffuse::{Diffuse, DiffuseTransmission};
use crate::shading::bsdf::lanes::LaneBsdf;
use crate::shading::bsdf::layered::{CoatLayer, Layered};
use crate::shading::bsdf::plastic::Plastic;
use crate::shading::bsdf::tinted::{Tint, TintedDielectric};
use crate::shading::bsdf::{Bsdf, MicrofacetFactors, fresnel};
use crate::shading::interaction::{ShadingGeometry, SurfaceInteraction};
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::{
    FloatTexture, PictureSet, SpectralMode, SpectrumTexture, TexturePoint, Textures,
};

pub use albedo::albedo;
pub(crate) use albedo::of_coefficients as albedo_of_coefficients;
pub use bump::Relief;
pub(crate) use bump::{Bending, Guard, frame_about};
pub(crate) use compile::Compiler;
pub use disney::DisneyMaterial;
pub use hair::{HairMaterial, Pigment};
pub use kind::{
    Anisotropy, BumpMapping, CoatMaterial, Ior, MaterialKind, Metal, NormalTexture, PlasticMaterial,
    PrincipledMaterial, Roughness, SubsurfaceMaterial, SubsurfaceMedium, TintTextures, WhittedMaterial,
};
pub use open_pbr::{OpenPbrMaterial, Tangent};
pub(crate) use rows::MaterialRow;

/// A material of a world.
#[derive(Clone, Debug)]
pub struct Material {
    /// Type and parameters.
    pub kind: MaterialKind,
    /// Perturbation of the shading normal.
    pub bump_mapping: BumpMapping,
    /// Guard of normals that it bends too far, in place of [`Self::reflects_outside`].
    pub bump_guard: Option<BumpGuard>,
    /// Its look from behind.
    pub back_face: BackFace,
    /// Whether shading normals are bent so that reflections stay outside (`Bending::valid`).
    pub reflects_outside: bool,
    /// Index into the world's media of the medium inside a body of this material, where the
    /// material declares one.
    pub medium: Option<u32>,
    /// The nearest equivalent in Whitted's model, for integrators that support no other.
    pub whitted: WhittedMaterial,
    /// The pictures that its scattering function depends on.
    pub pictures: PictureSet,
    /// False if its scattering function is known to be the same everywhere.
    pub varies: bool,
    /// Whether its textures depend on the footprint of pixels.
    pub needs_footprint: bool,
    /// Its [`albedo()`] where that is known to be the same everywhere.
    albedo: Option<[f32; 3]>,
}

/// A BSDF at a point, with its shading frame.
#[derive(Clone, Copy, Debug)]
pub struct Shading {
    /// In the local frame.
    pub bsdf: Bsdf,
    frame: Frame,
    /// The geometric normal to the outside, to prevent light leaks where the shading normal differs from it.
    ng: Vec3,
    /// The smooth surface that the mesh stands for.
    lift: Option<Lift<f32>>,
    /// The guard of a bent normal.
    guard: Option<Guard<f32>>,
    /// Whether the surface is black from behind.
    is_one_sided: bool,
}

/// An orthonormal frame of unit vectors in render space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    s: Vec3,
    t: Vec3,
    n: Vec3,
}

impl Frame {
    fn local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    fn render(&self, v: Vec3) -> Vec3 {
        v.x * self.s + v.y * self.t + v.z * self.n
    }

    fn axes(&self) -> [[f32; 3]; 3] {
        [self.s, self.t, self.n].map(|axis| axis.to_array())
    }

    /// The frame with the first axis turned toward a direction.
    fn along(&self, direction: Vec3) -> Self {
        bump::around(self.n, direction)
    }
}

impl Shading {
    /// A matte surface without bump mapping.
    pub fn matte(surface: &SurfaceInteraction, reflectance: Spectrum) -> Self {
        Self::plain(surface, Bsdf::diffuse(reflectance))
    }

    /// A BSDF at a surface without bump mapping.
    pub(crate) fn plain(surface: &SurfaceInteraction, bsdf: Bsdf) -> Self {
        Self::with_frame(surface, bump::plain(&surface.shading_geometry()), bsdf)
    }

    /// A BSDF at a surface in the frame of these axes, the third of which is the shading normal.
    pub(crate) fn in_frame(surface: &SurfaceInteraction, axes: [[f32; 3]; 3], bsdf: Bsdf) -> Self {
        let [s, t, n] = axes.map(Vec3::from);
        Self::with_frame(surface, Frame { s, t, n }, bsdf)
    }

    /// A BSDF at a surface in a frame, without a guard, that is seen from both sides.
    fn with_frame(surface: &SurfaceInteraction, frame: Frame, bsdf: Bsdf) -> Self {
        let (ng, lift) = (surface.ng.as_vec3(), surface.lift());
        Self { bsdf, frame, ng, lift, guard: None, is_one_sided: false }
    }

    /// The shading normal to the outside, unit length.
    pub fn n(&self) -> Vec3 {
        self.frame.n
    }

    /// The axes of the shading frame; the third is the shading normal.
    pub(crate) fn axes(&self) -> [[f32; 3]; 3] {
        self.frame.axes()
    }

    /// The cosine of the angle between a unit direction and the shading normal.
    pub fn cos(&self, w: Vec3) -> f32 {
        w.dot(self.frame.n)
    }

    /// The guard of its normal, if that is bent.
    pub(crate) fn guard(&self) -> Option<&Guard<f32>> {
        self.guard.as_ref()
    }

    /// Whether the surface is black in the direction `wo`, in render space.
    pub(crate) fn is_black_toward(&self, wo: Vec3) -> bool {
        self.is_one_sided && self.cos(wo) <= 0.0
    }

    /// True if the geometric and the shading normal agree whether two directions are on one side. pbrt's materials
    /// do without this test.
    fn agrees(&self, wo: Vec3, wi: Vec3) -> bool {
        let on_one_side = |n: Vec3| wo.dot(n) * wi.dot(n) > 0.0;
        let is_above = || self.lift.is_some_and(|lift| lift.is_above(wi.into()));
        !matches!(self.bsdf, Bsdf::Principled(_) | Bsdf::OpenPbr(_))
            || (on_one_side(self.ng) || is_above()) == on_one_side(self.frame.n)
    }

    /// The factors of its microfacets for two unit directions in render space ([`Bsdf::factors`]), with ω_m there.
    pub fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        let [wo, wi] = [wo, wi].map(|w| self.frame.local(w));
        let mut all = self.bsdf.factors(wo, wi, is_specular);
        all.iter_mut().for_each(|factors| factors.wm = self.frame.render(factors.wm));
        all
    }

    /// The BSDF for a fixed outgoing direction `wo` as a function of the incident one, without a cosine. Both have unit
    /// length and are in render space.
    pub fn f_toward(&self, wo: Vec3) -> impl Fn(Vec3) -> Spectrum {
        let prepared = self.bsdf.prepare(self.frame.local(wo).into());
        move |wi| match self.agrees(wo, wi) && !self.is_black_toward(wo) {
            true => {
                let f = LaneBsdf::f(&self.bsdf, &prepared, self.frame.local(wi).into());
                self.guard.map_or(f, |guard| f * guard.lets_through(wi.into(), self.frame.n.into()))
            }
            false => Spectrum::BLACK,
        }
    }
}

/// The state of a path that the shading of a surface depends on.
#[derive(Debug)]
pub struct ShadingContext<'a> {
    /// Meaning of the lanes. Where wavelengths are dispersed, only the first is kept.
    pub mode: &'a mut SpectralMode,
    /// The path throughput. In RGB mode, where colours are dispersed, one of its primaries is kept, weighted
    /// to stand for all.
    pub throughput: &'a mut Spectrum,
    /// The bodies and media that the light travels through.
    pub interior: InteriorStack,
    /// Random number in [0, 1) that chooses among mixed materials and dispersed colours. Used where
    /// [`Material::is_stochastic`].
    pub u: f32,
    /// Random number in [0, 1) that seeds the walks of layered BSDFs.
    pub seed: f32,
}

impl Material {
    /// True if its scattering function is chosen at random.
    #[inline]
    pub fn is_stochastic(&self) -> bool {
        match &self.kind {
            MaterialKind::Mix { .. } => true,
            kind => principled::Refraction::of(kind).is_some_and(principled::Refraction::disperses),
        }
    }

    /// True if it is layered, or may be replaced by a material that is.
    #[inline]
    pub(crate) fn takes_seed(&self) -> bool {
        use MaterialKind::{CoatedConductor, CoatedDiffuse, Mix};
        matches!(self.kind, CoatedDiffuse { .. } | CoatedConductor { .. } | Mix { .. })
    }

    /// The shading frame of this material.
    fn frame(&self, relief: Relief<'_>, surface: &ShadingGeometry, point: &TexturePoint) -> Frame {
        match (self.bump_guard, self.reflects_outside) {
            (Some(guard), _) => bump::guarded_frame(guard, &self.bump_mapping, relief, surface, point),
            (None, true) => bump::valid_frame(&self.bump_mapping, relief, surface, point),
            (None, false) => bump::frame(&self.bump_mapping, relief, surface, point),
        }
    }

    /// Its BSDF at a surface, in a frame.
    fn shading(&self, surface: &SurfaceInteraction, frame: Frame, bsdf: Bsdf) -> Shading {
        let guard = self.bump_guard.map(|guard| Guard::of(guard, surface.ns.into(), frame.n.into()));
        let is_one_sided = self.back_face == BackFace::Black;
        Shading { guard, is_one_sided, ..Shading::with_frame(surface, frame, bsdf) }
    }

    /// Whether it is a thin sheet that light passes straight on, and is not dispersed by.
    pub fn is_pane(&self) -> bool {
        matches!(self.kind, MaterialKind::ThinDielectric { eta: Ior::Value(_), .. })
    }

    /// True if its shapes are solid bodies that light enters.
    #[inline]
    pub fn is_body(&self) -> bool {
        match &self.kind {
            MaterialKind::Whitted(_) => true,
            MaterialKind::Principled(look) if look.is_solid => true,
            MaterialKind::OpenPbr(look) if look.is_solid => true,
            _ => self.medium.is_some(),
        }
    }
}

/// The scattering function of a material at a surface; `None` for an interface, which has none. A mixed material is
/// replaced by one of its parts at random.
pub fn shading(
    materials: &[Material],
    relief: Relief<'_>,
    surface: &SurfaceInteraction,
    point: &TexturePoint,
    arrival: ShadingContext<'_>,
) -> Option<Shading> {
    let textures = relief.textures;
    let mut u = arrival.u;
    let mut index = surface.material;
    let mut material = &materials[index as usize];
    while let MaterialKind::Mix { materials: [first, second], amount } = &material.kind {
        let amount = textures.float(*amount, point).clamp(0.0, 1.0);
        let chosen = if u < amount { second } else { first };
        u = if u < amount { u / amount } else { (u - amount) / (1.0 - amount) };
        index = *chosen;
        material = &materials[index as usize];
    }
    let mut at = Evaluator::new(materials, textures, point, ShadingContext { u, ..arrival });
    let geometry = surface.shading_geometry();
    if let MaterialKind::Principled(look) = &material.kind {
        let frame = material.frame(relief, &geometry, point);
        let (bsdf, frame) = at.principled(look, index, &geometry, frame);
        return Some(material.shading(surface, frame, Bsdf::Principled(bsdf)));
    }
    if let MaterialKind::OpenPbr(look) = &material.kind {
        let frame = material.frame(relief, &geometry, point);
        let (bsdf, frame) = at.open_pbr(look, index, &geometry, frame);
        return Some(material.shading(surface, frame, Bsdf::OpenPbr(bsdf)));
    }
    let bsdf = at.bsdf(index)?;
    Some(material.shading(surface, material.frame(relief, &geometry, point), bsdf))
}

/// The shading normal, to the outside, of unit length: that of [`shading`]; for mixed materials that of the first.
pub fn normal(
    materials: &[Material],
    relief: Relief<'_>,
    surface: &SurfaceInteraction,
    point: &TexturePoint,
) -> Vec3 {
    let mut material = &materials[surface.material as usize];
    while let MaterialKind::Mix { materials: [first, _], .. } = &material.kind {
        material = &materials[*first as usize];
    }
    match material.has_bumps() {
        true => material.frame(relief, &surface.shading_geometry(), point).n,
        false => surface.ns,
    }
}

/// The evaluation of a material at a point.
pub(crate) struct Evaluator<'a> {
    materials: &'a [Material],
    textures: &'a Textures,
    point: &'a TexturePoint<'a>,
    mode: &'a mut SpectralMode,
    throughput: &'a mut Spectrum,
    interior: InteriorStack,
    u: f32,
    seed: f32,
}

impl<'a> Evaluator<'a> {
    fn new(
        materials: &'a [Material],
        textures: &'a Textures,
        point: &'a TexturePoint,
        context: ShadingContext<'a>,
    ) -> Self {
        let ShadingContext { mode, throughput, interior, u, seed } = context;
        Self { materials, textures, point, mode, throughput, interior, u, seed }
    }
}

impl Evaluator<'_> {
    /// The BSDF of a material, by its index; of one that has any, and is not evaluated above.
    fn bsdf(&mut self, index: u32) -> Option<Bsdf> {
        let materials = self.materials;
        Some(match &materials[index as usize].kind {
            MaterialKind::Whitted(whitted) => Bsdf::Whitted(self.whitted(whitted)),
            MaterialKind::Diffuse { reflectance } => Bsdf::Diffuse(self.diffuse(reflectance)),
            MaterialKind::DiffuseTransmission { reflectance, transmittance, scale } => {
                Bsdf::DiffuseTransmission(self.diffuse_transmission(reflectance, transmittance, scale))
            }
            MaterialKind::Conductor { metal, roughness, energy, specular_reflectance } => {
                Bsdf::Conductor(self.conductor(metal, roughness, energy, specular_reflectance))
            }
            MaterialKind::Dielectric { eta, roughness, energy } => {
                Bsdf::Dielectric(self.dielectric(eta, roughness, energy))
            }
            MaterialKind::TintedDielectric { eta, roughness, energy, tint } => {
                Bsdf::TintedDielectric(self.tinted_dielectric(eta, roughness, energy, tint))
            }
            MaterialKind::ThinDielectric { eta, tint } => {
                let tint = tint.as_ref().map_or(Tint::NONE, |tint| self.tint(tint));
                Bsdf::ThinDielectric(ThinDielectric::new(self.ior(eta)).with_tint(tint))
            }
            MaterialKind::CoatedDiffuse { reflectance, coat } => {
                Bsdf::CoatedDiffuse(self.coated_diffuse(reflectance, coat))
            }
            MaterialKind::CoatedConductor { metal, roughness, coat } => {
                Bsdf::CoatedConductor(self.coated_conductor(metal, roughness, coat))
            }
            MaterialKind::Disney(look) => Bsdf::Disney(self.disney(look)),
            MaterialKind::Plastic(plastic) => Bsdf::Plastic(self.plastic(plastic)),
            MaterialKind::Hair(hair) => Bsdf::Hair(self.hair(hair)),
            MaterialKind::Measured(tables) => Bsdf::Measured(self.measured(tables)),
            MaterialKind::Subsurface(below) => Bsdf::Subsurface(self.subsurface(below, index)),
            // Its emission is all that is visible: see [`unlit`].
            MaterialKind::Unlit { .. } => Bsdf::diffuse(Spectrum::BLACK),
            // Mixtures are resolved above, materials of layers need the surface, and shadow catchers are shaded by the
            // world.
            MaterialKind::Mix { .. }
            | MaterialKind::Principled(_)
            | MaterialKind::OpenPbr(_)
            | MaterialKind::ShadowCatcher { .. }
            | MaterialKind::Interface => return None,
        })
    }

    #[inline]
    fn diffuse(&self, reflectance: &SpectrumTexture) -> Diffuse {
        match reflectance.is_unbounded() {
            true => Diffuse { reflectance: self.textures.spectrum(reflectance, self.point, self.mode) },
            false => Diffuse::new(self.albedo(reflectance)),
        }
    }

    #[inline]
    fn diffuse_transmission(
        &self,
        reflectance: &SpectrumTexture,
        transmittance: &SpectrumTexture,
        scale: &f32,
    ) -> DiffuseTransmission {
        let [reflected, transmitted] = [reflectance, transmittance]
            .map(|color| self.textures.spectrum(color, self.point, self.mode) * *scale);
        DiffuseTransmission::new(reflected, transmitted)
    }

    fn conductor(
        &self,
        metal: &Metal,
        roughness: &Roughness,
        &energy: &Energy,
        specular_reflectance: &SpectrumTexture,
    ) -> Conductor {
        let (eta, k) = self.indices(metal);
        Conductor::new(eta, k, roughness.at(self.textures, self.point))
            .with_energy(energy)
            .with_specular_reflectance(self.albedo(specular_reflectance))
    }

    fn dielectric(&mut self, eta: &Ior, roughness: &Roughness, &energy: &Energy) -> Dielectric {
        Dielectric::new(self.ior(eta), roughness.at(self.textures, self.point)).with_energy(energy)
    }

    fn tinted_dielectric(
        &mut self,
        eta: &Ior,
        roughness: &Roughness,
        energy: &Energy,
        tint: &TintTextures,
    ) -> TintedDielectric {
        TintedDielectric { boundary: self.dielectric(eta, roughness, energy), tint: self.tint(tint) }
    }

    fn tint(&self, tint: &TintTextures) -> Tint {
        Tint { reflectance: self.albedo(&tint.reflectance), transmittance: self.albedo(&tint.transmittance) }
    }

    fn coated_diffuse(&mut self, reflectance: &SpectrumTexture, coat: &CoatMaterial) -> Layered<Diffuse> {
        let coat = self.coat(coat);
        Layered::coated_diffuse(self.diffuse(reflectance), &coat, self.seed)
    }

    fn coated_conductor(
        &mut self,
        metal: &Metal,
        roughness: &Roughness,
        coat: &CoatMaterial,
    ) -> Layered<Conductor> {
        let coat = self.coat(coat);
        let (eta, k) = self.indices(metal);
        Layered::coated_conductor(eta, k, roughness.at(self.textures, self.point), &coat, self.seed)
    }

    fn plastic(&self, plastic: &PlasticMaterial) -> Plastic {
        let (base, surface) = (self.albedo(&plastic.reflectance), self.albedo(&plastic.specular_reflectance));
        Plastic::new(base, surface, plastic.is_nonlinear, plastic.interface)
    }

    #[inline]
    fn albedo(&self, color: &SpectrumTexture) -> Spectrum {
        self.textures.albedo(color, self.point, self.mode)
    }

    fn float(&self, texture: FloatTexture) -> f32 {
        self.textures.float(texture, self.point)
    }

    /// η and k.
    fn indices(&self, metal: &Metal) -> (Spectrum, Spectrum) {
        let spectrum = |texture| self.textures.spectrum(texture, self.point, self.mode);
        match metal {
            Metal::Indices { eta, k } => (spectrum(eta), spectrum(k)),
            Metal::Reflectance(color) => fresnel::conductor_of_reflectance(spectrum(color)),
        }
    }

    /// The index of refraction; if it varies with wavelength, only the first wavelength is kept.
    fn ior(&mut self, ior: &Ior) -> f32 {
        match ior {
            Ior::Value(eta) => *eta,
            Ior::Curve(curve) => ior_at(*curve, self.textures, self.mode),
        }
    }

    fn coat(&mut self, coat: &CoatMaterial) -> CoatLayer {
        let eta = self.ior(&coat.eta);
        CoatLayer {
            eta,
            roughness: coat.roughness.at(self.textures, self.point),
            thickness: self.float(coat.thickness),
            albedo: self.albedo(&coat.albedo),
            g: self.float(coat.g).clamp(-1.0, 1.0),
            max_depth: coat.max_depth,
            samples: coat.samples,
            estimate: coat.estimate,
            interior: coat.interior,
        }
    }
}

/// The index of refraction of a curve: at the first wavelength, the only one kept afterwards; in RGB mode at
/// sodium's yellow line.
fn ior_at(curve: CurveId, textures: &Textures, mode: &mut SpectralMode) -> f32 {
    let nm = match mode {
        SpectralMode::Rgb => [589.3; 4],
        SpectralMode::Spectral(wavelengths) => {
            wavelengths.terminate_secondary();
            wavelengths.lambda
        }
    };
    let [eta, ..] = textures.curve(curve).at(&nm).0;
    if eta > 0.0 { eta } else { 1.0 }
}
