//! Labels as arrays.

use lookfrom::render::{Label, Renderer};
use lookfrom::world::Objects;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Arrays of what is seen at the middle of each pixel, row by row; -1 and NaN where nothing is.
pub(super) fn arrays<'py>(
    py: Python<'py>,
    labels: &[Label],
    objects: &Objects,
) -> PyResult<Bound<'py, PyDict>> {
    let ids = |id: &dyn Fn(&Label) -> u32| -> Bound<'py, PyArray1<i32>> {
        let number = |label: &Label| match id(label) {
            Label::NONE => -1,
            id => id as i32,
        };
        labels.iter().map(number).collect::<Vec<_>>().into_pyarray(py)
    };
    let object = |&Label { shape, primitive, instance, .. }: &Label| match shape {
        Label::NONE => Label::NONE,
        _ => objects.of(shape, primitive, (instance != Label::NONE).then_some(instance)),
    };
    let dict = PyDict::new(py);
    dict.set_item("object", ids(&object))?;
    dict.set_item("shape", ids(&|label| label.shape))?;
    dict.set_item("instance", ids(&|label| label.instance))?;
    dict.set_item("material", ids(&|label| label.material))?;
    dict.set_item("primitive", ids(&|label| label.primitive))?;
    let points: Vec<f64> = labels.iter().flat_map(|label| label.point.to_array()).collect();
    dict.set_item("position", points.into_pyarray(py))?;
    let normals: Vec<f32> = labels.iter().flat_map(|label| label.n.to_array()).collect();
    dict.set_item("normal", normals.into_pyarray(py))?;
    Ok(dict)
}

/// Names of shapes, materials and objects, by index.
pub(super) fn names(renderer: &Renderer) -> [Vec<String>; 3] {
    let names = renderer.world().names();
    let shapes = names.shapes.iter().map(ToString::to_string).collect();
    [shapes, names.materials.clone(), renderer.world().objects().names().to_vec()]
}
