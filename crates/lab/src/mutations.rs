//! Mutation tests of building blocks: textbook formulas misread, frames, lanes, sines, warps, the guard. Each must be caught.

use crate::catalog::{Variant, variants};
use crate::finding::{Finding, Run};
use crate::frames::{self, kernel};
use crate::mitsuba::{self, Model};
use crate::normal_map::{self, Rules};
use crate::probe::{BsdfValue, Dir, Probe};
use crate::task::{Task, planted};
use crate::test_bsdf::{Answer, DynBsdf, Number, Question};
use crate::{elementary, lanes, reference, totality, warps};
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::AnyLobe;
use gonio_kernel::microfacet::{Distribution, Microfacets};
use gonio_kernel::model::Role;
use gonio_kernel::{BsdfSample, F32x8, Frame, Properties, Real, Value, Vec3};

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

type Lobe64 = AnyLobe<'static, f64>;

/// A measurement of a variant by name; one that is no longer there is a fault that is not caught.
fn of_variant(name: &str, run: &Run, measure: impl Fn(&Variant, &Run) -> Finding) -> Finding {
    let variant = variants().into_iter().find(|variant| variant.name == name);
    variant.map_or_else(|| Finding::at_most(0.0, "no such variant"), |variant| measure(&variant, run))
}

/// Errors that a lobe would make in value and density alike: only a second opinion can tell.
fn misread() -> [Task<'static>; 4] {
    let against = |name, variant: &'static str, model: reference::Model| {
        planted(name, "reference", move |run| {
            of_variant(variant, run, |variant, run| reference::measure(variant, model, run))
        })
    };
    [
        against("alpha_x and alpha_y swapped everywhere", "conductor eta+k", |lobe, wo, wi| {
            reference::kernel(&of_microfacets(lobe, swapped), wo, wi)
        }),
        against("1/π missing in value and density", "lambert", |lobe, wo, wi| {
            let BsdfValue { f_cos, pdf } = reference::kernel(lobe, wo, wi);
            BsdfValue { f_cos: f_cos.map(|f| f * std::f64::consts::PI), pdf: pdf * std::f64::consts::PI }
        }),
        against("η and k exchanged", "conductor eta+k", |lobe, wo, wi| {
            let mut lobe = *lobe;
            if let AnyLobe::Conductor(l) = &mut lobe
                && let Fresnel::Conductor { eta, k } = &mut l.fresnel
            {
                std::mem::swap(eta, k);
            }
            reference::kernel(&lobe, wo, wi)
        }),
        against("Schlick's power 4 for 5", "conductor f0", |lobe, wo, wi| {
            let BsdfValue { f_cos, pdf } = reference::kernel(lobe, wo, wi);
            let f0 = match lobe {
                AnyLobe::Conductor(l) => l.fresnel.reflectance(1.0).into(),
                _ => [1.0; 3],
            };
            let m = 1.0 - 0.5 * (wo + wi).length();
            let ratio = |f0: f64| (f0 + (1.0 - f0) * m.powi(4)) / (f0 + (1.0 - f0) * m.powi(5)).max(1e-99);
            BsdfValue { f_cos: [0, 1, 2].map(|c| f_cos[c] * ratio(f0[c])), pdf }
        }),
    ]
}

/// The same errors beside another renderer's answers, in every model that can make them.
fn beside_mitsuba() -> impl Iterator<Item = Task<'static>> {
    let [diffuse, metal, rough_metal, glass, rough_glass, smooth] = &mitsuba::MODELS;
    let faults: [(&str, &Model, mitsuba::Kernel); 10] = [
        ("1/π missing in value and density", diffuse, |lobe, wo, wi| {
            let mut numbers = mitsuba::kernel(lobe, wo, wi);
            numbers[..4].iter_mut().for_each(|x| *x *= std::f64::consts::PI);
            numbers
        }),
        ("alpha_x and alpha_y swapped everywhere", metal, |lobe, wo, wi| {
            mitsuba::kernel(&of_microfacets(lobe, swapped), wo, wi)
        }),
        ("alpha taken for roughness", metal, |lobe, wo, wi| {
            mitsuba::kernel(&of_microfacets(lobe, |m| with_alphas(m, |alpha| alpha * alpha)), wo, wi)
        }),
        ("alpha taken for a standard deviation", rough_metal, |lobe, wo, wi| {
            let root = |alpha| alpha * std::f64::consts::SQRT_2;
            mitsuba::kernel(&of_microfacets(lobe, |m| with_alphas(m, root)), wo, wi)
        }),
        ("GGX for Beckmann", rough_metal, |lobe, wo, wi| {
            mitsuba::kernel(&of_microfacets(lobe, |m| Microfacets { distribution: Distribution::Ggx, ..m }), wo, wi)
        }),
        ("index inverted where light is refracted", glass, |lobe, wo, wi| {
            let lobe = if wo.z * wi.z < 0.0 { inverted(lobe) } else { *lobe };
            mitsuba::kernel(&lobe, wo, wi)
        }),
        ("radiance not scaled by refraction", glass, unscaled),
        ("radiance not scaled by refraction", rough_glass, unscaled),
        ("radiance not scaled by refraction", smooth, unscaled),
        ("index inverted", smooth, |lobe, wo, wi| mitsuba::kernel(&inverted(lobe), wo, wi)),
    ];
    faults.into_iter().map(|(name, model, kernel)| {
        planted(&format!("{name} ({})", model.name), "mitsuba", move |run| mitsuba::measure(model, kernel, run))
    })
}

/// Values as importance.
fn unscaled(lobe: &Lobe64, wo: Dir, wi: Dir) -> [f64; 7] {
    let mut numbers = mitsuba::kernel(lobe, wo, wi);
    if wo.z * wi.z < 0.0 {
        let scale = gonio_kernel::Lobe::radiance_scale(lobe, wo);
        numbers[..3].iter_mut().for_each(|f| *f *= scale);
    }
    numbers
}

/// A lobe with other microfacets.
fn of_microfacets(lobe: &Lobe64, change: impl Fn(Microfacets<f64>) -> Microfacets<f64>) -> Lobe64 {
    let mut lobe = *lobe;
    match &mut lobe {
        AnyLobe::Conductor(l) => l.microfacets = change(l.microfacets),
        AnyLobe::RoughDielectric(l) => l.microfacets = change(l.microfacets),
        _ => {}
    }
    lobe
}
fn swapped(mut microfacets: Microfacets<f64>) -> Microfacets<f64> {
    std::mem::swap(&mut microfacets.alphas.alpha_x, &mut microfacets.alphas.alpha_y);
    microfacets
}
fn with_alphas(mut microfacets: Microfacets<f64>, change: impl Fn(f64) -> f64) -> Microfacets<f64> {
    let alphas = &mut microfacets.alphas;
    (alphas.alpha_x, alphas.alpha_y) = (change(alphas.alpha_x), change(alphas.alpha_y));
    microfacets
}
/// With the inverse index.
fn inverted(lobe: &Lobe64) -> Lobe64 {
    let mut lobe = *lobe;
    match &mut lobe {
        AnyLobe::Dielectric(l) => l.eta = l.eta.recip(),
        AnyLobe::RoughDielectric(l) => l.eta = l.eta.recip(),
        _ => {}
    }
    lobe
}

/// A lobe that takes other numbers for those that it is given.
struct Changed<'a> {
    base: &'a (dyn DynBsdf<'static> + 'a),
    change: fn(&Number, f32) -> f32,
}

impl Changed<'_> {
    fn changed(&self, numbers: &[f32]) -> Vec<f32> {
        self.base.numbers().iter().zip(numbers).map(|(number, &x)| (self.change)(number, x)).collect()
    }
}

impl DynBsdf<'static> for Changed<'_> {
    fn numbers(&self) -> Vec<Number> {
        self.base.numbers()
    }
    fn domain_at(&self, numbers: &[f32]) -> bool {
        self.base.domain_at(numbers)
    }
    fn is_combination(&self) -> bool {
        self.base.is_combination()
    }
    fn properties_at(&self, numbers: &[f64]) -> Properties<f64> {
        self.base.properties_at(numbers)
    }
    fn single_probe(&self, numbers: &[f32]) -> Box<dyn Probe> {
        self.base.single_probe(&self.changed(numbers))
    }
    fn double_probe(&self, numbers: &[f64]) -> Box<dyn Probe> {
        self.base.double_probe(numbers)
    }
    fn answer(&self, numbers: &[f32], question: &Question) -> Answer {
        self.base.answer(&self.changed(numbers), question)
    }
    fn answer_lanes(&self, numbers: &[[f32; 8]], questions: &[Question; 8]) -> [Answer; 8] {
        let all = self.base.numbers();
        let change = |(number, lanes): (&Number, &[f32; 8])| lanes.map(|x| (self.change)(number, x));
        self.base.answer_lanes(&all.iter().zip(numbers).map(change).collect::<Vec<_>>(), questions)
    }
    fn answer_gathered(&self, numbers: &[Vec<f32>; 8], questions: &[Question; 8]) -> [Answer; 8] {
        self.base.answer_gathered(&numbers.each_ref().map(|numbers| self.changed(numbers)), questions)
    }
    fn guarded(&self, numbers: &[f32], question: &Question) -> (Value<f32>, BsdfSample<f32>) {
        self.base.guarded(&self.changed(numbers), question)
    }
}

/// Closures that keep neither of their promises.
fn around() -> [Task<'static>; 2] {
    let spoilt = |name, change: fn(&Number, f32) -> f32, measure: fn(&dyn DynBsdf, &Run) -> Finding| {
        planted(name, "totality", move |run| {
            of_variant("conductor f0", run, |variant, run| measure(&Changed { base: &variant.surface(), change }, run))
        })
    };
    [
        spoilt(
            "parameters outside the domain quietly clamped",
            |number, x| {
                let quantity = number.parameter.quantity;
                x.max(quantity.lo as f32).min(quantity.hi as f32)
            },
            totality::measure_special,
        ),
        spoilt(
            "alphas for which D overflows",
            |number, x| if number.is(Role::Alpha) { x * 1e-25 } else { x },
            totality::measure_inside,
        ),
    ]
}
