//! What a normal map loses: the light that a tilted lobe sends to the wrong side of the surface.
//!
//! A normal map tilts the frame of a lobe and leaves the surface where it is. What the lobe then sends below the surface is
//! dropped (`gonio_kernel::frame::on_its_side`). For a white lobe, a tilt β and a viewer wo the loss is ∫ f·cos dω over
//! the wi above the shading normal and not above the geometric one: a lune between two great circles. In coordinates about
//! the axis that the two share it is a rectangle, 0 ≤ θ ≤ π, −β ≤ ψ ≤ 0, and what is returned is another, 0 ≤ ψ ≤ π − β, so
//! quadrature meets no edge.
//!
//! **Lambert.** n·wi = sinθ sin(ψ + β) and dω = sinθ dθ dψ, so the loss is ∫sin²θ dθ ∫sin(ψ + β) dψ/π = (1 − cosβ)/2,
//! wherever the viewer is. **Mirror.** A viewer at θ towards the tilt is mirrored to 2β − θ: all is lost or nothing,
//! as that is beyond 90° or not. **Any lobe.** Nothing is gained, a frame that is not tilted loses nothing, and the mean
//! weight of samples, each dropped by the same rule, is the integral.
//!
//! The losses themselves are in the note of each row, from viewers that face away from the tilt to those that face towards it.

use crate::finding::{Finding, Run};
use crate::probe::Dir;
use crate::quadrature::integrate;
use crate::random::Random;
use crate::statistics::bennett_p;
use crate::task::Task;
use gonio_kernel::closure::Unguarded;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{AnyLobe, Conductor, Eon, Lambert, Mirror};
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::{Frame, Lobe, Parameters, Rgb, Transport, Vec3, frame};
use std::f64::consts::PI;

/// What is under test: how a frame is tilted, with which normal a viewer is shown, and which light counts.
#[derive(Clone, Copy)]
pub(crate) struct Rules {
    pub(crate) tilted: fn(&Frame<f64>, Dir) -> Frame<f64>,
    pub(crate) facing: fn(n: Dir, geometric: Dir, wo: Dir) -> Dir,
    /// Of the surface's frame, the tilted one, and wi.
    pub(crate) counts: fn(&Frame<f64>, &Frame<f64>, Dir) -> bool,
}

/// The kernel's.
pub(crate) const KERNEL: Rules = Rules {
    tilted: Frame::tilted,
    facing: frame::facing,
    counts: |surface, _, wi| frame::on_its_side(surface.z, wi, false),
};

/// A lobe that absorbs nothing.
#[derive(Clone, Copy)]
pub(crate) struct White {
    name: &'static str,
    lobe: fn() -> AnyLobe<'static, f32>,
}

pub(crate) const LAMBERT: White = White { name: "white Lambert", lobe: || Lambert::new(Rgb::splat(1.0)).into() };
pub(crate) const GGX: White = White {
    name: "GGX α 0.5, F = 1",
    lobe: || Conductor::new(Ggx { alpha_x: 0.5, alpha_y: 0.5 }, Fresnel::Schlick { f0: Rgb::splat(1.0) }).into(),
};
pub(crate) const MIRROR: White = White { name: "white mirror", lobe: || Mirror::new(Rgb::splat(1.0)).into() };
const LOBES: [White; 5] = [
    LAMBERT,
    White { name: "white EON, roughness 1", lobe: || Eon::new(Rgb::splat(1.0), 1.0).into() },
    GGX,
    White {
        name: "GGX α 0.1, F = 1",
        lobe: || Conductor::new(Ggx { alpha_x: 0.1, alpha_y: 0.1 }, Fresnel::Schlick { f0: Rgb::splat(1.0) }).into(),
    },
    MIRROR,
];

/// Tilts in degrees; none that mirrors a view exactly into the surface.
const TILTS: [f64; 6] = [0.0, 5.0, 15.0, 30.0, 40.0, 60.0];
/// Viewers in the plane of the tilt, in degrees from the geometric normal: negative ones face away from the tilt.
const IN_PLANE: [f64; 7] = [-75.0, -50.0, -25.0, 0.0, 25.0, 50.0, 75.0];
/// A viewer beside that plane, likewise.
const SIDEWAYS: f64 = 50.0;

/// EON has kinks along curves that no rectangle follows: the estimated error of quadrature, about 1e-7, is too small there.
/// Albedos that are exactly 1 come out within 2e-6; five times that is a thousandth of a per cent.
const KINKS: f64 = 1e-5;

/// One row of the table for each lobe and tilt.
pub(crate) fn tasks() -> Vec<Task<'static>> {
    let all = LOBES.into_iter().flat_map(|lobe| TILTS.map(|tilt| (lobe, tilt)));
    all.map(|(lobe, tilt)| {
        let tests = if (lobe.lobe)().properties().all_delta { 0 } else { views().len() };
        let subject = format!("{} tilted by {tilt}°", lobe.name);
        Task::new("normal-map", subject, tests, move |run| measure(KERNEL, lobe, tilt, run))
    })
    .collect()
}

/// A viewer: its name, its direction before a surface tilted along x, and its angle if it is in the plane of the tilt.
struct View {
    name: String,
    wo: Dir,
    angle: Option<f64>,
}

fn views() -> Vec<View> {
    let at = |degrees: f64| degrees.to_radians().sin_cos();
    let in_plane = IN_PLANE.map(|angle| {
        let (sin, cos) = at(angle);
        View { name: format!("{angle}°"), wo: Vec3::new(sin, 0.0, cos), angle: Some(angle) }
    });
    let (sin, cos) = at(SIDEWAYS);
    let beside = View { name: format!("{SIDEWAYS}° sideways"), wo: Vec3::new(0.0, sin, cos), angle: None };
    in_plane.into_iter().chain([beside]).collect()
}

/// The smallest p-value of samples against the integral; broken where a law is.
pub(crate) fn measure(rules: Rules, white: White, tilt: f64, run: &Run) -> Finding {
    let mut random = run.random();
    let lobe: AnyLobe<'static, f64> = (white.lobe)().to();
    let all_delta = lobe.properties().all_delta;
    let (sin, cos) = tilt.to_radians().sin_cos();
    let mut finding = Finding::p_value(run.level);
    let mut losses = Vec::new();
    let mut error = 0.0_f64;
    for view in views() {
        // Anywhere in the world: nothing may depend on where x points.
        let flat = Frame::from_normal_tangent(random.above(), random.above());
        let n = (rules.facing)(Vec3::new(sin, 0.0, cos), Vec3::unit_z(), view.wo);
        let seen = Seen { rules, flat, tilted: (rules.tilted)(&flat, n), wo: flat.to_world(view.wo) };
        let name = &view.name;
        let faces = sin * view.wo.x + cos * view.wo.z >= frame::GRAZING;
        let (n, wo) = (seen.tilted.z, seen.wo);
        if n.dot(wo) <= 0.0 || faces && (flat.to_local(n) - Vec3::new(sin, 0.0, cos)).length() > 1e-14 {
            finding.broken(|| format!("{name}: the normal is shown as {:?}", flat.to_local(n)));
        }
        let loss = if all_delta {
            let loss = seen.mirrored(&lobe);
            let up = if faces { mirrored_upwards(&view, tilt) } else { false };
            if loss != f64::from(u8::from(!up)) {
                finding.broken(|| format!("{name}: {loss} is lost of a mirror that reflects to the outside: {up}"));
            }
            loss
        } else {
            let Returned { albedo, kept, square, error: off } =
                seen.integrated(&lobe, run.by_effort(100_000, 400_000, 2_000_000));
            let off = off + if matches!(lobe, AnyLobe::Lambert(_)) { 1e-12 } else { KINKS };
            error = error.max(off);
            if albedo > 1.0 + off + f64::from(lobe.properties().excess) || tilt == 0.0 && albedo - kept > off {
                finding.broken(|| format!("{name}: albedo {albedo:.9}, {kept:.9} of it on the surface's side"));
            }
            let exact = 0.5 * (1.0 - n.dot(flat.z));
            if matches!(lobe, AnyLobe::Lambert(_)) && (albedo - kept - exact).abs() + (albedo - 1.0).abs() > 2.0 * off {
                finding.broken(|| format!("{name}: {} of {albedo} is lost, exactly it is {exact}", albedo - kept));
            }
            let samples = run.by_effort(100_000, 400_000, 2_000_000);
            let mean = seen.sampled(&lobe, samples, &mut random);
            let reach = lobe.largest_weight(seen.tilted.to_local(seen.wo)).max(1.0);
            let p = bennett_p((mean - kept).abs() - off, samples as f64, square - kept * kept + off, reach);
            finding.lower(p, || format!("{name}: {mean:.6} by samples, {kept:.6} by quadrature"));
            albedo - kept
        };
        losses.push(format!("{:.2}{}", 100.0 * loss, if faces { "" } else { "*" }));
    }
    let named: Vec<_> = views().into_iter().map(|view| view.name).collect();
    let star = if losses.iter().any(|loss| loss.ends_with('*')) { "; *: turned to face the viewer" } else { "" };
    finding.note(format!("lost: {} % (± {error:.0e}) seen from {}{star}", losses.join(" | "), named.join(" | ")));
    finding
}

/// Whether a mirror whose normal faces the viewer reflects them to the outside, by angles alone.
fn mirrored_upwards(view: &View, tilt: f64) -> bool {
    match view.angle {
        Some(angle) => (2.0 * tilt - angle).abs() < 90.0,
        // 2(n·wo)n − wo with n·wo = cosβ cosθ has the height (2cos²β − 1) cosθ.
        None => (2.0 * tilt).to_radians().cos() > 0.0,
    }
}

/// A surface in the world, its tilted frame, and who looks at it.
struct Seen {
    rules: Rules,
    flat: Frame<f64>,
    tilted: Frame<f64>,
    wo: Dir,
}

/// What comes back of the light.
struct Returned {
    /// ∫ f·cos over the whole lobe.
    albedo: f64,
    /// Over what counts of it.
    kept: f64,
    /// ∫ (f·cos)²/pdf over the same: the mean square of a sample's weight.
    square: f64,
    error: f64,
}

impl Seen {
    fn integrated(&self, lobe: &AnyLobe<'static, f64>, budget: usize) -> Returned {
        let closure = Unguarded::new(lobe, self.tilted.to_local(self.wo), Transport::Radiance);
        let (z, n) = (self.flat.z, self.tilted.z);
        let aside = n - z * n.dot(z);
        let tilt = aside.length().atan2(n.dot(z));
        // In the plane of both normals, towards the tilt; then the axis of both great circles.
        let towards = aside.normalize_or(self.flat.x);
        let towards = (towards - z * towards.dot(z)).normalize();
        let axis = z.cross(towards);
        let f = |theta: f64, psi: f64| {
            let ((sin, cos), (up, along)) = (theta.sin_cos(), psi.sin_cos());
            let wi = axis * cos + (towards * along + z * up) * sin;
            let value = closure.eval(self.tilted.to_local(wi));
            let f_cos = value.f_cos.g * sin;
            let counts = f64::from(u8::from((self.rules.counts)(&self.flat, &self.tilted, wi)));
            let weight = if value.pdf > 0.0 { value.f_cos.g / value.pdf } else { 0.0 };
            [f_cos, counts * f_cos, counts * f_cos * weight, 0.0, 0.0, 0.0, 0.0]
        };
        // From the geometric horizon (v = 1) to the shading horizon (v = 0), where points lie close: seen at grazing, EON
        // has an edge there as narrow as the cosine.
        let [above, below] = [(PI - tilt, -(PI - tilt)), (-tilt, tilt)].map(|(horizon, span)| {
            let g = |theta: f64, v: f64| f(theta, horizon + span * v * v).map(|x| 2.0 * v * span.abs() * x);
            integrate(&g, [[0.0, PI], [0.0, 1.0]], 1e-9, budget)
        });
        let [albedo, kept, square] = [0, 1, 2].map(|i| above.value[i] + below.value[i]);
        Returned { albedo, kept, square, error: above.error + below.error }
    }

    /// The mean weight of samples, those that do not count being 0.
    fn sampled(&self, lobe: &AnyLobe<'static, f64>, samples: usize, random: &mut Random) -> f64 {
        let closure = Unguarded::new(lobe, self.tilted.to_local(self.wo), Transport::Radiance);
        let one = |random: &mut Random| {
            let sample = closure.sample(random.sampler_input(false));
            let value = closure.eval(sample.wi);
            let counts = (self.rules.counts)(&self.flat, &self.tilted, self.tilted.to_world(sample.wi));
            if counts && !sample.event.failed && value.pdf > 0.0 { value.f_cos.g / value.pdf } else { 0.0 }
        };
        (0..samples).map(|_| one(random)).sum::<f64>() / samples as f64
    }

    /// What is lost of the one direction into which a mirror reflects.
    fn mirrored(&self, lobe: &AnyLobe<'static, f64>) -> f64 {
        let closure = Unguarded::new(lobe, self.tilted.to_local(self.wo), Transport::Radiance);
        let sample = closure.sample([0.5; 3]);
        let value = closure.delta(&sample);
        let counts = (self.rules.counts)(&self.flat, &self.tilted, self.tilted.to_world(sample.wi));
        if counts && value.pdf > 0.0 { 1.0 - value.f_cos.g / value.pdf } else { 1.0 }
    }
}
