//! Materials whose BSDFs are computed in lanes: their classes, and their evaluation to a BSDF of a class.

use super::{BumpMapping, Evaluator, Frame, Material, MaterialKind, Relief, ShadingContext, bump};
use crate::shading::bsdf::BsdfClass;
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::diffuse::{Diffuse, DiffuseTransmission};
use crate::shading::bsdf::disney::Disney;
use crate::shading::bsdf::hair::Hair;
use crate::shading::bsdf::lanes::RowBsdf;
use crate::shading::bsdf::layered::Layered;
use crate::shading::bsdf::measured::Measured;
use crate::shading::bsdf::open_pbr::OpenPbrSurface;
use crate::shading::bsdf::plastic::Plastic;
use crate::shading::bsdf::principled::Principled;
use crate::shading::bsdf::tinted::TintedDielectric;
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{TexturePoint, Textures};

impl Material {
    /// The class of its BSDFs, if they are computed in lanes: not chosen at random, and the same in all media.
    pub(crate) fn class(&self) -> Option<BsdfClass> {
        // Guards of bent normals are found one by one.
        if self.bump_guard.is_some() {
            return None;
        }
        match &self.kind {
            MaterialKind::Diffuse { .. } => Some(BsdfClass::Diffuse),
            MaterialKind::DiffuseTransmission { .. } => Some(BsdfClass::DiffuseTransmission),
            MaterialKind::Conductor { .. } => Some(BsdfClass::Conductor),
            MaterialKind::Dielectric { .. } => Some(BsdfClass::Dielectric),
            MaterialKind::TintedDielectric { .. } => Some(BsdfClass::TintedDielectric),
            MaterialKind::CoatedDiffuse { .. } => Some(BsdfClass::CoatedDiffuse),
            MaterialKind::CoatedConductor { .. } => Some(BsdfClass::CoatedConductor),
            MaterialKind::Principled(look) => {
                (!look.is_solid && !look.refraction().disperses()).then_some(BsdfClass::Principled)
            }
            MaterialKind::OpenPbr(look) => (!look.is_solid).then_some(BsdfClass::OpenPbr),
            MaterialKind::Plastic(_) => Some(BsdfClass::Plastic),
            MaterialKind::Hair(_) => Some(BsdfClass::Hair),
            MaterialKind::Measured(_) => Some(BsdfClass::Measured),
            MaterialKind::Whitted(_) => Some(BsdfClass::Whitted),
            MaterialKind::Disney(_) => Some(BsdfClass::Disney),
            _ => None,
        }
    }

    /// Whether it has a bump or normal map.
    #[inline]
    pub(crate) fn has_bumps(&self) -> bool {
        !matches!(self.bump_mapping, BumpMapping::None)
    }

    /// Whether it has a bump map.
    pub(crate) fn has_bump_map(&self) -> bool {
        matches!(self.bump_mapping, BumpMapping::Bump(_))
    }

    /// Whether its shading frame is another than that of the surface.
    #[inline]
    pub(crate) fn bends_frames(&self) -> bool {
        self.has_bumps() || self.reflects_outside
    }

    /// Whether its frames are bent in lanes: with a normal map or none, and a BSDF that does not depend on the frame.
    #[inline]
    pub(crate) fn bends_in_lanes(&self) -> bool {
        let depends_on_frame = match &self.kind {
            MaterialKind::Principled(look) => look.template.is_none(),
            MaterialKind::OpenPbr(_) => true,
            _ => false,
        };
        self.reflects_outside
            && !depends_on_frame
            && matches!(self.bump_mapping, BumpMapping::None | BumpMapping::NormalTexture(_))
    }

    /// The normal of its normal map at a point, along the tangents and the shading normal of the surface; not of unit
    /// length.
    #[inline]
    pub(crate) fn local_normal(&self, textures: &Textures, point: &TexturePoint) -> Option<[f32; 3]> {
        match &self.bump_mapping {
            BumpMapping::NormalTexture(map) => Some(bump::local_normal(map, textures, point)),
            _ => None,
        }
    }

    /// The BSDF at a point, as [`super::shading`] has it; `None` where the material is of another class, or
    /// [bends frames](Material::bends_frames) and has a BSDF that depends on them. Where wavelengths are dispersed, only the
    /// first is kept.
    #[inline]
    pub(crate) fn row<B: MaterialRow>(
        &self,
        textures: &Textures,
        point: &TexturePoint,
        context: ShadingContext<'_>,
    ) -> Option<B> {
        B::at(&mut Evaluator::new(&[], textures, point, context), &self.kind)
    }

    /// The BSDF at a point where frames are bent, and the axes of the frame; the third is the shading normal.
    #[inline(never)]
    pub(crate) fn bent_row<B: MaterialRow>(
        &self,
        relief: Relief<'_>,
        geometry: &ShadingGeometry,
        point: &TexturePoint,
        context: ShadingContext<'_>,
    ) -> Option<(B, [[f32; 3]; 3])> {
        let mut frame = self.frame(relief, geometry, point);
        let mut evaluator = Evaluator::new(&[], relief.textures, point, context);
        let row = B::in_frame(&mut evaluator, &self.kind, geometry, &mut frame)?;
        Some((row, frame.axes()))
    }
}

/// A class of BSDFs that materials have.
pub(crate) trait MaterialRow: RowBsdf {
    /// Whether it depends on [`ShadingContext::seed`].
    const TAKES_SEED: bool = false;

    /// The BSDF of a material of this class.
    fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind) -> Option<Self>;

    /// The BSDF in a frame, which it may turn.
    #[inline]
    fn in_frame(
        evaluator: &mut Evaluator<'_>,
        kind: &MaterialKind,
        _geometry: &ShadingGeometry,
        _frame: &mut Frame,
    ) -> Option<Self> {
        Self::at(evaluator, kind)
    }
}

impl MaterialRow for Principled {
    #[inline]
    fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind) -> Option<Self> {
        let MaterialKind::Principled(look) = kind else { return None };
        look.template.as_ref().map(|template| evaluator.of_template(look, template))
    }

    fn in_frame(
        evaluator: &mut Evaluator<'_>,
        kind: &MaterialKind,
        geometry: &ShadingGeometry,
        frame: &mut Frame,
    ) -> Option<Self> {
        let MaterialKind::Principled(look) = kind else { return None };
        // Which material it is matters only where light enters its body.
        let (bsdf, turned) = evaluator.principled(look, 0, geometry, *frame);
        *frame = turned;
        Some(bsdf)
    }
}

impl MaterialRow for OpenPbrSurface {
    #[inline]
    fn at(_: &mut Evaluator<'_>, _: &MaterialKind) -> Option<Self> {
        None
    }

    fn in_frame(
        evaluator: &mut Evaluator<'_>,
        kind: &MaterialKind,
        geometry: &ShadingGeometry,
        frame: &mut Frame,
    ) -> Option<Self> {
        let MaterialKind::OpenPbr(look) = kind else { return None };
        // As above.
        let (bsdf, turned) = evaluator.open_pbr(look, 0, geometry, *frame);
        *frame = turned;
        Some(bsdf)
    }
}

macro_rules! material_row {
    ($row:ty, $kind:ident { $($field:ident),+ } => $method:ident $(, $takes_seed:literal)?) => {
        impl MaterialRow for $row {
            $(const TAKES_SEED: bool = $takes_seed;)?

            #[inline]
            fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind) -> Option<Self> {
                match kind {
                    MaterialKind::$kind { $($field),+ } => Some(evaluator.$method($($field),+)),
                    _ => None,
                }
            }
        }
    };
    ($row:ty, $kind:ident => $method:ident) => {
        impl MaterialRow for $row {
            #[inline]
            fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind) -> Option<Self> {
                match kind {
                    MaterialKind::$kind(look) => Some(evaluator.$method(look)),
                    _ => None,
                }
            }
        }
    };
}

material_row!(Diffuse, Diffuse { reflectance } => diffuse);
material_row!(
    DiffuseTransmission,
    DiffuseTransmission { reflectance, transmittance, scale } => diffuse_transmission
);
material_row!(Conductor, Conductor { metal, roughness, energy, specular_reflectance } => conductor);
material_row!(Dielectric, Dielectric { eta, roughness, energy } => dielectric);
material_row!(TintedDielectric, TintedDielectric { eta, roughness, energy, tint } => tinted_dielectric);
material_row!(Layered<Diffuse>, CoatedDiffuse { reflectance, coat } => coated_diffuse, true);
material_row!(Layered<Conductor>, CoatedConductor { metal, roughness, coat } => coated_conductor, true);
material_row!(Plastic, Plastic => plastic);
material_row!(Hair, Hair => hair);
material_row!(Measured, Measured => measured);
material_row!(WhittedCoefficients, Whitted => whitted);
material_row!(Disney, Disney => disney);
