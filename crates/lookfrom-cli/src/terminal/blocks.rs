//! Half blocks: a character is two pixels, one above the other, as its colour and that of its background.

use std::fmt::Write;

use lookfrom::session::Shown;

const UPPER: char = '▀';
const LOWER: char = '▄';
/// Alpha from which a pixel is drawn.
const OPAQUE: u8 = 128;

/// The parameters of SGR for a colour, after `38` or `48`.
type Encode = fn([u8; 3]) -> String;

/// 24 bits.
pub(super) fn true_color([r, g, b]: [u8; 3]) -> String {
    format!("2;{r};{g};{b}")
}

/// The nearest of the 6 × 6 × 6 colours or 24 greys that terminals with 256 colours have.
pub(super) fn nearest_of_256(color: [u8; 3]) -> String {
    let level = |step: u8| if step == 0 { 0 } else { 55 + 40 * step };
    let step = |value: u8| (0..6).min_by_key(|&step| level(step).abs_diff(value)).unwrap_or(0);
    let [r, g, b] = color.map(step);
    let mean = color.iter().map(|&value| u32::from(value)).sum::<u32>() / 3;
    let grey = (mean.saturating_sub(3) / 10).min(23) as u8;
    let distance = |other: [u8; 3]| -> u32 {
        color.iter().zip(other).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    match distance([8 + 10 * grey; 3]) < distance([r, g, b].map(level)) {
        true => format!("5;{}", 232 + u32::from(grey)),
        false => format!("5;{}", 16 + 36 * u32::from(r) + 6 * u32::from(g) + u32::from(b)),
    }
}

/// The text that draws a picture; what is transparent is the terminal's background.
pub(super) fn text(shown: &Shown, encode: Encode) -> String {
    let mut text = String::new();
    let width = shown.width as usize;
    let rows: Vec<&[[u8; 4]]> = shown.rgba.as_chunks().0.chunks(width.max(1)).collect();
    for pair in rows.chunks(2) {
        let mut last = String::new();
        for column in 0..width {
            let pixel = |row: usize| pair.get(row).map(|row| row[column]).filter(|pixel| pixel[3] >= OPAQUE);
            let color = |[r, g, b, _]: [u8; 4]| encode([r, g, b]);
            let (colors, character) = match (pixel(0), pixel(1)) {
                (Some(upper), Some(lower)) => {
                    (format!("\x1b[38;{};48;{}m", color(upper), color(lower)), UPPER)
                }
                (Some(upper), None) => (format!("\x1b[0;38;{}m", color(upper)), UPPER),
                (None, Some(lower)) => (format!("\x1b[0;38;{}m", color(lower)), LOWER),
                (None, None) => ("\x1b[0m".to_owned(), ' '),
            };
            if colors != last {
                text.push_str(&colors);
            }
            text.push(character);
            last = colors;
        }
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\x1b[0m");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels of a text: `None` where the terminal's background is.
    fn parsed(text: &str) -> Vec<Vec<Option<[u8; 3]>>> {
        let mut rows = Vec::new();
        for line in text.lines() {
            let (mut upper, mut lower) = (Vec::new(), Vec::new());
            let [mut fore, mut back] = [None; 2];
            let mut rest = line;
            while let Some(character) = rest.chars().next() {
                if let Some(sequence) = rest.strip_prefix("\x1b[") {
                    let (numbers, behind) = sequence.split_once('m').unwrap();
                    let numbers: Vec<u8> = numbers.split(';').map(|number| number.parse().unwrap()).collect();
                    let mut numbers = numbers.as_slice();
                    while let [code, others @ ..] = numbers {
                        match (code, others) {
                            (0, _) => ([fore, back], numbers) = ([None; 2], others),
                            (38, [2, r, g, b, others @ ..]) => (fore, numbers) = (Some([*r, *g, *b]), others),
                            (48, [2, r, g, b, others @ ..]) => (back, numbers) = (Some([*r, *g, *b]), others),
                            _ => panic!("{numbers:?}"),
                        }
                    }
                    rest = behind;
                    continue;
                }
                rest = &rest[character.len_utf8()..];
                let [above, below] = match character {
                    UPPER => [fore, back],
                    LOWER => [back, fore],
                    ' ' => [back, back],
                    other => panic!("{other:?}"),
                };
                upper.push(above);
                lower.push(below);
            }
            rows.extend([upper, lower]);
        }
        rows
    }

    #[test]
    fn the_characters_are_the_picture() {
        let (width, height) = (5, 7);
        let rgba: Vec<u8> = (0..width * height)
            .flat_map(|index| [index * 3, 255 - index, index / 2, if index % 4 == 1 { 0 } else { 255 }])
            .collect();
        let shown = Shown { width: width.into(), height: height.into(), rgba: rgba.clone(), has_alpha: true };
        let found = parsed(&text(&shown, true_color));
        assert_eq!(found.len(), 8);
        assert!(found[7].iter().all(Option::is_none));
        let pixels = rgba.as_chunks::<4>().0.iter();
        let expected: Vec<_> = pixels.map(|&[r, g, b, a]| (a > 0).then_some([r, g, b])).collect();
        assert_eq!(found[..7].concat(), expected);
    }

    #[test]
    fn the_nearest_of_few_colours() {
        let cases = [
            ([0, 0, 0], 16),
            ([255, 255, 255], 231),
            ([255, 0, 0], 196),
            ([128, 128, 128], 244),
            ([95, 135, 175], 67),
        ];
        for (color, number) in cases {
            assert_eq!(nearest_of_256(color), format!("5;{number}"), "{color:?}");
        }
    }
}
