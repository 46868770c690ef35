//! Text encodings.

use std::borrow::Cow;

/// The text in UTF-8 (or in an unknown 8-bit encoding) without byte order mark. UTF-16 is recognised by its mark.
pub(crate) fn utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let from_utf16 = |units: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = units.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
        let mut text = String::with_capacity(bytes.len() / 2);
        text.extend(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
        Cow::Owned(text.into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, text @ ..] => Cow::Borrowed(text),
        [0xff, 0xfe, units @ ..] => from_utf16(units, u16::from_le_bytes),
        [0xfe, 0xff, units @ ..] => from_utf16(units, u16::from_be_bytes),
        text => Cow::Borrowed(text),
    }
}

#[cfg(test)]
mod tests {
    use super::utf8;

    #[test]
    fn byte_order_marks_are_obeyed() {
        assert_eq!(&*utf8(b"\xef\xbb\xbfv"), b"v");
        assert_eq!(&*utf8(b"\xff\xfev\0\xe9\0"), "vé".as_bytes());
        assert_eq!(&*utf8(b"\xfe\xff\0v\0\xe9\xd8"), "vé".as_bytes());
        assert_eq!(&*utf8(b"v"), b"v");
    }
}
