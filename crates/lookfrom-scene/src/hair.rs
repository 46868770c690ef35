//! Reader for HAIR files: strands of hair as polylines.
//!
//! The binary format of Cem Yuksel's hair models ("HAIR File Format", www.cemyuksel.com): a header of 128 bytes, then arrays of
//! which the header tells by bits. Strands become cubic curves through their points (Catmull & Rom 1974). A curve has no colours
//! of its points: their mean is that of the material.

use std::path::Path;

use glam::Vec3;

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::material::{Color, Hair, Material, MaterialKind, Pigment, Scalar};
use crate::model::tally::Tally;
use crate::scene::{MaterialId, Scene};
use crate::shape::{Geometry, Part, Profile, Strand};

const HEADER: usize = 128;

/// The width of curves where the file has none, as a part of the largest extent.
const THIN: f32 = 1e-3;

/// The least width, as a part of the greatest.
const THINNEST: f32 = 1e-6;

/// Bits of the header: the arrays that follow it, in this order.
const SEGMENTS: u32 = 1;
const POINTS: u32 = 1 << 1;
const THICKNESS: u32 = 1 << 2;
const TRANSPARENCY: u32 = 1 << 3;
const COLORS: u32 = 1 << 4;

/// Reads the content of a HAIR file: one part with all strands.
/// Messages name `path`.
///
/// # Errors
/// `Limit` and `Syntax`.
pub fn from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let file = Location::file(path);
    let hair = Arrays::new(bytes, &file, context.limits.elements)?;
    let count = u64::from(hair.points.count());
    context.keep(count * size_of::<Strand>() as u64, "the strands", &file)?;
    let mut strands = Vec::new();
    let (mut not_finite, mut first) = (Tally::default(), 0);
    for strand in 0..hair.strands {
        let points = first..first + hair.segments(strand) + 1;
        first = points.end;
        let positions: Vec<Vec3> = points.clone().map(|point| hair.points.vector(point)).collect();
        match positions.iter().all(|position| position.is_finite()) {
            true => curves(&positions, |index| hair.width(points.start + index as u32), &mut strands),
            false => not_finite.add(0),
        }
    }
    not_finite.warn("strand", "left out: a coordinate is infinite or not a number", &file, context);
    if strands.is_empty() {
        context.warn(&file, "there are no strands");
        return Ok(Vec::new());
    }
    widen(&mut strands, &file, context);
    let (reflectance, transparency) = hair.mean_look(&file, context);
    let alpha = (transparency > 0.0).then_some(Scalar::Value(1.0 - transparency));
    let material = MaterialId(scene.materials.len() as u32);
    let kind = MaterialKind::Hair(Box::new(Hair {
        pigment: Pigment::Reflectance(Color::Value(reflectance)),
        eta: Scalar::Value(Hair::ETA),
        beta_m: Scalar::Value(Hair::ROUGHNESS),
        beta_n: Scalar::Value(Hair::ROUGHNESS),
        alpha: Scalar::Value(Hair::ALPHA),
    }));
    scene.materials.push(Material::new("hair", file, kind));
    let part = Part::new(None, Geometry::Curves(strands.into()));
    Ok(vec![Part { material: Some(material), alpha, ..part }])
}

/// Whether a content is that of a HAIR file.
pub(crate) fn is_hair(bytes: &[u8]) -> bool {
    bytes.starts_with(b"HAIR") && bytes.len() >= HEADER
}

/// The arrays of a file.
struct Arrays<'a> {
    strands: u32,
    /// The numbers of segments of strands, if they differ.
    segments: Option<Array<'a>>,
    points: Array<'a>,
    thickness: Option<Array<'a>>,
    transparency: Option<Array<'a>>,
    colors: Option<Array<'a>>,
    /// Values where there is no array.
    default_segments: u32,
    default_thickness: f32,
    default_transparency: f32,
    default_color: [f32; 3],
}

/// An array of items of `width` bytes.
#[derive(Clone, Copy)]
struct Array<'a> {
    bytes: &'a [u8],
    width: usize,
}

impl Array<'_> {
    fn count(self) -> u32 {
        (self.bytes.len() / self.width) as u32
    }

    fn item<const N: usize>(self, index: u32, part: usize) -> [u8; N] {
        let start = index as usize * self.width + part * N;
        self.bytes.get(start..).and_then(|bytes| bytes.first_chunk()).copied().unwrap_or([0; N])
    }

    fn float(self, index: u32, part: usize) -> f32 {
        f32::from_le_bytes(self.item(index, part))
    }

    fn vector(self, index: u32) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|part| self.float(index, part)))
    }
}

impl<'a> Arrays<'a> {
    fn new(bytes: &'a [u8], file: &Location, most: u64) -> Result<Self> {
        let Some((header, mut rest)) = bytes.split_at_checked(HEADER).filter(|_| is_hair(bytes)) else {
            let message = format!("{} bytes do not begin with the header of a HAIR file", bytes.len());
            return Err(Error::syntax(file, message).hint("the file may be empty or cut off"));
        };
        let header = Array { bytes: header, width: 4 };
        let [strands, points, bits, default_segments] =
            [1, 2, 3, 4].map(|word| u32::from_le_bytes(header.item(word, 0)));
        if bits & POINTS == 0 {
            return Err(Error::syntax(file, "there is no array of points"));
        }
        if u64::from(points.max(strands)) > most {
            let message = format!("{strands} strands of {points} points are more than the limit of {most}");
            return Err(Error::new(ErrorKind::Limit, file, message));
        }
        if strands > points {
            return Err(Error::syntax(file, format!("{strands} strands have only {points} points")));
        }
        let mut array = |bit: u32, count: u32, width: usize, what: &str| {
            if bits & bit == 0 {
                return Ok(None);
            }
            let Some((bytes, left)) = rest.split_at_checked(count as usize * width) else {
                let there = rest.len() / width;
                let message = format!("{count} {what} are declared, but there are only bytes for {there}");
                return Err(Error::syntax(file, message).hint("the file may be cut off"));
            };
            rest = left;
            Ok(Some(Array { bytes, width }))
        };
        let segments = array(SEGMENTS, strands, 2, "numbers of segments")?;
        let arrays = Self {
            strands,
            segments,
            points: array(POINTS, points, 12, "points")?.unwrap_or(Array { bytes: &[], width: 12 }),
            thickness: array(THICKNESS, points, 4, "thicknesses")?,
            transparency: array(TRANSPARENCY, points, 4, "transparencies")?,
            colors: array(COLORS, points, 12, "colours")?,
            default_segments,
            default_thickness: header.float(5, 0),
            default_transparency: header.float(6, 0),
            default_color: [7, 8, 9].map(|word| header.float(word, 0)),
        };
        let wanted: u64 = (0..strands).map(|strand| u64::from(arrays.segments(strand)) + 1).sum();
        if wanted != u64::from(points) {
            return Err(Error::syntax(
                file,
                format!("the strands have {wanted} points, but {points} are declared"),
            ));
        }
        Ok(arrays)
    }

    fn segments(&self, strand: u32) -> u32 {
        self.segments.map_or(self.default_segments, |array| u16::from_le_bytes(array.item(strand, 0)).into())
    }

    fn width(&self, point: u32) -> f32 {
        self.thickness.map_or(self.default_thickness, |array| array.float(point, 0))
    }

    /// The means of the colours and of the transparencies of all points, 0 … 1.
    fn mean_look(&self, file: &Location, context: &mut LoadContext<'_>) -> ([f32; 3], f32) {
        let mean = |array: Option<Array<'_>>, part: usize, default: f32| {
            let values = array.into_iter().flat_map(|array| {
                (0..array.count()).map(move |point| f64::from(array.float(point, part).clamp(0.0, 1.0)))
            });
            let (sum, count) = values
                .filter(|value| !value.is_nan())
                .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
            let mean = if count > 0.0 { (sum / count) as f32 } else { default };
            if mean.is_finite() { mean.clamp(0.0, 1.0) } else { 0.0 }
        };
        let varies = |array: &Array<'_>| {
            array.bytes.chunks(array.width).any(|item| item != &array.bytes[..array.width])
        };
        for (array, what) in [(self.colors, "colours"), (self.transparency, "transparencies")] {
            if array.is_some_and(|array| varies(&array)) {
                context.warn(file, format!("the {what} of points are replaced by their mean"));
            }
        }
        let color = std::array::from_fn(|part| mean(self.colors, part, self.default_color[part]));
        (color, mean(self.transparency, 0, self.default_transparency))
    }
}

/// Adds the curves through the points of a strand. Points that are the same as the one before are left out.
fn curves(positions: &[Vec3], width: impl Fn(usize) -> f32, strands: &mut Vec<Strand>) {
    let mut points: Vec<(Vec3, f32)> = positions.iter().copied().zip((0..).map(width)).collect();
    points.dedup_by_key(|(position, _)| *position);
    for (index, pair) in points.windows(2).enumerate() {
        let [(start, _), (end, _)] = [pair[0], pair[1]];
        // The ends of a strand continue straight.
        let before = index.checked_sub(1).map_or(start - (end - start), |index| points[index].0);
        let after = points.get(index + 2).map_or(end + (end - start), |(position, _)| *position);
        let points = [start, start + (end - before) / 6.0, end - (after - start) / 6.0, end];
        if points.iter().all(|point| point.is_finite()) {
            strands.push(Strand { points, width: [pair[0].1, pair[1].1], profile: Profile::Cylinder });
        }
    }
}

/// Makes all widths positive.
fn widen(strands: &mut [Strand], file: &Location, context: &mut LoadContext<'_>) {
    let is_width = |width: &f32| *width > 0.0 && width.is_finite();
    let all = strands.iter().flat_map(|strand| strand.width);
    let mut most = all.filter(is_width).fold(0.0, f32::max);
    if most == 0.0 {
        let points = || strands.iter().flat_map(|strand| strand.points);
        let extent = points().fold(Vec3::NEG_INFINITY, Vec3::max) - points().fold(Vec3::INFINITY, Vec3::min);
        most = (THIN * extent.max_element()).clamp(f32::MIN_POSITIVE, f32::MAX);
        context.warn(file, format!("the strands have no thickness: they are made {most} thick"));
        strands.iter_mut().for_each(|strand| strand.width = [most; 2]);
    }
    let least = (THINNEST * most).max(f32::MIN_POSITIVE);
    for width in strands.iter_mut().flat_map(|strand| &mut strand.width) {
        *width = if is_width(width) { width.max(least) } else { least };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Memory;

    /// A file with these arrays: segments, points, thickness, transparency, colours.
    fn file(bits: u32, counts: [u32; 2], segments: &[u16], numbers: &[f32]) -> Vec<u8> {
        let mut bytes = b"HAIR".to_vec();
        for word in [counts[0], counts[1], bits, 2] {
            bytes.extend(word.to_le_bytes());
        }
        for default in [0.25_f32, 0.5, 0.2, 0.4, 0.6] {
            bytes.extend(default.to_le_bytes());
        }
        bytes.resize(HEADER, b' ');
        bytes.extend(segments.iter().flat_map(|count| count.to_le_bytes()));
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    fn of(bytes: &[u8]) -> Result<(Vec<Part>, Scene, Vec<String>)> {
        let files = Memory::default();
        let (mut context, mut scene) = (LoadContext::new(&files), Scene::default());
        let parts = from_bytes(bytes, Path::new("a.hair"), &mut context, &mut scene)?;
        Ok((parts, scene, context.warnings.iter().map(ToString::to_string).collect()))
    }

    fn strands(part: &Part) -> &[Strand] {
        let Geometry::Curves(strands) = &part.geometry else { panic!("no curves") };
        strands
    }

    fn reflectance(scene: &Scene) -> [f32; 3] {
        let MaterialKind::Hair(hair) = &scene.materials[0].kind else { panic!("no hair") };
        let Pigment::Reflectance(Color::Value(rgb)) = hair.pigment else { panic!("no colour") };
        rgb
    }

    #[test]
    fn a_strand_passes_through_its_points() {
        let points = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0];
        let (parts, scene, warnings) = of(&file(POINTS, [1, 3], &[], &points)).unwrap();
        assert_eq!((warnings.len(), parts[0].alpha), (0, Some(Scalar::Value(0.5))));
        assert_eq!(reflectance(&scene), [0.2, 0.4, 0.6]);
        let [first, second] = strands(&parts[0]) else { panic!("two curves") };
        assert_eq!([first.width, second.width], [[0.25; 2]; 2]);
        assert_eq!([first.points[0], first.points[3]], [Vec3::ZERO, Vec3::X]);
        assert_eq!([second.points[0], second.points[3]], [Vec3::X, Vec3::new(1.0, 1.0, 0.0)]);
        // One tangent where they meet, along the chord; straight ends.
        let [before, after] = [first.points[3] - first.points[2], second.points[1] - second.points[0]];
        assert!(
            (before - after).length() < 1e-6 && (before - Vec3::new(1.0, 1.0, 0.0) / 6.0).length() < 1e-6
        );
        assert!((first.points[1] - Vec3::X / 3.0).length() < 1e-6);
    }

    #[test]
    fn arrays_replace_defaults() {
        let all = SEGMENTS | POINTS | THICKNESS | TRANSPARENCY | COLORS;
        let points = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 2.0, 0.0, 1.0, 2.0, 0.0, 1.0];
        let thickness = [0.4, 0.2, 0.1, 0.0, 0.1];
        let transparency = [0.0; 5];
        let colors = [0.0, 0.5, 1.0].repeat(5);
        let numbers = [&points[..], &thickness, &transparency, &colors].concat();
        let (parts, scene, warnings) = of(&file(all, [2, 5], &[1, 2], &numbers)).unwrap();
        assert_eq!((warnings.len(), parts[0].alpha, reflectance(&scene)), (0, None, [0.0, 0.5, 1.0]));
        // The last point is where the one before is: no curve.
        let [first, second] = strands(&parts[0]) else { panic!("two curves") };
        assert_eq!([first.width, second.width], [[0.4, 0.2], [0.1, 0.4 * THINNEST]]);
        let mut numbers = numbers;
        *numbers.last_mut().unwrap() = 0.5;
        let (_, scene, warnings) = of(&file(all, [2, 5], &[1, 2], &numbers)).unwrap();
        assert!(warnings[0].contains("the colours of points are replaced by their mean"), "{warnings:?}");
        assert!((reflectance(&scene)[2] - 0.9).abs() < 1e-6);
    }

    #[test]
    fn broken_files_are_told_of() {
        let two = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let cut = {
            let mut bytes = file(SEGMENTS | POINTS, [1, 2], &[1], &two);
            bytes.truncate(HEADER + 2 + 12);
            bytes
        };
        for (bytes, expected) in [
            (b"HAIR".to_vec(), "a.hair: 4 bytes do not begin with the header of a HAIR file"),
            (file(SEGMENTS, [1, 2], &[1], &[]), "there is no array of points"),
            (cut, "2 points are declared, but there are only bytes for 1"),
            (file(SEGMENTS | POINTS, [1, 2], &[2], &two), "the strands have 3 points, but 2 are declared"),
            (file(POINTS, [u32::MAX, u32::MAX], &[], &[]), "more than the limit"),
        ] {
            let error = of(&bytes).unwrap_err().to_string();
            assert!(error.contains(expected), "{expected}: {error}");
        }
        let not_finite = [0.0, f32::NAN, 0.0, 1.0, 0.0, 0.0];
        let (parts, _, warnings) = of(&file(SEGMENTS | POINTS, [1, 2], &[1], &not_finite)).unwrap();
        assert!(parts.is_empty() && warnings.len() == 2, "{warnings:?}");
        assert!(
            warnings[0].contains("1 strand left out: a coordinate is infinite or not a number"),
            "{warnings:?}"
        );
    }
}
