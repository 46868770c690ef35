//! Any BSDF as a class of its own, at width one: for those that are not computed in lanes, and where lanes are not filled.

use glam::Vec3;

use super::lanes::{ClassTraits, LaneBsdf};
use super::{Bsdf, DirectionSample};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;

/// A BSDF of any class seen from an outgoing direction, `P`.
#[derive(Debug)]
pub struct PreparedBsdf<P> {
    pub(super) is_grazing: bool,
    pub(super) class: P,
}

/// An enum of the classes in a table.
macro_rules! scattering_functions {
    (
        $(#[$meta:meta])* $name:ident
        lanes { $($(#[$lane_doc:meta])* $lane:ident($lane_type:ty $(| $of_whole:ident.$part:ident)?),)* }
        wholes { $($(#[$whole_doc:meta])* $whole:ident($whole_type:ty),)* }
        one_by_one { $($(#[$doc:meta])* $one:ident($type:ty),)* }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$lane_doc])* $lane($lane_type),)*
            $($(#[$whole_doc])* $whole($whole_type),)*
            $($(#[$doc])* $one($type),)*
        }

        /// One of them, and what it has prepared for an outgoing direction.
        #[derive(Debug)]
        #[non_exhaustive]
        pub enum PreparedClass {
            $($(#[$lane_doc])* $lane($lane_type, <$lane_type as LaneBsdf<f32>>::Prepared),)*
            $($(#[$doc])* $one($type, <$type as LaneBsdf<f32>>::Prepared),)*
        }

        impl $name {
            /// The scattering function.
            #[inline]
            pub(crate) fn class(&self) -> &dyn ScatteringFunction {
                match self {
                    $(Self::$lane(bsdf) => bsdf,)*
                    $(Self::$whole(bsdf) => bsdf,)*
                    $(Self::$one(bsdf) => bsdf,)*
                }
            }

            #[inline]
            pub(crate) fn class_mut(&mut self) -> &mut dyn ScatteringFunction {
                match self {
                    $(Self::$lane(bsdf) => bsdf,)*
                    $(Self::$whole(bsdf) => bsdf,)*
                    $(Self::$one(bsdf) => bsdf,)*
                }
            }
        }

        impl LaneBsdf<f32> for $name {
            type Prepared = PreparedBsdf<PreparedClass>;

            fn traits(&self) -> ClassTraits {
                match self {
                    $(
                        Self::$lane(bsdf) => LaneBsdf::<f32>::traits(bsdf),
                        $(Self::$of_whole(bsdf) => LaneBsdf::<f32>::traits(&bsdf.$part),)?
                    )*
                    $(Self::$one(bsdf) => LaneBsdf::<f32>::traits(bsdf),)*
                }
            }

            fn prepare(&self, wo: Vector<f32>) -> PreparedBsdf<PreparedClass> {
                let class = match *self {
                    $(
                        Self::$lane(bsdf) => PreparedClass::$lane(bsdf, bsdf.prepare(wo)),
                        $(Self::$of_whole(bsdf) => PreparedClass::$lane(bsdf.$part, bsdf.$part.prepare(wo)),)?
                    )*
                    $(Self::$one(bsdf) => PreparedClass::$one(bsdf, bsdf.prepare(wo)),)*
                };
                PreparedBsdf { is_grazing: is_grazing(wo), class }
            }

            fn f(&self, prepared: &PreparedBsdf<PreparedClass>, wi: Vector<f32>) -> Spectrum {
                match &prepared.class {
                    $(PreparedClass::$lane(bsdf, seen) => LaneBsdf::f(bsdf, seen, wi),)*
                    $(PreparedClass::$one(bsdf, seen) => LaneBsdf::f(bsdf, seen, wi),)*
                }
            }

            fn pdf(&self, prepared: &PreparedBsdf<PreparedClass>, wi: Vector<f32>) -> f32 {
                match &prepared.class {
                    $(PreparedClass::$lane(bsdf, seen) => LaneBsdf::pdf(bsdf, seen, wi),)*
                    $(PreparedClass::$one(bsdf, seen) => LaneBsdf::pdf(bsdf, seen, wi),)*
                }
            }

            fn f_and_pdf(&self, prepared: &PreparedBsdf<PreparedClass>, wi: Vector<f32>) -> (Spectrum, f32) {
                match &prepared.class {
                    $(PreparedClass::$lane(bsdf, seen) => LaneBsdf::f_and_pdf(bsdf, seen, wi),)*
                    $(PreparedClass::$one(bsdf, seen) => LaneBsdf::f_and_pdf(bsdf, seen, wi),)*
                }
            }

            fn sample(&self, prepared: &PreparedBsdf<PreparedClass>, uc: f32, u: [f32; 2]) -> DirectionSample<f32> {
                let sample = match &prepared.class {
                    $(PreparedClass::$lane(bsdf, seen) => LaneBsdf::sample(bsdf, seen, uc, u).if_useful(),)*
                    $(PreparedClass::$one(bsdf, seen) => LaneBsdf::sample(bsdf, seen, uc, u).if_useful(),)*
                };
                DirectionSample { is_valid: sample.is_valid && !prepared.is_grazing, ..sample }
            }

            fn has_density(&self) -> bool {
                self.class().lobes().is_non_specular()
            }

            fn diffuse_share(&self, prepared: &PreparedBsdf<PreparedClass>, wi: Vector<f32>, f: Spectrum) -> Spectrum {
                match &prepared.class {
                    $(PreparedClass::$lane(bsdf, seen) => LaneBsdf::diffuse_share(bsdf, seen, wi, f),)*
                    $(PreparedClass::$one(bsdf, seen) => LaneBsdf::diffuse_share(bsdf, seen, wi, f),)*
                }
            }
        }
    };
}

pub(super) use scattering_functions;

/// A BSDF whose directions are sampled uniformly over the sphere, whatever it is: to verify importance sampling.
pub(crate) struct Uniform<'a> {
    pub(crate) bsdf: &'a Bsdf,
    /// The axes of its frame, in the space where the numbers of samples make directions.
    pub(crate) axes: [[f32; 3]; 3],
}

impl LaneBsdf<f32> for Uniform<'_> {
    type Prepared = <Bsdf as LaneBsdf<f32>>::Prepared;

    fn traits(&self) -> ClassTraits {
        ClassTraits { pdf_is_proportional: false, ..self.bsdf.traits() }
    }

    fn prepare(&self, wo: Vector<f32>) -> Self::Prepared {
        self.bsdf.prepare(wo)
    }

    fn f(&self, prepared: &Self::Prepared, wi: Vector<f32>) -> Spectrum {
        LaneBsdf::f(self.bsdf, prepared, wi)
    }

    fn pdf(&self, _: &Self::Prepared, _: Vector<f32>) -> f32 {
        warp::UNIFORM_SPHERE_PDF
    }

    fn sample(&self, prepared: &Self::Prepared, _: f32, u: [f32; 2]) -> DirectionSample<f32> {
        let direction = warp::uniform_sphere(u);
        let wi = Vec3::from(self.axes.map(|axis| direction.dot(axis.into()))).into();
        let f = LaneBsdf::f(self.bsdf, prepared, wi);
        DirectionSample {
            wi,
            f,
            pdf: warp::UNIFORM_SPHERE_PDF,
            eta: 1.0,
            is_specular: false,
            is_diffuse: true,
            is_transmission: false,
            is_valid: true,
        }
    }

    fn has_density(&self) -> bool {
        self.bsdf.has_density()
    }
}
