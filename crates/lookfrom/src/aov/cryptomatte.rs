//! Cryptomattes: which named things cover a pixel, and how much of it (Friedman & Jones 2015; the layout in files is that of
//! Psyop's Cryptomatte Specification 1.2).
//!
//! A name is known by its hash, whose bits are a finite float. Of each pixel the names that cover most of it are kept, as pairs of
//! identifier and coverage: two pairs are the four channels of an RGBA layer.

use std::collections::{BTreeMap, BTreeSet};

use lookfrom_scene::settings::CryptomatteKind;

/// Number of names of a pixel that are kept.
const RANKS: usize = 6;

/// The hash of a name, which is no infinity, none that is not a number and none that is denormal as a float.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct CryptomatteId(u32);

impl CryptomatteId {
    /// The identifier of a name.
    pub(crate) fn of(name: &str) -> Self {
        const EXPONENT: u32 = 0xff << 23;
        let hash = murmur3(name.as_bytes());
        match hash & EXPONENT {
            0 | EXPONENT => Self(hash ^ 1 << 23),
            _ => Self(hash),
        }
    }
}

/// `MurmurHash3_x86_32` with the seed 0 (Austin Appleby 2011).
fn murmur3(bytes: &[u8]) -> u32 {
    let scrambled = |block: u32| block.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let mut hash = 0_u32;
    let mut blocks = bytes.chunks_exact(4);
    for block in &mut blocks {
        hash ^= scrambled(u32::from_le_bytes([block[0], block[1], block[2], block[3]]));
        hash = hash.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    let rest = blocks.remainder().iter().rev().fold(0, |rest, byte| rest << 8 | u32::from(*byte));
    hash ^= scrambled(rest) ^ bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

/// The names that cover most of a pixel with their coverage, 0 … 1, the greatest first; zeros where there are fewer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PixelMatte([(CryptomatteId, f32); RANKS]);

impl PixelMatte {
    /// Its bytes.
    pub(crate) const BYTES: u64 = size_of::<Self>() as u64;

    /// Of weighted names, in any order and repeated, and the sum of all weights: those that cover nothing, too.
    pub(crate) fn new(weighted: &mut [(CryptomatteId, f32)], all: f64) -> Self {
        // Stable, so that sums do not depend on anything but the order of samples.
        weighted.sort_by_key(|(id, _)| *id);
        let of_names = weighted.chunk_by(|a, b| a.0 == b.0).map(|of_name| {
            let sum: f64 = of_name.iter().map(|(_, weight)| f64::from(*weight)).sum();
            (of_name[0].0, (sum / all).clamp(0.0, 1.0) as f32)
        });
        let mut names: Vec<_> = of_names.filter(|(_, coverage)| *coverage > 0.0).collect();
        names.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut names = names.into_iter();
        Self(std::array::from_fn(|_| names.next().unwrap_or_default()))
    }
}

/// A Cryptomatte of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Cryptomatte {
    kind: CryptomatteKind,
    /// The names that are in the picture.
    names: BTreeMap<CryptomatteId, String>,
    /// Row by row from the top left.
    pixels: Vec<PixelMatte>,
}

impl Cryptomatte {
    /// The Cryptomatte of these pixels. Of all names that there are, those count which are in the picture.
    pub(crate) fn new(
        kind: CryptomatteKind,
        pixels: Vec<PixelMatte>,
        names: impl Iterator<Item = (CryptomatteId, String)>,
    ) -> Self {
        let seen: BTreeSet<_> = pixels.iter().flat_map(|pixel| pixel.0.map(|(id, _)| id)).collect();
        Self { kind, names: names.filter(|(id, _)| seen.contains(id)).collect(), pixels }
    }

    /// Its kind: the names are of objects or of materials.
    pub fn kind(&self) -> CryptomatteKind {
        self.kind
    }

    /// The names that cover most of a pixel, at most six, and the part that they cover, 0 … 1, the greatest first. Pixels count row by
    /// row from the top left.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn coverage(&self, pixel: usize) -> impl Iterator<Item = (&str, f32)> {
        let named = |(id, part): &(CryptomatteId, f32)| Some((self.names.get(id)?.as_str(), *part));
        self.pixels[pixel].0.iter().filter_map(named)
    }

    /// The names of its channels.
    pub(crate) fn channels(&self) -> impl Iterator<Item = String> {
        let layer = self.kind.layer();
        (0..RANKS / 2).flat_map(move |pair| ["R", "G", "B", "A"].map(|c| format!("{layer}{pair:02}.{c}")))
    }

    /// The numbers of its channels for a pixel.
    pub(crate) fn numbers(&self, pixel: usize) -> impl Iterator<Item = f32> {
        self.pixels[pixel].0.into_iter().flat_map(|(CryptomatteId(id), part)| [f32::from_bits(id), part])
    }

    /// The texts for the header of its file.
    pub(crate) fn attributes(&self) -> impl Iterator<Item = (String, String)> {
        let layer = self.kind.layer();
        let key = format!("{:08x}", murmur3(layer.as_bytes()));
        let texts = [
            ("name", layer.to_owned()),
            ("hash", "MurmurHash3_32".to_owned()),
            ("conversion", "uint32_to_float32".to_owned()),
            ("manifest", self.manifest()),
        ];
        texts.into_iter().map(move |(name, text)| (format!("{ATTRIBUTES}{}/{name}", &key[..7]), text))
    }

    /// The names with their identifiers, in JSON.
    fn manifest(&self) -> String {
        let ids = self.names.iter().map(|(CryptomatteId(id), name)| (name, format!("{id:08x}")));
        // A map of texts is always JSON.
        serde_json::to_string(&ids.collect::<BTreeMap<_, _>>()).unwrap_or_default()
    }
}

/// The beginning of the names of all attributes of Cryptomattes.
pub(crate) const ATTRIBUTES: &str = "cryptomatte/";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_murmur3() {
        for (text, hash) in [
            ("", 0),
            ("hello", 0x248b_fa47),
            ("hello, world", 0x149b_bb7f),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
    }

    #[test]
    fn identifiers_are_normal_floats() {
        // Of the empty name, all bits of the hash are 0.
        assert_eq!(CryptomatteId::of("").0, 1 << 23);
        for number in 0..100_000 {
            let name = format!("chair {number}");
            assert!(f32::from_bits(CryptomatteId::of(&name).0).is_normal(), "{name}");
        }
    }

    #[test]
    fn pixels_keep_what_covers_most() {
        let id = CryptomatteId;
        let mut weighted: Vec<_> = (1..=9_u8).map(|number| (id(number.into()), f32::from(number))).collect();
        weighted.extend([(id(1), 9.0), (id(20), -3.0)]);
        let pixel = PixelMatte::new(&mut weighted, 100.0);
        let expected = [(1, 0.1), (9, 0.09), (8, 0.08), (7, 0.07), (6, 0.06), (5, 0.05)];
        assert_eq!(pixel.0, expected.map(|(number, coverage)| (id(number), coverage)));
        assert_eq!(PixelMatte::new(&mut [], 0.0), PixelMatte::default());
    }

    #[test]
    fn manifests_are_json() {
        let names = ["a \"b\"", "back\\slash", "two\nlines", "Ä", "unseen"];
        let pixel = |name: &str| PixelMatte::new(&mut [(CryptomatteId::of(name), 1.0)], 2.0);
        let pixels = names[..4].iter().map(|name| pixel(name)).collect();
        let all = names.iter().map(|name| (CryptomatteId::of(name), (*name).to_owned()));
        let matte = Cryptomatte::new(CryptomatteKind::Object, pixels, all);
        let attributes: Vec<_> = matte.attributes().collect();
        let (name, manifest) = &attributes[3];
        assert!(name.len() == 28 && name.ends_with("/manifest"), "{name}");
        let ids = ["a \"b\"", "back\\slash", "two\nlines", "Ä"]
            .map(|name| format!("{:08x}", CryptomatteId::of(name).0));
        let [quote, backslash, lines, umlaut] = ids;
        let expected = format!(
            r#"{{"a \"b\"":"{quote}","back\\slash":"{backslash}","two\nlines":"{lines}","Ä":"{umlaut}"}}"#
        );
        assert_eq!(*manifest, expected);
        assert_eq!(matte.numbers(1).nth(1), Some(0.5));
        assert_eq!(matte.coverage(2).collect::<Vec<_>>(), [("two\nlines", 0.5)]);
    }
}
