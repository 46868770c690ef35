//! Morph targets: vertices displaced by weighted sums (specification, §3.7.2.2).

use std::collections::BTreeMap;

use super::file::Document;
use super::json::Whole;
use super::mesh::Vertices;
use crate::error::Result;

/// Adds a primitive's morph target displacements, times their weights. Targets without a weight are not read, and
/// displacements of attributes that the primitive does not have are ignored.
///
/// # Errors
/// If displacements cannot be read, or there is not one per vertex.
pub(super) fn morph(
    document: &Document,
    targets: &[BTreeMap<String, Whole>],
    weights: &[f64],
    pointer: &str,
    vertices: &mut Vertices,
) -> Result<()> {
    for (place, (target, &weight)) in targets.iter().zip(weights).enumerate() {
        if !weight.is_finite() || weight == 0.0 {
            continue;
        }
        for (name, &accessor) in target {
            let asked = format!("{pointer}/targets/{place}/{name}");
            let read = |count: usize| {
                let vectors = document.vectors::<3>(accessor, &asked)?;
                check_count(document, vectors.len(), count, &asked).map(|()| vectors)
            };
            match name.as_str() {
                "POSITION" => {
                    let steps = read(vertices.positions.len())?;
                    add(vertices.positions.iter_mut().map(AsMut::as_mut), &steps, weight);
                }
                "NORMAL" if !vertices.normals.is_empty() => {
                    let steps = read(vertices.normals.len())?;
                    add(vertices.normals.iter_mut().map(AsMut::as_mut), &steps, weight);
                }
                "TANGENT" if !vertices.tangents.is_empty() => {
                    let steps = read(vertices.tangents.len())?;
                    // w, the handedness, stays.
                    let directions = vertices.tangents.iter_mut().map(|tangent| {
                        let [x, y, z, _] = tangent.as_mut();
                        [x, y, z]
                    });
                    for (direction, step) in directions.zip(&steps) {
                        for (number, &step) in direction.into_iter().zip(step) {
                            *number = moved(*number, step, weight);
                        }
                    }
                }
                "COLOR_0" if !vertices.colors.is_empty() => {
                    colors(document, accessor, weight, &asked, vertices)?;
                }
                _ => {
                    let set = name.strip_prefix("TEXCOORD_").and_then(|set| set.parse::<usize>().ok());
                    let Some(uvs) = set.and_then(|set| vertices.uvs.get_mut(set)) else { continue };
                    if uvs.is_empty() {
                        continue;
                    }
                    let mut steps = document.vectors::<2>(accessor, &asked)?;
                    check_count(document, steps.len(), uvs.len(), &asked)?;
                    // v runs down in glTF and up here.
                    steps.iter_mut().for_each(|[_, v]| *v = -*v);
                    add(uvs.iter_mut().map(AsMut::as_mut), &steps, weight);
                }
            }
        }
    }
    for normal in &mut vertices.normals {
        *normal = normal.normalize_or_zero();
    }
    Ok(())
}

/// Adds displacements of colours and, where they have a fourth component, of opacities; both are clamped to [0, 1].
fn colors(
    document: &Document,
    accessor: Whole,
    weight: f64,
    asked: &str,
    vertices: &mut Vertices,
) -> Result<()> {
    let steps = match document.shape(accessor, asked)?.0 {
        4 => document.vectors::<4>(accessor, asked)?,
        _ => document.vectors::<3>(accessor, asked)?.into_iter().map(|[r, g, b]| [r, g, b, 0.0]).collect(),
    };
    check_count(document, steps.len(), vertices.colors.len(), asked)?;
    let fit = |number: f32| if number > 0.0 { number.min(1.0) } else { 0.0 };
    for (color, &[r, g, b, _]) in vertices.colors.iter_mut().zip(&steps) {
        for (number, step) in color.iter_mut().zip([r, g, b]) {
            *number = fit(moved(*number, step, weight));
        }
    }
    for (opacity, &[_, _, _, step]) in vertices.opacities.iter_mut().zip(&steps) {
        *opacity = fit(moved(*opacity, step, weight));
    }
    Ok(())
}

/// Adds to each vector its displacement times the weight.
fn add<'v, const N: usize>(vectors: impl Iterator<Item = &'v mut [f32; N]>, steps: &[[f32; N]], weight: f64) {
    for (vector, step) in vectors.zip(steps) {
        for (number, &step) in vector.iter_mut().zip(step) {
            *number = moved(*number, step, weight);
        }
    }
}

fn moved(number: f32, step: f32, weight: f64) -> f32 {
    (f64::from(number) + weight * f64::from(step)) as f32
}

fn check_count(document: &Document, found: usize, expected: usize, pointer: &str) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    let message = format!(
        "{} for {}: there must be one for each",
        crate::plural::counted(found, "displacement"),
        crate::plural::counted(expected, "vertex")
    );
    Err(document.invalid(pointer, message).hint("the file was written wrongly: export it again"))
}
