use gonio_tracer::scene::*;
use gonio_tracer::*;
use gonio_kernel::Rgb;
use glam::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let spp: u32 = args[1].parse().unwrap();
    let threads: usize = args[2].parse().unwrap();
    let backend: Backend = args[3].parse().unwrap();
    let text = std::fs::read_to_string("scenes/cornell-box.obj").unwrap();
    let names = ["white", "green", "red", "light"];
    let cols = [[0.885809, 0.698859, 0.666422], [0.105421, 0.37798, 0.076425], [0.570068, 0.0430135, 0.0443706], [0.885809, 0.698859, 0.666422]];
    let mut mesh = Mesh { name: "c".into(), positions: vec![], normals: None, uvs: None, triangles: vec![], materials: vec![] };
    let mut cur = 0;
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        match w.first() {
            Some(&"v") => mesh.positions.push([w[1].parse().unwrap(), w[2].parse().unwrap(), w[3].parse().unwrap()]),
            Some(&"usemtl") => cur = names.iter().position(|n| *n == w[1]).unwrap() as u32,
            Some(&"f") => {
                let i: Vec<u32> = w[1..].iter().map(|s| s.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                for k in 1..i.len() - 1 { mesh.triangles.push([i[0], i[k], i[k + 1]]); mesh.materials.push(cur); }
            }
            _ => {}
        }
    }
    let materials = (0..4).map(|i| Material { name: names[i].into(), lobes: vec![LobeSpec { weight: 1.0, model: Model::Diffuse { base_color: Color::Constant(Rgb::from(cols[i])) } }], emission: if i == 3 { Rgb::new(18.387, 13.9873, 6.75357) } else { Rgb::zero() }, two_sided: i != 3 }).collect();
    let scene = Scene { film: FilmSettings { width: 128, height: 128, spp, exposure: 0.0 }, camera: Camera { origin: DVec3::new(0., 0., 3.9), target: DVec3::ZERO, up: DVec3::Y, vfov: 39.3077 }, integrator: IntegratorSettings { max_depth: 8, russian_roulette: false, seed: 0 }, materials, textures: vec![], meshes: vec![mesh], instances: vec![Instance { name: "c".into(), mesh: 0, transform: DAffine3::IDENTITY }], environment: Rgb::zero(), warnings: vec![] };
    let world = World::new(&scene).unwrap();
    let accel = backend.build(world.geometry());
    let mut s = RenderSettings::of(&scene, &world);
    s.threads = threads;
    let r = render(&world, &*accel, &s, &mut |_| ());
    println!("{} {} tris {}", world.plan(), world.geometry().meshes()[0].triangles.len(), r.stats.film_hash);
    println!("Ms/s {:.3} closest {:.2} shadow {:.2} lanes {:.3} dropped {} largest {:?}", r.stats.samples as f64 / r.stats.render_seconds / 1e6, r.stats.closest_rays as f64 / r.stats.samples as f64, r.stats.shadow_rays as f64 / r.stats.samples as f64, r.stats.lanes_full, r.stats.dropped_samples, r.stats.largest[0]);
    let n = r.picture.rgb.len() as f64;
    let m = r.picture.rgb.iter().fold([0f64; 3], |a, p| [a[0] + p[0] as f64, a[1] + p[1] as f64, a[2] + p[2] as f64]).map(|x| x / n);
    println!("mean {m:?}");
    gonio_tracer::image::write_png("/tmp/scratch.png".as_ref(), &r.picture, 0.0).unwrap();
}
