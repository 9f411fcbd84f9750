//! What the benchmarks of lobes share: batches of directions, and the calls that are measured.
//!
//! Scalar code and lanes are called the way a caller meets them: through a function that is not inlined, on input that the
//! optimiser cannot see through. Without that it would turn the scalar loop into a vector loop of its own, and compare lanes
//! with lanes.

use crate::Random;
use gonio_kernel::microfacet::{Beckmann, Ggx, Reach};
use gonio_kernel::{BsdfSample, Closure, F32x8, Lobe, Real, Rgb, Sample, Transport, Value, Vec3};
use std::hint::black_box;

/// Directions per batch: with the results about 200 KB.
pub(crate) const BATCH: usize = 4096;

/// A batch of input, one direction after the other or eight side by side.
pub(crate) struct Batch<R> {
    pub(crate) wo: Vec<Vec3<R>>,
    pub(crate) wi: Vec<Vec3<R>>,
    pub(crate) u: Vec<[R; 3]>,
}
pub(crate) type Scalars = Batch<f32>;
pub(crate) type Lanes = Batch<F32x8>;

impl Scalars {
    /// Directions uniform over the upper hemisphere, from a fixed seed.
    pub(crate) fn new() -> Self {
        let mut random = Random(1);
        let mut direction = || {
            let w = gonio_kernel::warp::sample_uniform_sphere([random.next(), random.next()]);
            Vec3::new(w.x, w.y, w.z.abs().max(1e-3))
        };
        let (wo, wi) = (0..BATCH).map(|_| (direction(), direction())).unzip();
        let u = (0..BATCH).map(|_| [random.next(), random.next(), random.next()]).collect();
        Self { wo, wi, u }
    }
}

impl Lanes {
    /// The same directions.
    pub(crate) fn new() -> Self {
        let batch = Scalars::new();
        let eight = |of: &dyn Fn(usize) -> f32| F32x8::new(std::array::from_fn(of));
        let directions = |v: &[Vec3<f32>]| {
            v.chunks_exact(8).map(|v| Vec3::new(eight(&|i| v[i].x), eight(&|i| v[i].y), eight(&|i| v[i].z))).collect()
        };
        let u = batch.u.chunks_exact(8).map(|u| std::array::from_fn(|j| eight(&|i| u[i][j]))).collect();
        Self { wo: directions(&batch.wo), wi: directions(&batch.wi), u }
    }
}

impl<R: Real> Batch<R> {
    /// Value and density.
    pub(crate) fn eval(&self, lobe: &impl Lobe<R>) {
        for (&wo, &wi) in self.wo.iter().zip(&self.wi) {
            black_box(eval(lobe, black_box(wo), black_box(wi)));
        }
    }

    /// The value alone, as for a direction to a light that needs no density.
    pub(crate) fn value(&self, lobe: &impl Lobe<R>) {
        for (&wo, &wi) in self.wo.iter().zip(&self.wi) {
            black_box(value(lobe, black_box(wo), black_box(wi)));
        }
    }

    /// What choosing a visible normal costs by itself.
    pub(crate) fn normals(&self, sample: impl Fn(Vec3<R>, [R; 2]) -> Vec3<R>) {
        for (&wo, &u) in self.wo.iter().zip(&self.u) {
            black_box(normal(&sample, black_box(wo), black_box([u[1], u[2]])));
        }
    }

    /// A direction with its value, guarded.
    pub(crate) fn closure_sample(&self, lobe: &impl Lobe<R>) {
        for (&wo, &u) in self.wo.iter().zip(&self.u) {
            black_box(closure_sample(lobe, black_box(wo), black_box(u)));
        }
    }

    /// A direction.
    pub(crate) fn sample(&self, lobe: &impl Lobe<R>) {
        for (&wo, &u) in self.wo.iter().zip(&self.u) {
            black_box(sample(lobe, black_box(wo), black_box(u)));
        }
    }
}

#[inline(never)]
pub(crate) fn eval<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
    lobe.eval(wo, &lobe.prepare(wo, Transport::Radiance), wi)
}

#[inline(never)]
fn value<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, wi: Vec3<R>) -> Rgb<R> {
    lobe.eval(wo, &lobe.prepare(wo, Transport::Radiance), wi).f_cos
}

#[inline(never)]
fn normal<R: Real>(sample: &impl Fn(Vec3<R>, [R; 2]) -> Vec3<R>, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
    sample(wo, u)
}

#[inline(never)]
fn sample<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
    lobe.sample(wo, &lobe.prepare(wo, Transport::Radiance), u)
}

#[inline(never)]
fn closure_sample<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, u: [R; 3]) -> BsdfSample<R> {
    Closure::new(lobe, wo).sample(u)
}

/// A visible normal of Beckmann's distribution; [`Batch::normals`] shows it to the optimiser.
pub(crate) fn beckmann_normal<R: Real>(wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
    Beckmann { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) }.sample_visible(wo, u)
}

/// A visible normal of the GGX distribution.
pub(crate) fn ggx_normal<R: Real>(wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
    let ggx = Ggx { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) };
    let s_o = ggx.smith_length(wo);
    ggx.sample_visible(wo, s_o, Reach::whole(wo, s_o), u)
}
