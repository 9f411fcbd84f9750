//! The hard cases: inputs that broke other renderers, replayed in f32, f64 and every one of eight lanes.
//!
//! The corpus is `hard_cases/*.json`; its README describes the schema, so that any renderer can replay it. Each case goes
//! through the guarded closure and, where its input lies inside the domain, through the unguarded mixture as well.
//! In lanes it visits every position, beside neighbours that are NaN, infinite or ordinary.

mod input;

use gonio_kernel::closure::Unguarded;
use gonio_kernel::{Closure, F32x8, Frame, Lobe, Surface, Transport, Value, Vec3};
use input::{Arithmetic, number, numbers, read, surface, vector};
use serde_json::{Value as Json, json};
use std::fs;
use std::path::Path;

/// What is not finite, or negative.
fn unsound(values: &[[f64; 4]]) -> Option<String> {
    let sound = values.iter().flatten().all(|x| x.is_finite() && *x >= 0.0);
    (!sound).then(|| format!("{values:?} is not finite and non-negative"))
}

/// Three uniform numbers of a sampler: ordinary ones and the ends of their range.
const INPUTS: [[f64; 3]; 8] = [
    [0.5, 0.5, 0.5],
    [0.25, 0.75, 0.125],
    [0.75, 0.1, 0.9],
    [0.0, 0.0, 0.0],
    [0.999_999_94, 0.999_999_94, 0.999_999_94],
    [0.0, 0.9, 0.999_999_94],
    [0.999_999_94, 0.5, 0.0],
    [0.1, 0.3, 0.7],
];

/// A sample with its value.
struct Drawn {
    wi: [f64; 3],
    value: [f64; 4],
    failed: bool,
    is_delta: bool,
    transmitted: bool,
}

impl Drawn {
    fn weight(&self) -> f64 {
        self.value[..3].iter().fold(0.0, |most: f64, f| most.max(f / self.value[3]))
    }
}

/// Everything that a case is asked in one arithmetic at one place.
struct Replay<'a, R: Arithmetic> {
    surface: Surface<R>,
    wo: Vec3<R>,
    wi: Vec3<R>,
    at: usize,
    expect: &'a Json,
}

impl<'a, R: Arithmetic> Replay<'a, R> {
    fn of(case: &'a Json, at: usize) -> Self {
        let direction = |key: &str| case.get(key).map_or_else(Vec3::unit_z, |w| vector(w, at));
        Self {
            surface: surface(&case["material"]),
            wo: direction("wo"),
            wi: direction("wi"),
            at,
            expect: &case["expect"],
        }
    }
    fn is_inside(&self) -> bool {
        R::is(self.wo.is_direction() & self.wi.is_direction() & self.surface.domain(), self.at)
    }
    /// Guarded, and unguarded if inside the domain.
    fn values(&self) -> Vec<[f64; 4]> {
        let guarded = Closure::new(&self.surface, self.wo).eval(self.wi);
        let mut values = vec![numbers(&guarded, self.at)];
        if self.is_inside() {
            values.push(numbers(&Unguarded::new(&self.surface, self.wo, Transport::Radiance).eval(self.wi), self.at));
        }
        values
    }
    fn draw(&self, wo: Vec3<R>, u: [f64; 3]) -> Drawn {
        let closure = Closure::new(&self.surface, wo);
        let sample = closure.sample(u.map(|u| R::put(u, self.at)));
        let event = &sample.event;
        let [failed, is_delta, transmitted] =
            [event.failed, event.is_delta, event.transmitted].map(|mask| R::is(mask, self.at));
        let value = Value { f_cos: sample.f_cos, pdf: sample.pdf };
        Drawn { wi: read(sample.wi, self.at), value: numbers(&value, self.at), failed, is_delta, transmitted }
    }
    fn draws(&self) -> impl Iterator<Item = Drawn> {
        INPUTS.iter().map(|&u| self.draw(self.wo, u))
    }
    /// The expectation's number for this arithmetic: `key_f64` where there is one and it is f64.
    fn limit(&self, key: &str, default: f64, default_f64: f64) -> f64 {
        let double = R::NAME == "f64";
        let own = self.expect.get(format!("{key}_f64")).filter(|_| double);
        let found = own.or_else(|| self.expect.get(key).filter(|_| !double || key != "tolerance"));
        found.map_or(if double { default_f64 } else { default }, number)
    }

    /// What is wrong with one expectation, if anything.
    fn judge(&self, key: &str, wanted: &Json) -> Option<String> {
        let near = |x: f64, wanted: f64, tolerance: f64| (x - wanted).abs() <= tolerance * wanted.abs() + 1e-44;
        let tolerance = self.limit("tolerance", 1e-5, 1e-9);
        let values = self.values();
        match key {
            "f_cos" => {
                let wanted: [f64; 3] = std::array::from_fn(|c| number(wanted.get(c).unwrap_or(wanted)));
                let fine = |v: &[f64; 4]| (0..3).all(|c| near(v[c], wanted[c], tolerance));
                (!values.iter().all(fine)).then(|| format!("f_cos {values:?} instead of {wanted:?}"))
            }
            "pdf" => {
                let wanted = number(wanted);
                let fine = values.iter().all(|v| near(v[3], wanted, tolerance));
                (!fine).then(|| format!("pdf {values:?} instead of {wanted}"))
            }
            "f_cos_below" => {
                let bound = number(wanted);
                let fine = values.iter().all(|v| v[..3].iter().all(|f| *f <= bound));
                (!fine).then(|| format!("{values:?} is not below {bound}"))
            }
            "zero" => {
                let nothing = values.iter().flatten().all(|x| x.to_bits() == 0);
                (!nothing).then(|| format!("{values:?} is not exactly zero"))
            }
            "positive" => {
                let fine = values.iter().all(|v| v.iter().all(|x| x.is_finite() && *x > 0.0));
                (!fine).then(|| format!("{values:?} is not positive"))
            }
            "finite" => {
                let wrong = self.draws().find(|d| {
                    let length2: f64 = d.wi.iter().map(|x| x * x).sum();
                    unsound(&[d.value]).is_some() || (length2 - 1.0).abs() > 2e-3 || length2.is_nan()
                });
                if let Some(d) = wrong {
                    return Some(format!("samples {:?} with {:?}", d.wi, d.value));
                }
                unsound(&values)
            }
            "sample_fails" => {
                let alive = self.draws().find(|d| !d.failed);
                alive.map(|d| format!("samples {:?}", d.wi))
            }
            "weight_at_most" => {
                let bound = number(wanted) * 1.000_02;
                let heavy = self.draws().find(|d| !(d.failed || (d.value[3] > 0.0 && d.weight() <= bound)));
                heavy.map(|d| format!("a sample towards {:?} weighs {} ({:?})", d.wi, d.weight(), d.value))
            }
            "equals_mirror" => {
                let [x, y, z] = read(self.wo, self.at);
                let (distance, weight) = (number(wanted), number(&self.expect["weight"]));
                // The ends of the sampler's range belong to the tail of the distribution.
                let ordinary = [[0.5, 0.5, 0.5], [0.25, 0.75, 0.125], [0.75, 0.1, 0.9]];
                let wrong = ordinary.iter().map(|&u| self.draw(self.wo, u)).find(|d| {
                    let apart = (d.wi[0] + x).hypot(d.wi[1] + y).hypot(d.wi[2] - z);
                    d.failed || apart.is_nan() || apart > distance || !near(d.weight(), weight, 1e-5 + distance)
                });
                wrong.map(|d| format!("a sample towards {:?} weighs {}, failed {}", d.wi, d.weight(), d.failed))
            }
            "reflectance" => {
                // The probability of the delta reflection, which no other sample may have.
                let limit = self.limit("absolute", 1e-6, 1e-9);
                let wanted = number(wanted);
                let mut seen = false;
                for u in (0..200).map(|i| [f64::from(i) / 200.0, 0.5, 0.5]) {
                    let d = self.draw(self.wo, u);
                    if d.failed || !d.is_delta {
                        return Some(format!("u {u:?} gives no delta event"));
                    }
                    let expected = if d.transmitted { 1.0 - wanted } else { wanted };
                    seen |= !d.transmitted;
                    let wrong = (d.value[3] - expected).abs();
                    if wrong.is_nan() || wrong > limit {
                        let what = if d.transmitted { "transmitted" } else { "reflected" };
                        return Some(format!("{what} with probability {} instead of {expected}", d.value[3]));
                    }
                }
                (!seen && wanted > 0.01).then(|| "nothing is reflected".to_owned())
            }
            "returns" => {
                let through = (0..50).map(|i| self.draw(self.wo, [0.019 + f64::from(i) / 51.0, 0.5, 0.5]));
                let Some(there) = through.into_iter().find(|d| d.transmitted && !d.failed) else {
                    return Some("nothing passes".to_owned());
                };
                let turned: Vec3<R> = Vec3::from(there.wi.map(|x| R::put(x, self.at)));
                let back = (0..50).map(|i| self.draw(turned, [0.019 + f64::from(i) / 51.0, 0.5, 0.5]));
                let Some(back) = back.into_iter().find(|d| d.transmitted && !d.failed) else {
                    return Some(format!("nothing comes back from {:?}", there.wi));
                };
                let wo = read(self.wo, self.at);
                let apart = (0..3).map(|i| (back.wi[i] - wo[i]).powi(2)).sum::<f64>().sqrt();
                let fine = apart <= number(wanted);
                (!fine).then(|| format!("through {:?} it came back as {:?}", there.wi, back.wi))
            }
            "reciprocal" => {
                let swapped = Closure::new(&self.surface, self.wi).eval(self.wo);
                let (there, back) = (self.values()[0], numbers(&swapped, self.at));
                let (o, i) = (self.wo.z.get(self.at), self.wi.z.get(self.at));
                let fine = (0..3).all(|c| near(there[c] * o, back[c] * i, number(wanted)) && there[c] > 0.0);
                (!fine).then(|| format!("{there:?} there, {back:?} back"))
            }
            "tolerance" | "tolerance_f64" | "weight" | "absolute" | "absolute_f64" => None,
            other => panic!("unknown expectation \"{other}\""),
        }
    }
}

fn frame_is_wrong<R: Arithmetic>(case: &Json, at: usize) -> Option<String> {
    let normal: Vec3<R> = vector(&case["normal"], at);
    let frame = match case.get("tangent") {
        Some(tangent) => Frame::from_normal_tangent(normal, vector(tangent, at)),
        None => Frame::from_normal(normal),
    };
    let [x, y, z] = [frame.x, frame.y, frame.z].map(|w| read(w, at));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    let limit = number(&case["expect"]["frame"]);
    let pairs = [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0), (cross, z, 1.0)];
    let bad = |(a, b, wanted): &([f64; 3], [f64; 3], f64)| {
        let wrong = (dot(*a, *b) - wanted).abs();
        wrong.is_nan() || wrong > limit
    };
    if pairs.iter().any(bad) {
        return Some(format!("not orthonormal and right-handed: {x:?} {y:?} {z:?}"));
    }
    if case["expect"]["keeps_normal"] == json!(true) {
        let n: [f64; 3] = std::array::from_fn(|axis| number(&case["normal"][axis]));
        // Scaled first: a denormal f32 has squares that even f64 holds only as denormals.
        let scale = n.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let n = n.map(|x| x / scale);
        let along = dot(n, z) / dot(n, n).sqrt();
        if along.is_nan() || along < 1.0 - limit {
            return Some(format!("z is {z:?}, not along the normal"));
        }
    }
    None
}

fn refusal_is_wrong(case: &Json) -> Option<String> {
    let words = case["expect"]["refused"].as_str().expect("words of a refusal");
    // JSON scalars and arrays are TOML as well.
    let material = case["material"].as_object().expect("a material");
    let text: String = material.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
    match gonio_io::material_from_toml_str(&text, Path::new("case.toml")) {
        Ok(_) => Some("was accepted".to_owned()),
        Err(error) if error.to_string().contains(words) => None,
        Err(error) => Some(format!("was refused, but not for \"{words}\": {error}")),
    }
}

/// All that is wrong with a case, in all arithmetics.
fn failures(case: &Json) -> Vec<String> {
    let mut wrong = Vec::new();
    if case["expect"].get("refused").is_some() {
        wrong.extend(refusal_is_wrong(case));
        return wrong;
    }
    replay::<f32>(case, 0, &mut wrong);
    replay::<f64>(case, 0, &mut wrong);
    (0..8).for_each(|at| replay::<F32x8>(case, at, &mut wrong));
    wrong
}

fn replay<R: Arithmetic>(case: &Json, at: usize, wrong: &mut Vec<String>) {
    let place = |what: String| format!("{} {at}: {what}", R::NAME);
    if case["kind"] == json!("frame") {
        wrong.extend(frame_is_wrong::<R>(case, at).map(place));
        return;
    }
    let replay = Replay::<R>::of(case, at);
    for (key, wanted) in case["expect"].as_object().expect("expectations") {
        wrong.extend(replay.judge(key, wanted).map(place));
    }
}

fn corpus() -> Vec<Json> {
    let mut cases = Vec::new();
    for entry in fs::read_dir(crate::support::repository("tests/hard_cases")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let text = fs::read_to_string(&path).unwrap();
            let file: Vec<Json> = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            assert!(!file.is_empty(), "{} holds no case", path.display());
            cases.extend(file);
        }
    }
    cases
}

#[test]
fn every_hard_case_is_as_expected_in_every_arithmetic() {
    let cases = corpus();
    assert!(cases.len() > 1000, "only {} cases", cases.len());
    let mut bad = Vec::new();
    for case in &cases {
        assert!(case["origin"].is_string() && case["how"].is_string(), "{}: no origin or no how", case["name"]);
        let wrong = failures(case);
        if let Some(first) = wrong.first() {
            bad.push(format!("{}: {first} (and {} more places)", case["name"], wrong.len() - 1));
        }
    }
    assert!(bad.is_empty(), "{} of {} cases:\n{}", bad.len(), cases.len(), bad.join("\n"));
}

/// One wrong entry of every kind of expectation.
fn planted() -> Vec<Json> {
    let case = |material: Json, expect: Json| json!({ "name": "planted", "material": material, "wo": [0.6, 0, 0.8], "wi": [0, 0.6, 0.8], "expect": expect });
    let matte = || json!({ "type": "diffuse", "base_color": [0.5, 0.5, 0.5] });
    let metal = || json!({ "type": "conductor", "f0": [0.9, 0.9, 0.9], "alpha": 0.3 });
    let glass = || json!({ "type": "dielectric", "ior": 1.5 });
    let below = |expect: Json| {
        let mut case = case(matte(), expect);
        case["wi"] = json!([0.6, 0, -0.8]);
        case
    };
    // 1/π · 0.8 · 0.5, off by 1e-4.
    let f_cos = 0.5 * 0.8 / std::f64::consts::PI * 1.0001;
    let mut through = case(glass(), json!({ "returns": -1.0 }));
    through["wo"] = json!([0.0, 0.0, 1.0]);
    let refused = |words: &str| json!({ "material": matte(), "expect": { "refused": words } });
    let bad_type = json!({ "material": { "type": "velvet" }, "expect": { "refused": "brocade" } });
    let frame = |expect: Json| json!({ "kind": "frame", "normal": [1e-3, 0, -1], "expect": expect });
    let mut other_normal = frame(json!({ "frame": 1e-5, "keeps_normal": true }));
    other_normal["normal"] = json!(["nan", 0, 1]);
    vec![
        case(matte(), json!({ "f_cos": f_cos, "tolerance_f64": 1e-5 })),
        case(matte(), json!({ "f_cos": [f_cos / 1.0001, f_cos / 1.0001, f_cos] })),
        case(matte(), json!({ "pdf": 0.3 })),
        case(matte(), json!({ "f_cos_below": 0.1 })),
        case(matte(), json!({ "zero": true })),
        below(json!({ "positive": true })),
        case(matte(), json!({ "sample_fails": true })),
        case(matte(), json!({ "weight_at_most": 0.49 })),
        case(metal(), json!({ "equals_mirror": 1e-4, "weight": 0.9 })),
        case(
            json!({ "type": "mirror", "reflectance": [0.9, 0.9, 0.9] }),
            json!({ "equals_mirror": 1e-5, "weight": 0.8 }),
        ),
        case(glass(), json!({ "reflectance": 0.05 })),
        case(matte(), json!({ "reflectance": 0.5 })),
        through,
        case(matte(), json!({ "returns": 1e-3 })),
        case(metal(), json!({ "reciprocal": -1.0 })),
        below(json!({ "reciprocal": 1e-3 })),
        refused("base_color"),
        bad_type,
        frame(json!({ "frame": 1e-20 })),
        other_normal,
    ]
}

#[test]
fn an_expectation_of_every_kind_can_fail() {
    for case in planted() {
        assert!(!failures(&case).is_empty(), "{case} was believed");
    }
    // No kernel that is right fails "finite", so its judge is handed what a wrong one would return.
    for bad in [f64::NAN, f64::INFINITY, -1e-30] {
        assert!(unsound(&[[0.5; 4], [0.5, bad, 0.5, 0.5]]).is_some(), "{bad} was believed");
    }
    assert!(unsound(&[[0.5, 0.0, 1e300, 0.5]]).is_none());
}
