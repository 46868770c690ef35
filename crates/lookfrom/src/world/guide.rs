//! Worlds with guides to their environments.

use std::sync::Arc;

use super::World;
use crate::light::{Environment, Guide, Light};

impl World {
    /// The environment light that a guide may be learned for: the only one that illuminates, without a portal. One that is left
    /// to BSDF sampling must be the only light, since it would be sampled in place of others.
    pub(crate) fn guidable(&self) -> Option<(u32, &Environment)> {
        let lit = |index: &&u32| self.lights[**index as usize].illuminates();
        let mut lit = self.environments.iter().filter(lit);
        let (&index, None) = (lit.next()?, lit.next()) else { return None };
        let Light::Environment(environment) = &self.lights[index as usize] else { return None };
        let is_sampled = self.light_choice.is_listed(index) || self.light_choice.is_empty();
        (environment.portal.is_none() && is_sampled).then_some((index, environment))
    }

    /// This world with a guide to the environment that is the light of that index.
    pub(crate) fn guided(&self, light: u32, guide: &Arc<Guide>) -> Self {
        self.with_guides(|index| (index == light).then(|| guide.clone()))
    }

    /// This world without guides.
    pub(crate) fn unguided(self: Arc<Self>) -> Arc<Self> {
        if self.is_guided() { Arc::new(self.with_guides(|_| None)) } else { self }
    }

    /// Whether an environment has a guide.
    pub(crate) fn is_guided(&self) -> bool {
        let is_guided =
            |light: &Light| matches!(light, Light::Environment(Environment { guide: Some(_), .. }));
        self.lights.iter().any(is_guided)
    }

    fn with_guides(&self, guide_of: impl Fn(u32) -> Option<Arc<Guide>>) -> Self {
        let with_guide = |(index, light): (u32, &Light)| match light {
            Light::Environment(environment) => {
                Light::Environment(Environment { guide: guide_of(index), ..environment.clone() })
            }
            light => light.clone(),
        };
        let lights: Vec<Light> = (0..).zip(&self.lights).map(with_guide).collect();
        let light_choice = Arc::new(self.light_choice.among(&lights));
        Self { lights, light_choice, ..self.clone() }
    }
}
