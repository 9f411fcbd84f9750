//! The shading stage: eight paths at a time receive emitted light, ask a light, and scatter.
//!
//! Multiple importance sampling: light that can be reached both by scattering and by asking the light is weighted by the
//! power heuristic on both sides; after the camera or a delta event only scattering can reach it, with weight 1.
//! Per vertex the order of additions is: emission, then the answer of the shadow ray.

use crate::environment::EnvironmentMap;
use crate::layers::FirstHit;
use crate::light::{PreparedSky, Techniques};
use crate::material::{BatchBsdf, with_lanes};
use crate::plan::Plan;
use crate::point::{ShadingPoints, SurfacePoint};
use crate::queue::{Batch, Paths, Queue, ShadowQueue};
use crate::sampler::{Purpose, Random4, Sampler};
use crate::world::{World, splat_rgb};
use gonio_accel::Ray8;
use gonio_kernel::frame::on_its_side;
use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere, sample_uniform_triangle};
use gonio_kernel::{BsdfSample, F32x8, Mask, Mask8, Real, Rgb, U32x8, Vec3, each_lane};

/// Shadow rays stop this much short of the light, relative to its distance: the rounding of the distance and of t.
pub const SHORT_OF_LIGHT: f32 = 1.0 - 16.0 / 16_777_216.0;
/// Russian roulette starts with this scattering event.
const ROULETTE_FROM: u32 = 5;
/// No path goes on with a higher probability than this once roulette has started.
const ROULETTE_CAP: f64 = 0.95;

/// Everything a shading call reads.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) world: &'a World,
    pub(crate) plan: Plan,
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

    /// The weight of light found by scattering, which a light sample would have found with density `pdf_light`.
    #[inline(always)]
    fn weight(&self, techniques: Techniques, pdf_light: F32x8) -> F32x8 {
        let weight = techniques.weight(Techniques::Scattering, self.pdf, pdf_light);
        F32x8::select(self.pdf.gt(F32x8::ZERO), weight, F32x8::ONE)
    }
}

/// Paths that left the world after `depth` scattering events receive the environment.
#[inline(always)]
pub(crate) fn miss(ctx: &Context, depth: u32, batch: &Batch, gathered: &mut Gathered) {
    let lights = &ctx.world.lights;
    let incoming = Incoming::new(batch);
    let (radiance, pdf) = match lights.sky(depth) {
        None => return,
        Some(PreparedSky::Constant(radiance)) => (splat_rgb(*radiance), batch.path(|p| &p.pdf_environment)),
        Some(PreparedSky::Map(map)) => {
            let seen = map.at(incoming.dir);
            (seen.radiance, seen.pdf * F32x8::splat(lights.environment_probability()))
        }
    };
    let weight = incoming.weight(ctx.techniques, pdf);
    gathered.add(&incoming.path, batch.live, incoming.throughput * radiance * weight);
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
    let points = ShadingPoints::new(ctx.world, ctx.plan, batch, wo);
    if ctx.plan.area_lights {
        receive_emission(ctx, batch, &incoming, &points, gathered);
    }
    let materials = each_lane(|l| &ctx.world.materials[points.material[l] as usize]);
    let alike = points.material.iter().all(|&m| m == points.material[0]);
    with_lanes(materials, alike, &ctx.world.textures, points.uv, |bsdf| {
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
    if ctx.plan.one_sided {
        let two_sided = points
            .material
            .iter()
            .enumerate()
            .fold(0, |bits, (lane, &m)| bits | u32::from(ctx.world.materials[m as usize].two_sided) << lane);
        live = live & (points.front | Mask8::from_bits(two_sided));
    }
    if !live.any() {
        return 0;
    }

    let wo = points.frame.to_local(-incoming.dir);
    let origin = points.point.off_plane(points.normal);
    let light = sample_lights(ctx, depth, live, incoming, points, origin);
    let u = ctx.sampler.draw(incoming.pixel, incoming.sample, depth, Purpose::Scatter);
    let wi = light.as_ref().map(|light| points.frame.to_local(light.wi));
    let scattered = bsdf.scatter(wo, wi, [u.unit(0), u.unit(1), u.unit(2)]);

    if let (Some(light), Some(wi)) = (light, wi) {
        let value = scattered.light;
        let weight = ctx.techniques.weight(Techniques::Lights, light.pdf, value.pdf) / light.pdf;
        let arriving = incoming.throughput * value.f_cos * light.radiance * weight;
        let (origin, right_side) = leaving(ctx, points, origin, light.wi, wo.z * wi.z);
        let mask = light.mask & right_side & arriving.largest().gt(F32x8::ZERO);
        if mask.any() {
            shadow.push(mask, (origin, light.wi, light.t_max), arriving, &incoming.path);
        }
    }
    go_on(ctx, depth, live, incoming, points, &scattered.sample, (wo, origin, u.unit(3)), next);
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
    let materials = each_lane(|l| &ctx.world.materials[points.material[l] as usize]);
    if !materials.iter().any(|m| m.emits()) {
        return;
    }
    let emission = Rgb::new(
        F32x8::from_fn(|l| materials[l].emission.r),
        F32x8::from_fn(|l| materials[l].emission.g),
        F32x8::from_fn(|l| materials[l].emission.b),
    );
    let pdf_area = emission.luminance() * F32x8::splat(ctx.world.lights.pdf_area_per_luminance());
    let pdf_light = pdf_area * points.t * points.t / points.cos_geometric;
    let mask = batch.live & points.front & emission.largest().gt(F32x8::ZERO);
    gathered.add(&incoming.path, mask, incoming.throughput * emission * incoming.weight(ctx.techniques, pdf_light));
}

/// Where a ray in the direction wi starts (at `origin` if it stays on wo's side), and whether it leaves on the side on which the
/// closure scattered it: `sides` is the product of the local cosines.
#[inline(always)]
fn leaving(
    ctx: &Context,
    points: &ShadingPoints,
    origin: Vec3<F32x8>,
    wi: Vec3<F32x8>,
    sides: F32x8,
) -> (Vec3<F32x8>, Mask8) {
    if !ctx.plan.transmission {
        return (origin, on_its_side(points.normal, wi, Mask8::splat(false)));
    }
    let above = points.normal.dot(wi).gt(F32x8::ZERO);
    let start = Vec3::select(above, origin, points.point.off_plane(-points.normal));
    (start, on_its_side(points.normal, wi, sides.lt(F32x8::ZERO)))
}

/// A direction in which light may arrive.
struct LightSample {
    wi: Vec3<F32x8>,
    /// Per solid angle, the choice between lights included.
    pdf: F32x8,
    radiance: Rgb<F32x8>,
    /// How far the shadow ray goes.
    t_max: F32x8,
    /// Where there is one.
    mask: Mask8,
}

impl LightSample {
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            pdf: F32x8::select(mask, yes.pdf, no.pdf),
            radiance: Rgb::select(mask, yes.radiance, no.radiance),
            t_max: F32x8::select(mask, yes.t_max, no.t_max),
            mask: (mask & yes.mask) | (!mask & no.mask),
        }
    }
}

/// One light sample for each live lane: of the environment or of an emitter. None if no lane has one.
#[inline(always)]
fn sample_lights(
    ctx: &Context,
    depth: u32,
    live: Mask8,
    incoming: &Incoming,
    points: &ShadingPoints,
    origin: Vec3<F32x8>,
) -> Option<LightSample> {
    let lights = &ctx.world.lights;
    if !(ctx.plan.area_lights || ctx.plan.environment) || ctx.techniques == Techniques::Scattering {
        return None;
    }
    let u = ctx.sampler.draw(incoming.pixel, incoming.sample, depth, Purpose::Light);
    let u_select = u.unit(0);
    let u_position = [u.unit(2), u.unit(3)];
    let p_environment = F32x8::splat(lights.environment_probability());
    let environment = u_select.lt(p_environment);
    let from_sky = match lights.shining_sky() {
        Some(sky) if ctx.plan.environment && (live & environment).any() => Some(match sky {
            PreparedSky::Constant(sky) => sample_environment(*sky, points, u_position, p_environment),
            PreparedSky::Map(map) => {
                let u_position = ctx.sampler.draw(incoming.pixel, incoming.sample, depth, Purpose::Environment);
                sample_map(map, &u, &u_position, p_environment)
            }
        }),
        _ => None,
    };
    let from_emitter = (ctx.plan.area_lights && (live & !environment).any()).then(|| {
        // What is left of the number within the chosen strategy decides the emitter's alias; below 1 even after rounding.
        let rest = ((u_select - p_environment) / (F32x8::ONE - p_environment)).min(F32x8::splat(0.999_999_94));
        sample_emitter(ctx, points, origin, u.0[1], rest, u_position)
    });
    let sample = match (from_sky, from_emitter) {
        (Some(sky), Some(emitter)) => LightSample::select(environment, sky, emitter),
        (Some(sky), None) => LightSample { mask: sky.mask & environment, ..sky },
        (None, Some(emitter)) => LightSample { mask: emitter.mask & !environment, ..emitter },
        (None, None) => return None,
    };
    Some(LightSample { mask: sample.mask & live, ..sample })
}

/// A cosine-distributed direction of a constant environment.
#[inline(always)]
fn sample_environment(
    radiance: Rgb<f32>,
    points: &ShadingPoints,
    u_position: [F32x8; 2],
    probability: F32x8,
) -> LightSample {
    let local = sample_cosine_hemisphere(u_position);
    LightSample {
        wi: points.frame.to_world(local),
        pdf: pdf_cosine_hemisphere(local) * probability,
        radiance: splat_rgb(radiance),
        t_max: F32x8::splat(f32::INFINITY),
        mask: Mask8::splat(true),
    }
}

/// A direction of a map by its luminance; `u_select` are the numbers of the choice between lights, of which it uses the free ones.
#[inline(always)]
fn sample_map(map: &EnvironmentMap, u_select: &Random4, u_position: &Random4, probability: F32x8) -> LightSample {
    let wi = map.sample(u_position, [u_select.0[1], u_select.0[2]]);
    let seen = map.at(wi);
    LightSample {
        wi,
        pdf: seen.pdf * probability,
        radiance: seen.radiance,
        t_max: F32x8::splat(f32::INFINITY),
        mask: seen.pdf.gt(F32x8::ZERO),
    }
}

/// A uniform point of an emitting triangle chosen by power.
#[inline(always)]
fn sample_emitter(
    ctx: &Context,
    points: &ShadingPoints,
    origin: Vec3<F32x8>,
    slot: U32x8,
    u_select: F32x8,
    u_position: [F32x8; 2],
) -> LightSample {
    let emitters = ctx.world.lights.pick(slot, u_select);
    let normal = emitters.normal;
    let target = SurfacePoint::new(&emitters.corners, sample_uniform_triangle(u_position)).off_plane(normal);
    // The ray starts on the side where the light is.
    let start = if ctx.plan.transmission {
        let beside = points.normal.dot(target - points.point.position).lt(F32x8::ZERO);
        Vec3::select(beside, points.point.off_plane(-points.normal), origin)
    } else {
        origin
    };
    let to = target - start;
    let distance2 = to.length2();
    let distance = distance2.sqrt();
    let wi = to * distance.recip();
    let cos = -normal.dot(wi);
    let pdf_area = emitters.radiance.luminance() * F32x8::splat(ctx.world.lights.pdf_area_per_luminance());
    LightSample {
        wi,
        pdf: pdf_area * distance2 / cos,
        radiance: emitters.radiance,
        t_max: distance * F32x8::splat(SHORT_OF_LIGHT),
        mask: cos.gt(F32x8::ZERO) & distance.gt(F32x8::ZERO),
    }
}

/// Writes the rays of the next bounce.
#[inline(always)]
fn go_on(
    ctx: &Context,
    depth: u32,
    live: Mask8,
    incoming: &Incoming,
    points: &ShadingPoints,
    sample: &BsdfSample<F32x8>,
    (wo, origin, u_roulette): (Vec3<F32x8>, Vec3<F32x8>, F32x8),
    next: &mut Queue,
) {
    let wi = points.frame.to_world(sample.wi);
    let (origin, right_side) = leaving(ctx, points, origin, wi, wo.z * sample.wi.z);
    let mut alive = live & !sample.event.failed & right_side;
    let mut throughput = incoming.throughput * sample.f_cos * sample.pdf.recip();
    alive = alive & throughput.largest().gt(F32x8::ZERO);
    if ctx.russian_roulette && depth + 1 >= ROULETTE_FROM {
        let q = throughput.luminance().min(F32x8::lit(ROULETTE_CAP));
        alive = alive & u_roulette.lt(q);
        throughput *= q.recip();
    }
    if alive.any() {
        let lights = &ctx.world.lights;
        let pdf_environment = if ctx.plan.environment && matches!(lights.shining_sky(), Some(PreparedSky::Constant(_)))
        {
            let p = F32x8::splat(lights.environment_probability());
            pdf_cosine_hemisphere(sample.wi) * p
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
