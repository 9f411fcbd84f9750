//! The shading stage: eight paths at a time receive emitted light, ask a light, and scatter.
//!
//! Multiple importance sampling: light that can be reached both by scattering and by asking the light is weighted by the
//! power heuristic on both sides; after the camera or a discrete event only scattering can reach it, with weight 1.
//! Per vertex the order of additions is: emission, then the answer of the shadow ray.

use crate::environment::EnvironmentMap;
use crate::layers::FirstHit;
use crate::light::{PreparedSky, Techniques};
use crate::material::lane_surface;
use crate::plan::Plan;
use crate::point::{ShadingPoints, SurfacePoint};
use crate::queue::{Batch, Paths, Queue, ShadowQueue};
use crate::sampler::{Purpose, Random4, Sampler};
use crate::world::{World, splat_rgb};
use gonio_accel::Ray8;
use gonio_kernel::frame::on_its_side;
use gonio_kernel::lobe::Lobe;
use gonio_kernel::surface::Weighted;
use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere, sample_uniform_triangle};
use gonio_kernel::{Closure, F32x8, Mask, Mask8, Real, Rgb, Surface, U32x8, Vec3, each_lane};

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
    let looked_up;
    let surface = match &materials[0].surface {
        Some(surface) if alike => surface,
        _ => {
            looked_up = lane_surface(materials, &ctx.world.textures, points.uv);
            &looked_up
        }
    };
    if !first.is_empty() {
        note_first_hit(ctx, batch, &incoming, &points, surface, first);
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

    let local = points.frame.to_local(wo);
    let closure = Closure::new(surface, local);
    let origin = points.point.off_plane(points.normal);

    let lights = &ctx.world.lights;
    if (ctx.plan.area_lights || ctx.plan.environment) && ctx.techniques != Techniques::Scattering {
        let u = ctx.sampler.draw(incoming.pixel, incoming.sample, depth, Purpose::Light);
        let toss = u.unit(0);
        let p_environment = F32x8::splat(lights.environment_probability());
        let ask_environment = toss.lt(p_environment);
        // The toss within the chosen strategy decides the emitter's alias; below 1 even after rounding.
        let rest = ((toss - p_environment) / (F32x8::ONE - p_environment)).min(F32x8::splat(0.999_999_94));
        for (kind, mask) in [(true, live & ask_environment), (false, live & !ask_environment)] {
            let wanted = if kind { ctx.plan.environment } else { ctx.plan.area_lights };
            if !wanted || !mask.any() {
                continue;
            }
            let place = [u.unit(2), u.unit(3)];
            let asked = match (kind, lights.shining_sky()) {
                (false, _) => ask_emitter(ctx, &points, origin, u.0[1], rest, place),
                (true, None) => continue,
                (true, Some(PreparedSky::Constant(sky))) => ask_sky(*sky, &points, place, p_environment),
                (true, Some(PreparedSky::Map(map))) => {
                    let place = ctx.sampler.draw(incoming.pixel, incoming.sample, depth, Purpose::Environment);
                    ask_map(map, &u, &place, p_environment)
                }
            };
            let wi = points.frame.to_local(asked.wi);
            let value = closure.eval(wi);
            let weight = ctx.techniques.weight(Techniques::Lights, asked.pdf, value.pdf) / asked.pdf;
            let arriving = incoming.throughput * value.f_cos * asked.radiance * weight;
            let (origin, right_side) = leaving(ctx, &points, origin, asked.wi, local.z * wi.z);
            let mask = mask & asked.mask & right_side & arriving.largest().gt(F32x8::ZERO);
            if mask.any() {
                shadow.push(mask, (origin, asked.wi, asked.t_max), arriving, &incoming.path);
            }
        }
    }
    scatter(ctx, depth, live, &incoming, &points, &closure, local, origin, next);
    live.to_bits().count_ones()
}

/// What the layers want to know of the surfaces that the camera sees.
#[inline(always)]
fn note_first_hit(
    ctx: &Context,
    batch: &Batch,
    incoming: &Incoming,
    points: &ShadingPoints,
    surface: &Surface<F32x8>,
    first: &mut [FirstHit],
) {
    let along_normal = |sum: Rgb<F32x8>, l: &Weighted<F32x8>| sum + l.lobe.albedo_estimate(Vec3::unit_z()) * l.weight;
    let albedo = surface.lobes().fold(Rgb::zero(), along_normal).map(|x| x.min(F32x8::ONE));
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

/// A direction in which light is asked for.
struct Asked {
    wi: Vec3<F32x8>,
    pdf: F32x8,
    radiance: Rgb<F32x8>,
    t_max: F32x8,
    mask: Mask8,
}

/// A cosine-distributed direction of a constant environment.
#[inline(always)]
fn ask_sky(radiance: Rgb<f32>, points: &ShadingPoints, place: [F32x8; 2], probability: F32x8) -> Asked {
    let local = sample_cosine_hemisphere(place);
    Asked {
        wi: points.frame.to_world(local),
        pdf: pdf_cosine_hemisphere(local) * probability,
        radiance: splat_rgb(radiance),
        t_max: F32x8::splat(f32::INFINITY),
        mask: Mask8::splat(true),
    }
}

/// A direction of a map by its luminance; `toss` are the numbers of the choice between lights, of which it uses the free ones.
#[inline(always)]
fn ask_map(map: &EnvironmentMap, toss: &Random4, place: &Random4, probability: F32x8) -> Asked {
    let wi = map.sample(place, [toss.0[1], toss.0[2]]);
    let seen = map.at(wi);
    Asked {
        wi,
        pdf: seen.pdf * probability,
        radiance: seen.radiance,
        t_max: F32x8::splat(f32::INFINITY),
        mask: seen.pdf.gt(F32x8::ZERO),
    }
}

/// A uniform point of an emitting triangle chosen by power.
#[inline(always)]
fn ask_emitter(
    ctx: &Context,
    points: &ShadingPoints,
    origin: Vec3<F32x8>,
    slot: U32x8,
    toss: F32x8,
    place: [F32x8; 2],
) -> Asked {
    let emitters = ctx.world.lights.pick(slot, toss);
    let normal = emitters.normal;
    let target = SurfacePoint::new(&emitters.corners, sample_uniform_triangle(place)).off_plane(normal);
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
    Asked {
        wi,
        pdf: pdf_area * distance2 / cos,
        radiance: emitters.radiance,
        t_max: distance * F32x8::splat(SHORT_OF_LIGHT),
        mask: cos.gt(F32x8::ZERO) & distance.gt(F32x8::ZERO),
    }
}

/// Chooses how the paths go on, and writes the rays of the next bounce.
#[inline(always)]
fn scatter(
    ctx: &Context,
    depth: u32,
    live: Mask8,
    incoming: &Incoming,
    points: &ShadingPoints,
    closure: &Closure<F32x8>,
    local: Vec3<F32x8>,
    origin: Vec3<F32x8>,
    next: &mut Queue,
) {
    let u = ctx.sampler.draw(incoming.pixel, incoming.sample, depth, Purpose::Scatter);
    let sample = closure.sample([u.unit(0), u.unit(1), u.unit(2)]);
    let mut value = closure.eval(sample.wi);
    let mut continuous = live;
    if ctx.plan.discrete && (sample.event.discrete & live).any() {
        let discrete = closure.discrete(&sample.event);
        value.f_cos = Rgb::select(sample.event.discrete, discrete.f_cos, value.f_cos);
        value.pdf = F32x8::select(sample.event.discrete, discrete.pdf, value.pdf);
        continuous = live & !sample.event.discrete;
    }
    let wi = points.frame.to_world(sample.wi);
    let (origin, right_side) = leaving(ctx, points, origin, wi, local.z * sample.wi.z);
    let mut alive = live & !sample.event.failed & right_side & value.pdf.gt(F32x8::ZERO);
    let mut throughput = incoming.throughput * value.f_cos * value.pdf.recip();
    alive = alive & throughput.largest().gt(F32x8::ZERO);
    if ctx.russian_roulette && depth + 1 >= ROULETTE_FROM {
        let q = throughput.luminance().min(F32x8::lit(ROULETTE_CAP));
        alive = alive & u.unit(3).lt(q);
        throughput = throughput * q.recip();
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
                pdf: value.pdf.or_zero(continuous),
                pdf_environment,
                path: U32x8::new(incoming.path),
                pixel: incoming.pixel,
                sample: incoming.sample,
            },
        );
    }
}
