//! RGB colour spaces and their matrices.
//!
//! A space is given by the chromaticities of its primaries and by its white point, which is the colour of an illuminant's
//! spectrum instead of a rounded chromaticity, as in pbrt-v4. Vectors are columns; matrices are lists of rows.

use super::{named, observer};

/// A linear map of three numbers: rows of coefficients.
pub type Matrix = [[f64; 3]; 3];

/// The RGB spaces that scenes may name, in lower case: primaries and white point.
const SPACES: &[(&str, [[f64; 2]; 3], &str)] = &[
    ("srgb", [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], "stdillum-D65"),
    ("dci-p3", [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], "stdillum-D65"),
    ("rec2020", [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], "stdillum-D65"),
    ("aces2065-1", [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], "illum-acesD60"),
];

/// The names that [`xyz_from`] and [`rec709_from`] know.
pub fn names() -> impl Iterator<Item = &'static str> {
    SPACES.iter().map(|(name, ..)| *name)
}

/// The matrix from a space's RGB to XYZ; (1, 1, 1) is the space's white with Y = 1. The name is case-insensitive.
pub fn xyz_from(space: &str) -> Option<Matrix> {
    let (_, primaries, white) = SPACES.iter().find(|(name, ..)| name.eq_ignore_ascii_case(space))?;
    let white = observer::xyz(&named(white)?);
    let columns = primaries.map(|[x, y]| [x / y, 1.0, (1.0 - x - y) / y]);
    let primaries: Matrix = std::array::from_fn(|row| columns.map(|column| column[row]));
    // Scale the primaries so that their sum is white.
    let scale = apply(&inverse(&primaries), white);
    Some(primaries.map(|row| std::array::from_fn(|i| row[i] * scale[i])))
}

/// The colours that red, green, blue and white stand for, as CIE xy chromaticities: those that a picture file states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    /// Chromaticities of red, green and blue.
    pub primaries: [[f64; 2]; 3],
    /// Chromaticity of (1, 1, 1).
    pub white: [f64; 2],
}

impl Chromaticities {
    /// Rec. 709, and sRGB.
    pub const REC709: Self =
        Self { primaries: [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], white: [0.3127, 0.329] };

    /// X, Y and Z themselves.
    pub const XYZ: Self =
        Self { primaries: [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], white: [1.0 / 3.0, 1.0 / 3.0] };

    /// Whether all of them are nearly those of another one, as far as files round them (pbrt-v4's tolerance).
    fn nearly(&self, other: &Self) -> bool {
        const TOLERANCE: f64 = 1e-3;
        let pairs =
            self.primaries.iter().chain([&self.white]).zip(other.primaries.iter().chain([&other.white]));
        pairs.flat_map(|(a, b)| a.iter().zip(b)).all(|(a, b)| (a - b).abs() <= TOLERANCE)
    }

    /// The matrix to XYZ; (1, 1, 1) has Y = 1. `None` if they span no colours.
    pub fn xyz_from(&self) -> Option<Matrix> {
        let column = |[x, y]: [f64; 2]| [x, y, 1.0 - x - y];
        let columns = self.primaries.map(column);
        let primaries: Matrix = std::array::from_fn(|row| columns.map(|column| column[row]));
        let white = column(self.white).map(|value| value / self.white[1]);
        let scale = apply(&inverse(&primaries), white);
        let matrix: Matrix = primaries.map(|row| std::array::from_fn(|i| row[i] * scale[i]));
        matrix.as_flattened().iter().all(|value| value.is_finite()).then_some(matrix)
    }

    /// The luminances of red, green and blue; their sum is 1.
    pub fn luminance(&self) -> [f32; 3] {
        self.xyz_from().map_or([0.2126, 0.7152, 0.0722], |matrix| matrix[1].map(|value| value as f32))
    }

    /// The matrix to linear Rec. 709; `None` if that is what they are, or if they span no colours. White becomes white (adapted as
    /// by [`adapted`]) unless `keeps_white`. X, Y and Z stay the colours that they are.
    pub fn rec709(&self, keeps_white: bool) -> Option<[[f32; 3]; 3]> {
        if self.nearly(&Self::REC709) {
            return None;
        }
        let (from, to) = (self.xyz_from()?, xyz_from("srgb")?);
        let white = |matrix: &Matrix| apply(matrix, [1.0; 3]);
        let from = match keeps_white || self.nearly(&Self::XYZ) {
            true => from,
            false => product(&adapted(white(&from), white(&to)), &from),
        };
        let matrix = product(&inverse(&to), &from).map(|row| row.map(|value| value as f32));
        matrix.as_flattened().iter().all(|value| value.is_finite()).then_some(matrix)
    }
}

/// The matrix from a space's RGB to linear Rec. 709 of the same XYZ, for light; `srgb` gives (nearly) the identity.
///
/// The white of `aces2065-1` is warmer than that of Rec. 709 and stays so. For reflectances, whose white reflects all light,
/// see [`reflectance_rec709_from`].
pub fn rec709_from(space: &str) -> Option<[[f32; 3]; 3]> {
    let matrix = product(&inverse(&xyz_from("srgb")?), &xyz_from(space)?);
    Some(matrix.map(|row| row.map(|value| value as f32)))
}

/// The matrix from a space's RGB to linear Rec. 709 for reflectances: white stays white (adapted as by [`adapted`]).
pub fn reflectance_rec709_from(space: &str) -> Option<[[f32; 3]; 3]> {
    let (from, to) = (xyz_from(space)?, xyz_from("srgb")?);
    let white = |matrix: &Matrix| apply(matrix, [1.0; 3]);
    let matrix = product(&inverse(&to), &product(&adapted(white(&from), white(&to)), &from));
    Some(matrix.map(|row| row.map(|value| value as f32)))
}

/// Chromatic adaptation to another white: von Kries scaling of the cone responses in Bradford's sharpened space (Lam 1985).
/// Maps the XYZ `from` to `to`, if both have the same Y.
pub fn adapted(from: [f64; 3], to: [f64; 3]) -> Matrix {
    const BRADFORD: Matrix =
        [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    // Only the chromaticities matter.
    let response = |white: [f64; 3]| apply(&BRADFORD, white.map(|value| value / white[1]));
    let (from, to) = (response(from), response(to));
    let scaled: Matrix = std::array::from_fn(|row| BRADFORD[row].map(|value| value * to[row] / from[row]));
    product(&inverse(&BRADFORD), &scaled)
}

/// The product of a matrix and a column vector.
pub fn apply(matrix: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|[a, b, c]| a * x + b * y + c * z)
}

/// The product of two matrices: `right` is applied first.
pub fn product(left: &Matrix, right: &Matrix) -> Matrix {
    left.map(|row| std::array::from_fn(|column| (0..3).map(|i| row[i] * right[i][column]).sum()))
}

/// The inverse of an invertible matrix.
pub fn inverse(matrix: &Matrix) -> Matrix {
    let minor = |row: usize, column: usize| {
        let (r, s) = ((row + 1) % 3, (row + 2) % 3);
        let (c, d) = ((column + 1) % 3, (column + 2) % 3);
        matrix[r][c] * matrix[s][d] - matrix[r][d] * matrix[s][c]
    };
    let determinant: f64 = (0..3).map(|column| matrix[0][column] * minor(0, column)).sum();
    std::array::from_fn(|row| std::array::from_fn(|column| minor(column, row) / determinant))
}

/// The matrix from linear Rec. 709 to X, Y, Z (white, D65, has Y = 1), with seven digits: noise is measured in these
/// channels, by films and in comparisons. Y is luminance.
pub const XYZ_FROM_RGB: Matrix = [
    [0.412_390_8, 0.357_584_3, 0.180_480_8],
    [0.212_639, 0.715_168_7, 0.072_192_3],
    [0.019_330_8, 0.119_194_8, 0.950_532_2],
];

/// X, Y, Z by [`XYZ_FROM_RGB`].
pub fn xyz_of_rec709(rgb: [f64; 3]) -> [f64; 3] {
    apply(&XYZ_FROM_RGB, rgb)
}
