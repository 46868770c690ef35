//! Reader for lens files, as pbrt has them: four numbers for each surface, from the front to the film (radius of curvature, thickness,
//! index of refraction behind it, diameter), in millimetres, and comments after `#`.

use std::path::Path;

use super::LensSurface;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::packed;

/// The most surfaces of a lens system: zoom lenses have fifty or so.
const MOST_SURFACES: usize = 256;

/// The longest file.
const LONGEST: usize = 1 << 20;

/// The largest length in millimetres.
const LARGEST: f64 = 1e9;

/// Reads a lens file, which may be compressed.
///
/// # Errors
/// `Io` if it cannot be read; as [`parse`].
pub fn read(path: &Path, context: &LoadContext<'_>) -> Result<Vec<LensSurface>> {
    parse(&packed::read(path, context)?, &Location::file(path))
}

/// The surfaces of a lens file.
///
/// # Errors
/// `Syntax` for what is no table of numbers, `Invalid` for numbers out of range and a table without a surface that refracts, `Limit` for
/// more than 256 surfaces.
pub fn parse(bytes: &[u8], file: &Location) -> Result<Vec<LensSurface>> {
    if bytes.len() > LONGEST {
        let message = format!("{} bytes are more than a lens file has (at most {LONGEST})", bytes.len());
        return Err(Error::new(ErrorKind::Limit, file, message));
    }
    let text = String::from_utf8_lossy(bytes);
    let lines = (1_u32..).zip(text.lines());
    let words = lines.flat_map(|(line, text)| {
        text.split('#').next().unwrap_or_default().split_whitespace().map(move |word| (line, word))
    });
    let mut numbers = Vec::new();
    for (line, word) in words {
        if numbers.len() == 4 * MOST_SURFACES {
            let message = format!("more than {MOST_SURFACES} surfaces");
            return Err(Error::new(ErrorKind::Limit, &file.at(line, 0), message));
        }
        let number = word.parse().ok().filter(|number: &f64| number.abs() <= LARGEST);
        let number = number.ok_or_else(|| {
            Error::syntax(
                &file.at(line, 0),
                format!("`{word}` is no number; expected one of at most {LARGEST:e}"),
            )
        });
        numbers.push((line, number?));
    }
    let (rows, rest) = numbers.as_chunks::<4>();
    if !rest.is_empty() || rows.is_empty() {
        let message = format!(
            "{} numbers; expected four for each surface: radius of curvature, thickness, index of refraction, diameter",
            numbers.len()
        );
        return Err(Error::syntax(file, message));
    }
    let surfaces: Vec<LensSurface> = rows.iter().map(|row| surface(row, file)).collect::<Result<_>>()?;
    if surfaces.iter().all(LensSurface::is_stop) {
        return Err(Error::invalid(
            file,
            "no surface refracts: all have a radius of curvature of 0, as a stop has",
        ));
    }
    Ok(surfaces)
}

fn surface(row: &[(u32, f64); 4], file: &Location) -> Result<LensSurface> {
    let [(_, curvature_radius), (_, thickness), (_, index), (_, diameter)] = *row;
    let bad = |place: usize, what: &str, expected: &str| {
        let (line, number) = row[place];
        Err(Error::invalid(
            &file.at(line, 0),
            format!("{what} of a surface is {number}; expected {expected}"),
        ))
    };
    if thickness < 0.0 {
        return bad(1, "the thickness", "a number of at least 0");
    }
    if index < 0.0 {
        return bad(2, "the index of refraction", "a number greater than 0, or 0 for that of air");
    }
    if diameter <= 0.0 {
        return bad(3, "the diameter", "a number greater than 0");
    }
    Ok(LensSurface { curvature_radius, thickness, index, diameter })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_with_comments() {
        let file = Location::default();
        let lens =
            parse(b"# thin\n50 0.5 1.5 25 # front\r\n0 1 0 20\n-50 50\n1 25\n", &file).expect("a lens");
        let surface = |curvature_radius, thickness, index, diameter| LensSurface {
            curvature_radius,
            thickness,
            index,
            diameter,
        };
        let expected =
            [surface(50.0, 0.5, 1.5, 25.0), surface(0.0, 1.0, 0.0, 20.0), surface(-50.0, 50.0, 1.0, 25.0)];
        assert_eq!(lens, expected);
        assert!(lens[1].is_stop() && lens[1].index_behind() == 1.0);
    }

    #[test]
    fn files_that_are_no_lens_are_refused() {
        let of = |bytes: &[u8]| {
            parse(bytes, &Location::file(Path::new("a.dat"))).expect_err("no lens").to_string()
        };
        for (bad, why) in [
            (&b""[..], "a.dat: 0 numbers"),
            (b"# nothing", "0 numbers"),
            (b"1 2 3", "3 numbers"),
            (b"1 1 1 1\n50 a 1 1", "a.dat:2: `a` is no number"),
            (b"inf 1 1 1", "`inf` is no number"),
            (b"nan 1 1 1", "`nan` is no number"),
            (b"1e300 1 1 1", "`1e300` is no number"),
            (b"\xff\xfe\x00", "is no number"),
            (b"0 0 0 1", "no surface refracts"),
            (b"50 -1 1.5 20", "the thickness of a surface is -1"),
            (b"50 1 -1.5 20", "the index of refraction of a surface is -1.5"),
            (b"50 1 1.5 0", "the diameter of a surface is 0"),
        ] {
            assert!(of(bad).contains(why), "{} {why}", of(bad));
        }
        assert!(of(&b"1 1 1 1\n".repeat(100_000)).contains("a.dat:257: more than 256 surfaces"));
        assert!(of(&b"1 1 1 1\n".repeat(1_000_000)).contains("bytes are more"));
    }
}
