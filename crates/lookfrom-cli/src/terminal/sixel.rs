//! Sixels (DEC, "VT330/VT340 Programmer Reference Manual", chapter 14): bands of six rows, in each of which a colour at a
//! time is drawn, a character for six pixels.

use std::collections::BTreeSet;
use std::fmt::Write;

use color_quant::NeuQuant;
use lookfrom::session::Shown;

/// Effort of the choice of colours, from 1 (most) to 30.
const SPEED: i32 = 3;
/// Colours of the palette, as many as the VT340's successors have.
const COLORS: usize = 256;
/// Alpha from which a pixel is drawn.
const OPAQUE: u8 = 128;
/// Rows of a band.
const BAND: usize = 6;
/// Repetitions from which a count is shorter than the characters.
const LEAST_REPEATED: usize = 4;

/// The text that draws a picture; what is transparent stays as it is.
pub(super) fn text(shown: &Shown) -> String {
    let width = shown.width as usize;
    let pixels = shown.rgba.as_chunks::<4>().0;
    let (palette, indices) = with_palette(pixels);
    // Square pixels; those that are not drawn keep their colour. Writing to a string cannot fail.
    let mut text = format!("\x1bP0;1;0q\"1;1;{};{}", shown.width, shown.height);
    for (number, rgb) in palette.into_iter().enumerate() {
        let [r, g, b] = rgb.map(percent);
        let _ = write!(text, "#{number};2;{r};{g};{b}");
    }
    for band in indices.chunks((BAND * width).max(1)) {
        let mut colors: Vec<usize> = band.iter().flatten().copied().collect();
        colors.sort_unstable();
        colors.dedup();
        for color in colors {
            let _ = write!(text, "#{color}");
            let bits = |column: usize| {
                let rows = band.chunks(width).enumerate();
                rows.filter(|(_, row)| row[column] == Some(color)).fold(0u8, |bits, (row, _)| bits | 1 << row)
            };
            let sixels: Vec<u8> = (0..width).map(bits).collect();
            for run in sixels.chunk_by(|a, b| a == b) {
                let character = char::from(b'?' + run[0]);
                match run.len() {
                    LEAST_REPEATED.. => {
                        let _ = write!(text, "!{}{character}", run.len());
                    }
                    count => text.extend(std::iter::repeat_n(character, count)),
                }
            }
            // Back to the beginning of the band.
            text.push('$');
        }
        text.push('-');
    }
    text + "\x1b\\\n"
}

/// At most 256 colours, and the number of that of each pixel; `None` for those that are not drawn.
fn with_palette(pixels: &[[u8; 4]]) -> (Vec<[u8; 3]>, Vec<Option<usize>>) {
    let drawn = |pixel: &[u8; 4]| (pixel[3] >= OPAQUE).then_some([pixel[0], pixel[1], pixel[2]]);
    let few: BTreeSet<[u8; 3]> = pixels.iter().filter_map(drawn).collect();
    if few.len() <= COLORS {
        let palette: Vec<[u8; 3]> = few.into_iter().collect();
        let indices = pixels.iter().map(|pixel| palette.binary_search(&drawn(pixel)?).ok()).collect();
        return (palette, indices);
    }
    let opaque: Vec<u8> = pixels.iter().filter_map(drawn).flat_map(|[r, g, b]| [r, g, b, 255]).collect();
    let chosen = NeuQuant::new(SPEED, COLORS, &opaque);
    let index = |pixel: &[u8; 4]| drawn(pixel).map(|[r, g, b]| chosen.index_of(&[r, g, b, 255]));
    (chosen.color_map_rgb().as_chunks().0.to_vec(), pixels.iter().map(index).collect())
}

/// A colour's channel from 0 to 100.
fn percent(value: u8) -> u32 {
    (u32::from(value) * 100 + 127) / 255
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels of a text, in percent: `None` where nothing is drawn.
    fn parsed(text: &str) -> Vec<Vec<Option<[u32; 3]>>> {
        let body = text.strip_prefix("\x1bP0;1;0q\"1;1;").unwrap().strip_suffix("\x1b\\\n").unwrap();
        let start = body.find('#').unwrap();
        let size: Vec<usize> = body[..start].split(';').map(|side| side.parse().unwrap()).collect();
        let mut pixels = vec![vec![None; size[0]]; size[1].next_multiple_of(6)];
        let mut palette = vec![[0; 3]; 256];
        let (mut x, mut y, mut color, mut repeat) = (0, 0, 0, 1);
        let mut rest = &body[start..];
        let number = |rest: &mut &str| -> usize {
            let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
            let number = rest[..end].parse().unwrap();
            *rest = &rest[end..];
            number
        };
        while let Some(character) = rest.chars().next() {
            rest = &rest[1..];
            match character {
                '#' => {
                    color = number(&mut rest);
                    if let Some(behind) = rest.strip_prefix(";2") {
                        rest = behind;
                        palette[color] = [(); 3].map(|()| {
                            rest = rest.strip_prefix(';').unwrap();
                            number(&mut rest) as u32
                        });
                    }
                }
                '!' => repeat = number(&mut rest),
                '$' => x = 0,
                '-' => (x, y) = (0, y + 6),
                '?'..='~' => {
                    for _ in 0..std::mem::replace(&mut repeat, 1) {
                        let bits = character as u8 - b'?';
                        (0..6)
                            .filter(|row| bits >> row & 1 == 1)
                            .for_each(|row| pixels[y + row][x] = Some(palette[color]));
                        x += 1;
                    }
                }
                other => panic!("{other:?}"),
            }
        }
        pixels
    }

    /// The mean difference of a channel in percent; what is not drawn has to be the same.
    fn mean_difference(width: usize, height: usize, pixel: impl Fn(usize) -> [u8; 4]) -> f64 {
        let rgba: Vec<u8> = (0..width * height).flat_map(&pixel).collect();
        let shown = Shown { width: width as u32, height: height as u32, rgba, has_alpha: true };
        let (mut sum, mut count) = (0, 0);
        for (row, line) in parsed(&text(&shown)).iter().enumerate() {
            for (column, &found) in line.iter().enumerate() {
                let expected =
                    (row < height).then(|| pixel(row * width + column)).filter(|pixel| pixel[3] > 0);
                assert_eq!(found.is_some(), expected.is_some(), "{column}, {row}");
                if let (Some(found), Some([r, g, b, _])) = (found, expected) {
                    let pairs = found.iter().zip([r, g, b]);
                    sum += pairs.map(|(&found, value)| found.abs_diff(percent(value))).sum::<u32>();
                    count += 3;
                }
            }
        }
        f64::from(sum) / f64::from(count)
    }

    #[test]
    fn the_sixels_are_the_picture() {
        let colors =
            [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255], [9, 9, 9, 0]];
        let few = |index: usize| colors[(index / 5 + index / 23) % colors.len()];
        assert_eq!(mean_difference(23, 17, few), 0.0);
        let many = |index: usize| [(index % 64 * 4) as u8, (index / 64 * 4) as u8, 90, 255];
        let difference = mean_difference(64, 64, many);
        assert!((0.1..3.0).contains(&difference), "{difference}");
    }
}
