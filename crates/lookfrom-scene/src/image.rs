//! Decoded images; their readers, writers and comparison.

mod animation;
#[cfg(feature = "images")]
mod basis;
pub mod compare;
mod encoding;
pub mod flip;
#[cfg(feature = "images")]
mod ktx2;
mod metadata;
mod openexr;
mod radiance;
mod read;
mod rgbe;
mod srgb;
mod texels;
#[cfg(feature = "images")]
mod tiff;
mod write;

pub use self::animation::{Animation, AnimationFormat};
pub use self::encoding::Encoding;
pub use self::metadata::Metadata;
pub use self::openexr::{
    Channels, ExrChannel, ExrContents, ExrFill, ExrHeader, ExrRowStream, ExrRows, encode_exr, exr_contents,
    read_exr, read_exr_layer, write_exr,
};
pub use self::read::{By, Reading, decode, read, read_as, read_data, read_encoded, read_opacity};
pub use self::srgb::{linear_from_srgb, srgb_from_linear};
pub use self::texels::{Image, Quad};
pub use self::write::{
    Pixels, encode_hdr, encode_jpeg, encode_pfm, encode_png, encode_png_of, encode_png_to_show, encode_ppm,
    encode_webp, without_alpha, write_jpeg, write_png, write_webp,
};
