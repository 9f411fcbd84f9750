//! The tables of models in `docs/scene-format.md` are what the kernel declares, to the letter.

use crate::support::repository;
use gonio_kernel::lobe::{AnyLobe, Coating};
use gonio_kernel::model::{Entry, Model, Parameter, Parameters, Words};
use std::fmt::Write;
use std::fs;

const BEGIN: &str = "<!-- Written by `GONIO_WRITE_DOCS=1 cargo test model_tables`: the kernel's declarations. -->\n";
const END: &str = "<!-- End of what is written. -->\n";

/// A number as short as it can be said: powers of ten from 10⁻⁴ down and 10⁴ up by their exponents.
fn short(x: f64) -> String {
    let exponent = x.abs().log10().round();
    let is_power = x != 0.0 && (x / 10.0_f64.powf(exponent) - 1.0).abs() < 1e-12;
    if is_power && exponent.abs() >= 4.0 { format!("10^{exponent}") } else { format!("{x}") }
}

fn sentence(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn parameter(p: &Parameter, default: Option<&str>) -> String {
    let kind = if p.is_color { "a colour, " } else { "" };
    let stated = p.default.map(short);
    let default = default.or(stated.as_deref()).unwrap_or("required");
    let range = format!("{kind}{} to {}", short(p.quantity.lo), short(p.quantity.hi));
    format!("| `{}` | {} | {range} | {default} |\n", p.key, sentence(p.doc))
}

fn words(w: &Words, default: Option<&str>) -> String {
    let each: Vec<String> = w.each().map(|word| format!("`\"{word}\"`")).collect();
    let stated = w.default.and_then(|at| each.get(at)).map(String::as_str);
    let default = default.or(stated).unwrap_or("required");
    format!("| `{}` | {} | {} | {default} |\n", w.key, sentence(w.doc), each.join(", "))
}

fn rows(entries: &[Entry], default: Option<&str>, out: &mut String) {
    for entry in entries {
        match entry {
            Entry::Parameter(p) => out.push_str(&parameter(p, default)),
            Entry::Choice(w) => out.push_str(&words(w, default)),
            Entry::Group(entries) => rows(entries, default, out),
            Entry::OneOf { ways, .. } => {
                let has_default = ways.iter().any(|way| way.is_empty());
                let mut first = true;
                for way in ways.iter().filter(|way| !way.is_empty()) {
                    let keys: Vec<String> = way.iter().filter_map(key).collect();
                    let or = match (first, has_default) {
                        (true, true) => "one of these, or none",
                        (true, false) => "one of these",
                        (false, _) => "or",
                    };
                    let with = if keys.len() > 1 { format!("{or}: {}", keys.join(" with ")) } else { or.to_owned() };
                    rows(way, Some(&with), out);
                    first = false;
                }
            }
            other => panic!("no words for {other:?}"),
        }
    }
}

fn key(entry: &Entry) -> Option<String> {
    match entry {
        Entry::Parameter(p) => Some(format!("`{}`", p.key)),
        Entry::Choice(w) => Some(format!("`{}`", w.key)),
        _ => None,
    }
}

fn tables() -> String {
    let mut text = String::new();
    let mut table = |name: &str, doc: &str, entries: &[Entry]| {
        let _ = write!(
            text,
            "\n### `\"{name}\"`\n\n{}\n\n| key | meaning | range | default |\n|---|---|---|---|\n",
            sentence(doc)
        );
        rows(entries, None, &mut text);
    };
    AnyLobe::<f32>::each_model(&mut |info| table(info.name, info.doc, info.entries));
    table("layered", "A dielectric coat over `base`, a table of any type.", <Coating<f32> as Parameters>::ENTRIES);
    text.push('\n');
    text
}

#[test]
fn the_tables_of_models_say_what_the_kernel_declares() {
    let path = repository("docs/scene-format.md");
    let text = fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(BEGIN).expect("the tables begin");
    let (between, after) = rest.split_once(END).expect("the tables end");
    let declared = tables();
    if std::env::var_os("GONIO_WRITE_DOCS").is_some() {
        fs::write(&path, format!("{before}{BEGIN}{declared}{END}{after}")).unwrap();
        return;
    }
    assert_eq!(between, declared, "docs/scene-format.md: run `GONIO_WRITE_DOCS=1 cargo test model_tables`");
}
