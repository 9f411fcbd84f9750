//! Scene files, good and bad: what loads, what it becomes, and the very words of each refusal.

mod environments;
mod obj;

use std::fs;
use std::time::{Duration, Instant};

use crate::support::{Folder, cornell_box, data};
use gonio_io::exr::{self, Metadata};
use gonio_io::png;
use gonio_kernel::Rgb;
use gonio_kernel::lobe::{AnyLobe, Lambert, Layering};
use gonio_tracer::scene::Environment;
use gonio_tracer::{Picture, World, WorldError};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn refused_obj(text: &str) -> String {
    let folder = Folder::new();
    let path = folder.write("bad.obj", text);
    folder.refusal(&path)
}

fn refused_scene(text: &str) -> String {
    let folder = Folder::new();
    folder.write("tri.obj", TRIANGLE);
    let path = folder.write("scene.toml", text);
    folder.refusal(&path)
}

#[test]
fn every_torture_file_loads_or_says_why_in_under_a_second() {
    let Some(root) = data("obj_torture") else { return };
    let families = fs::read_dir(&root).expect("a folder");
    let (mut loaded, mut refused) = (0, 0);
    for family in families {
        for file in fs::read_dir(family.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "obj") {
                continue;
            }
            let start = Instant::now();
            let result = gonio_io::load(&path);
            assert!(start.elapsed() < Duration::from_secs(1), "{}: {:?}", path.display(), start.elapsed());
            match result {
                Ok(scene) => {
                    loaded += 1;
                    assert!(scene.meshes.iter().all(|mesh| !mesh.triangles.is_empty()));
                }
                Err(error) => {
                    refused += 1;
                    println!("{error}");
                    assert!(error.line.is_some() && error.to_string().contains(".obj:"), "no line in: {error}");
                }
            }
        }
    }
    println!("obj_torture: {loaded} loaded, {refused} refused");
    assert!(loaded + refused > 0);
}

#[test]
fn an_obj_alone_gets_a_camera_and_a_white_sky() {
    let folder = Folder::new();
    let scene = gonio_io::load(&folder.write("tri.obj", TRIANGLE)).unwrap();
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(scene.environment, Environment::constant(Rgb::splat(1.0)));
    assert!(scene.camera.origin.z > 0.0 && scene.camera.origin.y > 0.0);
    assert_eq!(folder.warnings(&scene), ["tri.obj: faces without a material are drawn in grey"]);
}

#[test]
fn the_example_in_the_documentation_loads() {
    let folder = Folder::new();
    folder.write("room.obj", format!("usemtl Ceiling_Light\n{TRIANGLE}"));
    folder.write("teapot.obj", TRIANGLE);
    let page = include_str!("../docs/scene-format.md");
    let example = page.split("```toml").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let scene = gonio_io::load(&folder.write("scene.toml", example)).unwrap();
    assert_eq!(folder.warnings(&scene), Vec::<String>::new());
    assert_eq!((scene.film.width, scene.film.spp, scene.integrator.max_depth), (512, 64, 8));
    assert_eq!(scene.materials[scene.meshes[0].materials[0] as usize].name, "lamp");
    assert_eq!(scene.materials[scene.meshes[1].materials[0] as usize].name, "gold");
}

#[test]
fn every_key_of_film_camera_and_integrator_arrives() {
    let folder = Folder::new();
    folder.write("tri.obj", TRIANGLE);
    let text = "[film]\nwidth = 1\nheight = 65536\nspp = 1_048_576\nexposure = -1.5\n\
                [camera]\norigin = [1, 2, 3]\ntarget = [0, 0, 0.5]\nup = [0, 0, 1]\nvfov = 90\n\
                [integrator]\nmax_depth = 0\nrussian_roulette = false\nseed = 0xffff_ffff_ffff_ffff\n\
                [[meshes]]\nfile = \"tri.obj\"\n";
    let scene = gonio_io::load(&folder.write("scene.toml", text)).unwrap();
    let film = scene.film;
    assert_eq!((film.width, film.height, film.spp, film.exposure), (1, 65_536, 1_048_576, -1.5));
    let camera = scene.camera;
    assert_eq!((camera.origin.to_array(), camera.target.to_array()), ([1.0, 2.0, 3.0], [0.0, 0.0, 0.5]));
    assert_eq!((camera.up.to_array(), camera.vfov), ([0.0, 0.0, 1.0], 90.0));
    let integrator = scene.integrator;
    assert_eq!((integrator.max_depth, integrator.russian_roulette, integrator.seed), (0, false, u64::MAX));
    let dark = "the scene has no light: the picture will be black";
    assert_eq!(folder.warnings(&scene), ["tri.obj: faces without a material are drawn in grey", dark]);
}

#[test]
fn a_scene_built_in_code_is_refused_by_the_name_of_its_material() {
    let mut scene = cornell_box(8, 1);
    let coat = scene.materials[0].lobes[0].clone().as_coat(Layering::Reciprocal);
    scene.materials[0].lobes = vec![coat; 4];
    let name = scene.materials[0].name.clone();
    let error = World::new(&scene).unwrap_err();
    assert!(matches!(&error, WorldError::Lobes { material, .. } if *material == name), "{error:?}");
    assert_eq!(
        error.to_string(),
        format!("material \"{name}\": nothing shines through this lobe: it cannot be a coat")
    );
    let mut scene = cornell_box(8, 1);
    scene.meshes[0].positions[0] = [1e30, 0.0, 0.0];
    let text = World::new(&scene).unwrap_err().to_string();
    assert!(text.ends_with("of instance 0 lies outside of what f32 rays can reach"), "{text}");
}

#[test]
fn missing_files_are_named() {
    let folder = Folder::new();
    let text = folder.refusal(&folder.path().join("absent.obj"));
    assert!(text.starts_with("absent.obj: cannot be read: "), "{text}");
    assert_eq!(
        refused_scene("[film]\nspp = 4\n[[meshes]]\nfile = \"absent.obj\"\n"),
        "scene.toml:4: the file \"absent.obj\" does not exist"
    );
    assert_eq!(
        refused_scene("[materials.a]\nbase_color = { texture = \"absent.png\" }\n[[meshes]]\nfile = \"tri.obj\"\n"),
        "scene.toml:2: the image \"absent.png\" does not exist"
    );
    assert_eq!(
        folder.refusal(&folder.write("a.gltf", "")),
        "a.gltf: is neither a scene file (.toml) nor an OBJ file (.obj)"
    );
}

#[test]
fn unknown_keys_and_bad_syntax_are_named_with_their_line() {
    assert_eq!(
        refused_scene("[film]\nwidth = 4\nheigth = 4\n[[meshes]]\nfile = \"tri.obj\"\n"),
        "scene.toml:3: unknown key \"heigth\" in [film]; known are \"width\", \"height\", \"spp\", \"exposure\""
    );
    assert_eq!(
        refused_scene("[materials.a]\ntype = \"diffuse\"\nroughness = 0.5\n[[meshes]]\nfile = \"tri.obj\"\n"),
        "scene.toml:3: unknown key \"roughness\" in material \"a\"; known are \"emission\", \"two_sided\", \
         \"normal_map\", \"normal_scale\", \"type\", \"weight\", \"base_color\""
    );
    let text = refused_scene("[film]\nwidth = = 4\n");
    assert!(text.starts_with("scene.toml:2: "), "{text}");
    assert_eq!(refused_scene("\n"), "scene.toml:1: the scene has no [[meshes]]: there is nothing to render");
    let broken = "{ rue\nemission = [1, 2, 3]\nlobe ".repeat(2000); // overflowed the stack of the parser
    let text = format!("[materials.a]\nlobes = {broken}");
    assert_eq!(refused_scene(&text), "scene.toml:129: brackets are nested more than 64 deep");
}

#[test]
fn undefined_materials_are_named_with_those_defined() {
    let materials = "[materials.white]\nbase_color = 0.7\n[materials.red]\nbase_color = [0.6, 0.1, 0.1]\n";
    assert_eq!(
        refused_scene(&format!("{materials}[[meshes]]\nfile = \"tri.obj\"\nmaterial = \"brass\"\n")),
        "scene.toml:7: material \"brass\" is not defined; defined are \"white\", \"red\""
    );
    assert_eq!(
        refused_scene(&format!("{materials}[[meshes]]\nfile = \"tri.obj\"\nmaterials = {{ hull = \"red\" }}\n")),
        "scene.toml:7: \"tri.obj\" has no material \"hull\"; it has none"
    );
}

#[test]
fn values_out_of_range_are_refused_with_their_line() {
    let mesh = "\n[[meshes]]\nfile = \"tri.obj\"\n";
    let cases = [
        ("[film]\nwidth = 0", "scene.toml:2: \"width\" must be a whole number from 1 to 65536, not 0"),
        ("[film]\nspp = 1048577", "scene.toml:2: \"spp\" must be a whole number from 1 to 1048576, not 1048577"),
        ("[film]\nexposure = nan", "scene.toml:2: \"exposure\" must be a number from -100 to 100, not nan"),
        ("[camera]\nvfov = 180", "scene.toml:2: \"vfov\" must be a number from 0.01 to 179, not 180"),
        (
            "[camera]\norigin = [0, inf, 0]",
            "scene.toml:2: \"origin\" must be a number from -1000000000000 to 1000000000000, not inf",
        ),
        ("[camera]\norigin = [0, 1]", "scene.toml:2: \"origin\" must be 3 numbers, not an array of 2"),
        (
            "[integrator]\nseed = -1",
            "scene.toml:2: \"seed\" must be a whole number from 0 to 18446744073709551615, not -1",
        ),
        ("[environment]\nradiance = -1.0", "scene.toml:2: \"radiance\" must be a number from 0 to 1000000, not -1.0"),
        (
            "[materials.a]\nbase_color = [0, 1.5, 0]",
            "scene.toml:2: \"base_color\" must be a number from 0 to 1, not 1.5",
        ),
        (
            "[materials.a]\ntype = \"glass\"",
            "scene.toml:2: type \"glass\" is not possible here; known are \"diffuse\", \"mirror\", \"conductor\", \"smooth-conductor\", \"dielectric\", \"phong\", \"eon\", \"ashikhmin-shirley\", \"blinn-phong\", \"mix\", \"layered\"",
        ),
        (
            "[materials.a]\ntype = \"conductor\"\nf0 = 0.9\nroughness = 0.00001",
            "scene.toml:4: \"roughness\" must be a number from 0.0001 to 1, not 0.00001; what is smooth is a \"mirror\", a \"smooth-conductor\" or a \"dielectric\" without roughness",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(refused_scene(&format!("{text}{mesh}")), expected);
    }
    assert_eq!(
        refused_scene("[camera]\norigin = [1, 1, 1]\ntarget = [1, 1, 1]\n[[meshes]]\nfile = \"tri.obj\""),
        "scene.toml:1: \"origin\" and \"target\" of the camera are the same point"
    );
    for (transform, expected) in [
        ("{ scale = 0 }", "a scale of 0 squeezes space flat"),
        ("{ rotate = { axis = [0, 0, 0], degrees = 1 } }", "\"axis\" has no length"),
        (
            "{ shear = 1 }",
            "unknown key \"shear\" in a step of the transform; known are \"scale\", \"rotate\", \"translate\", \"matrix\"",
        ),
        (
            "{ matrix = [1,0,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1] }",
            "the transform cannot be inverted: it is not finite or squeezes space flat",
        ),
        ("{ scale = [1, 1, 1e-320] }", "the transform cannot be inverted: it is not finite or squeezes space flat"),
        ("{ scale = 1e10 }", "the scene is 1e10 m wide; it must be 1e-6 to 1e9"),
    ] {
        let text = refused_scene(&format!("[[meshes]]\nfile = \"tri.obj\"\ntransform = [{transform}]\n"));
        assert!(text.starts_with("scene.toml:") && text.ends_with(expected), "{text}");
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_line() {
    let rest = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(refused_obj(&format!("v 0 nan 0\n{rest}")), "bad.obj:1: \"nan\" in a vertex is not finite");
    assert_eq!(refused_obj(&format!("v 0 0 -inf\n{rest}")), "bad.obj:1: \"-inf\" in a vertex is not finite");
    assert_eq!(refused_obj(&format!("v 0 0 1e999\n{rest}")), "bad.obj:1: \"1e999\" in a vertex is not finite");
    assert_eq!(
        refused_obj(&format!("\nv 0 0 1e40\n{rest}")),
        "bad.obj:2: \"1e40\" in a vertex is beyond the largest allowed, 1e12"
    );
    assert_eq!(refused_obj(&format!("v 0 0,5 0\n{rest}")), "bad.obj:1: \"0,5\" in a vertex is not a number");
    assert_eq!(
        refused_obj(&format!("v 0 0 0 0\n{rest}")),
        "bad.obj:1: the vertex divided by its weight 0 is not finite"
    );
    assert_eq!(
        refused_obj("v 0 0\n"),
        "bad.obj:1: a vertex has 3 coordinates, then optionally a weight or a colour; here are 2 numbers"
    );
    assert_eq!(refused_obj(&format!("vn 0 nan 0\nv 0 0 0\n{rest}")), "bad.obj:1: \"nan\" in a normal is not finite");
    assert_eq!(
        refused_obj(&format!("vt nan 0\nv 0 0 0\n{rest}")),
        "bad.obj:1: \"nan\" in a texture coordinate is not finite"
    );
}

#[test]
fn materials_come_from_the_scene_then_the_library_then_grey() {
    let folder = Folder::new();
    folder.write(
        "sub/two parts.mtl",
        "newmtl hull\nKd 0.1 0.2 0.3\nnewmtl glow\nKd 0 0 0\nKe 5 4 3\nnewmtl red\nKd 0 0 1\n",
    );
    folder.write(
        "sub/ship.obj",
        "mtllib .\\two parts.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl hull\nf 1 2 3\nusemtl glow\nf 1 2 3\nusemtl red\nf 1 2 3\n\
         usemtl keel\nf 1 2 3\n",
    );
    let text = "[materials.red]\nbase_color = [0.6, 0.1, 0.1]\n[materials.blue]\nbase_color = [0, 0, 0.5]\n\
                [[meshes]]\nfile = 'sub\\ship.obj'\n\
                [[meshes]]\nfile = \"sub/ship.obj\"\nmaterials = { hull = \"blue\" }\ntransform = [{ translate = [2, 0, 0] }]\n\
                [[meshes]]\nfile = \"sub/ship.obj\"\nmaterial = \"red\"\n\
                [[meshes]]\nfile = \"sub/ship.obj\"\ntransform = [{ scale = 2 }, { translate = [0, 0, 1] }]\n";
    let scene = gonio_io::load(&folder.write("scene.toml", text)).unwrap();
    let names = |mesh: usize| -> Vec<&str> {
        scene.meshes[mesh].materials.iter().map(|&m| scene.materials[m as usize].name.as_str()).collect()
    };
    assert_eq!(names(scene.instances[0].mesh), ["hull", "glow", "red", "grey"]);
    assert_eq!(names(scene.instances[1].mesh), ["blue", "glow", "red", "grey"]);
    assert_eq!(names(scene.instances[2].mesh), ["red"; 4]);
    assert_eq!(scene.instances[3].mesh, scene.instances[0].mesh, "the same file and materials share a mesh");
    let corner = scene.instances[3].transform.transform_point3([1.0, 0.0, 0.0].into());
    assert_eq!(corner.to_array(), [2.0, 0.0, 1.0]);
    let red = &scene.materials[scene.meshes[0].materials[2] as usize];
    let AnyLobe::Lambert(Lambert { albedo: color }) = red.lobes[0].lobe else { panic!("{red:?}") };
    assert_eq!(color.r, 0.6);
    assert_eq!(folder.warnings(&scene), ["sub/ship.obj:11: material \"keel\" is not defined; drawn in grey"]);
}

#[test]
fn a_bad_line_in_a_library_costs_only_that_line() {
    let folder = Folder::new();
    folder.write(
        "m.mtl",
        "Kd 1 1 1\nnewmtl a\nKd 0.5 0.5\nKd spectral x.rfl\nKs 2 0 0\nillum two\nmap_Kd\nNi 1.5\nd 0.5\nmap_Bump b.png\nKt 1 1 1\n",
    );
    let scene = gonio_io::load(&folder.write("m.obj", format!("mtllib gone.mtl m.mtl\nusemtl a\n{TRIANGLE}"))).unwrap();
    assert_eq!(
        folder.warnings(&scene),
        [
            "m.obj:1: the material library \"gone.mtl\" does not exist",
            "m.mtl:1: \"Kd\" before the first newmtl is ignored",
            "m.mtl:3: \"Kd 0.5 0.5\" is ignored: Kd has 3 numbers, here are 2",
            "m.mtl:4: \"Kd spectral x.rfl\" is ignored: \"spectral\" is not a number",
            "m.mtl:5: \"Ks 2 0 0\" is out of range and becomes 1 0 0",
            "m.mtl:6: \"illum two\" is ignored: \"two\" is not a number",
            "m.mtl:7: \"map_Kd\" has no value and is ignored",
            "m.mtl: not supported yet: Kt (in \"a\")",
            "m.mtl: not supported yet: Ni (in \"a\")",
            "m.mtl: not supported yet: bump (in \"a\")",
            "m.mtl: not supported yet: d or Tr (drawn opaque) (in \"a\")",
        ]
    );
}

#[test]
fn base_colour_images_are_found_decoded_and_shared() {
    let folder = Folder::new();
    let red = Picture { width: 1, height: 1, rgb: vec![[1.0, 0.0, 0.0]], alpha: None };
    fs::create_dir_all(folder.path().join("tex")).unwrap();
    png::write(&folder.path().join("tex/red wood.png"), &red, 0.0).unwrap();
    folder.write(
        "m.mtl",
        "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd -s 2 2 2 C:\\work\\tex\\red wood.png\nnewmtl b\nmap_Kd tex\\red wood.png\n",
    );
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
    let scene = gonio_io::load(&folder.write("m.obj", obj)).unwrap();
    assert_eq!(
        folder.warnings(&scene),
        [
            "m.mtl: not supported yet: option -s of map_Kd (in \"a\")",
            "m.mtl: the image \"C:\\work\\tex\\red wood.png\" does not exist; Kd is used alone (in \"a\")",
        ]
    );
    assert_eq!(scene.textures.len(), 1);
    assert_eq!(scene.textures[0].sample(0.3, 0.3).r, 1.0);
    folder.write("tex/red wood.png", "not an image");
    let text = folder.refusal(&folder.path().join("m.obj"));
    assert!(text.starts_with("tex/red wood.png: the image cannot be decoded: "), "{text}");
}

#[test]
fn pictures_that_cannot_be_written_say_so_and_leave_nothing_behind() {
    let folder = Folder::new();
    let picture = Picture { width: 1, height: 1, rgb: vec![[1.0; 3]], alpha: None };
    let nowhere = folder.path().join("absent/a.exr");
    let text = exr::write(&nowhere, &picture, None, &Metadata::default()).unwrap_err().to_string();
    assert!(folder.strip(&text).starts_with("absent/a.exr: cannot be written: "), "{text}");
    let text = png::write(&nowhere, &picture, 0.0).unwrap_err().to_string();
    assert!(folder.strip(&text).starts_with("absent/a.exr: cannot be written: "), "{text}");
    let taken = folder.path().join("taken.png"); // a folder of that name cannot be replaced by a file
    fs::create_dir(&taken).unwrap();
    assert!(png::write(&taken, &picture, 0.0).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
