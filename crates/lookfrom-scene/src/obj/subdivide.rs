//! Polygons of a file as the cage of a subdivision surface.

use glam::Vec2;

use super::statement::{Corner, Face, Group, NONE, Statements};
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::model::weld::Weld;
use crate::subdivision::{self, Cage, Refined};

/// Replaces all faces by quadrilaterals on their limit surface after some levels, with normals. Those of all materials are one
/// surface. Faces whose positions are not finite stay, to be told of later.
pub(super) fn subdivide(
    statements: &mut Statements,
    levels: u32,
    file: &Location,
    context: &mut LoadContext<'_>,
) -> Result<()> {
    let (cage, sources) = cage(statements);
    if sources.is_empty() {
        return Ok(());
    }
    let _subdividing = subdivision::check(&cage, levels, file, context)?;
    let refined = cage.subdivided(levels);
    replace(statements, &refined, &sources);
    Ok(())
}

/// A face of the file: its group, line, smoothing group and object.
struct Source {
    group: usize,
    line: u32,
    smoothing: u32,
    object: u32,
}

/// Takes the faces out of the groups. The values of corners are texture coordinates, then colours.
fn cage(statements: &mut Statements) -> (Cage, Vec<Source>) {
    let Statements { positions, colors, uvs, groups, .. } = statements;
    let mut cage = Cage {
        positions: positions.iter().map(|position| position.as_dvec3()).collect(),
        width: 2 + if colors.is_empty() { 0 } else { 3 },
        ..Cage::default()
    };
    let mut sources = Vec::new();
    for (index, group) in groups.iter_mut().enumerate() {
        let Group { faces, corners, .. } = std::mem::take(group).without_lines(group);
        let mut start = 0;
        for face in faces {
            let own = &corners[start..start + face.corners as usize];
            start += face.corners as usize;
            if own.iter().any(|corner| !positions[corner.position as usize].is_finite()) {
                group.corners.extend(own);
                group.faces.push(face);
                continue;
            }
            // A corner at the same vertex as the one before it has no edge.
            let before = |i: usize| own[(i + own.len() - 1) % own.len()].position;
            let kept = || (0..own.len()).filter(|&i| own[i].position != before(i));
            if kept().count() < 3 {
                continue;
            }
            for Corner { position, uv, .. } in kept().map(|i| own[i]) {
                cage.corners.push(position);
                cage.values.extend(uvs.get(uv as usize).copied().unwrap_or(Vec2::ZERO).to_array());
                if !colors.is_empty() {
                    cage.values.extend(colors.get(position as usize).copied().unwrap_or([1.0; 3]));
                }
            }
            cage.end_face(sources.len() as u32);
            let Face { line, smoothing, object, .. } = face;
            sources.push(Source { group: index, line, smoothing, object });
        }
    }
    (cage, sources)
}

impl Group {
    /// Its faces and corners; all else goes back to `rest`.
    fn without_lines(self, rest: &mut Self) -> Self {
        let Self { material, object, lines, faces, corners } = self;
        *rest = Self { material, object, lines, ..Self::default() };
        Self { faces, corners, ..Self::default() }
    }
}

fn replace(statements: &mut Statements, refined: &Refined, sources: &[Source]) {
    let width = refined.values.len() / refined.corners.len();
    let (first_position, first_normal) = (statements.positions.len() as u32, statements.normals.len() as u32);
    let has_uvs = !statements.uvs.is_empty();
    let first_uv = statements.uvs.len() as u32;
    let mut weld = Weld::new();
    if !statements.colors.is_empty() {
        statements.colors.resize(statements.positions.len(), [1.0; 3]);
        statements.colors.resize(statements.positions.len() + refined.positions.len(), [1.0; 3]);
    }
    for (index, corners) in refined.corners.chunks_exact(4).enumerate() {
        let Source { group, line, smoothing, object } = sources[refined.tags[index] as usize];
        let group = &mut statements.groups[group];
        group.faces.push(Face { corners: 4, line, smoothing, object });
        for (k, &vertex) in corners.iter().enumerate() {
            let values = &refined.values[(4 * index + k) * width..][..width];
            let uv = match has_uvs {
                true => first_uv + weld.id([values[0].to_bits(), values[1].to_bits()]),
                false => NONE,
            };
            group.corners.push(Corner {
                position: first_position + vertex,
                uv,
                normal: first_normal + vertex,
            });
            if let [_, _, r, g, b] = *values {
                statements.colors[(first_position + vertex) as usize] = [r, g, b];
            }
        }
    }
    statements.uvs.extend(weld.keys().iter().map(|key| Vec2::from(key.map(f32::from_bits))));
    statements.positions.extend(&refined.positions);
    statements.normals.extend(&refined.normals);
}
