//! Arguments from Python: geometry for a tree, rays for a query.

use std::sync::atomic::{AtomicUsize, Ordering};

use lookfrom_bvh::{Affine, Faces, Quality};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use super::chunk::Rays;
use super::geometry::{Geometry, Instance, Masks, Part};
use super::python::PyTree;
use super::tree::Selection;
use crate::arrays::{Numbers, Vectors, numbers};
use crate::error::Error;

/// One of a tree's geometries or instances.
#[derive(FromPyObject)]
pub(super) enum Item<'py> {
    /// Vertices, faces, masks.
    Triangles(Vectors<'py>, PyReadonlyArray2<'py, u32>, Option<MasksArgument<'py>>),
    /// Centres, radii, masks.
    Spheres(Vectors<'py>, PyReadonlyArray1<'py, f64>, Option<MasksArgument<'py>>),
    /// A tree, its place as the upper three rows of a matrix, its mask.
    Instance(PyRef<'py, PyTree>, PyReadonlyArray2<'py, f64>, Option<u32>),
}

/// A mask for all primitives, or one for each.
#[derive(FromPyObject)]
pub(super) enum MasksArgument<'py> {
    OfAll(u32),
    OfEach(PyReadonlyArray1<'py, u32>),
}

/// The geometry and the instances of a tree.
pub(super) fn parts_and_instances(items: &[Item<'_>]) -> PyResult<(Vec<Part>, Vec<Instance>)> {
    let (mut parts, mut instances) = (Vec::new(), Vec::new());
    for item in items {
        match item {
            Item::Triangles(vertices, faces, masks) => {
                let geometry = triangles(vertices.rows()?.to_vec()?, faces)?;
                parts.push(Part { geometry, masks: read_masks(masks.as_ref()) });
            }
            Item::Spheres(centers, radii, masks) => {
                let geometry = spheres(centers.rows()?.to_vec()?, radii)?;
                parts.push(Part { geometry, masks: read_masks(masks.as_ref()) });
            }
            Item::Instance(tree, matrix, mask) => {
                instances.push(instance(instances.len(), tree, matrix, *mask)?);
            }
        }
    }
    Ok((parts, instances))
}

fn triangles(vertices: Vec<[f64; 3]>, faces: &PyReadonlyArray2<'_, u32>) -> PyResult<Geometry> {
    let view = faces.as_array();
    if view.ncols() != 3 {
        return Err(PyTypeError::new_err(format!("faces have {} columns instead of 3", view.ncols())));
    }
    let faces: Vec<[u32; 3]> = view.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    match faces.iter().flatten().find(|&&index| index as usize >= vertices.len()) {
        Some(index) => Err(Error::new_err(format!(
            "faces refer to vertex {index}, but there are {}, counted from 0",
            vertices.len()
        ))),
        None => Ok(Geometry::Triangles { vertices, faces }),
    }
}

fn spheres(centers: Vec<[f64; 3]>, radii: &PyReadonlyArray1<'_, f64>) -> PyResult<Geometry> {
    let radii = radii.as_array().to_vec();
    if radii.len() == centers.len() {
        Ok(Geometry::Spheres { centers, radii })
    } else {
        Err(Error::new_err(format!("there are {} centers but {} radii", centers.len(), radii.len())))
    }
}

fn instance(
    number: usize,
    tree: &PyRef<'_, PyTree>,
    matrix: &PyReadonlyArray2<'_, f64>,
    mask: Option<u32>,
) -> PyResult<Instance> {
    let view = matrix.as_array();
    if view.dim() != (3, 4) {
        return Err(PyTypeError::new_err(format!("a matrix has shape {:?} instead of (3, 4)", view.dim())));
    }
    let world_from_object = Affine {
        matrix: [0, 1, 2].map(|row| [0, 1, 2].map(|column| view[[row, column]])),
        translation: [0, 1, 2].map(|row| view[[row, 3]]),
    };
    let object_from_world = world_from_object.inverse().ok_or_else(|| {
        Error::new_err(format!(
            "the matrix of instance {number} has no inverse: scales need to be other than 0"
        ))
    })?;
    Ok(Instance { tree: tree.get(tree.py()), world_from_object, object_from_world, mask })
}

fn read_masks(masks: Option<&MasksArgument<'_>>) -> Masks {
    match masks {
        None => Masks::Everyone,
        Some(MasksArgument::OfAll(mask)) => Masks::OfAll(*mask),
        Some(MasksArgument::OfEach(masks)) => Masks::OfEach(masks.as_array().to_vec()),
    }
}

pub(super) fn quality(name: &str) -> PyResult<Quality> {
    match name {
        "fast" => Ok(Quality::Fast),
        "balanced" => Ok(Quality::Balanced),
        "best" => Ok(Quality::Best),
        _ => Err(PyValueError::new_err(format!("quality is {name:?}"))),
    }
}

/// Rays, and what they see: origins, directions, ends of the ranges, mask, faces, whether rays that make no sense are errors, the
/// width of a picture, number of threads.
#[derive(FromPyObject)]
pub(super) struct RaysArgument<'py>(
    Vectors<'py>,
    Vectors<'py>,
    Numbers<'py>,
    Numbers<'py>,
    Option<u32>,
    String,
    bool,
    usize,
    pub(super) usize,
);

impl RaysArgument<'_> {
    pub(super) fn rays(&self) -> PyResult<Rays<'_>> {
        let (origins, directions) = (self.0.rows()?, self.1.rows()?);
        let count = directions.len();
        if origins.len() != count {
            return Err(PyTypeError::new_err(format!("{} origins for {count} directions", origins.len())));
        }
        Ok(Rays {
            origins,
            directions,
            t_min: numbers(&self.2, count)?,
            t_max: numbers(&self.3, count)?,
            width: self.7,
        })
    }

    pub(super) fn selection(&self) -> PyResult<Selection> {
        let faces = match self.5.as_str() {
            "both" => Faces::Both,
            "front" => Faces::Front,
            "back" => Faces::Back,
            name => return Err(PyValueError::new_err(format!("faces is {name:?}"))),
        };
        Ok(Selection { mask: self.4, faces })
    }

    /// Fails if a ray made no sense and that is an error.
    pub(super) fn check(&self, senseless: &Senseless) -> PyResult<()> {
        match senseless.first() {
            Some(number) if self.6 => Err(Error::new_err(senseless_ray(&self.rays()?, number))),
            _ => Ok(()),
        }
    }
}

/// A message about the numbers of a ray that make no sense.
fn senseless_ray(rays: &Rays<'_>, number: usize) -> String {
    let (origin, direction) = (rays.origins.row(number), rays.directions.row(number));
    let is_finite = |v: [f64; 3]| v.iter().all(|x| x.is_finite());
    let [t_min, t_max] = [rays.t_min[number], rays.t_max[number]];
    let remedy = "invalid=\"miss\" makes such rays miss";
    if !is_finite(origin) {
        format!("ray {number}: origin is {origin:?}, but all coordinates must be finite; {remedy}")
    } else if !is_finite(direction) {
        format!("ray {number}: direction is {direction:?}, but all components must be finite; {remedy}")
    } else if direction == [0.0; 3] {
        format!("ray {number}: direction is zero, but a ray needs one; {remedy}")
    } else {
        format!("ray {number}: t_min is {t_min} and t_max is {t_max}, but neither may be NaN; {remedy}")
    }
}

/// The first ray that made no sense, found by several threads.
pub(super) struct Senseless(AtomicUsize);

impl Senseless {
    pub(super) fn new() -> Self {
        Self(AtomicUsize::new(usize::MAX))
    }

    pub(super) fn add(&self, number: Option<usize>) {
        if let Some(number) = number {
            self.0.fetch_min(number, Ordering::Relaxed);
        }
    }

    pub(super) fn first(&self) -> Option<usize> {
        Some(self.0.load(Ordering::Relaxed)).filter(|&number| number != usize::MAX)
    }
}
