//! Each row of the MTL table in `docs/scene-format.md`.

use std::fs;

use super::*;
use gonio_kernel::lobe::AnyLobe;

fn converted(statements: &str) -> (Material, Vec<String>) {
    use std::sync::atomic::{AtomicU32, Ordering};
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    let path = std::env::temp_dir().join(format!("gonio-mtl-{}-{number}.mtl", std::process::id()));
    fs::write(&path, format!("newmtl m\n{statements}")).unwrap();
    let mut library = Library::load(&path).unwrap();
    let material = library.convert(0, &mut Textures::default()).unwrap();
    fs::remove_file(&path).unwrap();
    let prefix = format!("{}: ", path.display());
    (material, library.into_warnings().iter().map(|warning| warning.replace(&prefix, "")).collect())
}

fn quiet(statements: &str) -> Material {
    let (material, warnings) = converted(statements);
    assert!(warnings.is_empty(), "{warnings:?}");
    material
}

fn diffuse(r: f32, g: f32, b: f32) -> LobeSpec {
    LobeSpec::new(Lambert::new(Rgb::new(r, g, b)))
}

fn metal(f0: f32, alpha_x: f32, alpha_y: f32) -> LobeSpec {
    LobeSpec::new(Conductor::new(Ggx { alpha_x, alpha_y }, Fresnel::Schlick { f0: Rgb::splat(f0) }))
}

/// The same over what comes after it.
fn coat(f0: f32, alpha_x: f32, alpha_y: f32) -> LobeSpec {
    metal(f0, alpha_x, alpha_y).as_coat(Layering::Reciprocal)
}

fn mirror(reflectance: f32) -> LobeSpec {
    LobeSpec::new(Mirror::new(Rgb::splat(reflectance)))
}

#[test]
fn kd_is_the_diffuse_colour() {
    assert_eq!(quiet("Kd 0.1 0.2 0.3 # comment").lobes, [diffuse(0.1, 0.2, 0.3)]);
    assert_eq!(quiet("kd .5").lobes, [diffuse(0.5, 0.5, 0.5)]);
    assert_eq!(quiet("").lobes, [diffuse(0.8, 0.8, 0.8)]);
    assert_eq!(quiet("Kd 0 0 0").lobes, [diffuse(0.0, 0.0, 0.0)]);
}

#[test]
fn ks_with_ns_is_a_rough_reflection_from_illum_2_on() {
    assert_eq!(
        quiet("Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 30").lobes,
        [coat(0.25, 0.25, 0.25), diffuse(0.5, 0.5, 0.5)]
    );
    assert_eq!(quiet("Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 30\nillum 1").lobes, [diffuse(0.5, 0.5, 0.5)]);
    assert_eq!(quiet("Ks 0.5 0.5 0.5").lobes, [metal(0.5, 1.0, 1.0)]);
}

#[test]
fn ray_traced_reflections_of_a_large_exponent_are_mirrors() {
    assert_eq!(quiet("Kd 0 0 0\nKs 0.9 0.9 0.9\nNs 1000\nillum 3").lobes, [mirror(0.9)]);
    assert_eq!(quiet("Kd 0 0 0\nKs 0.9 0.9 0.9\nillum 5").lobes, [mirror(0.9)]);
    assert_eq!(quiet("Kd 0 0 0\nKs 0.9 0.9 0.9\nNs 1e9").lobes, [mirror(0.9)]);
    assert!(matches!(quiet("Kd 0 0 0\nKs 0.9 0.9 0.9\nNs 1000").lobes[0].lobe, AnyLobe::Conductor(_)));
}

#[test]
fn what_the_reflection_leaves_falls_on_the_diffuse_part() {
    let (material, warnings) = converted("Kd 1 1 1\nKs 1 1 1\nNs 30");
    assert_eq!(material.lobes, [coat(1.0, 0.25, 0.25), diffuse(1.0, 1.0, 1.0)]);
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn ke_is_emission() {
    let light = quiet("Ke 5 4 3");
    assert_eq!((light.emission, light.lobes), (Rgb::new(5.0, 4.0, 3.0), vec![diffuse(0.0, 0.0, 0.0)]));
}

#[test]
fn metalness_divides_kd_between_metal_and_diffuse() {
    assert_eq!(quiet("Kd 0.5 0.5 0.5\nPm 0.5\nPr 0.5").lobes, [coat(0.25, 0.25, 0.25), diffuse(0.25, 0.25, 0.25)]);
    assert_eq!(quiet("Kd 0.5 0.5 0.5\nPm 1").lobes, [metal(0.5, 0.25, 0.25)]);
    assert_eq!(quiet("Kd 0.5 0.5 0.5\nPm 1\nPr 0").lobes, [mirror(0.5)]);
}

#[test]
fn aniso_stretches_the_lobe() {
    let along = quiet("Kd 0.5 0.5 0.5\nPm 1\nPr 0.5\naniso 0.7");
    let aspect = (1.0_f64 - 0.9 * 0.7).sqrt();
    assert_eq!(along.lobes, [metal(0.5, (0.25 / aspect) as f32, (0.25 * aspect) as f32)]);
    let across = quiet("Kd 0.5 0.5 0.5\nPm 1\nPr 0.5\naniso -0.7");
    assert_eq!(across.lobes, [metal(0.5, (0.25 * aspect) as f32, (0.25 / aspect) as f32)]);
}

#[test]
fn what_is_not_carried_over_is_named_once() {
    let (_, warnings) = converted(
        "Ka 1 1 1\nNi 1.5\nd 0.5\nTr 0.5\nTf 0 1 0\nillum 7\nmap_Ka a\nmap_Ks a\nmap_Ns a\nmap_d a\nbump a\nmap_Ke a\nnorm a\n\
         disp a\ndecal a\nrefl a\nmap_Pr a\nmap_Pm a\nPs 1\nPc 1\nPcr 0\nanisor 0",
    );
    let names = [
        "Ni",
        "Pc",
        "Ps",
        "Tf",
        "bump",
        "d or Tr (drawn opaque)",
        "decal",
        "disp",
        "illum of a refracting material",
        "map_Ka",
        "map_Ke",
        "map_Ks",
        "map_Ns",
        "map_Pm",
        "map_Pr",
        "map_d",
        "norm",
        "refl",
    ];
    assert_eq!(warnings, names.map(|name| format!("not supported yet: {name} (in \"m\")")));
}

#[test]
fn an_image_that_is_missing_leaves_kd() {
    let (material, warnings) = converted("Kd 0.5 0.5 0.5\nmap_Kd -clamp on -o 0 0 wood grain.png");
    assert_eq!(material.lobes, [diffuse(0.5, 0.5, 0.5)]);
    assert_eq!(
        warnings,
        [
            "not supported yet: option -clamp of map_Kd (in \"m\")",
            "not supported yet: option -o of map_Kd (in \"m\")",
            "the image \"wood grain.png\" does not exist; Kd is used alone (in \"m\")",
        ]
    );
}

#[test]
fn options_end_where_the_file_name_begins() {
    assert_eq!(split_options("-s 2 2 2 a b.png"), (vec!["-s"], "a b.png"));
    assert_eq!(split_options("-o 1 7.png"), (vec!["-o"], "7.png"));
    assert_eq!(split_options("-mm 0 1 -bm 2 a.png"), (vec!["-mm", "-bm"], "a.png"));
    assert_eq!(split_options("-dash.png"), (vec![], "-dash.png"));
    assert_eq!(split_options("-s"), (vec!["-s"], ""));
    assert_eq!(split_options("\"quoted name.png\""), (vec![], "quoted name.png"));
}
