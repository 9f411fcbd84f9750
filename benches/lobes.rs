//! What the benchmarks of lobes share: a lobe of everyday parameters for each model, and batches of directions.
//!
//! Scalar code and lanes are called the way a caller meets them: through a function that is not inlined, on input that the
//! optimiser cannot see through. Without that it would turn the scalar loop into a vector loop of its own, and compare lanes
//! with lanes.

use crate::Random;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{Conductor, Dielectric, Eon, Lambert, Mirror, Phong, PhongNorm, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Ggx, Reach};
use gonio_kernel::{F32x8, Lobe, Real, Rgb, Sample, Value, Vec3};
use std::hint::black_box;

/// Directions per batch: with the results about 200 KB.
pub(crate) const BATCH: usize = 4096;

/// A lobe of everyday parameters.
pub(crate) trait Example {
    fn example() -> Self;
}
impl<R: Real> Example for Lambert<R> {
    fn example() -> Self {
        Self::new(Rgb::new(0.8, 0.5, 0.2).map(R::lit))
    }
}
impl<R: Real> Example for Mirror<R> {
    fn example() -> Self {
        Self::new(Rgb::new(0.9, 0.8, 0.7).map(R::lit))
    }
}
impl<R: Real> Example for Conductor<R> {
    /// Copper at 630, 532 and 465 nm (Johnson & Christy 1972), so no channel can stand for another.
    fn example() -> Self {
        let eta = Rgb::new(0.22, 0.96, 1.17).map(R::lit);
        let k = Rgb::new(3.68, 2.59, 2.46).map(R::lit);
        Self::new(Ggx { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) }, Fresnel::Conductor { eta, k })
    }
}

impl<R: Real> Example for Dielectric<R> {
    fn example() -> Self {
        Self::new(R::lit(1.5))
    }
}
impl<R: Real> Example for RoughDielectric<R> {
    fn example() -> Self {
        Self::new(Ggx { alpha_x: R::lit(0.3), alpha_y: R::lit(0.2) }, R::lit(1.5))
    }
}
impl<R: Real> Example for Phong<R> {
    fn example() -> Self {
        let (diffuse, glossy) = (Rgb::new(0.4, 0.3, 0.1).map(R::lit), Rgb::new(0.3, 0.3, 0.3).map(R::lit));
        Self { diffuse, glossy, exponent: R::lit(30.0), norm: PhongNorm::Lecture }
    }
}
impl<R: Real> Example for Eon<R> {
    fn example() -> Self {
        Self::new(Rgb::new(0.8, 0.5, 0.2).map(R::lit), R::lit(0.6))
    }
}

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

    /// A direction.
    pub(crate) fn sample(&self, lobe: &impl Lobe<R>) {
        for (&wo, &u) in self.wo.iter().zip(&self.u) {
            black_box(sample(lobe, black_box(wo), black_box(u)));
        }
    }
}

#[inline(never)]
pub(crate) fn eval<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, wi: Vec3<R>) -> Value<R> {
    lobe.eval(wo, wi)
}

#[inline(never)]
fn value<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, wi: Vec3<R>) -> Rgb<R> {
    lobe.eval(wo, wi).f_cos
}

#[inline(never)]
fn normal<R: Real>(sample: &impl Fn(Vec3<R>, [R; 2]) -> Vec3<R>, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
    sample(wo, u)
}

#[inline(never)]
fn sample<R: Real>(lobe: &impl Lobe<R>, wo: Vec3<R>, u: [R; 3]) -> Sample<R> {
    lobe.sample(wo, u)
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
