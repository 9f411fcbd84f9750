//! `gonio bsdf`: rows in, rows out, and the same digits whichever way they are asked for.

use super::{PROGRAM, folder, gonio, rows};
use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

#[test]
fn what_is_sampled_evaluates_to_the_same_digits() {
    let folder = folder();
    for precision in ["f32", "f64", "lanes"] {
        let sampled = gonio(
            folder.path(),
            &format!("bsdf sample metal.toml --wo 0.6,0,0.8 -n 1000 --seed 3 --precision {precision}"),
        )
        .succeeds();
        assert!(sampled.starts_with("wi_x,wi_y,wi_z,f_cos_r,f_cos_g,f_cos_b,pdf,weight_r,weight_g,weight_b,event\n"));
        let sampled: Vec<_> = rows(&sampled).into_iter().filter(|row| row[10] != "failed").collect();
        assert!(sampled.len() > 500);
        let table: String = sampled.iter().map(|row| format!("0.6,0,0.8,{}\n", row[..3].join(","))).collect();
        fs::write(folder.path().join("pairs.csv"), table).unwrap();
        gonio(
            folder.path(),
            &format!("bsdf eval metal.toml --directions pairs.csv -o out.csv --precision {precision}"),
        )
        .succeeds();
        let out = fs::read_to_string(folder.path().join("out.csv")).unwrap();
        assert_eq!(out.lines().next(), Some("f_cos_r,f_cos_g,f_cos_b,pdf"));
        for (sampled, evaluated) in sampled.iter().zip(rows(&out)) {
            assert_eq!(sampled[3..7], evaluated[..], "{precision}");
        }
    }
}

#[test]
fn eight_lanes_print_the_same_bytes_as_the_scalar() {
    let folder = folder();
    for material in ["white.toml", "metal.toml", "mirror.toml"] {
        let sample = |precision| {
            gonio(folder.path(), &format!("bsdf sample {material} --wo -0.48,0.36,0.8 -n 1003 --precision {precision}"))
                .succeeds()
        };
        assert_eq!(sample("f32"), sample("lanes"), "{material}");
    }
}

#[test]
fn directions_outside_of_the_domain_are_worth_exactly_nothing() {
    let folder = folder();
    let table = "0,0,1,0,0,2\nnan,0,1,0,0,1\n0,0,1,inf,0,1\n0,0,0,0,0,1\n0,0,1,0.6,0,-0.8\n0,0,1,0,0,1\n";
    fs::write(folder.path().join("odd.csv"), table).unwrap();
    let out = gonio(folder.path(), "bsdf eval white.toml --directions odd.csv --precision f64").succeeds();
    let rows = rows(&out);
    assert!(rows[..5].iter().all(|row| row.iter().all(|cell| *cell == "0.0")), "{out}");
    let value: f64 = rows[5][0].parse().unwrap();
    assert!((value - std::f64::consts::FRAC_1_PI).abs() < 1e-15);
    let run = gonio(folder.path(), "bsdf sample white.toml --wo 0,0,3 -n 2");
    assert!(run.err.contains("warning: --wo is not a unit vector"), "{}", run.err);
    assert!(run.succeeds().lines().skip(1).all(|line| line == "0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,failed"));
}

#[test]
fn a_longer_table_of_samples_begins_with_the_shorter_one() {
    let folder = folder();
    let sample =
        |n, seed| gonio(folder.path(), &format!("bsdf sample metal.toml --wo 0,0,1 -n {n} --seed {seed}")).succeeds();
    assert!(sample("5000", 1).starts_with(&sample("13", 1)));
    assert_ne!(sample("13", 1), sample("13", 2));
    let mirror = gonio(folder.path(), "bsdf sample mirror.toml --wo 0.6,0,0.8 -n 1").succeeds();
    assert_eq!(mirror.lines().nth(1), Some("-0.6,-0.0,0.8,0.75,0.5,0.25,1.0,0.75,0.5,0.25,mirror"));
}

#[test]
fn albedo_is_json_with_standard_errors() {
    let folder = folder();
    let text = gonio(folder.path(), "bsdf albedo white.toml --cos 0.1,1 --samples 1e4 --json").succeeds();
    assert_eq!(text.lines().count(), 1);
    let result: Value = serde_json::from_str(&text).unwrap();
    let rows = result["results"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        for channel in 0..3 {
            // A cosine sample of Lambert's law weighs its albedo, up to rounding.
            assert!((row["R"]["mean"][channel].as_f64().unwrap() - 1.0).abs() < 1e-6, "{row}");
            assert!(row["R"]["standard_error"][channel].as_f64().unwrap() < 1e-6);
            assert_eq!(row["T"]["mean"][channel].as_f64(), Some(0.0));
            assert_eq!(row["sum"]["mean"][channel], row["R"]["mean"][channel]);
        }
    }
    let pretty: Value =
        serde_json::from_str(&gonio(folder.path(), "bsdf albedo white.toml --cos 0.1,1 --samples 1e4").succeeds())
            .unwrap();
    assert_eq!(pretty, result);
}

#[test]
fn rows_can_be_json_and_come_from_standard_input() {
    let folder = folder();
    let input = fs::read(folder.path().join("in.csv")).unwrap();
    let output = Command::new(PROGRAM)
        .args(["bsdf", "eval", "white.toml", "--directions", "-", "--json"])
        .current_dir(folder.path())
        .write_stdin(input)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(rows.len(), 2);
    assert!(rows[0]["pdf"].as_f64().unwrap() > 0.3 && rows[1]["pdf"].as_f64() == Some(0.0));
}

#[test]
fn a_reader_that_stops_early_is_no_error() {
    let folder = folder();
    let mut child = std::process::Command::new(PROGRAM)
        .args(["bsdf", "sample", "white.toml", "--wo", "0,0,1", "-n", "100000"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(line.starts_with("wi_x") && output.status.success() && output.stderr.is_empty());
}
