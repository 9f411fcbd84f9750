//! All lights of a world, and the choice between their kinds.

use super::area::{EmissiveTriangles, Emitter};
use super::delta::DeltaLights;
use super::environment::Environment;
use super::mis::Techniques;
use super::sample::{LightSample, Reference};
use crate::fingerprint::Fingerprint;
use crate::sampler::Random4;
use crate::scene;
use gonio_kernel::{F32x8, Mask, Mask8, Real};

/// A light sample, and whether scattering cannot find that light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChosenSample {
    pub(crate) sample: LightSample,
    pub(crate) is_delta: Mask8,
}

/// All lights of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    pub(crate) environment: Environment,
    pub(crate) triangles: EmissiveTriangles,
    pub(crate) delta: DeltaLights,
    /// Where the shares of triangles and of delta lights begin; that of the environment begins at 0, and the last ends at 1.
    starts: [f32; 2],
}

impl Lights {
    pub(crate) fn new(emitters: Vec<Emitter>, environment: &scene::Environment, delta: DeltaLights) -> Self {
        let (mut environment, mut triangles) = (Environment::new(environment), EmissiveTriangles::new(emitters));
        let mut delta = delta;
        let present = [environment.is_light(), !triangles.emitters().is_empty(), !delta.is_empty()];
        let of = present.iter().filter(|present| **present).count().max(1) as f32;
        let mut begun = 0;
        let [first, second, third] = present.map(|present| {
            begun += u8::from(present);
            f32::from(begun) / of
        });
        environment.set_share(first);
        triangles.set_share(second - first);
        delta.set_share(third - second);
        Self { environment, triangles, delta, starts: [first, second] }
    }

    /// Whether there is a light to sample.
    #[inline(always)]
    pub(crate) fn are_sampled(&self, techniques: Techniques) -> bool {
        let hittable = self.environment.is_light() || !self.triangles.emitters().is_empty();
        !self.delta.is_empty() || (hittable && techniques != Techniques::Scattering)
    }

    /// One light sample for each live lane. None if no lane has one. `u` are four random numbers, `more` draws further ones.
    #[inline(always)]
    pub(crate) fn sample(
        &self,
        techniques: Techniques,
        live: Mask8,
        at: &Reference,
        u: &Random4,
        more: impl FnOnce() -> Random4,
    ) -> Option<ChosenSample> {
        let u_select = u.unit(0);
        let [second, third] = self.starts.map(F32x8::splat);
        let of_environment = u_select.lt(second);
        let of_delta = u_select.ge(third);
        let of_triangles = !of_environment & !of_delta;
        // What is left of the number within the chosen kind decides the second number of the alias; below 1 even after rounding.
        let rest = |from: F32x8, to: F32x8| ((u_select - from) / (to - from)).min(F32x8::splat(0.999_999_94));
        let u_position = [u.unit(2), u.unit(3)];
        let hittable = techniques != Techniques::Scattering;

        let mut found: Option<LightSample> = None;
        let mut add = |lanes: Mask8, sample: LightSample| {
            found = Some(match found {
                None => LightSample { possible: sample.possible & lanes, ..sample },
                Some(other) => LightSample::select(lanes, sample, other),
            });
        };
        if hittable
            && (live & of_environment).any()
            && let Some(sample) = self.environment.sample(at, u, more)
        {
            add(of_environment, sample);
        }
        if hittable && (live & of_triangles).any() && !self.triangles.emitters().is_empty() {
            add(of_triangles, self.triangles.sample(at, u.0[1], rest(second, third), u_position));
        }
        if (live & of_delta).any() && !self.delta.is_empty() {
            add(of_delta, self.delta.sample(at, live & of_delta, u.0[1], rest(third, F32x8::ONE), u_position));
        }
        let sample = found?;
        Some(ChosenSample { sample: LightSample { possible: sample.possible & live, ..sample }, is_delta: of_delta })
    }

    /// Takes what the scene's triangles and materials do not say into a fingerprint.
    pub(crate) fn describe(&self, print: &mut Fingerprint) {
        self.environment.describe(print);
        self.delta.describe(print);
    }
}
