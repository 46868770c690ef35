//! Materials whose BSDFs are computed in lanes: their classes, and their evaluation to a BSDF of a class.

use super::{
    BumpMapping, Evaluator, Frame, Guard, LocalNormal, Material, MaterialKind, Relief, ShadingContext,
};
use crate::shading::bsdf::BsdfClass;
use crate::shading::bsdf::lanes::RowBsdf;
use crate::shading::bsdf::types::*;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{PicturedFloat, TexturePoint, Textures};

impl Material {
    /// The class of its BSDFs, if they are computed in lanes: not chosen at random, and the same in all media.
    pub(crate) fn class(&self) -> Option<BsdfClass> {
        match &self.kind {
            MaterialKind::Diffuse { .. } => Some(BsdfClass::Diffuse),
            MaterialKind::DiffuseTransmission { .. } => Some(BsdfClass::DiffuseTransmission),
            MaterialKind::Conductor { .. } => Some(BsdfClass::Conductor),
            MaterialKind::Dielectric { .. } => Some(BsdfClass::Dielectric),
            MaterialKind::TintedDielectric { .. } => Some(BsdfClass::TintedDielectric),
            MaterialKind::ThinDielectric { .. } => Some(BsdfClass::ThinDielectric),
            MaterialKind::CoatedDiffuse { .. } => Some(BsdfClass::CoatedDiffuse),
            MaterialKind::CoatedConductor { .. } => Some(BsdfClass::CoatedConductor),
            MaterialKind::Principled(look) => {
                (!look.refraction().disperses()).then_some(BsdfClass::Principled)
            }
            MaterialKind::OpenPbr(look) => (!look.refraction().disperses()).then_some(BsdfClass::OpenPbr),
            MaterialKind::Plastic(_) => Some(BsdfClass::Plastic),
            MaterialKind::Hair(_) => Some(BsdfClass::Hair),
            MaterialKind::Measured(_) => Some(BsdfClass::Measured),
            MaterialKind::Whitted(_) => Some(BsdfClass::Whitted),
            MaterialKind::Disney(_) => Some(BsdfClass::Disney),
            _ => None,
        }
    }

    /// Whether all BSDFs of the material of an index have classes, also where it is mixed.
    pub(crate) fn has_class(materials: &[Self], index: u32) -> bool {
        match &materials[index as usize].kind {
            MaterialKind::Mix { materials: parts, .. } => {
                parts.iter().all(|part| Self::has_class(materials, *part))
            }
            _ => materials[index as usize].class().is_some(),
        }
    }

    /// Whether it has a bump or normal map.
    #[inline]
    pub(crate) fn has_bumps(&self) -> bool {
        !matches!(self.bump_mapping, BumpMapping::None)
    }

    /// The heights of its bump map, if it has one.
    #[inline]
    pub(crate) fn heights(&self) -> Option<&PicturedFloat> {
        if let BumpMapping::Bump(heights) = &self.bump_mapping { Some(heights) } else { None }
    }

    /// Whether its shading frame is another than that of the surface.
    #[inline]
    pub(crate) fn bends_frames(&self) -> bool {
        self.has_bumps() || self.reflects_outside
    }

    /// Whether its frames are bent in lanes: its BSDF does not depend on them.
    #[inline]
    pub(crate) fn bends_in_lanes(&self) -> bool {
        let depends_on_frame = match &self.kind {
            MaterialKind::Principled(look) => look.depends_on_frame(),
            MaterialKind::OpenPbr(_) => true,
            _ => false,
        };
        self.bends_frames() && !depends_on_frame
    }

    /// The normal of its normal map at a point, if it has one.
    #[inline]
    pub(crate) fn local_normal(&self, textures: &Textures, point: &TexturePoint) -> Option<LocalNormal> {
        LocalNormal::at(&self.bump_mapping, textures, point)
    }

    /// The BSDF at a point, as [`super::shading()`] has it; `None` where the material is of another class, or
    /// [bends frames](Material::bends_frames) and has a BSDF that depends on them. Where wavelengths are dispersed, only the
    /// first is kept.
    #[inline]
    pub(crate) fn row<B: MaterialRow>(
        &self,
        materials: &[Material],
        textures: &Textures,
        (side, point): (Side, &TexturePoint),
        context: ShadingContext<'_>,
    ) -> Option<B> {
        B::at(&mut Evaluator::new(materials, textures, point, context), &self.kind, side)
    }

    /// The BSDF at a point where frames are bent, the axes of the frame, the third of which is the shading normal, and the guard of
    /// that.
    #[inline(never)]
    pub(crate) fn bent_row<B: MaterialRow>(
        &self,
        materials: &[Material],
        relief: Relief<'_>,
        geometry: &ShadingGeometry,
        (side, point): (Side, &TexturePoint),
        context: ShadingContext<'_>,
    ) -> Option<(B, [[f32; 3]; 3], Option<Guard>)> {
        let mut frame = self.frame(relief, geometry, point);
        let mut evaluator = Evaluator::new(materials, relief.textures, point, context);
        let row = B::in_frame(&mut evaluator, &self.kind, side, geometry, &mut frame)?;
        Some((row, frame.axes(), self.guard(geometry.ns, frame.n)))
    }
}

/// The side of a surface that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Index of its material.
    pub(crate) material: u32,
    /// Whether it is the outside.
    pub(crate) front: bool,
}

/// A class of BSDFs that materials have.
pub(crate) trait MaterialRow: RowBsdf {
    /// Whether it depends on [`ShadingContext::seed`].
    const TAKES_SEED: bool = false;

    /// The BSDF of a material of this class, whatever its frame.
    fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind, side: Side) -> Option<Self>;

    /// The BSDF in a frame, which it may turn.
    #[inline]
    fn in_frame(
        evaluator: &mut Evaluator<'_>,
        kind: &MaterialKind,
        side: Side,
        _geometry: &ShadingGeometry,
        _frame: &mut Frame,
    ) -> Option<Self> {
        Self::at(evaluator, kind, side)
    }
}

impl MaterialRow for Principled {
    #[inline]
    fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind, side: Side) -> Option<Self> {
        let MaterialKind::Principled(look) = kind else { return None };
        evaluator.template_of(look).or_else(|| evaluator.principled_in_any_frame(look, side))
    }

    fn in_frame(
        evaluator: &mut Evaluator<'_>,
        kind: &MaterialKind,
        side: Side,
        geometry: &ShadingGeometry,
        frame: &mut Frame,
    ) -> Option<Self> {
        let MaterialKind::Principled(look) = kind else { return None };
        let (bsdf, turned) = evaluator.principled(look, side.material, geometry, *frame);
        *frame = turned;
        Some(bsdf)
    }
}

impl MaterialRow for OpenPbrSurface {
    #[inline]
    fn at(_: &mut Evaluator<'_>, _: &MaterialKind, _: Side) -> Option<Self> {
        None
    }

    fn in_frame(
        evaluator: &mut Evaluator<'_>,
        kind: &MaterialKind,
        side: Side,
        geometry: &ShadingGeometry,
        frame: &mut Frame,
    ) -> Option<Self> {
        let MaterialKind::OpenPbr(look) = kind else { return None };
        let (bsdf, turned) = evaluator.open_pbr(look, side.material, geometry, *frame);
        *frame = turned;
        Some(bsdf)
    }
}

impl MaterialRow for NormalizedFresnel {
    /// None: no material has it but where paths leave it that have entered elsewhere.
    fn at(_: &mut Evaluator<'_>, _: &MaterialKind, _: Side) -> Option<Self> {
        None
    }
}

macro_rules! material_row {
    ($row:ty, $kind:ident { $($field:ident),+ } => $method:ident $(, $takes_seed:literal)?) => {
        impl MaterialRow for $row {
            $(const TAKES_SEED: bool = $takes_seed;)?

            #[inline]
            fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind, _: Side) -> Option<Self> {
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
            fn at(evaluator: &mut Evaluator<'_>, kind: &MaterialKind, _: Side) -> Option<Self> {
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
material_row!(ThinDielectric, ThinDielectric { eta, tint } => thin_dielectric);
material_row!(Layered<Diffuse>, CoatedDiffuse { reflectance, coat } => coated_diffuse, true);
material_row!(Layered<Conductor>, CoatedConductor { metal, roughness, coat } => coated_conductor, true);
material_row!(Plastic, Plastic => plastic);
material_row!(Hair, Hair => hair);
material_row!(Measured, Measured => measured);
material_row!(WhittedCoefficients, Whitted => whitted);
material_row!(Disney, Disney => disney);
