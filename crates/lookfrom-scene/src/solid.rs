//! Constructive solid geometry: bodies, and the set operations that make one solid of them.
//!
//! Requicha (1980), "Representations for Rigid Solids"; Roth (1982), "Ray Casting for Modeling Solids". The surface of a solid consists of
//! what is left of the surfaces of its bodies: [`Solid::constraints`] says where one is left.

use glam::{DMat4, DVec3, DVec4};

use crate::scene::Bounds;

/// The most bodies of a solid: each point of a surface may ask all others.
pub const MOST_BODIES: usize = 64;

/// Surfaces are the same where their equations, in a space in which the solid has a size of about 1, differ by less.
const SAME: f64 = 1e-9;

/// A set operation on solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// All points that are in at least one of them.
    Union,
    /// All points that are in each of them.
    Intersection,
    /// The points of the first that are in none of the others.
    Difference,
}

/// A closed body, in its own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A ball whose poles lie on the y axis.
    Ball {
        /// The centre.
        center: DVec3,
        /// Positive.
        radius: f64,
    },
    /// A cylinder around the z axis with both of its ends.
    Cylinder {
        /// Positive.
        radius: f64,
        /// Minimum and maximum z.
        z: [f64; 2],
    },
    /// A box with sides along the axes.
    Cuboid {
        /// The least corner.
        min: DVec3,
        /// The greatest corner: beyond the least along each axis.
        max: DVec3,
    },
    /// A solid torus around the z axis: all points at a distance of at most `tube` from a circle.
    Torus {
        /// Of the circle, positive.
        radius: f64,
        /// Radius of the tube, positive.
        tube: f64,
    },
}

/// A body at its place in a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    form: Form,
    solid_from_body: DMat4,
    body_from_solid: DMat4,
}

/// Bodies and combinations of them.
#[derive(Clone, Debug, PartialEq)]
pub enum Combination {
    /// A body, by its number.
    Body(u32),
    /// At least one operand.
    Combined(Operation, Vec<Combination>),
}

/// A condition on the points of a body's surface that are on the surface of the solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Whether the point must be inside of `of`, or outside.
    pub inside: bool,
    /// Other bodies of the solid.
    pub of: Combination,
}

/// A solid: a combination of bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    bodies: Vec<Body>,
    combination: Combination,
}

impl Form {
    fn bounds(&self) -> Bounds {
        let around = |extent: DVec3| Bounds { min: -extent, max: extent };
        match *self {
            Self::Ball { center, radius } => Bounds { min: center - radius, max: center + radius },
            Self::Cylinder { radius, z: [low, high] } => {
                Bounds { min: DVec3::new(-radius, -radius, low), max: DVec3::new(radius, radius, high) }
            }
            Self::Cuboid { min, max } => Bounds { min, max },
            Self::Torus { radius, tube } => around(DVec3::new(radius + tube, radius + tube, tube)),
        }
    }

    /// Its surfaces, each by one or more symmetric matrices Q of equations pᵀ Q p = 0.
    fn surfaces(&self) -> Vec<Vec<DMat4>> {
        let centered = |square: DVec4| DMat4::from_diagonal(square);
        let plane = |axis: usize, offset: f64| {
            let mut rows = [[0.0; 4]; 4];
            (rows[axis][3], rows[3][axis], rows[3][3]) = (0.5, 0.5, -offset);
            vec![DMat4::from_cols_array_2d(&rows)]
        };
        match *self {
            Self::Ball { center, radius } => {
                let to_center = DMat4::from_translation(-center);
                let ball = centered(DVec4::new(1.0, 1.0, 1.0, -radius * radius));
                vec![vec![to_center.transpose() * ball * to_center]]
            }
            Self::Cylinder { radius, z: [low, high] } => {
                let side = vec![centered(DVec4::new(1.0, 1.0, 0.0, -radius * radius))];
                vec![side, plane(2, low), plane(2, high)]
            }
            Self::Cuboid { min, max } => {
                (0..3).flat_map(|axis| [plane(axis, min[axis]), plane(axis, max[axis])]).collect()
            }
            // The cylinder of its circle, and a ball of its tube.
            Self::Torus { radius, tube } => vec![vec![
                centered(DVec4::new(1.0, 1.0, 0.0, -radius * radius)),
                centered(DVec4::new(1.0, 1.0, 1.0, -tube * tube)),
            ]],
        }
    }
}

impl Body {
    /// A body by the map from its own space to that of the solid; none where that has no inverse.
    pub fn new(form: Form, solid_from_body: DMat4) -> Option<Self> {
        let body_from_solid = solid_from_body.inverse();
        let is_sound = solid_from_body.is_finite() && body_from_solid.is_finite();
        is_sound.then_some(Self { form, solid_from_body, body_from_solid })
    }

    /// Its form.
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// The map from its own space to that of the solid.
    pub fn solid_from_body(&self) -> &DMat4 {
        &self.solid_from_body
    }

    /// The map from the space of the solid to its own.
    pub fn body_from_solid(&self) -> &DMat4 {
        &self.body_from_solid
    }

    /// A box around it, after a map from the space of the solid.
    pub fn bounds(&self, map: &DMat4) -> Bounds {
        self.form.bounds().transformed(&(*map * self.solid_from_body))
    }

    /// A box around it in the space of the solid.
    pub(crate) fn own_bounds(&self) -> Bounds {
        self.bounds(&DMat4::IDENTITY)
    }

    /// Its surfaces in a space in which the box around the solid is `bounds` moved to the origin, with a diagonal of 1.
    fn surfaces_in(&self, bounds: Bounds) -> Vec<Vec<DMat4>> {
        let size = (bounds.max - bounds.min).length();
        let solid_from_unit =
            DMat4::from_translation(bounds.center()) * DMat4::from_scale(DVec3::splat(size));
        let body_from_unit = self.body_from_solid * solid_from_unit;
        let placed = |surface: Vec<DMat4>| -> Vec<DMat4> {
            let moved = surface.iter().map(|of_body| body_from_unit.transpose() * *of_body * body_from_unit);
            moved.map(|of_unit| of_unit * (1.0 / length(&of_unit))).collect()
        };
        self.form.surfaces().into_iter().map(placed).collect()
    }
}

impl Combination {
    /// Calls `visit` with the number of each of its bodies.
    fn visit(&self, visit: &mut impl FnMut(u32)) {
        match self {
            Self::Body(body) => visit(*body),
            Self::Combined(_, operands) => operands.iter().for_each(|operand| operand.visit(visit)),
        }
    }

    /// Adds the constraints of the surface of a body; whether it is one of its own, and whether that is turned inside out.
    fn constrain(&self, body: u32, constraints: &mut Vec<Constraint>) -> Option<bool> {
        let (operation, operands) = match self {
            Self::Body(own) => return (*own == body).then_some(false),
            Self::Combined(operation, operands) => (*operation, operands),
        };
        let found = |(index, operand): (usize, &Self)| Some((index, operand.constrain(body, constraints)?));
        let (place, is_turned) = operands.iter().enumerate().find_map(found)?;
        for (index, of) in operands.iter().enumerate().filter(|(index, _)| *index != place) {
            let inside = match operation {
                Operation::Union => false,
                Operation::Intersection => true,
                Operation::Difference => index == 0,
            };
            constraints.push(Constraint { inside, of: of.clone() });
        }
        Some(is_turned != (operation == Operation::Difference && place > 0))
    }
}

impl Solid {
    /// A combination of bodies. Its numbers have to be those of all bodies, each once: [`Self::is_sound`].
    pub fn new(bodies: Vec<Body>, combination: Combination) -> Self {
        Self { bodies, combination }
    }

    /// Its bodies.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The combination of all of them.
    pub fn combination(&self) -> &Combination {
        &self.combination
    }

    /// Whether it has at most [`MOST_BODIES`] bodies, and combines each of them once.
    pub fn is_sound(&self) -> bool {
        let mut numbers = Vec::new();
        self.combination.visit(&mut |body| numbers.push(body));
        numbers.sort_unstable();
        self.bodies.len() <= MOST_BODIES && numbers.into_iter().eq(0..self.bodies.len() as u32)
    }

    /// The conditions on the points of a body's surface that are on the surface of the solid, and whether its inside is outside of the solid
    /// there.
    pub fn constraints(&self, body: u32) -> (Vec<Constraint>, bool) {
        let mut constraints = Vec::new();
        let is_turned = self.combination.constrain(body, &mut constraints);
        (constraints, is_turned.unwrap_or(false))
    }

    /// A box around a combination of its bodies, after a map from its space.
    fn bounds_of(&self, combination: &Combination, map: &DMat4) -> Bounds {
        match combination {
            Combination::Body(body) => self.bodies[*body as usize].bounds(map),
            Combination::Combined(operation, operands) => {
                let mut bounds = operands.iter().map(|operand| self.bounds_of(operand, map));
                match operation {
                    Operation::Union => bounds.fold(Bounds::EMPTY, Bounds::union),
                    Operation::Intersection => bounds.reduce(common).unwrap_or(Bounds::EMPTY),
                    Operation::Difference => bounds.next().unwrap_or(Bounds::EMPTY),
                }
            }
        }
    }

    /// A box around what is left of a body's surface, after a map from its space; empty where nothing can be left.
    pub fn bounds_of_surface(&self, body: u32, map: &DMat4) -> Bounds {
        let (constraints, _) = self.constraints(body);
        let inside = constraints.iter().filter(|constraint| constraint.inside);
        inside
            .map(|constraint| self.bounds_of(&constraint.of, map))
            .fold(self.bodies[body as usize].bounds(map), common)
    }

    /// Whether surfaces of two bodies coincide, where rounding alone would decide which of them is left.
    pub fn has_flush_surfaces(&self) -> bool {
        let whole = self.bodies.iter().map(Body::own_bounds).fold(Bounds::EMPTY, Bounds::union);
        let margin = SAME * (whole.max - whole.min).length();
        let placed: Vec<_> =
            self.bodies.iter().map(|body| (body.own_bounds(), body.surfaces_in(whole))).collect();
        placed.iter().enumerate().any(|(index, (bounds, surfaces))| {
            placed[..index].iter().any(|(others_bounds, others)| {
                let Bounds { min, max } = common(*bounds, *others_bounds);
                min.cmple(max + margin).all()
                    && surfaces.iter().any(|one| others.iter().any(|other| are_same(one, other)))
            })
        })
    }
}

/// The box that two boxes have in common.
fn common(a: Bounds, b: Bounds) -> Bounds {
    Bounds { min: a.min.max(b.min), max: a.max.min(b.max) }
}

/// The Frobenius norm.
fn length(matrix: &DMat4) -> f64 {
    matrix.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Whether two surfaces are the same, given equations of length 1.
fn are_same(a: &[DMat4], b: &[DMat4]) -> bool {
    let is_same = |(a, b): (&DMat4, &DMat4)| length(&(*a - *b)).min(length(&(*a + *b))) < SAME;
    a.len() == b.len() && a.iter().zip(b).all(is_same)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f64, radius: f64) -> Body {
        Body::new(Form::Ball { center: DVec3::new(x, 0.0, 0.0), radius }, DMat4::IDENTITY).unwrap()
    }

    /// Whether a form contains a point of its own space.
    fn is_in(form: &Form, p: DVec3) -> bool {
        match *form {
            Form::Ball { center, radius } => (p - center).length() < radius,
            _ => panic!("only balls are asked for"),
        }
    }

    /// Whether a combination contains a point.
    fn contains(solid: &Solid, combination: &Combination, p: DVec3) -> bool {
        match combination {
            Combination::Body(body) => {
                let body = &solid.bodies()[*body as usize];
                is_in(body.form(), body.body_from_solid().transform_point3(p))
            }
            Combination::Combined(operation, operands) => {
                let mut inside = operands.iter().map(|operand| contains(solid, operand, p));
                match operation {
                    Operation::Union => inside.any(|inside| inside),
                    Operation::Intersection => inside.all(|inside| inside),
                    Operation::Difference => inside.next() == Some(true) && !inside.any(|inside| inside),
                }
            }
        }
    }

    fn of_all(operation: Operation, bodies: Vec<Body>) -> Solid {
        let operands = (0..bodies.len() as u32).map(Combination::Body).collect();
        Solid::new(bodies, Combination::Combined(operation, operands))
    }

    #[test]
    fn a_point_of_a_surface_is_left_where_the_solid_is_on_one_side_of_it() {
        // (0 ∪ 1) − (2 ∩ 3)
        let pair = |operation, a, b| {
            Combination::Combined(operation, vec![Combination::Body(a), Combination::Body(b)])
        };
        let combination = Combination::Combined(
            Operation::Difference,
            vec![pair(Operation::Union, 0, 1), pair(Operation::Intersection, 2, 3)],
        );
        let solid =
            Solid::new(vec![ball(0.0, 1.0), ball(0.9, 0.8), ball(0.3, 0.7), ball(0.7, 0.6)], combination);
        assert!(solid.is_sound());
        let mut left = 0;
        for (number, body) in solid.bodies().iter().enumerate() {
            let Form::Ball { center, radius } = *body.form() else { panic!() };
            let (constraints, is_turned) = solid.constraints(number as u32);
            assert_eq!(is_turned, number >= 2);
            for k in 0..400 {
                let (height, turn) = (f64::from(k) / 200.0 - 0.9975, 2.4 * f64::from(k));
                let ring = (1.0 - height * height).sqrt();
                let normal = DVec3::new(ring * turn.cos(), height, ring * turn.sin());
                let at = |r: f64| contains(&solid, solid.combination(), center + r * normal);
                let [within, beyond] = [at(radius - 1e-9), at(radius + 1e-9)];
                let is_left = constraints.iter().all(|constraint| {
                    contains(&solid, &constraint.of, center + radius * normal) == constraint.inside
                });
                assert_eq!(is_left, within != beyond, "body {number} {normal}");
                assert!(!is_left || within != is_turned);
                left += u32::from(is_left);
            }
        }
        assert!((400..1200).contains(&left), "{left}");
    }

    #[test]
    fn flush_surfaces_are_found() {
        let cuboid = |min: [f64; 3], max: [f64; 3]| {
            Body::new(Form::Cuboid { min: min.into(), max: max.into() }, DMat4::IDENTITY).unwrap()
        };
        let rod = |z: [f64; 2], map: DMat4| Body::new(Form::Cylinder { radius: 0.3, z }, map).unwrap();
        let ring = |map: DMat4| Body::new(Form::Torus { radius: 1.0, tube: 0.2 }, map).unwrap();
        let turned = DMat4::from_rotation_x(0.4);
        let around = DMat4::from_rotation_z(1.1);
        let block = cuboid([0.0; 3], [1.0; 3]);
        for (is_flush, a, b) in [
            (false, block, cuboid([0.2; 3], [2.0; 3])),
            (true, block, cuboid([0.2, 0.2, 0.0], [0.5, 0.5, 2.0])),
            (true, block, cuboid([0.2, 0.2, 1.0], [0.5, 0.5, 2.0])),
            // One plane, but far from one another.
            (false, block, cuboid([3.0, 3.0, 0.0], [4.0, 4.0, 2.0])),
            (true, rod([0.0, 1.0], turned), rod([0.5, 2.0], turned * around)),
            (false, rod([0.0, 1.0], turned), rod([0.5, 2.0], DMat4::IDENTITY)),
            (true, rod([0.0, 1.0], DMat4::IDENTITY), cuboid([-1.0, -1.0, 1.0], [1.0, 1.0, 3.0])),
            (true, ball(1e3, 0.5), ball(1e3, 0.5)),
            (false, ball(1e3, 0.5), ball(1e3, 0.501)),
            (true, ring(turned), ring(turned * around)),
            (false, ring(turned), ring(around)),
        ] {
            assert_eq!(of_all(Operation::Union, vec![a, b]).has_flush_surfaces(), is_flush, "{a:?} {b:?}");
        }
    }
}
