//! A decoded picture, how it is read from a file, how one is written, and how two differ.

pub mod compare;
pub mod flip;
mod openexr;
mod read;
mod srgb;
mod write;

pub use self::openexr::{Channels, encode_exr, read_exr};
pub use self::read::{read, read_data, read_encoded, read_opacity};
pub use self::srgb::{linear_from_srgb, srgb_from_linear};
pub use self::write::{encode_hdr, encode_pfm, encode_png, encode_ppm};

/// A picture of linear colours, row 0 on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// The file it came from.
    pub name: String,
    /// Columns: > 0.
    pub width: u32,
    /// Rows: > 0.
    pub height: u32,
    /// `width * height` linear Rec. 709 colours, row by row.
    pub texels: Vec<[f32; 3]>,
}
