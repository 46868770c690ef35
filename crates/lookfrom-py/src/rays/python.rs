//! The class `Tree` of the compiled module, which `lookfrom.Bvh` wraps.

use std::sync::{Arc, PoisonError, RwLock};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyIndexError, PyTypeError};
use pyo3::prelude::*;

use super::arguments::{Item, RaysArgument, parts_and_instances, quality};
use super::geometry::{Geometry, Masks, Part};
use super::point_queries::{self, HitsArgument};
use super::queries;
use super::tree;
use crate::arrays::Vectors;
use crate::error::Error;
use crate::parallel::in_pool;

/// Below this number of primitives a tree is built on the calling thread.
const FEW: usize = 4096;

/// A tree and its geometry. Queries share it; a refit waits for them.
#[pyclass(frozen, name = "Tree", module = "lookfrom._lookfrom")]
pub(crate) struct PyTree(RwLock<Arc<tree::Tree>>);

impl PyTree {
    /// The tree as it is now. Waits for a refit without the GIL.
    pub(super) fn get(&self, py: Python<'_>) -> Arc<tree::Tree> {
        py.detach(|| self.0.read().unwrap_or_else(PoisonError::into_inner).clone())
    }
}

#[pymethods]
impl PyTree {
    #[new]
    fn new(py: Python<'_>, items: Vec<Item<'_>>, quality: &str, threads: usize) -> PyResult<Self> {
        let (parts, instances) = parts_and_instances(&items)?;
        let quality = self::quality(quality)?;
        let count = parts.iter().map(|part| part.geometry.len()).sum::<usize>() + instances.len();
        let build = || tree::Tree::build(parts, instances, quality);
        let built = if count < FEW { py.detach(build) } else { in_pool(py, threads, build) };
        let built = built.map_err(|error| Error::new_err(error.to_string()))?;
        Ok(Self(RwLock::new(Arc::new(built))))
    }

    /// Another tree that shares everything with this one, until either is refitted.
    fn clone(&self, py: Python<'_>) -> Self {
        Self(RwLock::new(self.get(py)))
    }

    fn closest_hits<'py>(&self, py: Python<'py>, rays: RaysArgument<'_>) -> PyResult<Bound<'py, PyAny>> {
        queries::closest_hits(py, &self.get(py), &rays)?.into_bound_py_any(py)
    }

    fn closest_primitives<'py>(
        &self,
        py: Python<'py>,
        rays: RaysArgument<'_>,
    ) -> PyResult<Bound<'py, PyArray1<i32>>> {
        queries::closest_primitives(py, &self.get(py), &rays)
    }

    fn occluded<'py>(&self, py: Python<'py>, rays: RaysArgument<'_>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        queries::occluded(py, &self.get(py), &rays)
    }

    fn count_hits<'py>(
        &self,
        py: Python<'py>,
        rays: RaysArgument<'_>,
        crossings: bool,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        queries::count_hits(py, &self.get(py), &rays, crossings)
    }

    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: RaysArgument<'_>,
        crossings: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        queries::all_hits(py, &self.get(py), &rays, crossings)?.into_bound_py_any(py)
    }

    fn points_and_normals<'py>(
        &self,
        py: Python<'py>,
        hits: HitsArgument<'_>,
        threads: usize,
    ) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
        point_queries::points_and_normals(py, &self.get(py), &hits, threads)
    }

    fn contains<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        point_queries::contains(py, &self.get(py), &points, threads)
    }

    fn winding_numbers<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        point_queries::winding_numbers(py, &self.get(py), &points, threads)
    }

    fn closest_points<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        max_distance: f64,
        threads: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        point_queries::closest_points(py, &self.get(py), &points, max_distance, threads)?
            .into_bound_py_any(py)
    }

    /// Moves a geometry: new vertices, or new centres and radii.
    fn refit(
        &self,
        py: Python<'_>,
        geometry: usize,
        points: Vectors<'_>,
        radii: Option<PyReadonlyArray1<'_, f64>>,
        threads: usize,
    ) -> PyResult<()> {
        let points = points.rows()?.to_vec()?;
        let radii = radii.map(|radii| radii.as_array().to_vec());
        let refit = || {
            let mut tree = self.0.write().unwrap_or_else(PoisonError::into_inner);
            let Some(part) = tree.parts.get(geometry) else { return Err(None) };
            let moved = match (&part.geometry, radii) {
                (Geometry::Triangles { vertices, faces }, None) if vertices.len() == points.len() => {
                    Geometry::Triangles { vertices: points, faces: faces.clone() }
                }
                (Geometry::Spheres { centers, .. }, Some(radii))
                    if centers.len() == points.len() && radii.len() == points.len() =>
                {
                    Geometry::Spheres { centers: points, radii }
                }
                _ => return Err(None),
            };
            tree.refit(geometry, moved).map_err(Some)
        };
        in_pool(py, threads, refit).map_err(|error| match error {
            Some(error) => Error::new_err(error.to_string()),
            None => PyTypeError::new_err("no geometry of this kind and number of primitives"),
        })
    }

    /// A geometry as it was given: vertices, faces and masks, or centres, radii and masks.
    fn geometry<'py>(&self, py: Python<'py>, number: usize) -> PyResult<Bound<'py, PyAny>> {
        let tree = self.get(py);
        let part = tree.parts.get(number).ok_or_else(|| PyIndexError::new_err(number))?;
        let masks = match &part.masks {
            Masks::Everyone => py.None().into_bound(py),
            Masks::OfAll(mask) => mask.into_bound_py_any(py)?,
            Masks::OfEach(masks) => masks.clone().into_pyarray(py).into_any(),
        };
        let rows = |rows: &[[f64; 3]]| rows.as_flattened().to_vec().into_pyarray(py).reshape([rows.len(), 3]);
        match &part.geometry {
            Geometry::Triangles { vertices, faces } => {
                let flat = faces.as_flattened().to_vec().into_pyarray(py);
                (rows(vertices)?, flat.reshape([faces.len(), 3])?, masks).into_bound_py_any(py)
            }
            Geometry::Spheres { centers, radii } => {
                (rows(centers)?, radii.clone().into_pyarray(py), masks).into_bound_py_any(py)
            }
        }
    }

    /// For each geometry: whether it has spheres, the number of its vertices or centres, and that of its primitives.
    #[getter]
    fn shapes(&self, py: Python<'_>) -> Vec<(bool, usize, usize)> {
        let tree = self.get(py);
        let shape = |part: &Part| match &part.geometry {
            Geometry::Triangles { vertices, faces } => (false, vertices.len(), faces.len()),
            Geometry::Spheres { centers, .. } => (true, centers.len(), centers.len()),
        };
        tree.parts.iter().map(shape).collect()
    }

    /// True if each edge of the triangles belongs to an even number of them.
    fn is_closed(&self, py: Python<'_>) -> bool {
        let tree = self.get(py);
        py.detach(|| matches!(tree.boundary(), super::inside::Boundary::Closed))
    }

    /// The least and the greatest coordinates; `None` if there is nothing.
    #[getter]
    fn bounds(&self, py: Python<'_>) -> Option<[[f64; 3]; 2]> {
        self.get(py).bounds().map(|bounds| [bounds.min, bounds.max])
    }

    /// Numbers of triangles, spheres and instances that rays can hit, of primitives that none can, and memory in bytes.
    #[getter]
    fn statistics(&self, py: Python<'_>) -> [usize; 5] {
        let tree = self.get(py);
        let counts = tree.bvh.statistics();
        [counts.triangles, counts.spheres, counts.instances, counts.left_out, tree.memory()]
    }
}
