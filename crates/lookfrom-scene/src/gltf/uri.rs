//! URIs: embedded bytes (`data:`, RFC 2397), or the percent-encoded path of another file (RFC 3986).

use crate::error::{Error, ErrorKind, Location, Result};

/// The content of a `uri`.
pub(crate) enum Uri {
    /// Embedded bytes.
    Data(Vec<u8>),
    /// The path of a file relative to this file: percent-decoded, as written where that differs, and each with slashes
    /// instead of backslashes.
    Names(Vec<String>),
}

/// Reads a `uri`.
pub(super) fn read(uri: &str, at: &Location) -> Result<Uri> {
    if let Some(data) = strip_scheme(uri, "data:") {
        let Some((kind, payload)) = data.split_once(',') else {
            return Err(Error::syntax(at, "a data URI has a comma before its data; there is none"));
        };
        let bytes = match kind.to_ascii_lowercase().ends_with(";base64") {
            true => base64(payload.as_bytes(), at)?,
            false => percent_decoded(payload),
        };
        return Ok(Uri::Data(bytes));
    }
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    let is_scheme =
        |word: &str| word.len() > 1 && word.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b));
    if scheme.is_some_and(is_scheme) {
        return Err(Error::new(
            ErrorKind::Unsupported,
            at,
            format!("{:?} is an address, not a file", shown(uri)),
        )
        .hint("put the file beside the model and name it relative to the model"));
    }
    if uri.is_empty() || uri.contains('\0') {
        return Err(Error::invalid(at, "this names no file"));
    }
    let written = uri.to_owned();
    let mut names = Vec::new();
    match String::from_utf8(percent_decoded(uri)) {
        Ok(meant) if meant != written && !meant.contains('\0') => names.push(meant),
        _ => {}
    }
    names.push(written);
    // Programs for Windows may write backslashes.
    let turned: Vec<String> =
        names.iter().filter(|name| name.contains('\\')).map(|name| name.replace('\\', "/")).collect();
    names.extend(turned);
    Ok(Uri::Names(names))
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let start = uri.get(..scheme.len())?;
    start.eq_ignore_ascii_case(scheme).then(|| &uri[scheme.len()..])
}

/// The beginning of a long text, for messages.
fn shown(uri: &str) -> String {
    let start: String = uri.chars().take(60).collect();
    if start.len() < uri.len() { start + "…" } else { start }
}

fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let hex = |byte: u8| (byte as char).to_digit(16).map(|digit| digit as u8);
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        if let [b'%', high, low, ..] = bytes[i..]
            && let (Some(high), Some(low)) = (hex(high), hex(low))
        {
            decoded.push(16 * high + low);
            i += 3;
        } else {
            decoded.push(bytes[i]);
            i += 1;
        }
    }
    decoded
}

/// Not a digit.
const NONE: u8 = 255;
/// To be skipped: white space and padding.
const SKIP: u8 = 254;

/// The value of each byte as a base64 digit (RFC 4648, both alphabets).
const DIGITS: [u8; 256] = {
    let mut digits = [NONE; 256];
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut i = 0;
    while i < 64 {
        digits[alphabet[i] as usize] = i as u8;
        i += 1;
    }
    digits[b'-' as usize] = 62;
    digits[b'_' as usize] = 63;
    digits[b'=' as usize] = SKIP;
    digits[b' ' as usize] = SKIP;
    digits[b'\n' as usize] = SKIP;
    digits[b'\r' as usize] = SKIP;
    digits
};

fn base64(text: &[u8], at: &Location) -> Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut word, mut digits) = (0_u32, 0);
    let mut i = 0;
    while i < text.len() {
        // Four digits at a time while nothing is between them.
        if digits == 0
            && let Some(&[a, b, c, d]) = text.get(i..i + 4)
        {
            let [a, b, c, d] = [a, b, c, d].map(|byte| DIGITS[byte as usize]);
            if a | b | c | d < 64 {
                bytes.extend([a << 2 | b >> 4, b << 4 | c >> 2, c << 6 | d]);
                i += 4;
                continue;
            }
        }
        match DIGITS[text[i] as usize] {
            SKIP => {}
            NONE => {
                let byte = text[i];
                return Err(Error::syntax(at, format!("the base64 data has the byte {byte} at {i}"))
                    .hint("the file is damaged: export it again"));
            }
            digit => {
                word = word << 6 | u32::from(digit);
                digits += 1;
                if digits == 4 {
                    bytes.extend(&word.to_be_bytes()[1..]);
                    (word, digits) = (0, 0);
                }
            }
        }
        i += 1;
    }
    match digits {
        2 => bytes.push((word >> 4) as u8),
        3 => bytes.extend([(word >> 10) as u8, (word >> 2) as u8]),
        _ => {}
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::{Uri, read};
    use crate::error::Location;

    fn data(uri: &str) -> Vec<u8> {
        match read(uri, &Location::default()) {
            Ok(Uri::Data(bytes)) => bytes,
            Ok(Uri::Names(names)) => panic!("{names:?}"),
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn data_of_every_length_is_read() {
        assert_eq!(data("data:,a%20b"), b"a b");
        assert_eq!(data("data:;base64,"), b"");
        assert_eq!(data("data:application/octet-stream;base64,Zg=="), b"f");
        assert_eq!(data("data:application/gltf-buffer;base64,Zm8="), b"fo");
        assert_eq!(data("DATA:;base64,Zm9v"), b"foo");
        assert_eq!(data("data:;base64,Zm9v\nYmFy"), b"foobar");
        assert_eq!(data("data:;base64,_-8"), [0xff, 0xef]);
        assert!(read("data:;base64,Zm9v!", &Location::default()).is_err());
        assert!(read("data:nothing", &Location::default()).is_err());
    }

    #[test]
    fn names_are_those_that_are_meant_and_those_that_are_written() {
        let names = |uri| match read(uri, &Location::default()) {
            Ok(Uri::Names(names)) => names,
            _ => Vec::new(),
        };
        assert_eq!(names("a%20b.bin"), ["a b.bin", "a%20b.bin"]);
        assert_eq!(names("100%.png"), ["100%.png"]);
        assert_eq!(names("C:/a.png"), ["C:/a.png"]);
        assert_eq!(
            names(r"maps\a%20b.png"),
            [r"maps\a b.png", r"maps\a%20b.png", "maps/a b.png", "maps/a%20b.png"]
        );
        assert!(names("https://example.org/a.png").is_empty());
    }
}
