//! Reader for lens files, as pbrt has them: four numbers for each surface, from the front to the film (radius of curvature, thickness,
//! index of refraction behind it, diameter), in millimetres, and comments after `#`.
//!
//! A plane, whose radius of curvature is written as 0 or `inf`, refracts where the index changes. A plane of the radius 0 where it does not
//! change is the aperture stop, whose index may be left out (0).

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

/// Reads a lens file, which may be compressed. A film that is not in air is a notice, since a table that lacks its last row, or is in the
/// other order, has one.
///
/// # Errors
/// `Io` if it cannot be read; as [`parse`].
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Vec<LensSurface>> {
    let file = Location::file(path);
    let surfaces = parse(&packed::read(path, context)?, &file)?;
    if let Some(rear) = surfaces.last().filter(|rear| rear.index != 1.0) {
        let message = format!(
            "the film is in a medium of the index {}, as the last row says, which has 1 where it is in air",
            rear.index
        );
        context.notice(&file, message);
    }
    Ok(surfaces)
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
        // A plane has an infinite radius.
        let is_radius = numbers.len() % 4 == 0;
        let number = word
            .parse()
            .ok()
            .filter(|number: &f64| number.abs() <= LARGEST || is_radius && number.is_infinite());
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
    let mut surfaces: Vec<LensSurface> = Vec::with_capacity(rows.len());
    for row in rows {
        let before = surfaces.last().map_or(1.0, |surface| surface.index);
        surfaces.push(surface(row, before, file)?);
    }
    if surfaces.iter().all(LensSurface::is_stop) {
        return Err(Error::invalid(
            file,
            "no surface refracts: all are planes where the index of refraction does not change, as a stop is",
        ));
    }
    Ok(surfaces)
}

/// The surface of a row, behind a medium whose index of refraction is `before`.
fn surface(row: &[(u32, f64); 4], before: f64, file: &Location) -> Result<LensSurface> {
    let [(_, written_radius), (_, thickness), (_, written_index), (_, diameter)] = *row;
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
    if written_index < 0.0 {
        return bad(2, "the index of refraction", "a number greater than 0, or 0 for that of air");
    }
    if diameter <= 0.0 {
        return bad(3, "the diameter", "a number greater than 0");
    }
    let index = match (written_radius, written_index) {
        // A hole changes no medium.
        (0.0, 0.0) => before,
        (_, 0.0) => 1.0,
        (_, index) => index,
    };
    let is_flat = written_radius == 0.0 && index != before;
    let curvature_radius = if is_flat { f64::INFINITY } else { written_radius };
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
            [surface(50.0, 0.5, 1.5, 25.0), surface(0.0, 1.0, 1.5, 20.0), surface(-50.0, 50.0, 1.0, 25.0)];
        assert_eq!(lens, expected);
        assert!(lens[1].is_stop());
    }

    #[test]
    fn planes_refract_where_the_index_changes() {
        let of = |bytes: &[u8]| {
            let lens = parse(bytes, &Location::default()).expect("a lens");
            lens.iter().map(|surface| (surface.curvature_radius, surface.index)).collect::<Vec<_>>()
        };
        let flat = f64::INFINITY;
        assert_eq!(of(b"25 5 1.5 20\n0 50 1 20"), [(25.0, 1.5), (flat, 1.0)]);
        assert_eq!(of(b"0 5 1.5 20\n0 1 0 9\n-25 50 0 20"), [(flat, 1.5), (0.0, 1.5), (-25.0, 1.0)]);
        assert_eq!(of(b"Infinity 5 1.5 20\n-25 1 1 20\n0 50 1 9"), [(flat, 1.5), (-25.0, 1.0), (0.0, 1.0)]);
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
            (b"50 inf 1 1", "`inf` is no number"),
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
