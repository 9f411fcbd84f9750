//! Cases read: numbers, directions and materials of JSON in every arithmetic, at one place among strangers.

use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::eon::Directional;
use gonio_kernel::lobe::{AnyLobe, Conductor, Dielectric, Eon, Lambert, Mirror, Phong, PhongNorm, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Ggx, Masking, Microfacets};
use gonio_kernel::{Alpha, F32x8, Mask8, Real, Rgb, Roughness, Surface, Value, Vec3};
use serde_json::Value as Json;

/// A `Real` whose number at one place is ours.
pub(super) trait Arithmetic: Real {
    const NAME: &'static str;
    /// x at the place `at`; strangers elsewhere.
    fn put(x: f64, at: usize) -> Self;
    /// x everywhere.
    fn all(x: f64) -> Self;
    fn get(self, at: usize) -> f64;
    fn is(mask: Self::Mask, at: usize) -> bool;
}

macro_rules! scalar {
    ($t:ty, $name:literal) => {
        impl Arithmetic for $t {
            const NAME: &'static str = $name;
            fn put(x: f64, _: usize) -> $t {
                x as $t
            }
            fn all(x: f64) -> $t {
                x as $t
            }
            fn get(self, _: usize) -> f64 {
                f64::from(self)
            }
            fn is(mask: bool, _: usize) -> bool {
                mask
            }
        }
    };
}
scalar!(f32, "f32");
scalar!(f64, "f64");

impl Arithmetic for F32x8 {
    const NAME: &'static str = "lanes";
    fn put(x: f64, at: usize) -> Self {
        const STRANGERS: [f32; 8] = [0.6, f32::NAN, 0.0, -1.0, f32::INFINITY, 1e-40, 0.8, 0.5];
        Self::new(std::array::from_fn(|l| if l == at { x as f32 } else { STRANGERS[l] }))
    }
    fn all(x: f64) -> Self {
        Self::splat(x as f32)
    }
    fn get(self, at: usize) -> f64 {
        f64::from(self.to_array()[at])
    }
    fn is(mask: Mask8, at: usize) -> bool {
        mask.lane(at)
    }
}

/// A JSON number, or one that JSON cannot say: "nan", "inf", "-inf", "-0.0", "0x1p-149".
pub(super) fn number(json: &Json) -> f64 {
    if let Some(x) = json.as_f64() {
        return x;
    }
    let text = json.as_str().unwrap_or_else(|| panic!("{json} is no number"));
    match text.strip_prefix("0x").and_then(|text| text.split_once('p')) {
        Some((mantissa, exponent)) => {
            let mantissa = u32::from_str_radix(mantissa, 16).expect("a hexadecimal integer");
            f64::from(mantissa) * 2.0_f64.powi(exponent.parse().expect("an exponent"))
        }
        None => text.parse().unwrap_or_else(|_| panic!("{text} is no number")),
    }
}

pub(super) fn vector<R: Arithmetic>(json: &Json, at: usize) -> Vec3<R> {
    let x = |axis: usize| R::put(number(&json[axis]), at);
    Vec3::new(x(0), x(1), x(2))
}

pub(super) fn read<R: Arithmetic>(w: Vec3<R>, at: usize) -> [f64; 3] {
    [w.x, w.y, w.z].map(|x| x.get(at))
}

pub(super) fn numbers<R: Arithmetic>(value: &Value<R>, at: usize) -> [f64; 4] {
    [value.f_cos.r, value.f_cos.g, value.f_cos.b, value.pdf].map(|x| x.get(at))
}

/// The kernel's surface of a material, out of its domain or not. (A material file would refuse what is out of it.)
pub(super) fn surface<R: Arithmetic>(material: &Json) -> Surface<R> {
    match material["lobes"].as_array() {
        Some(lobes) => {
            lobes.iter().fold(Surface::black(), |s, json| s.with(R::all(number(&json["weight"])), lobe::<R>(json)))
        }
        None => Surface::of(lobe::<R>(material)),
    }
}

pub(super) fn lobe<R: Arithmetic>(json: &Json) -> AnyLobe<R> {
    let scalar = |key: &str| R::all(number(&json[key]));
    let colour = |key: &str| {
        let c = &json[key];
        Rgb::new(R::all(number(&c[0])), R::all(number(&c[1])), R::all(number(&c[2])))
    };
    let word = |key: &str, default| json[key].as_str().unwrap_or(default).to_owned();
    let has = |key: &str| json.get(key).is_some();
    let microfacets = || -> Microfacets<R> {
        let same = || match has("alpha") {
            true => scalar("alpha"),
            false => Alpha::from(Roughness(scalar("roughness"))).0,
        };
        let [alpha_x, alpha_y] = match has("alpha_x") {
            true => [scalar("alpha_x"), scalar("alpha_y")],
            false => [same(), same()],
        };
        match &*word("distribution", "ggx") {
            "ggx" => Ggx { alpha_x, alpha_y }.into(),
            "beckmann" => Beckmann { alpha_x, alpha_y }.into(),
            other => panic!("unknown distribution {other}"),
        }
    };
    let masking = match &*word("masking", "correlated") {
        "correlated" => Masking::HeightCorrelated,
        "separable" => Masking::Separable,
        other => panic!("unknown masking {other}"),
    };
    match json["type"].as_str() {
        Some("diffuse") => Lambert::new(colour("base_color")).into(),
        Some("mirror") => Mirror::new(colour("reflectance")).into(),
        Some("eon") => {
            let directional =
                if word("albedo", "exact") == "fitted" { Directional::Fitted } else { Directional::Exact };
            Eon { directional, ..Eon::new(colour("base_color"), scalar("roughness")) }.into()
        }
        Some("phong") => {
            let lecture = word("normalization", "lafortune") == "lecture";
            let norm = if lecture { PhongNorm::Lecture } else { PhongNorm::Lafortune };
            Phong { diffuse: colour("diffuse"), glossy: colour("glossy"), exponent: scalar("exponent"), norm }.into()
        }
        Some("conductor") => {
            let fresnel = if has("eta") {
                Fresnel::Conductor { eta: colour("eta"), k: colour("k") }
            } else if has("ior") {
                Fresnel::Dielectric { eta: scalar("ior") }
            } else if has("f82") {
                Fresnel::F82 { f0: colour("f0"), tint: colour("f82") }
            } else {
                Fresnel::Schlick { f0: colour("f0") }
            };
            Conductor::new(microfacets(), fresnel).with_masking(masking).into()
        }
        Some("dielectric") if ["alpha", "alpha_x", "roughness"].iter().any(|key| has(key)) => {
            RoughDielectric::new(microfacets(), scalar("ior")).with_masking(masking).into()
        }
        Some("dielectric") => Dielectric::new(scalar("ior")).into(),
        other => panic!("unknown type {other:?}"),
    }
}
