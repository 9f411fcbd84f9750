//! The shading stage: eight paths at a time receive emitted light, sample a light, and scatter.
//!
//! Multiple importance sampling: light that both scattering and a light sample can find is weighted by the
//! power heuristic on both sides; after the camera or a delta event only scattering can find it, with weight 1.
//! Per vertex the order of additions is: emission, then the answer of the shadow ray.

use crate::bsdf::BatchBsdf;
use crate::effects::{Effect, EffectSet};
use crate::layers::FirstHit;
use crate::light::Techniques;
use crate::light::lights::ChosenSample;
use crate::light::sample::{Reference, SHORT_OF_LIGHT};
use crate::material::with_lanes;
use crate::point::ShadingPoints;
use crate::queue::{Batch, Paths, Queue, ShadowQueue};
use crate::sampler::{Purpose, Sampler};
use crate::sides::{self, Sides};
use crate::world::World;
use gonio_accel::Ray8;
use gonio_kernel::{BsdfSample, F32x8, Mask, Mask8, Real, Rgb, U32x8, Vec3};

/// Russian roulette starts with this scattering event.
const ROULETTE_FROM: u32 = 5;
/// No path goes on with a higher probability than this once roulette has started.
const ROULETTE_CAP: f64 = 0.95;

/// Everything a shading call reads.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) world: &'a World,
    pub(crate) effects: EffectSet,
    pub(crate) sampler: Sampler,
    pub(crate) max_depth: u32,
    pub(crate) russian_roulette: bool,
    pub(crate) techniques: Techniques,
}

/// The gathered radiance of a tile's paths.
pub(crate) struct Gathered<'a>(pub(crate) &'a mut [[f32; 3]]);

impl Gathered<'_> {
    /// Adds light to those lanes' paths.
    #[inline(always)]
    pub(crate) fn add(&mut self, path: &[u32; F32x8::LANES], mask: Mask8, light: Rgb<F32x8>) {
        let (mut bits, [r, g, b]) = (mask.to_bits(), [light.r, light.g, light.b].map(F32x8::to_array));
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize % F32x8::LANES;
            bits &= bits - 1;
            let sum = &mut self.0[path[lane] as usize];
            *sum = [sum[0] + r[lane], sum[1] + g[lane], sum[2] + b[lane]];
        }
    }
}

/// What eight paths bring to their hits.
struct Incoming {
    dir: Vec3<F32x8>,
    throughput: Rgb<F32x8>,
    pdf: F32x8,
    path: [u32; F32x8::LANES],
    pixel: U32x8,
    sample: U32x8,
}

impl Incoming {
    #[inline(always)]
    fn new(batch: &Batch) -> Self {
        Self {
            pixel: batch.path_int(|p| &p.pixel),
            sample: batch.path_int(|p| &p.sample),
            dir: Vec3::new(batch.ray(|r| &r.dir.x), batch.ray(|r| &r.dir.y), batch.ray(|r| &r.dir.z)),
            throughput: Rgb::new(
                batch.path(|p| &p.throughput.r),
                batch.path(|p| &p.throughput.g),
                batch.path(|p| &p.throughput.b),
            ),
            pdf: batch.path(|p| &p.pdf),
            path: batch.path_int(|p| &p.path).to_array(),
        }
    }
}

/// Paths that left the world after `depth` scattering events receive the environment.
#[inline(always)]
pub(crate) fn miss(ctx: &Context, depth: u32, batch: &Batch, gathered: &mut Gathered) {
    let incoming = Incoming::new(batch);
    let ahead = || batch.path(|p| &p.pdf_environment);
    let Some(escaped) = ctx.world.lights.environment.escaped(depth, incoming.dir, ahead) else { return };
    let weight = ctx.techniques.weight_of_scattering(incoming.pdf, escaped.pdf);
    gathered.add(&incoming.path, batch.live, incoming.throughput * escaped.radiance * weight);
}

/// Paths that met materials of one variant: emission, light sample, scattering. `depth` counts the scattering events
/// so far. Returns how many lanes a closure was evaluated for. What the camera sees first goes into `first`, unless it is
/// empty.
#[inline(always)]
pub(crate) fn hit(
    ctx: &Context,
    depth: u32,
    batch: &Batch,
    gathered: &mut Gathered,
    first: &mut [FirstHit],
    shadow: &mut ShadowQueue,
    next: &mut Queue,
) -> u32 {
    let incoming = Incoming::new(batch);
    let wo = -incoming.dir;
    let points = ShadingPoints::new(ctx.world, ctx.effects, batch, wo);
    if ctx.effects.has(Effect::AreaLights) {
        receive_emission(ctx, batch, &incoming, &points, gathered);
    }
    with_lanes(&points.materials, points.of_one_material(), &ctx.world.textures, points.uv, |bsdf| {
        shade(ctx, depth, batch, &incoming, &points, bsdf, first, shadow, next)
    })
}

/// Light sample and scattering by one BSDF. Returns how many lanes it was evaluated for.
fn shade(
    ctx: &Context,
    depth: u32,
    batch: &Batch,
    incoming: &Incoming,
    points: &ShadingPoints,
    bsdf: &dyn BatchBsdf,
    first: &mut [FirstHit],
    shadow: &mut ShadowQueue,
    next: &mut Queue,
) -> u32 {
    if !first.is_empty() {
        note_first_hit(ctx, batch, incoming, points, bsdf.albedo(), first);
    }
    if depth >= ctx.max_depth {
        return 0;
    }
    let mut live = batch.live;
    if ctx.effects.has(Effect::OneSided) {
        live = live & sides::scattering(points.front, points.which(|material| material.two_sided));
    }
    if !live.any() {
        return 0;
    }

    let wo = points.frame.to_local(-incoming.dir);
    let sides = Sides::new(points.point, points.normal, ctx.effects.has(Effect::Transmission));
    let at = Reference::new(&points.frame, &sides);
    let draw = |purpose| ctx.sampler.draw(incoming.pixel, incoming.sample, depth, purpose);
    let light = ctx.world.lights.are_sampled(ctx.techniques).then(|| {
        let u = draw(Purpose::Light);
        ctx.world.lights.sample(ctx.techniques, live, &at, &u, || draw(Purpose::Environment))
    });
    let u = draw(Purpose::Scatter);
    let light = light.flatten().map(|light| (points.frame.to_local(light.sample.wi), light));
    let scattered = bsdf.scatter(wo, light.map(|(wi, _)| wi), [u.unit(0), u.unit(1), u.unit(2)]);

    if let Some((wi, ChosenSample { sample: light, is_delta })) = light {
        let value = scattered.light;
        let weight = ctx.techniques.weight_of_light_sample(light.pdf, value.pdf, is_delta) / light.pdf;
        let arriving = incoming.throughput * value.f_cos * light.radiance * weight;
        let (origin, leaves) = sides.leaving(light.wi, wo.z * wi.z);
        let mask = light.possible & leaves & arriving.largest().gt(F32x8::ZERO);
        if mask.any() {
            let t_max = light.distance * F32x8::splat(SHORT_OF_LIGHT);
            shadow.push(mask, (origin, light.wi, t_max), arriving, &incoming.path);
        }
    }
    go_on(ctx, depth, live, incoming, points, &sides, &scattered.sample, wo, u.unit(3), next);
    live.to_bits().count_ones()
}

/// What the layers want to know of the surfaces that the camera sees.
#[inline(always)]
fn note_first_hit(
    ctx: &Context,
    batch: &Batch,
    incoming: &Incoming,
    points: &ShadingPoints,
    albedo: Rgb<F32x8>,
    first: &mut [FirstHit],
) {
    let depth = points.t * incoming.dir.dot(Vec3::broadcast(ctx.world.view.forward));
    let lanes = |v: [F32x8; 3], l: usize| v.map(|x| x.lane(l));
    for l in (0..F32x8::LANES).filter(|l| batch.live.to_bits() >> l & 1 != 0) {
        first[incoming.path[l] as usize] = FirstHit {
            albedo: lanes([albedo.r, albedo.g, albedo.b], l),
            normal: lanes([points.frame.z.x, points.frame.z.y, points.frame.z.z], l),
            depth: depth.lane(l),
        };
    }
}

/// Light that a hit triangle emits towards the path, from the front of its winding.
#[inline(always)]
fn receive_emission(
    ctx: &Context,
    batch: &Batch,
    incoming: &Incoming,
    points: &ShadingPoints,
    gathered: &mut Gathered,
) {
    let materials = &points.materials;
    if !materials.iter().any(|m| m.emits()) {
        return;
    }
    let emission = Rgb::from_lanes(|l| materials[l].emission);
    let pdf = ctx.world.lights.triangles.pdf(emission, [points.t; 2], points.cos_geometric);
    let weight = ctx.techniques.weight_of_scattering(incoming.pdf, pdf);
    let mask = batch.live & points.front & emission.largest().gt(F32x8::ZERO);
    gathered.add(&incoming.path, mask, incoming.throughput * emission * weight);
}

/// Writes the rays of the next bounce.
#[inline(always)]
fn go_on(
    ctx: &Context,
    depth: u32,
    live: Mask8,
    incoming: &Incoming,
    points: &ShadingPoints,
    sides: &Sides,
    sample: &BsdfSample<F32x8>,
    wo: Vec3<F32x8>,
    u_roulette: F32x8,
    next: &mut Queue,
) {
    let wi = points.frame.to_world(sample.wi);
    let (origin, leaves) = sides.leaving(wi, wo.z * sample.wi.z);
    let mut alive = live & !sample.event.failed & leaves;
    let mut throughput = incoming.throughput * sample.f_cos * sample.pdf.recip();
    alive = alive & throughput.largest().gt(F32x8::ZERO);
    if ctx.russian_roulette && depth + 1 >= ROULETTE_FROM {
        let q = throughput.luminance().min(F32x8::lit(ROULETTE_CAP));
        alive = alive & u_roulette.lt(q);
        throughput *= q.recip();
    }
    if alive.any() {
        let pdf_environment = if ctx.effects.has(Effect::Environment) {
            ctx.world.lights.environment.pdf_ahead(sample.wi)
        } else {
            F32x8::ZERO
        };
        next.push(
            Ray8 { mask: alive, ..Ray8::new(origin, wi) },
            Paths {
                throughput,
                pdf: sample.pdf.or_zero(!sample.event.is_delta),
                pdf_environment,
                path: U32x8::new(incoming.path),
                pixel: incoming.pixel,
                sample: incoming.sample,
            },
        );
    }
}
