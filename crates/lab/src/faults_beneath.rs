//! Planted faults beneath and around the lobes: textbook formulas misread, frames, lanes, sines, warps, the guard.

use crate::faults::planted;
use crate::frames::{self, kernel};
use crate::mitsuba::{self, Model};
use crate::normal_map::{self, Rules};
use crate::probe::{Dir, Worth};
use crate::run::Task;
use crate::zoo::{LAMBERT, METAL, SCHLICK};
use crate::{elementary, lanes, reference, totality, warps};
use gonio_kernel::lobe::AnyLobe;
use gonio_kernel::{F32x8, Frame, Real, Vec3};

/// One task per fault and instrument.
pub(crate) fn tasks() -> Vec<Task<'static>> {
    let mut tasks = Vec::from(misread());
    tasks.extend(beside_mitsuba());
    tasks.extend(around());
    tasks.extend([
        planted("left-handed frame", "frames", |run| {
            frames::measure(
                |n, t| {
                    let f = kernel(n, t);
                    Frame { y: -f.y, ..f }
                },
                run,
            )
        }),
        planted("tangent on the other side", "frames", |run| {
            frames::measure(
                |n, t| {
                    let f = kernel(n, t);
                    Frame { x: -f.x, y: -f.y, ..f }
                },
                run,
            )
        }),
        planted("tangent not orthonormalised", "frames", |run| {
            frames::measure(
                |n, t| Frame { x: t.unwrap_or(Vec3::unit_z()).normalize_or(kernel(n, t).x), ..kernel(n, t) },
                run,
            )
        }),
        planted("frame of a normal that is not normalised", "frames", |run| {
            frames::measure(|n, t| Frame { z: n, ..kernel(n, t) }, run)
        }),
        planted("tilted to the left hand", "frames", |run| {
            frames::measure_tilted(|f, n| Frame { y: -f.tilted(n).y, ..f.tilted(n) }, run)
        }),
        planted("tangent not leaned against the map's normal", "frames", |run| {
            frames::measure_tilted(|f, n| Frame { x: f.x, ..f.tilted(n) }, run)
        }),
        planted("green channel downwards", "frames", |run| {
            frames::measure_tilted(|f, n| f.tilted(Vec3::new(n.x, -n.y, n.z)), run)
        }),
        planted("map's normal below the surface used as it is", "frames", |run| {
            frames::measure_tilted(|f, n| Frame::from_normal_tangent(f.to_world(n), f.x), run)
        }),
        planted("normal left facing away", "frames", |run| frames::measure_facing(|n, _, _| n, run)),
        planted("geometric normal where the other faces away", "frames", |run| {
            let wrong: frames::Face = |n, geometric, wo| {
                let least = geometric.dot(wo).min(gonio_kernel::frame::GRAZING as f32);
                if n.dot(wo) >= least { n } else { geometric }
            };
            frames::measure_facing(wrong, run)
        }),
        planted("light on the wrong side kept", "normal-map", |run| {
            let rules = Rules { counts: |_, _, _| true, ..normal_map::KERNEL };
            normal_map::measure(rules, normal_map::LAMBERT, 30.0, run)
        }),
        planted("side decided by the shading normal", "normal-map", |run| {
            let rules = Rules { counts: |_, tilted, wi| tilted.z.dot(wi) > 0.0, ..normal_map::KERNEL };
            normal_map::measure(rules, normal_map::MIRROR, 30.0, run)
        }),
        planted("tilted to the other side", "normal-map", |run| {
            let rules = Rules { tilted: |f, n| f.tilted(Vec3::new(-n.x, n.y, n.z)), ..normal_map::KERNEL };
            normal_map::measure(rules, normal_map::MIRROR, 15.0, run)
        }),
        planted("bitangent 2 % too long", "normal-map", |run| {
            let wrong = |f: &Frame<f64>, n: Dir| Frame { y: f.tilted(n).y * 1.02, ..f.tilted(n) };
            normal_map::measure(Rules { tilted: wrong, ..normal_map::KERNEL }, normal_map::GGX, 30.0, run)
        }),
        planted("normal left facing away", "normal-map", |run| {
            let rules = Rules { facing: |n, _, _| n, ..normal_map::KERNEL };
            normal_map::measure(rules, normal_map::LAMBERT, 40.0, run)
        }),
        planted("cosine of the wrong sign in one quadrant", "elementary", |run| {
            let wrong = |u: f64| {
                let (s, c) = elementary::double(u);
                (s, if s < 0.0 && c < 0.0 { -c } else { c })
            };
            elementary::measure(wrong, false, run)
        }),
        planted("sine off by 4 ulp", "elementary", |run| {
            let wrong = |u: f64| {
                let (s, c) = elementary::single(u);
                (s * (1.0 + 4.0 * f64::from(f32::EPSILON)), c)
            };
            elementary::measure(wrong, true, run)
        }),
        planted("exponential with denormal results", "elementary", |_| {
            let gradual = |x: F32x8| F32x8::new(x.to_array().map(f32::exp));
            elementary::measure_function(&elementary::Function { lanes: gradual, ..elementary::FUNCTIONS[0] }, 20_011)
        }),
        planted("logarithm that takes denormal numbers for 0", "elementary", |_| {
            let flushed =
                |x: F32x8| F32x8::new(x.to_array().map(|x| if x.is_subnormal() { f32::NEG_INFINITY } else { x.ln() }));
            elementary::measure_function(&elementary::Function { lanes: flushed, ..elementary::FUNCTIONS[2] }, 20_011)
        }),
        planted("power through a logarithm of one word", "elementary", |run| {
            elementary::measure_pow(|x, y| (y * x.ln()).exp(), run)
        }),
        planted("lane 3 off by one ulp", "lanes", |run| {
            lanes::compare(
                run,
                1,
                &mut |random| vec![random.coarse() as f32],
                |x, out| {
                    let root = F32x8::new(std::array::from_fn(|l| x[l][0])).sqrt().to_array();
                    out.iter_mut()
                        .zip(root)
                        .enumerate()
                        .for_each(|(l, (out, x))| out.push(if l == 3 { x.next_up() } else { x }));
                },
                |x, out| out.push(x[0].sqrt()),
            )
        }),
        planted("triangle without its fold", "warps", |run| warps::measure_triangle(|[u, v]| [u * (1.0 - v), v], run)),
        planted("triangle that leaves itself", "warps", |run| warps::measure_triangle(|[u, v]| [u, v], run)),
    ]);
    tasks
}

/// Errors that a lobe would make in value and density alike: only a second opinion can tell.
fn misread() -> [Task<'static>; 4] {
    [
        planted("alpha_x and alpha_y swapped everywhere", "reference", |run| {
            reference::measure(&METAL, |s, p, wo, wi| reference::kernel(s, &swapped(p), wo, wi), run)
        }),
        planted("1/π missing in value and density", "reference", |run| {
            reference::measure(
                &LAMBERT,
                |s, p, wo, wi| {
                    let Worth { f_cos, pdf } = reference::kernel(s, p, wo, wi);
                    Worth { f_cos: f_cos.map(|f| f * std::f64::consts::PI), pdf: pdf * std::f64::consts::PI }
                },
                run,
            )
        }),
        planted("η and k exchanged", "reference", |run| {
            reference::measure(
                &METAL,
                |s, p, wo, wi| reference::kernel(s, &[&p[..2], &p[5..8], &p[2..5]].concat(), wo, wi),
                run,
            )
        }),
        planted("Schlick's power 4 for 5", "reference", |run| {
            reference::measure(
                &SCHLICK,
                |s, p, wo, wi| {
                    let Worth { f_cos, pdf } = reference::kernel(s, p, wo, wi);
                    let m = 1.0 - 0.5 * (wo + wi).length();
                    let ratio = |f0: f64| (f0 + (1.0 - f0) * m.powi(4)) / (f0 + (1.0 - f0) * m.powi(5)).max(1e-99);
                    Worth { f_cos: [0, 1, 2].map(|c| f_cos[c] * ratio(p[2 + c])), pdf }
                },
                run,
            )
        }),
    ]
}

/// The same errors beside another renderer's answers, in every model that can make them.
fn beside_mitsuba() -> impl Iterator<Item = Task<'static>> {
    let [diffuse, metal, rough_metal, glass, rough_glass, smooth] = &mitsuba::MODELS;
    let faults: [(&str, &Model, mitsuba::Kernel); 10] = [
        ("1/π missing in value and density", diffuse, |p, wo, wi| {
            let mut numbers = (mitsuba::MODELS[0].kernel)(p, wo, wi);
            numbers[..4].iter_mut().for_each(|x| *x *= std::f64::consts::PI);
            numbers
        }),
        ("alpha_x and alpha_y swapped everywhere", metal, |p, wo, wi| (mitsuba::MODELS[1].kernel)(&swapped(p), wo, wi)),
        ("alpha taken for roughness", metal, |p, wo, wi| {
            (mitsuba::MODELS[1].kernel)(&[&[p[0] * p[0], p[1] * p[1]], &p[2..]].concat(), wo, wi)
        }),
        ("alpha taken for a standard deviation", rough_metal, |p, wo, wi| {
            let root = std::f64::consts::SQRT_2;
            (mitsuba::MODELS[2].kernel)(&[&[p[0] * root, p[1] * root], &p[2..]].concat(), wo, wi)
        }),
        ("GGX for Beckmann", rough_metal, mitsuba::MODELS[1].kernel),
        ("index inverted where light is refracted", glass, |p, wo, wi| {
            let through = wo.z * wi.z < 0.0;
            (mitsuba::MODELS[3].kernel)(&[p[0], p[1], if through { p[2].recip() } else { p[2] }], wo, wi)
        }),
        ("radiance not compressed by refraction", glass, |p, wo, wi| {
            uncompressed((mitsuba::MODELS[3].kernel)(p, wo, wi), p[2], wo, wi)
        }),
        ("radiance not compressed by refraction", rough_glass, |p, wo, wi| {
            uncompressed((mitsuba::MODELS[4].kernel)(p, wo, wi), p[2], wo, wi)
        }),
        ("radiance not compressed by refraction", smooth, |p, wo, wi| {
            uncompressed((mitsuba::MODELS[5].kernel)(p, wo, wi), p[0], wo, wi)
        }),
        ("index inverted", smooth, |p, wo, wi| (mitsuba::MODELS[5].kernel)(&[p[0].recip()], wo, wi)),
    ];
    faults.into_iter().map(|(name, model, kernel)| {
        planted(&format!("{name} ({})", model.name), "mitsuba", move |run| mitsuba::measure(model, kernel, run))
    })
}

/// Values as importance.
fn uncompressed(mut numbers: [f64; 7], eta: f64, wo: Dir, wi: Dir) -> [f64; 7] {
    if wo.z * wi.z < 0.0 {
        let factor = if wo.z > 0.0 { eta * eta } else { (eta * eta).recip() };
        numbers[..3].iter_mut().for_each(|f| *f *= factor);
    }
    numbers
}

fn swapped(p: &[f64]) -> Vec<f64> {
    [&[p[1], p[0]], &p[2..]].concat()
}

/// Closures that keep neither of their promises.
fn around() -> [Task<'static>; 2] {
    fn clamped(p: &[f32]) -> AnyLobe<f32> {
        let inside: Vec<f32> = p.iter().zip(SCHLICK.parameters).map(|(&x, r)| x.max(r.lo).min(r.hi)).collect();
        (SCHLICK.single)(&inside)
    }
    fn too_narrow(p: &[F32x8]) -> AnyLobe<F32x8> {
        let narrow = F32x8::splat(1e-25);
        (SCHLICK.lanes)(&[&[p[0] * narrow, p[1] * narrow], &p[2..]].concat())
    }
    [
        planted("parameters outside the domain quietly clamped", "totality", |run| {
            totality::measure_special(&SCHLICK, clamped, run)
        }),
        planted("widths for which D overflows", "totality", |run| totality::measure_inside(&SCHLICK, too_narrow, run)),
    ]
}
