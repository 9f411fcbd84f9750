//! Cases read: numbers, directions and materials of JSON in every arithmetic, at one place among strangers.

use gonio_kernel::lobe::AnyLobe;
use gonio_kernel::model::{Parameter, Problem, Source, Words};
use gonio_kernel::{F32x8, Mask8, Parameters, Real, Rgb, Surface, Value, Vec3};
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
    let one = |surface: Surface<R>, json: &Json| {
        let weight = json.get("weight").map_or(1.0, number);
        let lobe = AnyLobe::read(&mut Keys(json)).unwrap_or_else(|why| panic!("{json}: {why}"));
        surface.with(R::all(weight), lobe).unwrap_or_else(|why| panic!("{material}: {why}"))
    };
    match material["lobes"].as_array() {
        Some(lobes) => lobes.iter().fold(Surface::black(), one),
        None => one(Surface::black(), material),
    }
}

/// A JSON object as a source of parameters, in whatever range.
struct Keys<'a>(&'a Json);

impl<R: Arithmetic> Source<R> for Keys<'_> {
    type Error = String;

    fn model(&self) -> &str {
        self.0["type"].as_str().unwrap_or("diffuse")
    }
    fn has(&self, key: &str) -> bool {
        self.0.get(key).is_some()
    }
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<R>, String> {
        Ok(self.0.get(parameter.key).map(|json| R::all(number(json))))
    }
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<R>>, String> {
        let channel = |json: &Json, c: usize| R::all(number(json.get(c).unwrap_or(json)));
        Ok(self.0.get(parameter.key).map(|c| Rgb::new(channel(c, 0), channel(c, 1), channel(c, 2))))
    }
    fn word(&mut self, words: &'static Words) -> Result<Option<usize>, String> {
        let Some(json) = self.0.get(words.key) else { return Ok(None) };
        json.as_str().and_then(|word| words.find(word)).map(Some).ok_or_else(|| format!("{json} is no {}", words.key))
    }
    fn break_rule(&mut self, _: &'static str) -> Result<(), String> {
        Ok(())
    }
    fn refuse(&mut self, problem: Problem) -> String {
        format!("{problem:?}")
    }
}
