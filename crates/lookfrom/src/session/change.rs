//! Changes of a session's camera, image and render settings, for which no scene is read and no tree is built, unless the camera goes
//! far away.

use std::sync::Arc;

use lookfrom_scene::camera::Camera;
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::{CameraChoice, ImportOptions, Result};

use super::options::unsuitable;
use super::prepare::settle_limits;
use super::{Exposure, Fireflies, Options, Session, Turning, seeing_backs};
use crate::integrator::Integrator;
use crate::render::StopCriteria;
use crate::view::View;

impl Session {
    /// Changes what options give: size, samples and how they are taken, camera, development, stop criteria. What they leave open stays
    /// as it is. The picture is that of a session with all of these options, with two exceptions: the world stays where the first
    /// camera was, so that another camera's picture may round differently; and the light of a studio stays, whatever is up.
    ///
    /// ```no_run
    /// use lookfrom::session::{Options, Session};
    ///
    /// let mut session = Session::open("scene.toml", &Options::default())?;
    /// for x in 0..10 {
    ///     session.change(&Options { lookfrom: Some((f64::from(x), 1.0, 5.0).into()), ..Options::default() })?;
    ///     session.render(&())?.save(format!("{x}.png"))?;
    /// }
    /// # Ok::<(), lookfrom::scene::Error>(())
    /// ```
    ///
    /// # Errors
    /// `Request` for options that need the scene read again ([`Options::of_scene`]), or do not suit it; as [`Session::set_camera`],
    /// [`Session::set_image`] and [`Session::set_settings`]. Then nothing has changed.
    pub fn change(&mut self, options: &Options) -> Result<()> {
        if let Some(option) = options.of_scene() {
            return Err(unsuitable(format!("{option} needs the scene read again: make a new session")));
        }
        let mut changed = self.clone();
        let (mut image, mut settings) = (self.image().clone(), self.settings().clone());
        options.check_numbers()?;
        options.apply_to_settings(&mut image, &mut settings)?;
        settle_limits(&mut settings, options);
        let StopCriteria { time, noise } = options.stop;
        changed.stop = StopCriteria { time: time.or(self.stop.time), noise: noise.or(self.stop.noise) };
        let range = options.range(&settings)?;
        if options.samples.is_some() || options.part.is_some() || options.first_sample != 0 {
            changed.first_sample = range.start;
            settings.samples = range.end;
        }
        if options.fireflies != Fireflies::Keep {
            changed.fireflies = options.fireflies;
        }
        if options.threads.is_some() {
            changed.threads = options.threads;
        }
        if options.format.is_some() {
            changed.format = options.format;
        }
        if !changed.has_room_for_layers() {
            image = image.without_layers();
        }
        match options.integrator {
            Some(_) => changed.set_settings(settings)?,
            None => changed.set_settings_of_same_integrator(settings)?,
        }
        changed.set_image(image)?;
        if let Some(degrees) = options.turn {
            changed.set_turn(degrees)?;
        }
        let mut camera: Camera = changed.camera().clone();
        if options.apply_to_camera(&mut camera, self.info.bounds.center())? {
            changed.set_camera(camera)?;
        }
        if options.exposure == Some(Exposure::Auto) {
            changed.expose()?;
        }
        *self = changed;
        Ok(())
    }

    /// Changes the camera. Nothing is read or built again, unless the camera is so far from the origin of render space,
    /// and so near to a surface, that the world would not be precise there ([`World::is_precise_from`](crate::world::World::is_precise_from)): then the scene
    /// that is kept ([`Options::keep_scene`]), with all its changes, or else the scene read again, is built around that camera.
    ///
    /// # Errors
    /// `Invalid` for a degenerate camera; `Request` where the world is not precise from there and the scene is not kept and cannot be
    /// read again, because the session was made of a scene or through [`Session::read`]; `Limit` where there is no memory for a second
    /// world ([`Options::budget`]), until the first is gone. Then nothing has changed.
    pub fn set_camera(&mut self, camera: Camera) -> Result<()> {
        let view = View::new(&camera, self.image().clone())?;
        let eye = view.camera().lookfrom();
        self.renderer = match self.world().is_precise_from(eye) {
            true => self.renderer.with_view(view)?,
            false => {
                let (mut world, memory) = self.world_around(&camera)?;
                if let Some(turning) = &self.turntable {
                    world = world.with_surroundings_turned(&turning.rotation());
                }
                let (renderer, _) = seeing_backs(self.renderer.with_world(Arc::new(world), view)?)?;
                self.memory = Arc::new(memory);
                renderer
            }
        };
        self.camera = camera;
        Ok(())
    }

    /// Turns the scene on a turntable: the initial camera orbits it by `degrees`, counter-clockwise as seen from above,
    /// and environment maps rotate with it. No BVH is built, nothing is read.
    ///
    /// # Errors
    /// `Request` for a session without a turntable ([`Options::turn`]).
    pub fn set_turn(&mut self, degrees: f64) -> Result<()> {
        let Some(turning) = &self.turntable else {
            let message = "this session has no turntable: enable it by the option `turn`";
            return Err(unsuitable(message.to_owned()));
        };
        let turning = Turning { degrees, ..turning.clone() };
        let camera = turning.turntable.turned(&turning.camera, degrees);
        let world = Arc::new(turning.world.with_surroundings_turned(&turning.rotation()));
        let view = View::new(&camera, self.image().clone())?;
        self.renderer = self.renderer.with_world(world, view)?;
        (self.camera, self.turntable) = (camera, Some(turning));
        Ok(())
    }

    /// Changes the image settings: size, crop, filter, background or development.
    ///
    /// # Errors
    /// `Invalid` for a size or crop without pixels and as [`ImageSettings::validate`]; `Request` for a background that the picture's
    /// format, if it is known, cannot hold. Then nothing has changed.
    pub fn set_image(&mut self, image: ImageSettings) -> Result<()> {
        if let Some(format) = self.format {
            format.check_background(image.background)?;
        }
        self.renderer = self.renderer.with_view(View::new(&self.camera, image)?)?;
        Ok(())
    }

    /// Changes the render settings: samples, integrator, depth, seed. The light sampler stays as the world was
    /// compiled.
    ///
    /// # Errors
    /// `Invalid` for no samples and as [`RenderSettings::validate`]; then nothing has changed.
    pub fn set_settings(&mut self, settings: RenderSettings) -> Result<()> {
        self.renderer = self.renderer.with_settings(settings)?;
        Ok(())
    }

    /// Changes the render settings, but not a custom integrator.
    ///
    /// # Errors
    /// As [`Session::set_settings`].
    pub(super) fn set_settings_of_same_integrator(&mut self, settings: RenderSettings) -> Result<()> {
        let other = self.renderer.with_settings(settings)?;
        self.renderer = self.renderer.with_same_integrator(other);
        Ok(())
    }

    /// Sets a custom integrator, which stays until [`Options::integrator`] or the next [`Session::set_settings`] chooses another.
    pub fn set_integrator(&mut self, integrator: impl Integrator + 'static) {
        self.renderer = self.renderer.clone().with_integrator(integrator);
    }
}

impl Options {
    /// The name of an option among these that chooses or changes the scene, and not only its picture and camera.
    pub fn of_scene(&self) -> Option<&'static str> {
        let ImportOptions { animation, at, shutter, variant, scene, camera, subdivision, instanced_lights } =
            &self.import;
        let asked = [
            ("film", self.film),
            ("keep_scene", self.keep_scene),
            ("bounds", self.bounds.is_some()),
            ("light_sampler", self.light_sampler.is_some()),
            ("view", self.view.is_some()),
            ("azimuth", self.azimuth.is_some()),
            ("elevation", self.elevation.is_some()),
            ("environment", self.environment.is_some()),
            ("rotate_environment", self.rotate_environment.is_some()),
            ("floor", self.floor),
            ("animation", animation.is_some()),
            ("at", at.is_some()),
            ("shutter", shutter.is_some()),
            ("variant", variant.is_some()),
            ("scene", scene.is_some()),
            ("camera", *camera != CameraChoice::First),
            ("subdivide", *subdivision > 0),
            ("instanced_lights", *instanced_lights),
            ("variables", !self.variables.values.is_empty()),
        ];
        asked.into_iter().find(|(_, is_asked)| *is_asked).map(|(name, _)| name)
    }
}
