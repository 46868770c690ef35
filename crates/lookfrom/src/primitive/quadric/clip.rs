//! Clips: the parts of quadrics that are on the surface of a solid.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use lookfrom_bvh::Affine;
use lookfrom_scene::solid::{Combination, Constraint, Form, Operation, Solid};
use lookfrom_simd::{Float, Mask, Real};

use crate::core::math;
use crate::core::vector::Vector;

/// A part of a quadric: that which is on the surface of a solid. Whether a point is left, is decided in double precision.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Regions, and whether the points that are left are inside of each, or outside.
    conditions: Vec<(bool, Region)>,
    /// A box around the part, in render space.
    pub bounds: [DVec3; 2],
    solid: Arc<Solid>,
    constraints: Vec<Constraint>,
}

/// A region of the object space of a quadric: that of a body, or of several.
#[derive(Clone, Debug)]
enum Region {
    Body(Form, Affine),
    Combined(Operation, Vec<Self>),
}

/// The masks of a width.
type Masks<R> = <<R as Real>::Double as Float>::Mask;

impl Clip {
    /// The clip of a body's surface, by its [constraints](Solid::constraints). `solid_from_object` maps from the object space of the
    /// quadric; `bounds` are in render space.
    pub fn new(
        solid: Arc<Solid>,
        constraints: Vec<Constraint>,
        solid_from_object: &DMat4,
        bounds: [DVec3; 2],
    ) -> Self {
        let region = |constraint: &Constraint| {
            (constraint.inside, Region::new(&solid, &constraint.of, solid_from_object))
        };
        let conditions = constraints.iter().map(region).collect();
        Self { conditions, bounds, solid, constraints }
    }

    /// The mask of the points that are left, in the object space of the quadric; `like` has the width.
    #[inline(always)]
    pub(crate) fn keeps<R: Real>(&self, like: R, p: Vector<R::Double>) -> Masks<R> {
        let mut kept = p.x.eq(p.x).like(true);
        for (inside, region) in &self.conditions {
            let is_inside = region.contains(like, p);
            kept = kept & if *inside { is_inside } else { !is_inside };
            if !kept.any() {
                break;
            }
        }
        kept
    }

    /// The reason why a point is not left, by the first condition that it does not fulfil: `inside of shape 2 of the solid, a cylinder`.
    pub(crate) fn cut(&self, p: DVec3) -> Option<String> {
        let is_broken = |(inside, region): &(bool, Region)| region.contains(0.0_f32, p.into()) != *inside;
        let Constraint { inside, of } = &self.constraints[self.conditions.iter().position(is_broken)?];
        let side = if *inside { "outside of" } else { "inside of" };
        let name = match of {
            Combination::Body(body) => {
                let kind = match self.solid.bodies()[*body as usize].form() {
                    Form::Ball { .. } => "sphere",
                    Form::Cylinder { .. } => "cylinder",
                    Form::Cuboid { .. } => "box",
                    Form::Torus { .. } => "torus",
                };
                format!("shape {body} of the solid, a {kind}")
            }
            Combination::Combined(Operation::Union, _) => "a union within the solid".to_owned(),
            Combination::Combined(Operation::Intersection, _) => {
                "an intersection within the solid".to_owned()
            }
            Combination::Combined(Operation::Difference, _) => "a difference within the solid".to_owned(),
        };
        Some(format!("{side} {name}"))
    }
}

impl Region {
    fn new(solid: &Solid, combination: &Combination, solid_from_object: &DMat4) -> Self {
        match combination {
            Combination::Body(body) => {
                let body = &solid.bodies()[*body as usize];
                Self::Body(*body.form(), math::affine(&(*body.body_from_solid() * *solid_from_object)))
            }
            Combination::Combined(operation, operands) => {
                let operands = operands.iter().map(|operand| Self::new(solid, operand, solid_from_object));
                Self::Combined(*operation, operands.collect())
            }
        }
    }

    /// Membership of points.
    #[inline(always)]
    fn contains<R: Real>(&self, like: R, p: Vector<R::Double>) -> Masks<R> {
        match self {
            Self::Body(form, body_from_object) => is_in(form, transformed(body_from_object, p)),
            Self::Combined(operation, operands) => combination_contains(*operation, operands, like, p),
        }
    }
}

/// Which points a combination contains.
#[inline(never)]
fn combination_contains<R: Real>(
    operation: Operation,
    operands: &[Region],
    like: R,
    p: Vector<R::Double>,
) -> Masks<R> {
    like.at_level(
        #[inline(always)]
        || {
            let mut inside = operands[0].contains(like, p);
            for operand in &operands[1..] {
                let other = operand.contains(like, p);
                inside = match operation {
                    Operation::Union => inside | other,
                    Operation::Intersection => inside & other,
                    Operation::Difference => inside & !other,
                };
            }
            inside
        },
    )
}

#[inline(always)]
fn transformed<F: Float<Scalar = f64>>(affine: &Affine, p: Vector<F>) -> Vector<F> {
    let [x, y, z] = affine.matrix;
    let linear =
        Vector::new(Vector::splat(p.x, x).dot(p), Vector::splat(p.x, y).dot(p), Vector::splat(p.x, z).dot(p));
    linear + Vector::splat(p.x, affine.translation)
}

/// Which numbers are between two others.
#[inline(always)]
fn is_between<F: Float<Scalar = f64>>(x: F, low: f64, high: f64) -> F::Mask {
    x.gt(x.like(low)) & x.lt(x.like(high))
}

/// Which points a body contains, in its own space.
#[inline(always)]
fn is_in<F: Float<Scalar = f64>>(form: &Form, p: Vector<F>) -> F::Mask {
    let from_axis = p.x * p.x + p.y * p.y;
    match *form {
        Form::Ball { center, radius } => {
            let from_center = p - Vector::splat(p.x, center.to_array());
            from_center.length_squared().lt(p.x.like(radius * radius))
        }
        Form::Cylinder { radius, z: [low, high] } => {
            is_between(p.z, low, high) & from_axis.lt(p.x.like(radius * radius))
        }
        Form::Cuboid { min, max } => {
            is_between(p.x, min.x, max.x) & is_between(p.y, min.y, max.y) & is_between(p.z, min.z, max.z)
        }
        Form::Torus { radius, tube } => {
            let across = from_axis.sqrt() - p.x.like(radius);
            (across * across + p.z * p.z).lt(p.x.like(tube * tube))
        }
    }
}
