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
mod evaluator;
mod hair;
mod interior;
mod kind;
mod measured;
mod open_pbr;
mod pictures;
mod principled;
mod rows;
mod shading;
mod subsurface;
mod whitted;

use glam::Vec3;
use lookfrom_scene::material::{BackFace, BumpGuard};

use crate::shading::bsdf::Bsdf;
use crate::shading::interaction::{ShadingGeometry, SurfaceInteraction};
use crate::shading::texture::{FloatTexture, PictureSet, TexturePoint};

pub use albedo::albedo;
pub(crate) use albedo::of_coefficients as albedo_of_coefficients;
pub use bump::Relief;
pub(crate) use bump::{Bending, Guard, LocalNormal, Neighbours, NormalLimit, displaced_normal, frame_about};
pub(crate) use compile::Compiler;
pub use disney::DisneyMaterial;
pub(crate) use evaluator::Evaluator;
pub use evaluator::ShadingContext;
pub use hair::{HairMaterial, Pigment};
pub use kind::{
    Anisotropy, BumpMapping, CoatMaterial, Ior, MaterialKind, Metal, NormalTexture, PlasticMaterial,
    PrincipledMaterial, Roughness, SubsurfaceMaterial, SubsurfaceMedium, TintTextures, WhittedMaterial,
};
pub use open_pbr::{OpenPbrMaterial, Tangent};
pub(crate) use rows::{MaterialRow, Side};
pub(crate) use shading::Frame;
pub use shading::Shading;

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

impl Material {
    /// True if its scattering function is chosen at random.
    #[inline]
    pub fn is_stochastic(&self) -> bool {
        match &self.kind {
            MaterialKind::Mix { .. } => true,
            kind => principled::Refraction::of(kind).is_some_and(principled::Refraction::disperses),
        }
    }

    /// Whether it is mixed of others.
    #[inline]
    pub(crate) fn is_mixture(&self) -> bool {
        matches!(self.kind, MaterialKind::Mix { .. })
    }

    /// One of the materials that the material of an index is mixed of, by the shares of the second ones and a number in [0, 1), and what
    /// is left of that number, which serves again; itself, where it is not mixed. `None` where a share is not known.
    pub(crate) fn chosen(
        materials: &[Self],
        mut index: u32,
        share: impl Fn(FloatTexture) -> Option<f32>,
        number: impl Fn() -> f32,
    ) -> Option<(u32, f32)> {
        let mut rest = None;
        while let MaterialKind::Mix { materials: [first, second], amount } = &materials[index as usize].kind {
            let amount = share(*amount)?.clamp(0.0, 1.0);
            let u = rest.unwrap_or_else(&number);
            let takes_second = u < amount;
            index = if takes_second { *second } else { *first };
            rest = Some(if takes_second { u / amount } else { (u - amount) / (1.0 - amount) });
        }
        Some((index, rest.unwrap_or_else(number)))
    }

    /// True if it is layered, or may be replaced by a material that is.
    #[inline]
    pub(crate) fn takes_seed(&self) -> bool {
        use MaterialKind::{CoatedConductor, CoatedDiffuse, Mix};
        matches!(self.kind, CoatedDiffuse { .. } | CoatedConductor { .. } | Mix { .. })
    }

    /// The shading frame of this material.
    fn frame(&self, relief: Relief<'_>, surface: &ShadingGeometry, point: &TexturePoint) -> Frame {
        bump::frame((&self.bump_mapping, self.normal_limit()), relief, surface, point)
    }

    /// The limit of the normals that its map bends.
    #[inline]
    pub(crate) fn normal_limit(&self) -> NormalLimit {
        match (self.bump_guard, self.reflects_outside) {
            (Some(guard), _) => NormalLimit::Guarded(guard),
            (None, true) => NormalLimit::Valid,
            (None, false) => NormalLimit::Outward,
        }
    }

    /// The guard of a bent normal `n` on a surface with the normal `ns`, if it has guards.
    fn guard(&self, ns: Vec3, n: Vec3) -> Option<Guard> {
        self.bump_guard.map(|guard| Guard::of(guard, ns.into(), n.into()))
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
    let share = |amount: FloatTexture| Some(textures.float(amount, point));
    let (index, u) = Material::chosen(materials, surface.material, share, || arrival.u)?;
    let material = &materials[index as usize];
    let mut at = Evaluator::new(materials, textures, point, ShadingContext { u, ..arrival });
    let geometry = surface.shading_geometry();
    if let MaterialKind::Principled(look) = &material.kind {
        let frame = material.frame(relief, &geometry, point);
        let (bsdf, frame) = at.principled(look, index, &geometry, frame);
        return Some(Shading::of(material, surface, frame, Bsdf::Principled(bsdf)));
    }
    if let MaterialKind::OpenPbr(look) = &material.kind {
        let frame = material.frame(relief, &geometry, point);
        let (bsdf, frame) = at.open_pbr(look, index, &geometry, frame);
        return Some(Shading::of(material, surface, frame, Bsdf::OpenPbr(bsdf)));
    }
    let bsdf = at.bsdf(index)?;
    Some(Shading::of(material, surface, material.frame(relief, &geometry, point), bsdf))
}

/// The shading normal, to the outside, of unit length: that of [`shading()`]; for mixed materials that of the first.
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
