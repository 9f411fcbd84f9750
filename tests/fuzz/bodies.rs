//! What is done with one input of a parser, and what must hold afterwards. Tests and `fuzz/` share this file.
//!
//! A body gets a folder of its own and bytes. It loads them the way the program does and panics if a promise is broken:
//! what loads obeys the invariants that [`Scene`] documents, and what is refused names a file, and if a line, one that
//! the file has. It returns what happened, in words, so that runs can count how much of a parser they reach.

use gonio_io::{ImageError, SceneError, bitmap, hdr};
use gonio_kernel::Lobe;
use gonio_tracer::scene::{Material, Mesh, Scene, Sky};
use gonio_tracer::{Picture, World};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A parser under test.
#[derive(Clone, Copy)]
pub(crate) struct Target {
    /// Names its corpus, `tests/corpus/NAME`, and its program, `fuzz/fuzz_targets/NAME.rs`.
    pub(crate) name: &'static str,
    /// Writes what the body needs beside its input.
    pub(crate) prepare: fn(&Path),
    pub(crate) body: fn(&Path, &[u8]) -> String,
}

/// All parsers of files.
pub(crate) const TARGETS: [Target; 8] = [
    Target { name: "scene", prepare: beside_a_scene, body: scene },
    Target { name: "obj", prepare: beside_a_scene, body: obj },
    Target { name: "mtl", prepare: beside_a_library, body: mtl },
    Target { name: "exr", prepare: nothing, body: exr },
    Target { name: "hdr", prepare: nothing, body: radiance },
    Target { name: "texture", prepare: nothing, body: texture },
    Target { name: "directions", prepare: beside_directions, body: directions },
    Target { name: "material", prepare: beside_a_material, body: material },
];

/// Feeds one input to the target of that name, in a folder that this process keeps: for programs in `fuzz/`.
#[cfg_attr(test, expect(dead_code, reason = "the tests run targets themselves"))]
pub(crate) fn feed(name: &str, data: &[u8]) {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let target = TARGETS.iter().find(|target| target.name == name).expect("the target exists");
    let folder = FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("gonio-fuzz-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("there is room for temporary files");
        (target.prepare)(&folder);
        folder
    });
    (target.body)(folder, data);
}

/// Separates an OBJ file from the MTL file that goes with it.
pub(crate) const SEPARATOR: &[u8] = b"\n%%%% fuzz.mtl\n";

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n";

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, content).expect("the folder for fuzzing can be written to");
    path
}

fn nothing(_: &Path) {}

fn beside_a_scene(folder: &Path) {
    write(folder, "tri.obj", TRIANGLE);
    write(folder, "image.png", PNG);
}

fn beside_a_library(folder: &Path) {
    beside_a_scene(folder);
    let uses = ["a", "b", "c", ""].map(|name| format!("usemtl {name}\nf 1/1 2/2 3/3\n")).concat();
    write(folder, "uses.obj", format!("mtllib fuzz.mtl\n{TRIANGLE}{uses}"));
}

fn beside_directions(folder: &Path) {
    write(folder, "material.toml", "base_color = 0.5\n");
}

fn beside_a_material(folder: &Path) {
    write(folder, "rows.csv", "0.6,0,0.8,-0.6,0,0.8\n0,0,1,0.6,0,0.8\n");
}

/// A PNG of one white texel.
const PNG: [u8; 69] = [
    0x89, b'P', b'N', b'G', 13, 10, 26, 10, 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0,
    0x90, 0x77, 0x53, 0xde, 0, 0, 0, 12, b'I', b'D', b'A', b'T', 0x78, 0x9c, 0x63, 0xf8, 0xff, 0xff, 0x3f, 0, 5, 0xfe,
    2, 0xfe, 0x0d, 0xef, 0x46, 0xb8, 0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82,
];

fn scene(folder: &Path, data: &[u8]) -> String {
    judge(gonio_io::load(&write(folder, "fuzz.toml", data)), folder)
}

fn obj(folder: &Path, data: &[u8]) -> String {
    let cut = data.windows(SEPARATOR.len()).position(|window| window == SEPARATOR);
    let (obj, mtl) = cut.map_or((data, &[][..]), |at| (&data[..at], &data[at + SEPARATOR.len()..]));
    write(folder, "fuzz.mtl", mtl);
    judge(gonio_io::load(&write(folder, "fuzz.obj", obj)), folder)
}

fn mtl(folder: &Path, data: &[u8]) -> String {
    write(folder, "fuzz.mtl", data);
    judge(gonio_io::load(&folder.join("uses.obj")), folder)
}

fn exr(folder: &Path, data: &[u8]) -> String {
    let path = write(folder, "fuzz.exr", data);
    judge_picture(gonio_io::exr::read(&path), &path)
}

fn radiance(folder: &Path, data: &[u8]) -> String {
    let path = write(folder, "fuzz.hdr", data);
    judge_picture(hdr::read(&path).map(|(picture, _)| picture), &path)
}

fn judge_picture(result: Result<Picture, ImageError>, path: &Path) -> String {
    match result {
        Ok(picture) => {
            assert!(picture.width > 0 && picture.height > 0);
            assert_eq!(picture.rgb.len(), picture.width as usize * picture.height as usize);
            "read".to_owned()
        }
        Err(error) => named(&error.to_string(), path),
    }
}

fn texture(folder: &Path, data: &[u8]) -> String {
    let path = write(folder, "fuzz.png", data);
    if let Ok(map) = bitmap::read_normal_map(&path) {
        assert!((map.sample(0.3, 0.7, 1.0).length() - 1.0).abs() < 1e-5);
    }
    match bitmap::read_texture(&path) {
        Ok(texture) => {
            let color = texture.sample(0.3, 0.7);
            assert!([color.r, color.g, color.b].iter().all(|c| (0.0..=1.0).contains(c)));
            "read".to_owned()
        }
        Err(error) => error,
    }
}

fn directions(folder: &Path, data: &[u8]) -> String {
    let rows = write(folder, "rows.csv", data);
    evaluate(folder, &folder.join("material.toml"), &rows, &rows)
}

fn material(folder: &Path, data: &[u8]) -> String {
    let material = write(folder, "fuzz.toml", data);
    if let Ok(material) =
        str::from_utf8(data).map_or(Err(()), |text| gonio_io::material_from_toml_str(text, &material).map_err(drop))
    {
        assert_material(&material, 0);
    }
    evaluate(folder, &material, &folder.join("rows.csv"), &material)
}

/// `gonio bsdf eval`; an error names the file `blamed`.
fn evaluate(folder: &Path, material: &Path, rows: &Path, blamed: &Path) -> String {
    let output = folder.join("values.csv");
    let text = |path: &Path| path.display().to_string();
    let arguments = ["gonio", "bsdf", "eval", &text(material), "--directions", &text(rows), "-o", &text(&output)];
    match gonio_cli::execute(arguments) {
        Ok(_) => {
            let table = fs::read_to_string(&output).expect("the table was written");
            for cell in table.lines().skip(1).flat_map(|row| row.split(',')) {
                let number: f64 = cell.parse().expect("the table holds numbers");
                assert!(number.is_finite() && number >= 0.0, "{cell} in the table");
            }
            "evaluated".to_owned()
        }
        Err(error) => named(&format!("{error:#}"), blamed),
    }
}

/// Holds what is promised of a scene or of its refusal.
fn judge(result: Result<Scene, SceneError>, folder: &Path) -> String {
    match result {
        Ok(scene) => {
            assert_scene(&scene);
            let placed = match World::new(&scene) {
                Ok(_) => "placed".to_owned(),
                Err(error) => error.to_string(),
            };
            // Which warnings, not how many: an outcome is a kind of behaviour.
            let mut kinds: Vec<String> = scene.warnings.iter().map(|warning| plain(warning)).collect();
            kinds.sort();
            kinds.dedup();
            format!("{placed} {kinds:?}")
        }
        Err(error) => {
            assert!(error.path.starts_with(folder), "{error}: whose file is this?");
            assert!(!error.message.is_empty());
            if let Some(line) = error.line {
                assert!((1..=lines(&error.path)).contains(&(line as usize)), "{error}: there is no such line");
            }
            error.message
        }
    }
}

/// An error as the command line prints it: `FILE: …`, or `FILE:LINE: …` with a line that exists.
fn named(error: &str, path: &Path) -> String {
    let rest = error.strip_prefix(&path.display().to_string()).and_then(|rest| rest.strip_prefix(':'));
    let rest = rest.unwrap_or_else(|| panic!("{error}: does not begin with {}", path.display()));
    if let Some(Ok(line)) = rest.split(':').next().map(str::parse) {
        assert!((1..=lines(path)).contains(&line), "{error}: there is no such line");
    }
    rest.to_owned()
}

/// How many lines a file has, the empty one after its last line end included.
fn lines(path: &Path) -> usize {
    let bytes = fs::read(path).unwrap_or_default();
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    1 + bytes.iter().filter(|&&byte| byte == end).count()
}

/// A message without what is quoted and without words that are not words, so that kinds of outcomes can be counted.
pub(crate) fn plain(message: &str) -> String {
    let outside: Vec<&str> = message.split('"').step_by(2).collect();
    let outside = outside.join(" ");
    let letters = |word: &str| word.trim_end_matches([',', ';', ':', '.']).bytes().all(|b| b.is_ascii_alphabetic());
    let words: Vec<&str> = outside.split_whitespace().filter(|word| letters(word)).take(16).collect();
    words.join(" ")
}

/// Holds every invariant that [`Scene`] and its parts document.
pub(crate) fn assert_scene(scene: &Scene) {
    let film = scene.film;
    assert!((1..=65_536).contains(&film.width) && (1..=65_536).contains(&film.height));
    assert!((1..=1 << 20).contains(&film.spp) && film.exposure.is_finite());
    let camera = scene.camera;
    let view = camera.target - camera.origin;
    assert!(camera.origin.is_finite() && view.is_finite() && view.length() > 0.0, "{camera:?}");
    assert!(camera.up.is_finite() && view.normalize().cross(camera.up.normalize()).length() > 0.0, "{camera:?}");
    assert!(camera.vfov > 0.0 && camera.vfov < 180.0);
    assert!(scene.integrator.max_depth <= 1024);
    let in_range = |c: f32| (0.0..=1e6).contains(&c);
    match &scene.environment.sky {
        Sky::Constant(radiance) => assert!([radiance.r, radiance.g, radiance.b].into_iter().all(in_range)),
        Sky::Map(map) => {
            assert!(map.rotation.is_finite() && map.intensity >= 0.0);
            assert!(map.picture.rgb.iter().flatten().all(|&c| c >= 0.0 && in_range(c * map.intensity)));
        }
    }
    assert!(scene.materials.len() <= 65_535);
    scene.materials.iter().for_each(|material| assert_material(material, scene.textures.len()));
    for mesh in &scene.meshes {
        let maps = mesh.materials.iter().filter_map(|&m| scene.materials.get(m as usize)?.normal_map);
        maps.for_each(|spec| {
            assert!(mesh.uvs.is_some() && spec.map < scene.normal_maps.len() && (0.0..=10.0).contains(&spec.scale));
        });
    }
    assert!(!scene.meshes.is_empty() && !scene.instances.is_empty());
    scene.meshes.iter().for_each(|mesh| assert_mesh(mesh, scene.materials.len()));
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len());
        let map = instance.transform;
        assert!(map.is_finite() && map.matrix3.determinant() != 0.0 && map.inverse().is_finite(), "{map:?}");
    }
    assert!(scene.warnings.iter().all(|warning| !warning.is_empty()));
}

fn assert_mesh(mesh: &Mesh, materials: usize) {
    let count = mesh.positions.len();
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    if let Some(normals) = &mesh.normals {
        assert_eq!(normals.len(), count);
        let unit = |n: &[f32; 3]| (n.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() - 1.0).abs() < 1e-5;
        let used = mesh.triangles.iter().flatten().map(|&v| normals[v as usize]);
        used.for_each(|n| assert!(unit(&n), "a normal {n:?} is not unit"));
    }
    if let Some(uvs) = &mesh.uvs {
        assert_eq!(uvs.len(), count);
        assert!(uvs.iter().flatten().all(|x| x.is_finite()));
    }
    assert!(!mesh.triangles.is_empty());
    assert_eq!(mesh.materials.len(), mesh.triangles.len());
    assert!(mesh.materials.iter().all(|&m| (m as usize) < materials));
    for triangle in &mesh.triangles {
        assert!(triangle.iter().all(|&v| (v as usize) < count), "{triangle:?} of {count}");
        let [a, b, c] = triangle.map(|v| glam::DVec3::from_array(mesh.positions[v as usize]));
        assert!((b - a).cross(c - a).length() > 0.0, "{triangle:?} has no area");
    }
}

fn assert_material(material: &Material, textures: usize) {
    assert!((1..=12).contains(&material.lobes.len()), "{material:?}");
    let emission = material.emission;
    assert!([emission.r, emission.g, emission.b].iter().all(|c| (0.0..=1e6).contains(c)), "{material:?}");
    for spec in &material.lobes {
        assert!(spec.weight.within(0.0, 1.0) && spec.lobe.domain(), "{material:?}");
        assert!(spec.textures.iter().all(|t| t.texture < textures), "{material:?}");
    }
}
