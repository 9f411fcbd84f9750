use std::path::*; use std::fs; use gonio_tracer::scene::Scene;
fn collect(d:&Path,out:&mut Vec<PathBuf>){ for e in fs::read_dir(d).unwrap(){ let p=e.unwrap().path(); if p.is_dir(){collect(&p,out)} else if p.extension().is_some_and(|e|e=="obj"){out.push(p)} } }
#[test] fn big(){ let mut v=vec![]; collect(Path::new("/work/shared/data/scenes"),&mut v); collect(Path::new("/work/shared/data/obj_torture"),&mut v); v.sort();
 for p in v { let t=std::time::Instant::now(); match Scene::load(&p){ Ok(s)=>{ println!("{} {:?} tris {} mats {}", p.display(), t.elapsed(), s.meshes.iter().map(|m|m.triangles.len()).sum::<usize>(), s.materials.len()); for w in s.warnings {println!("    {w}")}}, Err(e)=>println!("ERR {e}")} } 
 let s=Scene::load(Path::new("/work/main/scenes/cornell-box.toml")).unwrap(); println!("{:?} {:?}",s.warnings, s.materials.len()); }
#[test] fn fuzz(){ let mut v=vec![]; collect(Path::new("/work/shared/data/obj_torture"),&mut v);
 let dir=std::env::temp_dir().join("gonio-fuzz"); fs::create_dir_all(&dir).unwrap();
 let mut st=7u64; let mut r=move |n:usize|{ st=st.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((st>>33) as usize)%n.max(1)};
 let words:[&[u8];22]=[b"nan",b"-1",b"0",b"1e308",b"9223372036854775807",b"-9223372036854775808",b"/",b"//",b"\n",b"\\\n",b"f ",b"v ",b"vt 1\n",b"vn 0 0 0\n",b"usemtl\n",b"l 1 2 3\n",b"#",b"\xff",b"mtllib m.mtl\n",b"g\n",b"1e-320",b"\xe2\x80\x83"];
 let mwords:[&[u8];14]=[b"nan",b"-1",b"1e308",b"\n",b"Kd 1\n",b"newmtl\n",b"map_Kd -s 1",b"-o",b"#",b"\xff",b"illum 99\n",b"Pr ",b"aniso -1\n",b"\xe2\x80\x83"];
 let (mut ok,mut bad)=(0,0);
 for i in 0..20000 { let p=&v[r(v.len())]; let mut b=fs::read(p).unwrap(); if b.len()>6000 {continue}
  let mut m=fs::read(p.with_extension("mtl")).unwrap_or_else(|_|b"newmtl white\nKd 1 1 1\nmap_Kd a.png\n".to_vec());
  for _ in 0..1+r(6){ let at=r(b.len()+1); let w=words[r(words.len())]; match r(3){0=>{b.splice(at..at,w.iter().copied());},1=>{let e=(at+r(8)).min(b.len()); b.splice(at..e,w.iter().copied());},_=>{ if at<b.len(){b[at]=r(256) as u8;} }} 
    let at=r(m.len()+1); let w=mwords[r(mwords.len())]; let e=(at+r(6)).min(m.len()); m.splice(at..e,w.iter().copied()); }
  b.splice(0..0,b"mtllib m.mtl\n".iter().copied());
  fs::write(dir.join("f.obj"),&b).unwrap(); fs::write(dir.join("m.mtl"),&m).unwrap();
  match Scene::load(&dir.join("f.obj")) { Ok(s)=>{ok+=1; for m in &s.meshes { assert!(m.positions.iter().flatten().all(|x|x.is_finite())); assert!(m.triangles.iter().flatten().all(|&x|(x as usize)<m.positions.len())); assert_eq!(m.materials.len(),m.triangles.len()); assert!(m.normals.iter().flatten().flatten().all(|x|x.is_finite())); assert!(m.normals.iter().flatten().all(|n| n==&[0.0;3] || (n.iter().map(|x|x*x).sum::<f32>()-1.0).abs()<1e-5)); assert!(m.uvs.iter().flatten().flatten().all(|x|x.is_finite())); assert!(m.materials.iter().all(|&x|(x as usize)<s.materials.len())); if let Some(n)=&m.normals {assert_eq!(n.len(),m.positions.len())} if let Some(n)=&m.uvs {assert_eq!(n.len(),m.positions.len())} } for m in &s.materials { assert!(!m.lobes.is_empty()&&m.lobes.len()<=4);} }, Err(e)=>{bad+=1; if e.line.is_none() {println!("{i} {e}"); } } } }
 println!("{ok} {bad}");
 // toml fuzz
 let base=fs::read("/work/main/scenes/cornell-box.toml").unwrap(); fs::write(dir.join("cornell-box.obj"),fs::read("/work/main/scenes/cornell-box.obj").unwrap()).unwrap();
 let tw:[&[u8];16]=[b"nan",b"inf",b"-1",b"[",b"]",b"{",b"}",b"=",b"\n",b"\"",b"1e308",b"0x10",b"1979-05-27",b"true",b"\xff",b"[[meshes]]\n"]; let (mut ok,mut bad)=(0,0);
 for _ in 0..3000 { let mut b=base.clone(); for _ in 0..1+r(3){ let at=r(b.len()+1); let w=tw[r(tw.len())]; let e=(at+r(6)).min(b.len()); b.splice(at..e,w.iter().copied()); } fs::write(dir.join("s.toml"),&b).unwrap(); match Scene::load(&dir.join("s.toml")){Ok(_)=>ok+=1,Err(e)=>{bad+=1; if e.line.is_none(){println!("{e}")}}} }
 println!("{ok} {bad}");
}
