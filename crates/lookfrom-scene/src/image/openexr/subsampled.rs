//! Subsampled channels of OpenEXR files, which are not read: luminance with chroma of half the width and height.

use super::MAGIC;
use crate::error::{Error, ErrorKind, Location};

/// The error of a file with subsampled channels; `None` for every other file.
pub(super) fn told(bytes: &[u8], at: &Location) -> Option<Error> {
    let names = subsampled(bytes.strip_prefix(&MAGIC)?.get(4..)?)?;
    let is_chroma = names.iter().any(|name| name.ends_with("RY") || name.ends_with("BY"));
    let kind = if is_chroma { "luminance and subsampled chroma (Y, RY, BY)" } else { "subsampled channels" };
    let message =
        format!("OpenEXR with {kind} is not read here: {} have fewer values than pixels", names.join(", "));
    Some(
        Error::new(ErrorKind::Unsupported, at, message).hint(
            "the file is whole; save it with the channels R, G and B, each with a value for every pixel",
        ),
    )
}

/// The names of the channels of the first part that are subsampled, if there are any.
fn subsampled(mut header: &[u8]) -> Option<Vec<String>> {
    loop {
        let name = word(&mut header)?;
        if name.is_empty() {
            return None;
        }
        let _kind = word(&mut header)?;
        let (length, rest) = header.split_first_chunk::<4>()?;
        let (mut value, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        header = rest;
        if name != b"channels" {
            continue;
        }
        let mut names = Vec::new();
        loop {
            let channel = word(&mut value)?;
            if channel.is_empty() {
                return Some(names).filter(|names| !names.is_empty());
            }
            // The pixel type, whether it is linear, three unused bytes, and how many columns and rows have one value.
            let (description, rest) = value.split_first_chunk::<16>()?;
            value = rest;
            if description[8..] != [1, 0, 0, 0, 1, 0, 0, 0] {
                names.push(String::from_utf8_lossy(channel).into_owned());
            }
        }
    }
}

/// The bytes up to the next zero, which is removed as well.
fn word<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let end = bytes.iter().position(|&byte| byte == 0)?;
    let word = &bytes[..end];
    *bytes = &bytes[end + 1..];
    Some(word)
}
