//! Cryptomattes: layers of an EXR that tell which part of each pixel every object or material covers.

/// The kind of things that a Cryptomatte has mattes of (Friedman & Jones 2015).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CryptomatteKind {
    /// Shapes, and whole instances.
    Object,
    /// Materials.
    Material,
}

impl CryptomatteKind {
    /// The words for them.
    pub const WORDS: &[(&str, Self)] = &[("object", Self::Object), ("material", Self::Material)];

    /// Kinds in their order, each once.
    pub fn distinct(kinds: impl IntoIterator<Item = Self>) -> Vec<Self> {
        let mut distinct = Vec::new();
        for kind in kinds {
            if !distinct.contains(&kind) {
                distinct.push(kind);
            }
        }
        distinct
    }

    /// The name of its layer in a file, by which compositors choose it.
    pub fn layer(self) -> &'static str {
        match self {
            Self::Object => "CryptoObject",
            Self::Material => "CryptoMaterial",
        }
    }
}
