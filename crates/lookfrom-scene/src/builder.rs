//! Scenes made by code: materials, shapes, lights and a camera, added one by one.

use glam::DVec3;

use crate::camera::{Camera, Projection, View, up_across};
use crate::composite;
use crate::error::Location;
use crate::light::{Light, LightKind, Power};
use crate::material::{Material, MaterialKind};
use crate::scene::{MaterialId, MeshId, Scene, TextureId};
use crate::settings::Integrator;
use crate::shape::{Geometry, Mesh, Shape, Sphere};
use crate::texture::{Texture, TextureKind};

/// Scenes made by code. Methods that add what others refer to return its id; the others return the scene, so that calls can
/// be chained. Everything is a public field, too: what has no method here is set there.
///
/// ```
/// use lookfrom_scene::Scene;
/// use lookfrom_scene::light::LightKind;
/// use lookfrom_scene::material::{Color, MaterialKind};
///
/// let mut scene = Scene::new();
/// let clay = scene.material("clay", MaterialKind::Diffuse { reflectance: Color::Value([0.7, 0.3, 0.2]) });
/// scene
///     .sphere([0.0, 1.0, 0.0], 1.0, clay)
///     .light(LightKind::Distant { direction: [-1.0, -2.0, -1.0].into(), intensity: Color::gray(1.0) })
///     .look([0.0, 2.0, 6.0], [0.0, 1.0, 0.0], 40.0);
/// scene.validate()?;
/// # Ok::<(), lookfrom_scene::Error>(())
/// ```
impl Scene {
    /// A scene of nothing, with default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a material with a name, for reports, and without bump mapping.
    pub fn material(&mut self, name: impl Into<String>, kind: MaterialKind) -> MaterialId {
        self.materials.push(Material::new(name, Location::default(), kind));
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture with a name, for reports.
    pub fn texture(&mut self, name: impl Into<String>, kind: TextureKind) -> TextureId {
        self.textures.push(Texture { name: name.into(), at: Location::default(), kind });
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a mesh, which is visible where shapes are made of it: [`Scene::shape`] with [`Geometry::Mesh`].
    pub fn mesh(&mut self, mesh: Mesh) -> MeshId {
        self.meshes.push(mesh);
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// Adds a geometry with a material, and returns the shape: it can be given a name, a transform or an emission.
    ///
    /// ```
    /// # use lookfrom_scene::Scene;
    /// # use lookfrom_scene::material::{Color, MaterialKind};
    /// use lookfrom_scene::shape::{Emission, Geometry, Sphere};
    /// # let mut scene = Scene::new();
    /// # let black = scene.material("black", MaterialKind::Diffuse { reflectance: Color::BLACK });
    /// let bulb = Geometry::Sphere(Sphere { center: [0.0, 3.0, 0.0].into(), radius: 0.1 });
    /// scene.shape(bulb, black).emission = Some(Emission::new(Color::gray(100.0), false));
    /// ```
    pub fn shape(&mut self, geometry: Geometry, material: MaterialId) -> &mut Shape {
        let index = self.shapes.len();
        self.shapes.push(Shape::new(Location::default(), geometry, material));
        &mut self.shapes[index]
    }

    /// Adds a sphere.
    pub fn sphere(&mut self, center: impl Into<DVec3>, radius: f64, material: MaterialId) -> &mut Self {
        self.shape(Geometry::Sphere(Sphere { center: center.into(), radius }), material);
        self
    }

    /// Adds the parallelogram with a corner and two edges; its normal is along `edge_u × edge_v`.
    pub fn quad(
        &mut self,
        corner: impl Into<DVec3>,
        edge_u: impl Into<DVec3>,
        edge_v: impl Into<DVec3>,
        material: MaterialId,
    ) -> &mut Self {
        let (corner, edge_u, edge_v) = (corner.into(), edge_u.into(), edge_v.into());
        self.shape(Geometry::Quad { corner, edge_u, edge_v }, material);
        self
    }

    /// Adds the box along the axes between two opposite corners, in either order.
    pub fn cuboid(&mut self, a: impl Into<DVec3>, b: impl Into<DVec3>, material: MaterialId) -> &mut Self {
        let (a, b) = (a.into(), b.into());
        // Not by minimum and maximum, which drop what is not a number: validation has to see it.
        let is_sorted = a.cmple(b);
        let (min, max) = (DVec3::select(is_sorted, a, b), DVec3::select(is_sorted, b, a));
        let mesh = self.mesh(composite::cuboid(min, max));
        self.shape(Geometry::Mesh(mesh), material);
        self
    }

    /// Adds a light, as bright as it is written. Area lights are shapes with an emission.
    pub fn light(&mut self, kind: LightKind) -> &mut Self {
        self.lights.push(Light { name: None, at: Location::default(), kind, power: Power::AS_WRITTEN });
        self
    }

    /// Sets the camera: a pinhole that looks from one point to another, with a vertical field of view of `fov` degrees.
    pub fn look(&mut self, lookfrom: impl Into<DVec3>, lookat: impl Into<DVec3>, fov: f64) -> &mut Self {
        let (lookfrom, lookat) = (lookfrom.into(), lookat.into());
        let view = View::Look { lookfrom, lookat, up: up_across(lookat - lookfrom) };
        self.camera = Some(Camera { view, projection: Projection::Perspective { fov }, ..Camera::default() });
        self
    }

    /// Sets the size of the picture, in pixels.
    pub fn size(&mut self, width: u32, height: u32) -> &mut Self {
        self.image.resize(width, height);
        self
    }

    /// Sets the integrator, and the number of samples for each pixel.
    pub fn integrator(&mut self, integrator: Integrator, samples: u32) -> &mut Self {
        (self.render.integrator, self.render.samples) = (integrator, samples);
        self
    }
}
