//! Tests of `rasterscope compare`: figures, better picture, bounds, exit codes and messages.

use std::path::Path;
use std::process::{Command, Output};

use rasterscope::image::file::{self, write_png};
use rasterscope::image::pfm::{Floats, write_pfm};
use rasterscope::image::{Image, Rgba8};
use rasterscope::measure::against::figures;
use rasterscope::measure::difference::{Difference, picture, values};
use serde_json::Value;
use tempfile::TempDir;

fn gradient(shift: u8) -> Image<Rgba8> {
    Image::from_fn(40, 30, |x, y| [(x * 6) as u8, (y * 8) as u8, (x * y / 5) as u8 | shift, 255])
}

/// Creates a folder with the PNG files `a`, `b` (nearer to `r`) and `r`, a smaller `small.png`, and PFM files.
fn pictures() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, picture) in [("a.png", gradient(64)), ("b.png", gradient(4)), ("r.png", gradient(0))] {
        write_png(&folder.path().join(name), &picture).unwrap();
    }
    write_png(&folder.path().join("small.png"), &Image::filled(39, 30, [0, 0, 0, 255])).unwrap();
    let floats = |scale: f32| Floats::Three(Image::from_fn(40, 30, |x, y| [x as f32 * scale, y as f32, 0.25]));
    write_pfm(&folder.path().join("bright.pfm"), &floats(1.0)).unwrap();
    write_pfm(&folder.path().join("brighter.pfm"), &floats(1.5)).unwrap();
    std::fs::write(folder.path().join("text.exr"), "no picture").unwrap();
    folder
}

fn compare(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterscope"));
    command.arg("compare").args(args).current_dir(folder).output().unwrap()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn figures_of_png_files_are_those_of_the_engine() {
    let folder = pictures();
    let output = compare(folder.path(), &["a.png", "b.png", "--json", "-o", "d.png", "--gain", "2"]);
    assert_eq!(output.status.code(), Some(0));
    let metrics = &json(&output)["errors"][0]["metrics"];
    let (expected, _) = figures(&gradient(64), &gradient(4)).unwrap();
    for (name, value) in [
        ("psnr", expected.codes.psnr_db),
        ("ssim", expected.codes.ssim),
        ("flip", expected.flip),
        ("mse", expected.codes.mse),
        ("max", expected.codes.max_abs.into()),
        ("changed", expected.codes.differing_pixels as f64),
    ] {
        let measured = metrics[name].as_f64().unwrap();
        assert!((measured - value).abs() <= 1e-9 * value.abs(), "{name}: {measured} is not {value}");
    }
    let absolute = values(Difference::Absolute, &gradient(64), &gradient(4)).unwrap();
    assert_eq!(file::read(&folder.path().join("d.png")).unwrap(), picture(Difference::Absolute, 2, &absolute));
}

#[test]
fn floats_are_compared_as_linear_light_and_stated_to_be() {
    let folder = pictures();
    let report = json(&compare(folder.path(), &["bright.pfm", "brighter.pfm", "--json", "--metric", "max"]));
    assert_eq!(report["errors"][0]["scale"], "linear");
    assert_eq!(report["errors"][0]["metrics"], serde_json::json!({ "max": 39.0 * 0.5 }));
    assert_eq!(report["pictures"][1]["channels"][2], serde_json::json!({ "name": "B", "type": "32-bit float" }));
    let text = compare(folder.path(), &["bright.pfm", "brighter.pfm", "--tone-curve", "aces", "--exposure", "-2"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("SSIM and perceptual metrics: exposure -2 EV, tone curve ACES (fit)"), "{text}");
}

#[test]
fn slow_metrics_are_measured_on_request() {
    let folder = pictures();
    let ids = |args: &[&str]| -> Vec<String> {
        let report = json(&compare(folder.path(), &[&["a.png", "b.png", "--json"], args].concat()));
        report["errors"][0]["metrics"].as_object().unwrap().keys().cloned().collect()
    };
    let (fast, all) = (ids(&[]), ids(&["--all-metrics"]));
    assert!(fast.contains(&"ms-ssim".to_owned()) && !fast.iter().any(|id| id == "jod" || id == "ssimulacra2"));
    assert_eq!(all.len(), fast.len() + 2, "{all:?}");
    let same = json(&compare(folder.path(), &["a.png", "a.png", "--metric", "jod,ssimulacra2", "--json"]));
    assert_eq!(same["errors"][0]["metrics"], serde_json::json!({ "jod": 10.0, "ssimulacra2": 100.0 }));
    let text =
        compare(folder.path(), &["a.png", "b.png", "--metric", "jod", "--pixels-per-degree", "30", "--min", "jod=9.9"]);
    assert_eq!(text.status.code(), Some(1), "{}", stderr(&text));
    assert!(String::from_utf8_lossy(&text.stdout).contains("ColorVideoVDP: 30 pixels per degree"));
    write_png(&folder.path().join("tiny.png"), &Image::filled(3, 3, [0, 0, 0, 255])).unwrap();
    let tiny = compare(folder.path(), &["tiny.png", "tiny.png", "--metric", "jod"]);
    assert!(stderr(&tiny).contains("jod: not defined for pictures of this size"), "{}", stderr(&tiny));
}

#[test]
fn colorvideovdp_of_a_sequence_counts_flicker() {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..6_u32 {
        let write = |name: &str, factor: f64| {
            let path = folder.path().join(format!("{name}.{frame}.png"));
            let code = |code: u8| (f64::from(code) * factor).round() as u8;
            write_png(&path, &gradient(0).map(|[r, g, b, a]| [code(r), code(g), code(b), a])).unwrap();
        };
        write("reference", 1.0);
        write("still", 1.03);
        write("flicker", if frame % 2 == 0 { 1.03 } else { 0.97 });
    }
    let args = ["flicker.#.png", "still.#.png", "--reference", "reference.#.png", "--metric", "jod,max", "--fps", "60"];
    let report = json(&compare(folder.path(), &[&args[..], &["--json"]].concat()));
    let jod = |index: usize| report["quality"][index]["jod"].as_f64().unwrap();
    assert!(jod(0) < jod(1) && jod(1) < 10.0, "{report}");
    assert_eq!(report["quality"][0]["viewing"]["frames_per_second"], 60.0);
    assert!(report["frames"][0]["errors"][0]["metrics"]["jod"].is_null(), "only the sequence has a value");
    let bounded = compare(folder.path(), &[&args[..], &["--min", "jod=9.999"]].concat());
    assert_eq!(bounded.status.code(), Some(1));
    let text = String::from_utf8_lossy(&bounded.stdout).into_owned();
    assert!(text.contains("JOD over the sequence, at 60 frames per second and 67 pixels per degree"), "{text}");
}

#[test]
fn the_picture_nearer_to_the_reference_is_named() {
    let folder = pictures();
    let text = compare(folder.path(), &["a.png", "b.png", "--reference", "r.png"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("B is better: b.png"));
    let swapped = json(&compare(folder.path(), &["b.png", "a.png", "--reference", "r.png", "--json"]));
    assert_eq!((&swapped["better"]["flip"], &swapped["better"]["psnr"]), (&Value::from("A"), &Value::from("A")));
    let same = compare(folder.path(), &["a.png", "a.png", "--reference", "r.png"]);
    assert!(String::from_utf8_lossy(&same.stdout).contains("A and B are equally good"));
}

#[test]
fn bounds_decide_about_the_exit_code() {
    let folder = pictures();
    let code = |bounds: &[&str]| {
        let output = compare(folder.path(), &[&["b.png", "r.png"], bounds].concat());
        (output.status.code(), stderr(&output))
    };
    assert_eq!(code(&["--max", "max=4", "--min", "psnr=20"]), (Some(0), String::new()));
    let (status, message) = code(&["--max", "max=3.5"]);
    assert_eq!((status, message.as_str()), (Some(1), "error: A against B: max 4 is above 3.5\n"));
    let (status, message) = code(&["--min", "ssim=1"]);
    assert!(status == Some(1) && message.contains("ssim") && message.contains("is below 1"), "{message}");
}

#[test]
fn bad_input_is_one_sentence_and_exit_code_2() {
    let folder = pictures();
    for (args, culprit) in [
        (
            &["a.png", "small.png"][..],
            "a.png and small.png: the pictures have different sizes: 40 × 30 px and 39 × 30 px",
        ),
        (&["a.png", "missing.png"], "missing.png: cannot read it"),
        (&["text.exr", "a.png"], "text.exr: not a supported picture"),
        (&["a.png", "b.png", "--layer", "Z"], "a.png: no layer Z; its layers are RGB"),
        (&["a.png", "b.png", "--max", "psnr=30"], "use --min psnr=VALUE"),
        (&["a.png", "b.png", "--max", "flop=1"], "flop is not a metric"),
    ] {
        let output = compare(folder.path(), args);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.contains(culprit) && message.lines().count() == 1, "{args:?}: {message}");
    }
}

/// Creates a folder with the frames 1 to 4 of a sequence, each brighter than the one before.
fn frames() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("ours")).unwrap();
    for frame in 1..=4 {
        let name = format!("f.{frame:03}.png");
        write_png(&folder.path().join(&name), &Image::filled(8, 6, [10 * frame, 0, 0, 255])).unwrap();
        // One frame behind.
        let ours = folder.path().join("ours").join(format!("{}.png", frame + 1));
        write_png(&ours, &Image::filled(8, 6, [10 * frame, u8::from(frame == 3), 0, 255])).unwrap();
    }
    folder
}

#[test]
fn every_frame_of_a_sequence_is_compared_and_the_worst_is_named() {
    let folder = frames();
    let report = json(&compare(folder.path(), &["f.###.png", "ours", "--metric", "max", "--json", "-o", "d.##.png"]));
    let errors = |report: &Value| -> Vec<(i64, f64)> {
        let frames = report["frames"].as_array().unwrap();
        let error = |frame: &Value| frame["errors"][0]["metrics"]["max"].as_f64().unwrap();
        frames.iter().map(|frame| (frame["frame"].as_i64().unwrap(), error(frame))).collect()
    };
    assert_eq!(errors(&report), [(2, 10.0), (3, 10.0), (4, 10.0)]);
    assert_eq!(report["skipped"], serde_json::json!([1, 5]));
    assert_eq!(file::read(&folder.path().join("d.03.png")).unwrap().size(), (8, 6));

    let shifted = json(&compare(folder.path(), &["f.###.png", "ours", "--shift-b", "1", "--metric", "max", "--json"]));
    assert_eq!(errors(&shifted), [(1, 0.0), (2, 0.0), (3, 1.0), (4, 0.0)]);
    let worst = &shifted["summary"][0];
    assert_eq!((&worst["worst"], &worst["worst_frame"], &worst["mean"]), (&1.0.into(), &3.into(), &0.25.into()));

    let output = compare(folder.path(), &["f.###.png", "ours", "--shift-b", "1", "--max", "max=0.5"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stderr(&output), "error: frame 3: A against B: max 1 is above 0.5\n");
}

#[test]
fn one_picture_serves_as_the_reference_of_every_frame() {
    let folder = frames();
    let text = compare(folder.path(), &["f.#.png", "f.#.png", "--reference", "f.001.png", "--metric", "max"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("reference: f.001.png: one picture for all frames"), "{text}");
    assert!(text.contains("frame 4, B against reference: max 30"), "{text}");
    assert!(
        text.contains("A against reference, Largest difference: mean 15.000000, worst 30.000000 (frame 4)"),
        "{text}"
    );
}

#[test]
fn unusable_sequences_are_refused_in_one_sentence() {
    let folder = frames();
    for (args, message) in [
        (&["x.#.png", "ours"][..], "error: x.#.png: no file has a name of this pattern\n"),
        (
            &["f.#.png", "ours", "--shift-b", "9"],
            "error: the sequences have no frame number in common; see --shift-b\n",
        ),
        (
            &["f.#.png", "ours", "-o", "d.png"],
            "error: --output d.png: for sequences, name a pattern such as difference.####.png\n",
        ),
        (
            &["f.#.png", "f.#.png", "--shift-b", "1", "-o", "f.###.png"],
            "error: --output: f.001.png is a picture of the sequences; choose another name or folder\n",
        ),
        (
            // Frame 2 of the folder is compared with no other, but is not replaced either.
            &["f.#.png", "ours", "--shift-b", "3", "-o", "ours/#.png"],
            "error: --output: ours/2.png is a picture of the sequences; choose another name or folder\n",
        ),
        (
            &["f.001.png", "f.002.png", "--shift-b", "1"],
            "error: --shift-b and --shift-reference: only sequences have frames\n",
        ),
    ] {
        let output = compare(folder.path(), args);
        assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(2), message));
    }
}

#[test]
fn a_damaged_frame_is_named_and_the_others_are_compared() {
    let folder = frames();
    std::fs::write(folder.path().join("f.003.png"), "no picture").unwrap();
    let output = compare(folder.path(), &["f.#.png", "ours", "--shift-b", "1", "--metric", "psnr"]);
    assert_eq!(output.status.code(), Some(2));
    let complaint = stderr(&output);
    assert!(complaint.starts_with("error: frame 3: f.003.png: not a supported picture"), "{complaint}");
    assert!(complaint.ends_with("error: 1 of 4 frames cannot be compared, first frame 3\n"), "{complaint}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("frame 2") && !text.contains("frame 3, ") && text.contains("frame 4"), "{text}");
}

#[test]
fn the_mean_psnr_is_that_of_the_mean_squared_error() {
    let folder = tempfile::tempdir().unwrap();
    for (name, red) in [("a1.png", 0), ("a2.png", 0), ("b1.png", 0), ("b2.png", 30)] {
        write_png(&folder.path().join(name), &Image::filled(8, 6, [red, 0, 0, 255])).unwrap();
    }
    let report = json(&compare(folder.path(), &["a#.png", "b#.png", "--metric", "psnr", "--metric", "mse", "--json"]));
    let summary = report["summary"].as_array().unwrap();
    let mean = |id: &str| summary.iter().find(|row| row["metric"] == id).unwrap()["mean"].as_f64().unwrap();
    let expected = 10.0 * (255.0_f64 * 255.0 / mean("mse")).log10();
    assert!((mean("psnr") - expected).abs() < 1e-9 && mean("mse") == 150.0, "{} is not {expected}", mean("psnr"));
}
