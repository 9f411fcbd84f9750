//! OBJ files: faces, indices, normals, encodings.

use super::{TRIANGLE, refused_obj};
use crate::support::Folder;

#[test]
fn indices_out_of_range_are_refused_with_their_line() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
    let cases = [
        ("f 1 2 4", "vertex index 4 in a face is out of range: the file defines 3"),
        ("f 0 1 2", "vertex index 0 in a face: indices start at 1"),
        ("f -4 -2 -1", "vertex index -4 in a face is out of range: 3 are defined above it"),
        ("f 1/2 2/2 3/2", "texture coordinate index 2 in a face is out of range: the file defines 1"),
        ("f 1//9 2//9 3//9", "normal index 9 in a face is out of range: the file defines 1"),
        (
            "f 1//6148914691236517206 2 3",
            "normal index 6148914691236517206 in a face is out of range: the file defines 1",
        ),
        ("f 1 2 99999999999999999999", "\"99999999999999999999\" in a face is not an index"),
        ("f 1 2 x", "\"x\" in a face is not an index"),
        ("f 1/2/3/4 2 3", "\"1/2/3/4\" is not a corner of a face (vertex/texture/normal)"),
        ("f // // //", "\"//\" is not a corner of a face (vertex/texture/normal)"),
    ];
    for (face, expected) in cases {
        assert_eq!(refused_obj(&format!("{vertices}{face}\n")), format!("bad.obj:6: {expected}"));
    }
}

#[test]
fn meshes_without_triangles_are_refused() {
    assert_eq!(refused_obj(""), "bad.obj:1: the file ends here and has no faces");
    assert_eq!(refused_obj("v 0 0 0\n# nothing\n"), "bad.obj:2: the file ends here and has no faces");
    assert_eq!(
        refused_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n"),
        "bad.obj:4: the file has no triangles; lines and points are not drawn"
    );
    assert_eq!(
        refused_obj("v 0 0 0\nv 1 1 1\nv 2 2 2\n\nf 1 2 3\nf 1 1 2\n"),
        "bad.obj:5: every triangle has zero area (2); nothing is left to draw"
    );
}

#[test]
fn triangles_without_area_are_dropped_with_one_warning() {
    let folder = Folder::new();
    let text = format!("usemtl m\n{TRIANGLE}f 1 1 2\nf 1 2 2\nl 1 2 3\n");
    let scene = gonio_io::load(&folder.write("flat.obj", text)).unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert_eq!(
        folder.warnings(&scene),
        [
            "flat.obj:8: lines and points are not drawn: ignored",
            "flat.obj:6: triangles without area: 2 dropped, the first on this line",
            "flat.obj:1: material \"m\" is not defined; drawn in grey",
        ]
    );
}

#[test]
fn normals_that_the_file_does_not_have_are_left_out_with_a_warning() {
    let folder = Folder::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/7 2/2/8 3/3/9\nf 1/1/7 2/2/8 3/3/9\n";
    let scene = gonio_io::load(&folder.write("bare.obj", text)).unwrap();
    assert_eq!((&scene.meshes[0].normals, &scene.meshes[0].uvs), (&None, &None));
    assert_eq!(
        folder.warnings(&scene)[..2],
        [
            "bare.obj:4: faces name normals, but the file defines none: 2 lines ignored, the first is this",
            "bare.obj:4: faces name texture coordinates, but the file defines none: 2 lines ignored, the first is this",
        ]
    );
}

#[test]
fn faces_with_and_without_normals_do_not_mix_them_up() {
    let folder = Folder::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 0 1 0\nvt 0 0\nf 1 2 3\nf 1//1 2//1 3//2\n\
                f 1/1/1 2//1 4\nf 1/1 2/1 3/1\n";
    let scene = gonio_io::load(&folder.write("mixed.obj", text)).unwrap();
    let formats: Vec<_> =
        scene.meshes.iter().map(|mesh| (mesh.uvs.is_some(), mesh.normals.is_some(), mesh.triangles.len())).collect();
    assert_eq!(formats, [(false, false, 2), (true, false, 1), (false, true, 1)]);
    let normals = scene.meshes[2].normals.as_ref().unwrap();
    assert_eq!(normals.as_slice(), [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
    for mesh in &scene.meshes {
        assert!(mesh.normals.as_ref().is_none_or(|normals| normals.len() == mesh.positions.len()));
        assert!(mesh.uvs.as_ref().is_none_or(|uvs| uvs.len() == mesh.positions.len()));
        assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
    }
}

#[test]
fn files_of_every_age_and_system_are_read() {
    let folder = Folder::new();
    let same = |name: &str, text: &[u8]| {
        let scene = gonio_io::load(&folder.write(name, text)).unwrap();
        assert_eq!(scene.meshes[0].positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "{name}");
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]], "{name}");
    };
    same("windows.obj", TRIANGLE.replace('\n', "\r\n").as_bytes());
    same("mac.obj", TRIANGLE.replace('\n', "\r").as_bytes());
    same("mark.obj", format!("\u{feff}{TRIANGLE}").as_bytes());
    same("latin1.obj", &[b"# caf\xe9\n".as_slice(), TRIANGLE.as_bytes()].concat());
    same("continued.obj", b"v 0 0 0\nv 1 \\\n0 0\nv 0 1 0\nf 1 \\\n 2 \\\n 3");
    same("comments.obj", b"v 0 0 0 # one\nv 1 0 0\nv 0 1 0\n  f 1 2 3 # a face\n");
    same("tabs.obj", b"v\t0\t0\t0\nv 1 0 0\nv 0 1 0\nusemtl\tred\nf\t1 2 3\n");
    same("later.obj", b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
}

#[test]
fn coordinates_of_a_map_projection_keep_their_digits() {
    let folder = Folder::new();
    let text = "v 680000.001 5400000.002 0\nv 680000.003 5400000.002 0\nv 680000.001 5400000.004 0\nf 1 2 3\n";
    let scene = gonio_io::load(&folder.write("far.obj", text)).unwrap();
    assert_eq!(scene.meshes[0].positions[0], [680_000.001, 5_400_000.002, 0.0]);
}
