//! Materials whose BSDFs are computed in lanes: their classes, and their evaluation to a BSDF of a class.

use super::{BumpMapping, Evaluator, Material, MaterialKind, ShadingContext};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::diffuse::Diffuse;
use crate::shading::bsdf::lanes::{BsdfClass, RowBsdf};
use crate::shading::bsdf::layered::Layered;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::{SpectralMode, TexturePoint, Textures};

impl Material {
    /// The class of its BSDFs, if they are computed in lanes: neither chosen at random nor around a perturbed normal, and
    /// the same in all media.
    pub(crate) fn class(&self) -> Option<BsdfClass> {
        if !matches!(self.bump_mapping, BumpMapping::None) {
            return None;
        }
        match self.kind {
            MaterialKind::Diffuse { .. } => Some(BsdfClass::Diffuse),
            MaterialKind::Conductor { .. } => Some(BsdfClass::Conductor),
            MaterialKind::Dielectric { .. } => Some(BsdfClass::Dielectric),
            MaterialKind::CoatedDiffuse { .. } => Some(BsdfClass::CoatedDiffuse),
            MaterialKind::CoatedConductor { .. } => Some(BsdfClass::CoatedConductor),
            _ => None,
        }
    }

    /// The BSDF at a point, as [`super::shading`] has it; `None` where the material is of another class. Where wavelengths
    /// are dispersed, only the first is kept.
    #[inline]
    pub(crate) fn row<B: MaterialRow>(
        &self,
        textures: &Textures,
        point: &TexturePoint,
        mode: &mut SpectralMode,
    ) -> Option<B> {
        let (mut throughput, interior) = (Spectrum::ONE, InteriorStack::default());
        let context = ShadingContext { lanes: mode, throughput: &mut throughput, interior, u: 0.0 };
        B::at(&mut Evaluator::new(&[], textures, point, context), &self.kind)
    }
}

/// A class of BSDFs that materials have.
pub(crate) trait MaterialRow: RowBsdf {
    /// The BSDF of a material of this class.
    fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind) -> Option<Self>;
}

macro_rules! material_row {
    ($row:ty, $kind:ident { $($field:ident),+ } => $method:ident) => {
        impl MaterialRow for $row {
            #[inline]
            fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind) -> Option<Self> {
                match kind {
                    MaterialKind::$kind { $($field),+ } => Some(evaluator.$method($($field),+)),
                    _ => None,
                }
            }
        }
    };
}

material_row!(Diffuse, Diffuse { reflectance } => diffuse);
material_row!(Conductor, Conductor { metal, roughness } => conductor);
material_row!(Dielectric, Dielectric { eta, roughness } => dielectric);
material_row!(Layered<Diffuse>, CoatedDiffuse { reflectance, coat } => coated_diffuse);
material_row!(Layered<Conductor>, CoatedConductor { metal, roughness, coat } => coated_conductor);
