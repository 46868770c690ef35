//! Disney's principled surface.

use super::{Color, Scalar};

/// Disney's principled surface, solid or thin, as in Mitsuba's `principled` and `principledthin` (Burley 2012, 2015). Numbers without
/// another range are 0 … 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Disney {
    /// The albedo of the base, the colour of metal; its square root is that of glass.
    pub base_color: Color,
    /// Perceptual roughness: α is its square.
    pub roughness: Scalar,
    /// Stretch of highlights along u.
    pub anisotropic: Scalar,
    /// The fraction of metal; not of a thin sheet.
    pub metallic: Scalar,
    /// The fraction of glass, or of a thin sheet's light that passes it or is reflected, not scattered.
    pub spec_trans: Scalar,
    /// Index of refraction, inside over outside; more than 0.
    pub eta: Scalar,
    /// The share of the base colour in the reflection of dielectrics.
    pub spec_tint: Scalar,
    /// Strength of sheen, at least 0 …
    pub sheen: Scalar,
    /// … and the share of the base colour in it.
    pub sheen_tint: Scalar,
    /// The share of a base in which light scatters below the surface.
    pub flatness: Scalar,
    /// Strength of a clear coat; not of a thin sheet.
    pub clearcoat: Scalar,
    /// Gloss of the coat: α is 0.1 at 0, 0.001 at 1.
    pub clearcoat_gloss: Scalar,
    /// Light that a thin sheet scatters to its other side: 0 … 2, of which 2 is all.
    pub diff_trans: Scalar,
    /// Whether it is a thin sheet.
    pub is_thin: bool,
}

impl Default for Disney {
    fn default() -> Self {
        let zero = Scalar::Value(0.0);
        Self {
            base_color: Color::gray(0.5),
            roughness: Scalar::Value(0.5),
            anisotropic: zero,
            metallic: zero,
            spec_trans: zero,
            eta: Scalar::Value(1.5),
            spec_tint: zero,
            sheen: zero,
            sheen_tint: zero,
            flatness: zero,
            clearcoat: zero,
            clearcoat_gloss: zero,
            diff_trans: zero,
            is_thin: false,
        }
    }
}

impl Disney {
    /// Its numbers by name.
    pub fn scalars(&self) -> [(&'static str, Scalar); 12] {
        [
            ("roughness", self.roughness),
            ("anisotropic", self.anisotropic),
            ("metallic", self.metallic),
            ("spec_trans", self.spec_trans),
            ("eta", self.eta),
            ("spec_tint", self.spec_tint),
            ("sheen", self.sheen),
            ("sheen_tint", self.sheen_tint),
            ("flatness", self.flatness),
            ("clearcoat", self.clearcoat),
            ("clearcoat_gloss", self.clearcoat_gloss),
            ("diff_trans", self.diff_trans),
        ]
    }

    /// Whether light passes it nowhere.
    pub fn is_opaque(&self) -> bool {
        let none = Scalar::Value(0.0);
        self.spec_trans == none && (!self.is_thin || self.diff_trans == none)
    }
}
