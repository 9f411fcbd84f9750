//! `gonio accel`: the census of all backends, and the benchmark.

use super::{PROGRAM, Run, folder, gonio, scene};
use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The files of a census of the Cornell box with few rays.
fn census(folder: &Path, more: &str) -> Run {
    gonio(folder, &format!("accel census {} --rays 4000 --scales 1,1e-4 {more}", scene("cornell-box.toml")))
}

#[test]
fn a_census_prints_its_rows_and_its_json_has_the_same_numbers() {
    let folder = folder();
    let table = census(folder.path(), "--json census.json").succeeds();
    for words in ["edge-from-inside", "axis-parallel", "pass  obvhs at scale 1e-4", "by brute", "passed"] {
        assert!(table.contains(words), "\"{words}\" is not in: {table}");
    }
    let report: Value = serde_json::from_slice(&fs::read(folder.path().join("census.json")).unwrap()).unwrap();
    assert_eq!((report["passed"].as_bool(), report["triangles"].as_u64()), (Some(true), Some(36)));
    // Rays aimed at edges meet either triangle: with Embree there are disagreements, all of them its own.
    assert!(report["disagreements"].as_array().unwrap().iter().all(|d| d["backend"] == "embree"));
    let rows = report["rows"].as_array().unwrap();
    let backends = 1 + report["backends"].as_array().unwrap().len();
    assert_eq!(rows.len(), 2 * 15 * backends);
    for row in rows {
        let number = |name: &str| row[name].as_u64().unwrap_or_else(|| panic!("{name} in {row}"));
        assert!(number("rays") > 1000 && number("hits") > 0 && number("hits") <= number("rays"), "{row}");
        assert_eq!(number("seen_by_brute"), number("rays"), "brute can look at all rays of a small scene");
        let disagreements: u64 = ["hit_or_miss", "prim", "t", "bary", "shadow"].map(number).iter().sum();
        assert!(disagreements == 0 || row["backend"] == "embree", "{row}");
        assert!(row["family"].is_string() && row["scale"].is_number() && row["specimen"].is_string());
    }
    for finding in report["findings"].as_array().unwrap() {
        assert!(finding["count"].as_u64() <= finding["limit"].as_u64(), "{finding}");
    }
    let without = report["not_run"].as_array().unwrap().iter().any(|name| name == "embree");
    assert_eq!(without, !rows.iter().any(|row| row["backend"] == "embree"));
    assert_eq!(table.contains("not run  embree"), without);
    // To standard output it is JSON alone, and the same census but for its duration.
    let mut again: Value = serde_json::from_str(&census(folder.path(), "--json -").succeeds()).unwrap();
    again["seconds"] = report["seconds"].clone();
    assert_eq!(again, report);
}

#[test]
fn a_backend_that_is_wrong_fails_the_census_and_its_rays_can_be_cast_again() {
    let folder = folder();
    let run = census(folder.path(), "--plant-fault second --json -");
    run.fails(2, "faults are: drops hits on shared edges");
    let output = Command::new(PROGRAM)
        .args([
            "accel",
            "census",
            &scene("cornell-box.toml"),
            "--rays",
            "4000",
            "--scales",
            "1",
            "--json",
            "census.json",
        ])
        .args(["--plant-fault", "returns the second nearest hit"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(3));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("FAIL  obvhs at scale 1e0: rays that disagree") && text.contains("obvhs: another"), "{text}");
    let report: Value = serde_json::from_slice(&fs::read(folder.path().join("census.json")).unwrap()).unwrap();
    let listed = report["disagreements"].as_array().unwrap();
    assert!(listed.len() > 20 && text.contains("more; --json FILE"), "{}", listed.len());
    for entry in listed.iter().filter(|entry| entry["backend"] == "obvhs") {
        let numbers = entry["ray"]["origin"].as_array().into_iter().chain(entry["ray"]["dir"].as_array()).flatten();
        for number in numbers.chain([&entry["ray"]["t_min"], &entry["ray"]["t_max"], &entry["told"][0]["hit"]["t"]]) {
            let decimal: f32 = number["decimal"].as_str().unwrap().parse().unwrap();
            let bits = u32::from_str_radix(number["bits"].as_str().unwrap(), 16).unwrap();
            assert_eq!(decimal.to_bits(), bits, "{entry}");
        }
        assert_eq!((&entry["told"][0]["backend"], &entry["told"][1]["backend"]), (&"brute".into(), &"obvhs".into()));
        // The second nearest lies behind the nearest.
        let t = |i: usize| entry["told"][i]["hit"]["t"]["decimal"].as_str().unwrap().parse::<f32>().unwrap();
        assert!(t(1) > t(0), "{entry}");
    }
}

#[test]
fn a_benchmark_prints_ratios_and_json_with_the_same_shape() {
    let folder = folder();
    let bench = format!("accel bench {} --rays 2000 --rounds 5", scene("cornell-box.toml"));
    let table = gonio(folder.path(), &format!("{bench} --threads 2 --backends obvhs,brute")).succeeds();
    for words in ["Mrays/s", "ratio", "ambient-occlusion", "brute", "incoherent", "2 threads", "build s"] {
        assert!(table.contains(words), "\"{words}\" is not in: {table}");
    }
    let report: Value = serde_json::from_str(&gonio(folder.path(), &format!("{bench} --json")).succeeds()).unwrap();
    assert_eq!((report["rounds"].as_u64(), report["threads"].as_u64()), (Some(5), Some(1)));
    for build in report["builds"].as_array().unwrap() {
        assert!(build["seconds"].as_f64().unwrap() >= 0.0 && build["intersect"].is_string(), "{build}");
    }
    let results = report["results"].as_array().unwrap();
    for set in ["primary", "bounce", "random", "shadow", "ambient-occlusion"] {
        let rows: Vec<_> = results.iter().filter(|row| row["set"] == set).collect();
        assert_eq!(rows[0]["ratio"].as_f64(), Some(1.0));
        assert_eq!(rows.iter().any(|row| row["coherent"] == true), set == "primary");
        for row in rows {
            let [min, median, max, ratio] = ["min", "median", "max", "ratio"].map(|name| row[name].as_f64().unwrap());
            assert!(0.0 < min && min <= median && median <= max && ratio > 0.0, "{row}");
            assert!(row["hits"].as_u64().unwrap() <= row["rays"].as_u64().unwrap());
        }
    }
    assert!(report["environment"]["processor"].is_string());
}
