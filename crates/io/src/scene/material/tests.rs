//! Material tables: what each spelling becomes, and what is refused.

use std::path::Path;

use super::*;
use gonio_kernel::energy::Compensation;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{Conductor, Dielectric, EonAlbedo, Lambert, Layering, PhongNormalization};
use gonio_kernel::microfacet::Distribution;

fn read_text(text: &str) -> Result<Material, String> {
    material_from_toml_str(text, Path::new("dir/brass.toml")).map_err(|error| error.to_string())
}

fn refused(text: &str) -> String {
    read_text(text).expect_err("this should have been refused")
}

#[test]
fn an_empty_material_is_a_light_grey_diffuser_named_after_its_file() {
    let material = read_text("").unwrap();
    assert_eq!(material.name, "brass");
    assert!(material.two_sided);
    assert_eq!(material.lobes, [LobeSpec::new(Lambert::new(Rgb::splat(0.8)))]);
}

#[test]
fn a_conductor_takes_any_one_spelling_of_its_width() {
    let widths = |text: &str| {
        let material = read_text(&format!("type = \"conductor\"\nf0 = [0.9, 0.6, 0.3]\n{text}")).unwrap();
        let AnyLobe::Conductor(conductor) = material.lobes[0].lobe else { panic!("{material:?}") };
        let [alpha_x, alpha_y] = conductor.microfacets.alphas();
        (alpha_x, alpha_y)
    };
    assert_eq!(widths("roughness = 0.5"), (0.25, 0.25));
    assert_eq!(widths("alpha = 0.5"), (0.5, 0.5));
    assert_eq!(widths("alpha_x = 1\nalpha_y = 1e-4"), (1.0, 1e-4));
    assert_eq!(widths(""), (0.09, 0.09));
}

#[test]
fn a_mix_adds_its_lobes() {
    let text = "type = \"mix\"\nemission = 2\ntwo_sided = false\nlobes = [\n  { type = \"diffuse\", base_color = 0.5 },\n  \
                { type = \"mirror\", weight = 0.5 },\n]\n";
    let material = read_text(text).unwrap();
    assert_eq!(material.lobes.len(), 2);
    assert_eq!((material.lobes[1].weight.g, material.emission.g, material.two_sided), (0.5, 2.0, false));
}

#[test]
fn a_mix_that_creates_light_is_refused() {
    let text = "type = \"mix\"\nlobes = [{ base_color = 0.8 }, { type = \"mirror\", weight = 0.5 }]\n";
    let message = refused(text);
    assert!(
        message.ends_with("the material reflects 1.3 of the light; the sum over its lobes is at most 1"),
        "{message}"
    );
}

#[test]
fn the_coefficients_of_gold_are_within_the_law() {
    let gold = "type = \"conductor\"\neta = [0.143, 0.375, 1.442]\nk = [3.983, 2.386, 1.603]\nroughness = 0.2\n";
    assert!(read_text(gold).is_ok());
}

#[test]
fn refusals_name_the_line_and_what_would_be_right() {
    let cases = [
        (
            "type = \"conductor\"\nf0 = 1\neta = 1\nk = 1",
            "dir/brass.toml:1: the material needs one of \"eta\" with \"k\", \"f0\", \"f0\" with \"f82\", \"ior\", or \"metal\"",
        ),
        (
            "type = \"conductor\"\neta = 1",
            "dir/brass.toml:1: the material needs one of \"eta\" with \"k\", \"f0\", \"f0\" with \"f82\", \"ior\", or \"metal\"",
        ),
        (
            "type = \"conductor\"\nf0 = 1\nalpha = 0.1\nroughness = 0.1",
            "dir/brass.toml:1: the material needs one of \"alpha_x\" with \"alpha_y\", \"alpha\", or \"roughness\"",
        ),
        (
            "type = \"conductor\"\nf0 = 1\nalpha = 1e-9",
            "dir/brass.toml:3: \"alpha\" must be a number from 0.00000001 to 1, not 1e-9; what is smooth is a \"mirror\", a \
             \"smooth-conductor\" or a \"dielectric\" without roughness",
        ),
        (
            "type = \"conductor\"\nf0 = 1\nalpha = 1.1",
            "dir/brass.toml:3: \"alpha\" must be a number from 0.00000001 to 1, not 1.1",
        ),
        ("emission = [1, 1]", "dir/brass.toml:1: \"emission\" must be 3 numbers, not an array of 2"),
        ("\nemission = 2e6", "dir/brass.toml:2: \"emission\" must be a number from 0 to 1000000, not 2e6"),
        ("two_sided = 1", "dir/brass.toml:1: \"two_sided\" must be true or false, not 1"),
        ("type = \"mix\"", "dir/brass.toml:1: a mix needs \"lobes\", an array of tables"),
        ("type = \"mix\"\nlobes = []", "dir/brass.toml:2: a mix has 1 to 12 lobes, not 0"),
        (
            "type = \"mix\"\nlobes = [\n{ type = \"mix\" }]",
            "dir/brass.toml:3: type \"mix\" is not possible here; known are \"diffuse\", \"mirror\", \"conductor\", \"smooth-conductor\", \
             \"dielectric\", \"phong\", \"eon\", \"ashikhmin-shirley\", \"blinn-phong\", \"mix\", \"layered\"",
        ),
        (
            "type = \"mix\"\nlobes = [\n{ type = \"mirror\",\n alpha = 1 }]",
            "dir/brass.toml:4: unknown key \"alpha\" in lobe 1 of the material; known are \"type\", \"weight\", \"reflectance\"",
        ),
        ("base_color = { texture = \"a.png\" }", "dir/brass.toml:1: an image is only possible in a scene file"),
        ("base_color = { scale = 1 }", "dir/brass.toml:1: a colour table needs \"texture\""),
    ];
    for (text, expected) in cases {
        assert_eq!(refused(text), expected);
    }
}

#[test]
fn every_type_has_defaults_and_its_own_keys() {
    let lobe = |text: &str| read_text(text).unwrap_or_else(|error| panic!("{text}: {error}")).lobes[0].lobe;
    for word in ["fitted", "exact", "analytic"] {
        let AnyLobe::Eon(eon) = lobe(&format!("type = \"eon\"\nalbedo = \"{word}\"")) else { panic!() };
        assert_eq!(eon.directional == EonAlbedo::Fitted, word == "fitted");
    }
    for (word, normalization) in [
        ("", PhongNormalization::LafortuneWillems),
        ("normalization = \"lafortune\"", PhongNormalization::LafortuneWillems),
        ("normalization = \"lecture\"", PhongNormalization::Modified),
    ] {
        let AnyLobe::Phong(phong) = lobe(&format!("type = \"phong\"\n{word}")) else { panic!() };
        assert_eq!((phong.normalization, phong.diffuse.g, phong.exponent), (normalization, 0.5, 30.0));
    }
    assert_eq!(lobe("type = \"dielectric\""), Dielectric::new(1.5).into());
    let rough = lobe("type = \"dielectric\"\nior = 1.33\nroughness = 0.5\ndistribution = \"beckmann\"");
    let AnyLobe::RoughDielectric(rough) = rough else { panic!("{rough:?}") };
    assert_eq!((rough.microfacets.distribution, rough.microfacets.alphas()), (Distribution::Beckmann, [0.25; 2]));
    let gold = lobe("type = \"conductor\"\nmetal = \"gold\"\ncompensation = \"kulla-conty\"");
    assert!(matches!(
        gold,
        AnyLobe::Conductor(Conductor {
            fresnel: Fresnel::Conductor { .. },
            compensation: Compensation::KullaConty,
            ..
        })
    ));
    assert!(matches!(
        lobe("type = \"conductor\"\nf0 = 0.9\nf82 = 0.5\nalpha = 1e-8"),
        AnyLobe::Conductor(Conductor { fresnel: Fresnel::F82 { .. }, .. })
    ));
}

#[test]
fn a_layered_material_is_a_coat_over_its_base() {
    let text = "type = \"layered\"\nior = 1.6\ncolor = [1, 0.5, 0.25]\nbase = { type = \"mix\", lobes = [\n\
                { base_color = 0.5, weight = 0.5 }, { type = \"mirror\", weight = 0.5 }] }\n";
    let material = read_text(text).unwrap();
    let [coat, base, mirror] = &material.lobes[..] else { panic!("{material:?}") };
    assert_eq!((coat.coat, base.coat), (Some(Layering::Reciprocal), None));
    assert!(matches!(coat.lobe, AnyLobe::SmoothConductor(_)), "{coat:?}");
    assert_eq!((base.weight, mirror.weight), (Rgb::new(0.5, 0.25, 0.125), Rgb::new(0.5, 0.25, 0.125)));
    let rough = "type = \"layered\"\nroughness = 0.3\nlayering = \"furnace-preserving\"\nbase = {}";
    let material = read_text(rough).unwrap();
    assert!(matches!(material.lobes[0].lobe, AnyLobe::Conductor(_)), "{material:?}");
    assert_eq!(material.lobes[0].coat, Some(Layering::FurnacePreserving));
    let twice = "type = \"layered\"\nbase = { type = \"layered\", base = { type = \"eon\" } }";
    assert_eq!(read_text(twice).unwrap().lobes.iter().filter(|l| l.coat.is_some()).count(), 2);
    for (text, says) in [
        ("type = \"layered\"", "a layered material needs a \"base\", a table"),
        (
            "type = \"layered\"\ncolor = 0.5\nbase = { type = \"layered\", base = {} }",
            "a coloured coat over a layered base is not possible",
        ),
        ("type = \"layered\"\nior = 0.9\nbase = {}", "\"ior\" must be a number from 1 to 3, not 0.9"),
        ("type = \"layered\"\nbase = { gloss = 1 }", "unknown key \"gloss\" in the base of the material"),
        ("type = \"layered\"\ngloss = 1\nbase = {}", "unknown key \"gloss\" in the material; known are"),
    ] {
        let message = refused(text);
        assert!(message.contains(says), "{text}: {message}");
    }
}

#[test]
fn what_a_type_cannot_be_is_refused_with_what_it_can() {
    for (text, says) in [
        ("type = \"conductor\"\nmetal = \"gould\"", "\"metal\" cannot be \"gould\"; known are \"silver\""),
        ("type = \"conductor\"\nmetal = \"gold\"\nf0 = 1", "the material needs one of"),
        ("type = \"conductor\"\nf0 = 1\nalpha = 0", "what is smooth is a \"mirror\""),
        ("type = \"conductor\"\nf0 = 1\nmasking = \"smith\"", "\"masking\" cannot be \"smith\""),
        (
            "type = \"conductor\"\nf0 = 1\ndistribution = \"beckmann\"\ncompensation = \"turquin\"",
            "\"compensation\" needs the distribution \"ggx\"",
        ),
        ("type = \"dielectric\"\nior = 0", "ior"),
        (
            "type = \"phong\"\ndiffuse = 0.6\nglossy = 0.6",
            "\"diffuse\" and \"glossy\" together reflect more than all light",
        ),
        ("type = \"eon\"\nroughness = 1.5", "roughness"),
    ] {
        let message = refused(text);
        assert!(message.contains(says), "{text}: {message}");
    }
}
