//! The rows: surfaces that all instruments measure.

use super::{Given, coloured, extreme, lobe, variants};
use gonio_kernel::Surface;
use gonio_kernel::lobe::{AnyLobe, Layering};

/// A surface with its name.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Its name.
    pub(crate) name: String,
    /// It.
    pub(crate) surface: Surface<f32>,
    /// One of its lobes lies on another.
    pub(crate) is_layered: bool,
    /// Instruments that are not asked.
    pub(crate) except: &'static [&'static str],
}

/// Indices near gold's and silver's at red, green and blue.
const GOLD: [[f32; 3]; 2] = [[0.143, 0.375, 1.442], [3.983, 2.386, 1.603]];
const SILVER: [[f32; 3]; 2] = [[0.155, 0.117, 0.138], [4.828, 3.122, 2.147]];
const WHITE: f32 = 1.0;
const COLOUR: [f32; 3] = [0.8, 0.5, 0.2];

type Any = AnyLobe<'static, f32>;

/// A lobe by its type and keys.
macro_rules! lobe {
    ($model:literal $(, $key:ident = $value:expr)* $(,)?) => {
        lobe($model, &[$((stringify!($key), Given::from($value))),*])
    };
}

/// GGX of these alphas with a Schlick curve.
fn schlick([alpha_x, alpha_y]: [f32; 2], f0: impl Into<Given>) -> Any {
    lobe!("conductor", alpha_x = alpha_x, alpha_y = alpha_y, f0 = f0.into())
}
fn metal([alpha_x, alpha_y]: [f32; 2], [eta, k]: [[f32; 3]; 2]) -> Any {
    lobe!("conductor", alpha_x = alpha_x, alpha_y = alpha_y, eta = eta, k = k)
}
fn beckmann([alpha_x, alpha_y]: [f32; 2], f0: impl Into<Given>) -> Any {
    lobe!("conductor", distribution = "beckmann", alpha_x = alpha_x, alpha_y = alpha_y, f0 = f0.into())
}
fn compensated(by: &'static str, [alpha_x, alpha_y]: [f32; 2], f0: impl Into<Given>) -> Any {
    lobe!("conductor", alpha_x = alpha_x, alpha_y = alpha_y, f0 = f0.into(), compensation = by)
}
fn dielectric([alpha_x, alpha_y]: [f32; 2], ior: f32) -> Any {
    lobe!("dielectric", alpha_x = alpha_x, alpha_y = alpha_y, ior = ior)
}
fn reflection([alpha_x, alpha_y]: [f32; 2], ior: f32) -> Any {
    lobe!("conductor", alpha_x = alpha_x, alpha_y = alpha_y, ior = ior)
}
fn glass(ior: f32) -> Any {
    lobe!("dielectric", ior = ior)
}
fn diffuse(base_color: impl Into<Given>) -> Any {
    lobe!("diffuse", base_color = base_color.into())
}
fn mirror(reflectance: impl Into<Given>) -> Any {
    lobe!("mirror", reflectance = reflectance.into())
}
/// k_s = 1 − k_d.
fn phong(normalization: &'static str, diffuse: [f32; 3], exponent: f32) -> Any {
    let glossy = diffuse.map(|k| 1.0 - k);
    lobe!("phong", diffuse = diffuse, glossy = glossy, exponent = exponent, normalization = normalization)
}
fn eon(base_color: impl Into<Given>, roughness: f32, albedo: &'static str) -> Any {
    lobe!("eon", base_color = base_color.into(), roughness = roughness, albedo = albedo)
}
/// The reflection of a coat, smooth for alpha 0.
fn coat(alpha: f32, ior: f32) -> Any {
    if alpha == 0.0 { lobe!("smooth-conductor", ior = ior) } else { reflection([alpha; 2], ior) }
}

/// A row of one lobe.
fn row(name: impl Into<String>, lobe: Any) -> Row {
    Row { name: name.into(), surface: Surface::of(lobe), is_layered: false, except: &[] }
}

/// A row of lobes side by side, each with its weight.
fn mixed(name: &str, lobes: &[(f32, Any)]) -> Row {
    let surface = lobes.iter().try_fold(Surface::black(), |surface, (weight, lobe)| surface.with(*weight, *lobe));
    let surface = surface.unwrap_or_else(|error| panic!("{name}: {error}"));
    Row { name: name.to_owned(), surface, is_layered: false, except: &[] }
}

/// A row of one lobe over another.
fn coated(name: &str, top: Any, base: Any, layering: Layering) -> Row {
    let surface = Surface::black().coat(1.0, top, layering);
    let surface = surface.and_then(|surface| surface.with(1.0, base)).unwrap_or_else(|error| panic!("{name}: {error}"));
    Row { name: name.to_owned(), surface, is_layered: true, except: &[] }
}

/// Every row: those worth a look, and each variant at usual values and at the ends of what plots show.
pub(crate) fn rows() -> Vec<Row> {
    let mut rows = diffuse_and_glossy();
    rows.extend(conductors());
    rows.extend(interfaces());
    rows.extend(mixtures());
    rows.extend(layers());
    for variant in variants() {
        rows.push(row(format!("{} typical", variant.name), coloured(&variant.lobe)));
        let extreme = row(format!("{} extreme", variant.name), extreme(&variant.lobe));
        rows.push(Row { except: known_failures(&variant.name), ..extreme });
    }
    rows
}

/// What an extreme is known to fail. With f82 = 0 the curve of a metal touches 0 at 82°, as the difference of two numbers near 1:
/// there `f32` is right to 1e-7 of all light, not of what is left.
fn known_failures(variant: &str) -> &'static [&'static str] {
    if variant.contains("f82") { &["precision"] } else { &[] }
}

fn diffuse_and_glossy() -> Vec<Row> {
    let mut rows = vec![
        row("lambert white", diffuse(WHITE)),
        row("lambert colour", diffuse(COLOUR)),
        row("lambert black", diffuse(0.0)),
        row("mirror white", mirror(WHITE)),
        row("mirror colour", mirror(COLOUR)),
    ];
    for (name, normalization) in [("phong lecture", "modified"), ("phong lafortune", "lafortune-willems")] {
        for exponent in [0.0_f32, 1.0, 10.0, 100.0, 1e4, 1e7] {
            rows.push(row(format!("{name} {exponent} glossy"), phong(normalization, [0.0; 3], exponent)));
            rows.push(row(format!("{name} {exponent} both"), phong(normalization, [0.5, 0.25, 0.125], exponent)));
        }
        rows.push(row(format!("{name} diffuse"), phong(normalization, [1.0; 3], 100.0)));
    }
    for roughness in [0.0_f32, 0.25, 0.5, 1.0] {
        for (name, albedo) in [("exact", "analytic"), ("fitted", "fitted")] {
            rows.push(row(format!("eon {name} {roughness} white"), eon(WHITE, roughness, albedo)));
            rows.push(row(format!("eon {name} {roughness} colour"), eon(COLOUR, roughness, albedo)));
        }
    }
    rows
}

fn conductors() -> Vec<Row> {
    let mut rows = Vec::new();
    // Alphas over four decades, isotropic; then anisotropic, each way round.
    let alphas = [1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5, 1.0].map(|a: f32| [a, a]);
    let stretched = [[0.3, 0.03], [0.03, 0.3], [0.05, 0.9], [0.9, 0.05]];
    for (index, [x, y]) in alphas.into_iter().chain(stretched).enumerate() {
        rows.push(row(format!("conductor {x}x{y} white"), schlick([x, y], WHITE)));
        let (name, index) = if index % 2 == 0 { ("gold", GOLD) } else { ("silver", SILVER) };
        rows.push(row(format!("conductor {x}x{y} {name}"), metal([x, y], index)));
    }
    let pale = [0.9, 0.6, 0.3];
    let [eta, k] = GOLD;
    let f82 = lobe!("conductor", alpha_x = 0.3, alpha_y = 0.2, f0 = [0.9, 0.6, 0.4], f82 = [0.5, 0.8, 1.0]);
    let separable = lobe!("conductor", alpha_x = 0.6, alpha_y = 0.3, f0 = [0.9, 0.6, 0.4], masking = "separable");
    let gold_metal = lobe!("conductor", alpha = 0.3, eta = eta, k = k, compensation = "kulla-conty");
    rows.extend([
        row("conductor 1e-8x1e-8 white", schlick([1e-8, 1e-8], WHITE)),
        row("conductor 1e-3x1 white", schlick([1e-3, 1.0], WHITE)),
        row("beckmann 1e-4x1e-4 white", beckmann([1e-4, 1e-4], WHITE)),
        row("beckmann 0.02x0.3 white", beckmann([0.02, 0.3], WHITE)),
        row("beckmann 0.4x0.4 colour", beckmann([0.4, 0.4], COLOUR)),
        row("beckmann 1x1 white", beckmann([1.0, 1.0], WHITE)),
        row("compensated 0.01x0.01 white", compensated("kulla-conty", [0.01; 2], WHITE)),
        row("compensated 0.2x0.2 white", compensated("kulla-conty", [0.2; 2], WHITE)),
        row("compensated 1x1 white", compensated("kulla-conty", [1.0; 2], WHITE)),
        row("compensated 0.6x0.6 gold", compensated("kulla-conty", [0.6; 2], pale)),
        row("compensated 0.3x0.3 gold metal", gold_metal),
        row("compensated 0.3x0.9 white", compensated("kulla-conty", [0.3, 0.9], WHITE)),
        row("turquin 0.5x0.5 white", compensated("turquin", [0.5; 2], WHITE)),
        row("turquin 1x1 gold", compensated("turquin", [1.0; 2], pale)),
        row("conductor f82", f82),
        row("conductor separable", separable),
        row("coat", reflection([0.2, 0.2], 1.5)),
        row("coat from within", reflection([0.2, 0.4], 0.66)),
    ]);
    rows
}

/// Smooth and rough interfaces: glass, from within, diamond, a thin one, none.
fn interfaces() -> Vec<Row> {
    let mut rows = Vec::new();
    for eta in [1.5, 1.0 / 1.5, 2.4, 1.01, 1.0] {
        rows.push(row(format!("glass {eta}"), glass(eta)));
    }
    for (x, y, eta) in [(0.01, 0.01, 1.5), (0.3, 0.1, 1.5), (0.5, 0.5, 0.66), (1.0, 1.0, 2.4), (0.2, 0.2, 1.2)] {
        rows.push(row(format!("ground glass {x}x{y} {eta}"), dielectric([x, y], eta)));
    }
    let walter = lobe!("dielectric", distribution = "beckmann", alpha_x = 0.3, alpha_y = 0.1, ior = 1.5);
    rows.extend([
        row("ground glass beckmann 0.3x0.1 1.5", walter),
        row("ground glass between equal indices", dielectric([0.3, 0.3], 1.0)),
    ]);
    rows
}

fn mixtures() -> Vec<Row> {
    let sharp = schlick([0.03, 0.3], [0.9, 0.6, 0.4]);
    let wide = schlick([0.5, 0.5], 0.04);
    let gold = metal([0.2, 0.2], GOLD);
    let plastic = phong("lafortune-willems", [0.5, 0.25, 0.125], 30.0);
    vec![
        mixed("coat over lambert", &[(0.5, reflection([0.1, 0.1], 1.5)), (0.5, diffuse(COLOUR))]),
        mixed("glass and lambert", &[(0.5, glass(1.5)), (0.5, diffuse(COLOUR))]),
        mixed("half lambert half mirror", &[(0.5, diffuse(WHITE)), (0.5, mirror(WHITE))]),
        mixed("mirror before lambert", &[(0.25, mirror(COLOUR)), (0.75, diffuse(COLOUR))]),
        mixed("phong over mirror", &[(0.5, plastic), (0.5, mirror(WHITE))]),
        mixed("two mirrors", &[(0.25, mirror(COLOUR)), (0.5, mirror(WHITE))]),
        mixed("two mirrors weight 0", &[(0.0, mirror(COLOUR)), (0.0, mirror(WHITE))]),
        mixed("lambert weight 0.3", &[(0.3, diffuse(COLOUR))]),
        mixed("lambert weight 0", &[(0.0, diffuse(WHITE))]),
        mixed("conductor over lambert", &[(0.4, sharp), (0.6, diffuse(COLOUR))]),
        mixed("conductor weight 0, lambert", &[(0.0, sharp), (1.0, diffuse(COLOUR))]),
        mixed("conductor over eon", &[(0.4, sharp), (0.6, eon(COLOUR, 0.7, "analytic"))]),
        mixed("two conductors", &[(0.5, gold), (0.5, sharp)]),
        mixed("three lobes", &[(0.3, wide), (0.2, mirror(COLOUR)), (0.5, diffuse(COLOUR))]),
        mixed("four lobes", &[(0.25, gold), (0.1, mirror(WHITE)), (0.25, sharp), (0.4, diffuse(COLOUR))]),
        mixed("no lobe", &[]),
    ]
}

fn layers() -> Vec<Row> {
    let (both, view) = (Layering::Reciprocal, Layering::FurnacePreserving);
    let gold = metal([0.2, 0.2], GOLD);
    vec![
        coated("coat 0 1.5 over lambert", coat(0.0, 1.5), diffuse(COLOUR), both),
        coated("coat 0.1 1.5 over lambert", coat(0.1, 1.5), diffuse(COLOUR), both),
        coated("coat 0.5 2 over lambert", coat(0.5, 2.0), diffuse(WHITE), both),
        coated("coat 0.3 1.5 over eon", coat(0.3, 1.5), eon(COLOUR, 0.7, "analytic"), both),
        coated("coat 0.1 1.5 over conductor", coat(0.1, 1.5), gold, both),
        coated("coat 0 1.5 over mirror", coat(0.0, 1.5), mirror(WHITE), both),
        coated("coat 0.1 1.5 over glass", coat(0.1, 1.5), glass(1.5), both),
        coated("coat 0 1.5 over ground glass", coat(0.0, 1.5), dielectric([0.3, 0.3], 1.5), both),
        coated("coat 0.1 1.5 over lambert, furnace-preserving", coat(0.1, 1.5), diffuse(COLOUR), view),
        coated("coat 0 1.5 over conductor, furnace-preserving", coat(0.0, 1.5), gold, view),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::Lobe;

    #[test]
    fn rows_lie_in_the_domain_and_have_names_of_their_own() {
        let rows = rows();
        for (i, row) in rows.iter().enumerate() {
            assert!(row.surface.domain(), "{row:?}");
            assert!(rows[..i].iter().all(|other| other.name != row.name), "{}", row.name);
        }
    }
}
