//! The objects of `info --json`, described in docs/guide/command.md.

use std::collections::BTreeMap;
use std::path::Path;

use lookfrom::session::{SceneInfo, Session};
use lookfrom_scene::WarningKind;
use lookfrom_scene::camera::{Camera, Projection, View};
use lookfrom_scene::contents::{AnimationEntry, CameraEntry, Contents};
use lookfrom_scene::count::Counts;
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::watertight::Watertightness;
use serde::Serialize;

use super::{Tree, tree};
use crate::{exit, report};

/// Contents and settings of a scene, and statistics of its BVH.
#[derive(Serialize)]
pub(super) struct Object<'a> {
    scene: String,
    #[serde(flatten)]
    counts: &'a Counts,
    /// Those of Cryptomattes and labels.
    names: Vec<String>,
    bounds: Option<BoundsObject>,
    /// Of its meshes, if it has any.
    watertight: Option<WatertightObject>,
    scenes: Vec<SceneObject<'a>>,
    animations: Vec<AnimationObject<'a>>,
    duration: Option<f64>,
    variants: &'a [Option<String>],
    variables: BTreeMap<&'a str, &'a str>,
    cameras: Vec<CameraEntryObject<'a>>,
    camera: CameraObject,
    image: ImageObject,
    render: RenderObject,
    bvh: Tree,
    seconds: SecondsObject,
    added: &'a [&'static str],
    warnings: Vec<String>,
    notices: Vec<String>,
}

#[derive(Serialize)]
struct WatertightObject {
    is_closed: bool,
    #[serde(flatten)]
    found: Watertightness,
}

impl WatertightObject {
    fn new(found: Watertightness) -> Self {
        Self { is_closed: found.is_closed(), found }
    }
}

#[derive(Serialize)]
struct BoundsObject {
    min: [f64; 3],
    max: [f64; 3],
}

#[derive(Serialize)]
struct SceneObject<'a> {
    name: Option<&'a str>,
    /// Whether this is the scene that the rest of the object describes.
    shown: bool,
}

#[derive(Serialize)]
struct AnimationObject<'a> {
    name: Option<&'a str>,
    seconds: Option<f64>,
}

#[derive(Serialize)]
struct CameraEntryObject<'a> {
    name: Option<&'a str>,
    #[serde(flatten)]
    projection: Option<ProjectionObject>,
}

/// A projection in the words of our scene format.
#[derive(Serialize)]
struct ProjectionObject {
    projection: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    fov: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<f64>,
    /// The name of the shapes whose irradiance is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    surface: Option<String>,
}

#[derive(Serialize)]
struct CameraObject {
    #[serde(flatten)]
    view: ViewObject,
    #[serde(flatten)]
    projection: ProjectionObject,
    #[serde(skip_serializing_if = "Option::is_none")]
    lens_radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    focus_distance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lens: Option<LensObject>,
}

/// A lens system; lengths in units of the world.
#[derive(Serialize)]
struct LensObject {
    file: String,
    surfaces: usize,
    aperture: String,
    film_diagonal: f64,
    focal_length: f64,
    f_number: f64,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ViewObject {
    Look { lookfrom: [f64; 3], lookat: [f64; 3], up: [f64; 3] },
    Matrix { matrix_by_columns: [f64; 16] },
}

#[derive(Serialize)]
struct ImageObject {
    width: u32,
    height: u32,
    crop: Option<[u32; 4]>,
    filter: String,
    exposure: f32,
    tonemap: &'static str,
    denoise: bool,
}

#[derive(Serialize)]
struct RenderObject {
    integrator: &'static str,
    samples: u32,
    depth: u32,
    min_contribution: f32,
    sampler: &'static str,
    seed: u64,
    transparent_shadows: bool,
    open_fronts: bool,
}

#[derive(Serialize)]
struct SecondsObject {
    read: f64,
    build: f64,
}

impl<'a> Object<'a> {
    /// The description of a session's scene.
    pub(super) fn new(path: &Path, session: &'a Session) -> Self {
        let SceneInfo { counts, contents, bounds, added, read, build } = session.info();
        Self {
            scene: path.display().to_string(),
            counts,
            names: session.world().objects().names().to_vec(),
            bounds: (!bounds.is_empty()).then(|| bounds.into()),
            watertight: session.scene().and_then(Watertightness::of).map(WatertightObject::new),
            scenes: scenes(contents),
            animations: contents.animations.iter().map(Into::into).collect(),
            duration: contents.duration,
            variants: &contents.variants,
            variables: contents
                .variables
                .iter()
                .map(|(name, value)| (name.as_str(), value.as_str()))
                .collect(),
            cameras: contents.cameras.iter().map(Into::into).collect(),
            camera: CameraObject { lens: lens(session), ..session.camera().into() },
            image: session.image().into(),
            render: session.settings().into(),
            bvh: tree(session),
            seconds: SecondsObject { read: report::seconds(*read), build: report::seconds(*build) },
            added,
            warnings: exit::lines(session.warnings(), WarningKind::Warning),
            notices: exit::lines(session.warnings(), WarningKind::Notice),
        }
    }
}

fn scenes(contents: &Contents) -> Vec<SceneObject<'_>> {
    let names = contents.scenes.iter().map(Option::as_deref).enumerate();
    names.map(|(number, name)| SceneObject { name, shown: contents.scene == Some(number) }).collect()
}

impl From<&Bounds> for BoundsObject {
    fn from(bounds: &Bounds) -> Self {
        Self { min: bounds.min.to_array(), max: bounds.max.to_array() }
    }
}

impl<'a> From<&'a AnimationEntry> for AnimationObject<'a> {
    fn from(entry: &'a AnimationEntry) -> Self {
        Self { name: entry.name.as_deref(), seconds: entry.duration }
    }
}

impl<'a> From<&'a CameraEntry> for CameraEntryObject<'a> {
    fn from(entry: &'a CameraEntry) -> Self {
        Self { name: entry.name.as_deref(), projection: entry.projection.as_ref().map(Into::into) }
    }
}

impl From<&Projection> for ProjectionObject {
    fn from(written: &Projection) -> Self {
        let (projection, fov, height) = match *written {
            Projection::Perspective { fov } => ("perspective", Some(fov), None),
            Projection::Orthographic { height } => ("orthographic", None, Some(height)),
            Projection::LensSystem(_) => ("lens", None, None),
            Projection::Equirectangular | Projection::EquirectangularPbrt => ("equirectangular", None, None),
            Projection::Octahedral => ("octahedral", None, None),
            Projection::Irradiance { .. } => ("irradiance", None, None),
        };
        let surface = match &written {
            Projection::Irradiance { surface } => Some(surface.clone()),
            _ => None,
        };
        Self { projection, fov, height, surface }
    }
}

impl From<&Camera> for CameraObject {
    fn from(camera: &Camera) -> Self {
        let view = match camera.view {
            View::Look { lookfrom, lookat, up } => ViewObject::Look {
                lookfrom: lookfrom.to_array(),
                lookat: lookat.to_array(),
                up: up.to_array(),
            },
            View::Matrix(matrix) => ViewObject::Matrix { matrix_by_columns: matrix.to_cols_array() },
        };
        Self {
            view,
            projection: (&camera.projection).into(),
            lens_radius: camera.lens.map(|lens| lens.radius),
            focus_distance: camera.focus_distance(),
            lens: None,
        }
    }
}

fn lens(session: &Session) -> Option<LensObject> {
    let camera = session.renderer().view().camera();
    let (Projection::LensSystem(written), Some(system)) = (&camera.projection, &camera.lens_system) else {
        return None;
    };
    Some(LensObject {
        file: written.name.clone(),
        surfaces: written.surfaces.len(),
        aperture: written.shape.name().to_owned(),
        film_diagonal: 2.0 * system.film_radius(),
        focal_length: system.focal_length(),
        f_number: system.f_number(),
    })
}

impl From<&ImageSettings> for ImageObject {
    fn from(image: &ImageSettings) -> Self {
        Self {
            width: image.width,
            height: image.height,
            crop: image.crop.map(|crop| [crop.x0, crop.y0, crop.x1, crop.y1]),
            filter: image.filter.to_string(),
            exposure: image.exposure,
            tonemap: image.tonemap.word(),
            denoise: image.denoise,
        }
    }
}

impl From<&RenderSettings> for RenderObject {
    fn from(render: &RenderSettings) -> Self {
        Self {
            integrator: render.integrator.word(),
            samples: render.samples,
            depth: render.depth,
            min_contribution: render.min_contribution,
            sampler: render.sampler.word(),
            seed: render.seed,
            transparent_shadows: render.transparent_shadows,
            open_fronts: render.open_fronts,
        }
    }
}
