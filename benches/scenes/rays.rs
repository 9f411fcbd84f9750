//! The rays that a renderer casts at a scene, in eights.
//!
//! Camera rays go by tiles of 8 × 4 pixels, packets of 4 × 2, so that four packets in a row are a tile. Rays that start at the
//! hits of camera rays keep their order and close ranks where a camera ray missed: packets are full but for the last, and
//! neighbours stay neighbours.

use super::{Random, Scene};
use gonio_accel::{Accel, Hit8, Ray8, RayKind};
use gonio_kernel::warp::{sample_cosine_hemisphere, sample_uniform_sphere};
use gonio_kernel::{F32x8, Frame, Mask8, Real, Vec3, each_lane};
use gonio_tracer::{SHORT_OF_LIGHT, SurfacePoint};

/// Rays of one kind.
pub(crate) struct RaySet {
    /// What kind.
    pub(crate) name: &'static str,
    /// What a renderer would say of them.
    pub(crate) kind: RayKind,
    /// Whether any hit will do.
    pub(crate) any_hit: bool,
    /// The rays; dead lanes only in the last packet.
    pub(crate) packets: Vec<Ray8>,
    /// How many are alive.
    pub(crate) count: usize,
}

/// Room for the answers to a ray set; filled anew whenever it is asked.
pub(crate) struct Answers {
    pub(crate) hits: Vec<Hit8>,
    pub(crate) blocked: Vec<Mask8>,
}

impl Answers {
    pub(crate) fn of(set: &RaySet) -> Self {
        let n = set.packets.len();
        let (hits, blocked) = if set.any_hit { (0, n) } else { (n, 0) };
        Self { hits: vec![Hit8::miss(); hits], blocked: vec![Mask8::first(0); blocked] }
    }

    /// Asks a backend about all rays of the set, as of that kind.
    pub(crate) fn ask(&mut self, accel: &dyn Accel, kind: RayKind, set: &RaySet) {
        if set.any_hit {
            accel.occluded(kind, &set.packets, None, &mut self.blocked);
        } else {
            accel.closest(kind, &set.packets, &mut self.hits);
        }
    }
}

/// Names of all sets, in their order.
pub(crate) const NAMES: [&str; 5] = ["primary", "diffuse", "random", "shadow", "occlusion"];

/// All sets, with about `count` camera rays; the scout finds what they hit. Deterministic.
pub(crate) fn sets(scene: &Scene, scout: &dyn Accel, count: usize) -> [RaySet; 5] {
    let mut random = Random(11);
    let primary = primary(scene, count, &mut random);
    let mut hits = vec![Hit8::miss(); primary.len()];
    scout.closest(RayKind::Coherent, &primary, &mut hits);
    let starts = starts(scene, &primary, &hits);
    let diffuse = pack(starts.iter().map(|start| start.bounce(&mut random)));
    let shadow = pack(starts.iter().filter_map(|start| start.to_light(scene, &mut random)));
    let anywhere = pack(anywhere(scene, primary.len() * F32x8::LANES, &mut random));
    let occlusion = diffuse.clone();
    let [a, b, c, d, e] = NAMES;
    [
        RaySet::new(a, RayKind::Coherent, false, primary),
        RaySet::new(b, RayKind::Incoherent, false, diffuse),
        RaySet::new(c, RayKind::Incoherent, false, anywhere),
        RaySet::new(d, RayKind::Incoherent, true, shadow),
        RaySet::new(e, RayKind::Incoherent, true, occlusion),
    ]
}

impl RaySet {
    fn new(name: &'static str, kind: RayKind, any_hit: bool, packets: Vec<Ray8>) -> Self {
        let count = packets.iter().map(|ray| ray.mask.to_bits().count_ones() as usize).sum();
        Self { name, kind, any_hit, packets, count }
    }
}

/// A picture twice as wide as high, of about `count` pixels; each ray goes through some point of its pixel.
fn primary(scene: &Scene, count: usize, random: &mut Random) -> Vec<Ray8> {
    let tiles_across = ((count as f32 * 2.0).sqrt() / 8.0).round().max(1.0) as usize;
    let [width, height] = [8 * tiles_across, 4 * tiles_across];
    let camera = scene.camera;
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(Vec3::new(0.0, 1.0, 0.0)).normalize();
    let up = right.cross(forward);
    let half = (0.5 * camera.field_of_view.to_radians()).tan();
    let mut packets = Vec::with_capacity(width * height / F32x8::LANES);
    for tile in 0..tiles_across * tiles_across {
        let [left, top] = [tile % tiles_across * 8, tile / tiles_across * 4];
        for block in 0..4 {
            let dirs: [Vec3<f32>; F32x8::LANES] = std::array::from_fn(|lane| {
                let x = (left + block % 2 * 4 + lane % 4) as f32 + random.next();
                let y = (top + block / 2 * 2 + lane / 4) as f32 + random.next();
                let [x, y] = [x * 2.0 - width as f32, height as f32 - y * 2.0].map(|d| d * half / height as f32);
                (forward + right * x + up * y).normalize()
            });
            packets.push(Ray8::new(Vec3::broadcast(camera.eye), Vec3::from_lanes(|l| dirs[l])));
        }
    }
    packets
}

/// One ray: origin, direction, t_max.
type Ray = (Vec3<f32>, Vec3<f32>, f32);

fn pack(rays: impl Iterator<Item = Ray>) -> Vec<Ray8> {
    let rays: Vec<Ray> = rays.collect();
    let packet = |eight: &[Ray]| {
        // Lanes past the end repeat the last ray, and are dead.
        let lane = |l: usize| eight[l.min(eight.len() - 1)];
        let ray = Ray8::new(Vec3::from_lanes(|l| lane(l).0), Vec3::from_lanes(|l| lane(l).1));
        Ray8 { t_max: F32x8::from_fn(|l| lane(l).2), mask: Mask8::first(eight.len()), ..ray }
    };
    rays.chunks(F32x8::LANES).map(packet).collect()
}

/// Where a ray may start anew: off the surface, on the side that the first one came from.
struct Start {
    origin: Vec3<f32>,
    normal: Vec3<f32>,
}

/// Of every hit, in order.
fn starts(scene: &Scene, rays: &[Ray8], hits: &[Hit8]) -> Vec<Start> {
    let (meshes, instances) = (scene.geometry.meshes(), scene.geometry.instances());
    let mut starts = Vec::with_capacity(rays.len() * F32x8::LANES);
    for (ray, hit) in rays.iter().zip(hits) {
        let found = each_lane(|l| hit.lane(l));
        let corners = each_lane(|l| {
            let (mesh, instance, prim) = found[l].map_or((0, 0, 0), |hit| (hit.mesh, hit.instance, hit.prim));
            let (mesh, instance) = (&meshes[mesh as usize], &instances[instance as usize]);
            mesh.triangles[prim as usize].map(|v| Vec3::from(instance.to_world(mesh.positions[v as usize])))
        });
        let corners = [0, 1, 2].map(|c| Vec3::from_lanes(|l| corners[l][c]));
        let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let winding = across.normalize_or(Vec3::unit_z());
        let away = winding.dot(ray.dir);
        let normal = Vec3::select(away.gt(F32x8::ZERO), winding * F32x8::splat(-1.0), winding);
        let origin = SurfacePoint::new(&corners, hit.bary).off_plane(normal);
        let at = |v: Vec3<F32x8>, l: usize| Vec3::new(v.x.lane(l), v.y.lane(l), v.z.lane(l));
        let hit_lanes = (0..F32x8::LANES).filter(|&l| found[l].is_some());
        starts.extend(hit_lanes.map(|l| Start { origin: at(origin, l), normal: at(normal, l) }));
    }
    starts
}

impl Start {
    /// As diffuse light leaves.
    fn bounce(&self, random: &mut Random) -> Ray {
        let local = sample_cosine_hemisphere([random.next(), random.next()]);
        (self.origin, Frame::from_normal(self.normal).to_world(local), f32::INFINITY)
    }

    /// To some point of the light, just short of it; none from below the surface.
    fn to_light(&self, scene: &Scene, random: &mut Random) -> Option<Ray> {
        let [a, b] = [random.next(), random.next()];
        let to = scene.light.corner + scene.light.edges[0] * a + scene.light.edges[1] * b - self.origin;
        let distance = to.length();
        let above = to.dot(self.normal) > 0.0;
        above.then(|| (self.origin, to * (1.0 / distance), distance * SHORT_OF_LIGHT))
    }
}

/// From anywhere within the bounds in any direction.
fn anywhere<'a>(scene: &Scene, count: usize, random: &'a mut Random) -> impl Iterator<Item = Ray> + use<'a> {
    let extreme = |pick: fn(f32, f32) -> f32| {
        let corners = scene.geometry.world_triangles().flat_map(|triangle| triangle.corners);
        corners.reduce(|a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z))).unwrap_or(Vec3::splat(0.0))
    };
    let (lo, hi) = (extreme(f32::min), extreme(f32::max));
    (0..count).map(move |_| {
        let share = Vec3::new(random.next(), random.next(), random.next());
        let dir = sample_uniform_sphere([random.next(), random.next()]);
        (lo + (hi - lo).mul_each(share), dir, f32::INFINITY)
    })
}
