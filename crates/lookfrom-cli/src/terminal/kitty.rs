//! The graphics protocol of kitty (Goyal, "Terminal graphics protocol"): a PNG as base64, in pieces.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The longest piece, in characters.
const LONGEST: usize = 4096;

/// The text that draws a PNG as wide as so many columns. The terminal is asked not to answer.
pub(super) fn text(png: &[u8], columns: u32) -> String {
    let payload = STANDARD.encode(png);
    let mut text = String::with_capacity(payload.len() + payload.len() / 64 + 64);
    let mut rest = payload.as_str();
    let mut keys = format!("a=T,f=100,q=2,c={columns},");
    loop {
        let (piece, behind) = rest.split_at(rest.len().min(LONGEST));
        let has_more = u8::from(!behind.is_empty());
        // Writing to a string cannot fail.
        let _ = write!(text, "\x1b_G{keys}m={has_more};{piece}\x1b\\");
        if behind.is_empty() {
            return text + "\n";
        }
        rest = behind;
        keys.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pieces_are_the_picture() {
        for length in [1, 3072, 3073, 20_000] {
            let bytes: Vec<u8> = (0..length).map(|index| (index * 7 % 251) as u8).collect();
            let text = text(&bytes, 12);
            let pieces: Vec<&str> = text.trim_end().split_terminator("\x1b\\").collect();
            let mut payload = String::new();
            for (index, piece) in pieces.iter().enumerate() {
                let (keys, data) =
                    piece.strip_prefix("\x1b_G").and_then(|piece| piece.split_once(';')).unwrap();
                let has_more = u8::from(index + 1 < pieces.len());
                assert_eq!(keys.ends_with("m=1"), has_more == 1);
                assert_eq!(keys.contains("a=T,f=100,q=2,c=12"), index == 0);
                assert!(data.len() <= 4096 && (has_more == 0 || data.len().is_multiple_of(4)));
                payload.push_str(data);
            }
            assert_eq!(STANDARD.decode(payload).unwrap(), bytes);
        }
    }
}
