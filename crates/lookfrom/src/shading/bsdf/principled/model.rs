//! The two models that are made of these layers: glTF's, and OpenPBR, which has more of them.

use lookfrom_simd::Real;

use super::Principled;
use super::open_pbr::OpenPbr;
use crate::core::vector::Vector;

/// The additions of a model to the layers. They are known when the program is compiled, so that glTF's costs nothing more.
pub trait Model<R: Real>: Copy {
    /// The additions of OpenPBR; `None` for glTF's model.
    fn open_pbr(&self) -> Option<&OpenPbr<R>>;

    /// This with the terms that depend on the outgoing direction `wo`, in the local frame and above the surface.
    fn seen(look: &Principled<R, Self>, wo: Vector<R>) -> Self;
}

/// glTF's model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gltf;

impl<R: Real> Model<R> for Gltf {
    #[inline(always)]
    fn open_pbr(&self) -> Option<&OpenPbr<R>> {
        None
    }

    #[inline(always)]
    fn seen(_: &Principled<R>, _: Vector<R>) -> Self {
        Self
    }
}
