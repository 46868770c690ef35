//! Derivations of portals: the window of the square, the cell of a direction in it, its density and its radiance.

use glam::{DVec3, Vec3};

use super::{Portal, cell_solid_angle, slope};
use crate::light::derivation::{Derivation, as_spectrum, cell_of_density, color_of, vector};
use crate::shading::texture::SpectralMode;

impl Portal {
    /// The formulas of a direction's density and radiance, with operands; `scale` is that of the environment map.
    pub(in crate::light) fn derivations(
        &self,
        from: DVec3,
        wi: Vec3,
        pdf: f32,
        scale: [f32; 3],
        mode: &SpectralMode,
    ) -> Vec<Derivation> {
        // Rounding may leave a direction just outside of the window.
        if pdf == 0.0 {
            return Vec::new();
        }
        let direction = wi.as_dvec3();
        let (Some(window), Some(at)) = (self.opening.window(from), self.opening.place(direction)) else {
            return Vec::new();
        };
        let size = self.choice.size();
        let per_cell = (size[0] * size[1]) as f64;
        let solid_angle = f64::from(self.opening.solid_angle(at));
        let total = self.choice.total(&window);
        let density = |cell| self.choice.weight(cell) / total * per_cell / solid_angle;
        let by_direction = [0, 1].map(|axis| ((at[axis] * size[axis] as f64) as usize).min(size[axis] - 1));
        let cell = cell_of_density(by_direction, size, pdf, density);
        let edges = |axis: usize| [0, 1].map(|end| slope((cell[axis] + end) as f64 / size[axis] as f64));
        let of_cell = cell_solid_angle(edges(0), edges(1));
        let [x, y, z] = self.opening.axes;
        let [to_x, to_y] = at.map(slope);
        let pair = |pair: [f64; 2]| pair.to_vec();
        let corner = |corner: DVec3| (corner - from).to_array().to_vec();
        let mut all = vec![
            Derivation::new(
                "cell (i, j) of the square of angles: i = ⌊u columns⌋, j = ⌊v rows⌋; u = ½ + atan(x) / π, v = ½ + atan(y) / π; \
                 x = wi·X / wi·Z, y = wi·Y / wi·Z",
                vec![
                    ("X", x.to_array().to_vec()),
                    ("Y", y.to_array().to_vec()),
                    ("Z", z.to_array().to_vec()),
                    ("x, y", vec![to_x, to_y]),
                    ("u, v", pair(at)),
                    ("columns, rows", pair(size.map(|size| size as f64))),
                    ("i, j", pair(cell.map(|index| index as f64))),
                ],
            ),
            Derivation::new(
                "pdf = W / ΣW · columns rows / J, J = π² (1 + x²)(1 + y²) / (1 + x² + y²)^(3/2); W = B ω: the brightest channel of \
                 the cell times its solid angle; ΣW: of all cells, or parts of them, in the window, from the (u, v) of the \
                 portal's first corner to that of the one across",
                vec![
                    ("first corner − p", corner(self.opening.corner)),
                    ("across − p", corner(self.opening.opposite)),
                    ("window from", pair(window.min)),
                    ("window to", pair(window.max)),
                    ("B", vec![self.choice.weight(cell) / of_cell]),
                    ("ω", vec![of_cell]),
                    ("W", vec![self.choice.weight(cell)]),
                    ("ΣW", vec![total]),
                    ("J", vec![solid_angle]),
                ],
            ),
        ];
        if let Some(picture) = &self.picture {
            let numbers = vec![("scale", vector(scale)), ("texel", vector(color_of(picture, cell)))];
            all.push(Derivation::new(
                format!("L = scale · texel (i, j) of the map, resampled to the square{}", as_spectrum(mode)),
                numbers,
            ));
        }
        all
    }
}
