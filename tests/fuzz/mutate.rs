//! Inputs made from other inputs: small changes that a parser may not expect.
//!
//! Half of the changes know that most formats here are words and numbers: they put a number that overflows, or a keyword,
//! in the place of a word. The others know nothing and also serve images.

use crate::support::Random;

/// Largest input.
const LONGEST: usize = 1 << 16;

/// Numbers at the edges of what types hold, and words that only look like numbers.
const NUMBERS: [&str; 44] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "7",
    "0.5",
    "1.0001",
    "255",
    "256",
    "65535",
    "65536",
    "65537",
    "1e-4",
    "1e-7",
    "1e-45",
    "1e-320",
    "1e6",
    "1000001",
    "1e9",
    "1e12",
    "1.1e12",
    "3.4028236e38",
    "1e39",
    "1e308",
    "1e309",
    "-1e309",
    "nan",
    "inf",
    "-inf",
    "2147483647",
    "2147483648",
    "-2147483649",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "0x1p3",
    "1_000",
    "+5",
    ".",
];

/// Words of all text formats here.
const WORDS: [&str; 86] = [
    "v",
    "vt",
    "vn",
    "f",
    "fo",
    "l",
    "p",
    "g",
    "o",
    "s",
    "usemtl",
    "mtllib",
    "fuzz.mtl",
    "#",
    "\\\n",
    "curv",
    "end",
    "//",
    "1/1/1",
    "-1//-1",
    "1/2",
    "newmtl",
    "a",
    "b",
    "Kd",
    "Ks",
    "Ke",
    "Ka",
    "Ns",
    "Ni",
    "d",
    "Tr",
    "Tf",
    "illum",
    "Pr",
    "Pm",
    "aniso",
    "map_Kd",
    "-s",
    "-o",
    "-bm",
    "image.png",
    "[film]",
    "[camera]",
    "[integrator]",
    "[environment]",
    "[[meshes]]",
    "[materials.a]",
    "[materials]",
    "width =",
    "height =",
    "spp =",
    "exposure =",
    "origin =",
    "target =",
    "up =",
    "vfov =",
    "max_depth =",
    "russian_roulette =",
    "seed =",
    "radiance =",
    "file = \"tri.obj\"",
    "material = \"a\"",
    "materials = { a = \"a\" }",
    "transform =",
    "{ scale = 2 }",
    "{ rotate = { axis = [0, 0, 1], degrees = 9 } }",
    "{ translate = [1, 2, 3] }",
    "{ matrix = [",
    "type =",
    "\"diffuse\"",
    "\"mirror\"",
    "\"conductor\"",
    "\"mix\"",
    "lobes =",
    "base_color =",
    "{ texture = \"image.png\" }",
    "emission =",
    "weight =",
    "roughness =",
    "f0 =",
    "eta =",
    "k =",
    "true",
    "{ a = 1 }",
    "[1, 2, 3]",
];

/// Bytes between words.
const GAPS: &[u8] = b" \t\n\r,=/[]{}\"#";

/// An input made from the seeds by one to six changes.
pub(super) fn mutate(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut data = seeds[random.pick(seeds.len())].clone();
    for _ in 0..=random.pick(6) {
        change(&mut data, seeds, random);
        data.truncate(LONGEST);
    }
    data
}

fn change(data: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    let at = random.pick(data.len() + 1);
    let to = at + random.pick(data.len() - at + 1).min(1 << random.pick(9));
    match random.pick(13) {
        0 if at < data.len() => data[at] ^= 1 << random.pick(8),
        1 if at < data.len() => data[at] = random.pick(256) as u8,
        2 => data.truncate(at),
        3 => drop(data.drain(at..to)),
        4 => insert(data, at, &repeated(&data[at..to], 1 << random.pick(13))),
        5 => insert(data, at, &[b'-', b'/', b'"', b'\\', 0, 0xff, 0xe9, b'\n'][random.pick(8)..][..1]),
        6 => {
            let other = &seeds[random.pick(seeds.len())];
            let from = random.pick(other.len() + 1);
            let length = random.pick(other.len() - from + 1);
            insert(data, at, &other[from..from + length]);
        }
        7 => {
            let other = &seeds[random.pick(seeds.len())];
            data.truncate(at);
            data.extend(&other[random.pick(other.len() + 1)..]);
        }
        8 => swap_lines(data, random),
        9 => {
            let word = WORDS[random.pick(WORDS.len())];
            insert(data, at, format!(" {word} ").as_bytes());
        }
        10 => {
            let word = WORDS[random.pick(WORDS.len())];
            replace_word(data, at, word.as_bytes());
        }
        _ => replace_word(data, at, NUMBERS[random.pick(NUMBERS.len())].as_bytes()),
    }
}

/// Long lines and deep nesting: so many times, as far as an input may grow.
fn repeated(part: &[u8], times: usize) -> Vec<u8> {
    part.repeat(times.min(LONGEST / part.len().max(1)))
}

fn insert(data: &mut Vec<u8>, at: usize, what: &[u8]) {
    drop(data.splice(at..at, what.iter().copied()));
}

fn replace_word(data: &mut Vec<u8>, at: usize, with: &[u8]) {
    let gap = |byte: &u8| GAPS.contains(byte);
    let from = data[..at].iter().rposition(gap).map_or(0, |gap| gap + 1);
    let to = data[at..].iter().position(gap).map_or(data.len(), |gap| at + gap);
    drop(data.splice(from..to, with.iter().copied()));
}

fn swap_lines(data: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<&[u8]> = data.split_inclusive(|&byte| byte == b'\n').collect();
    if !lines.is_empty() {
        let (a, b) = (random.pick(lines.len()), random.pick(lines.len()));
        lines.swap(a, b);
        *data = lines.concat();
    }
}
