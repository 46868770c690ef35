//! Attributes of meshes.

use super::*;

const ATTRIBUTES: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property float heat_0\nelement face 2\nproperty list uchar int vertex_indices\nproperty float color_0\n\
    property float color_1\nproperty float color_2\nend_header\n0 0 0 0.25\n1 0 0 0.5\n0 1 0 0.75\n1 1 0 1\n\
    3 0 1 2 1 0 0\n3 1 3 2 0 0.5 0\n";

fn of(bsdf: &str) -> Result<Scene> {
    let text = format!(
        "<scene version=\"3.0.0\">\n<shape type=\"ply\"><string name=\"filename\" value=\"m.ply\"/>{bsdf}</shape>\n</scene>"
    );
    read_of(&files(&[("s/a.xml", &text), ("s/m.ply", ATTRIBUTES)]), &[]).0
}

#[test]
fn attributes_of_meshes_are_their_colours() {
    let diffuse = |name: &str| {
        of(&format!(
            "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"mesh_attribute\"><string name=\"name\" value=\"{name}\"/></texture></bsdf>"
        ))
    };
    let read = diffuse("vertex_heat").expect("a scene");
    assert_eq!(read.meshes[0].colors, [[0.25; 3], [0.5; 3], [0.75; 3], [1.0; 3]]);
    let read = diffuse("face_color").expect("a scene");
    let colors = read.meshes[0].triangles[1].map(|corner| read.meshes[0].colors[corner as usize]);
    assert_eq!((read.meshes[0].positions.len(), colors), (6, [[0.0, 0.5, 0.0]; 3]));
    let missing = diffuse("vertex_color").expect_err("no such attribute");
    assert_eq!((missing.kind, missing.at.line), (ErrorKind::Invalid, 2));
    assert!(diffuse("color").expect_err("of nothing").message.starts_with("`name` has to be"));
}

/// The value of a texture at a vertex.
fn value(scene: &Scene, color: Color, vertex: usize) -> [f32; 3] {
    let mesh = &scene.meshes[0];
    match color {
        Color::Value(rgb) => rgb,
        Color::Curve(_) => panic!("a curve"),
        Color::Texture(id) => match &scene.textures[id.index()].kind {
            TextureKind::VertexColor { tint } => std::array::from_fn(|c| tint[c] * mesh.colors[vertex][c]),
            TextureKind::Bilinear { corners: [c00, c01, c10, c11], mapping: Mapping::Affine { set, .. } } => {
                let uv = mesh.more_uvs[*set as usize - 1][vertex];
                let [c00, c01, c10, c11] = [c00, c01, c10, c11].map(|corner| value(scene, *corner, vertex));
                std::array::from_fn(|c| {
                    let low = c00[c] * (1.0 - uv.x) + c10[c] * uv.x;
                    let high = c01[c] * (1.0 - uv.x) + c11[c] * uv.x;
                    low * (1.0 - uv.y) + high * uv.y
                })
            }
            TextureKind::Mix { low, high, amount: Scalar::Value(0.5) } => {
                let [low, high] = [low, high].map(|color| value(scene, *color, vertex));
                std::array::from_fn(|c| 0.5 * (low[c] + high[c]))
            }
            other => panic!("{other:?}"),
        },
    }
}

#[test]
fn a_surface_has_several_attributes() {
    let texture = |property: &str, name: &str| {
        format!(
            "<texture name=\"{property}\" type=\"mesh_attribute\"><string name=\"name\" value=\"{name}\"/></texture>"
        )
    };
    for names in [["vertex_heat", "face_color"], ["face_color", "vertex_heat"]] {
        let read = of(&format!(
            "<bsdf type=\"principled\">{}{}</bsdf>",
            texture("base_color", names[0]),
            texture("roughness", names[1])
        ))
        .expect("a scene");
        let MaterialKind::Disney(look) = &read.materials[read.shapes[0].material.index()].kind else {
            panic!("{:?}", read.materials)
        };
        let colors = [look.base_color, look.roughness.into()];
        let mesh = &read.meshes[0];
        assert_eq!(mesh.positions.len(), 6);
        for (triangle, color) in mesh.triangles.iter().zip([[1.0, 0.0, 0.0], [0.0, 0.5, 0.0]]) {
            for vertex in triangle.map(|vertex| vertex as usize) {
                let heat = 0.25 + 0.25 * (mesh.positions[vertex].x + 2.0 * mesh.positions[vertex].y);
                for (found, name) in colors.iter().zip(names) {
                    let expected = if name == "vertex_heat" { [heat; 3] } else { color };
                    assert_eq!(value(&read, *found, vertex), expected, "{name} {vertex}");
                }
            }
        }
        // Normals of vertices are those of the mesh as it was.
        assert!(mesh.normals.iter().all(|normal| *normal == glam::Vec3::Z));
    }
}
