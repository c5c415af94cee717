//! Tests of `rasterscope explain`: causes, further pictures, and messages.

use std::path::Path;
use std::process::{Command, Output};

use rasterscope::image::Image;
use rasterscope::image::file::write_png;
use serde_json::Value;

/// Size of all pictures.
const SIZE: [&str; 2] = ["--size", "64x36"];

fn program(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rasterscope")).args(args).current_dir(folder).output().unwrap()
}

/// Draws the chess scene as another renderer that culls front faces on a green background: picture, depths and ids.
fn drawn(folder: &Path) {
    let faulty = ["--set", "culling=front", "--set", "background=#104010"];
    for further in [
        &["-o", "theirs.png"][..],
        &["-o", "depth.png", "--buffer", "depth", "--data", "depth.pfm"],
        &["-o", "ids.png", "--set", "shading=object-id"],
    ] {
        let output = program(folder, &[&["render", "chess"], &SIZE[..], &faulty, further].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn depths_and_ids_are_compared_and_other_inputs_named() {
    let folder = tempfile::tempdir().unwrap();
    drawn(folder.path());
    let further = ["--depth", "depth.pfm", "--ids", "ids.png"];
    let output = program(folder.path(), &[&["explain", "theirs.png", "chess", "--json"], &further[..]].concat());
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let causes: Vec<_> = found["causes"].as_array().unwrap().iter().collect();
    assert_eq!(causes.len(), 2, "{found:#}");
    let cause = |id: &str| *causes.iter().find(|cause| cause["fault"] == id).unwrap_or_else(|| panic!("{found:#}"));
    let background = cause("background-colour");
    assert_eq!((&background["kind"], &background["detail"]), (&"input".into(), &"#104010".into()));
    assert!(cause("culling-front")["depth"]["explained"].as_u64() > Some(100), "{found:#}");
    assert_eq!(found["depth"]["mapping"], "0 at the near plane, 1 at the far plane");
    assert_eq!(found["ids"]["level"], "objects");
    for buffer in ["depth", "ids"] {
        assert!(found[buffer]["differing_before"].as_u64() > Some(100), "{found:#}");
        assert_eq!(found[buffer]["differing_after"], 0, "{found:#}");
    }
}

#[test]
fn unusable_further_pictures_are_named() {
    let folder = tempfile::tempdir().unwrap();
    drawn(folder.path());
    write_png(&folder.path().join("small.png"), &Image::filled(9, 5, [7, 7, 7, 255])).unwrap();
    for (further, message) in [
        (["--depth", "missing.pfm"], "missing.pfm: "),
        (["--depth", "theirs.png"], "theirs.png: it has colours, not depths"),
        (["--ids", "small.png"], "small.png: it has 9 × 5 px, but the picture 64 × 36"),
    ] {
        let output = program(folder.path(), &[&["explain", "theirs.png", "chess"], &further[..]].concat());
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), complaint.lines().count()), (Some(2), 1), "{complaint}");
        assert!(complaint.contains(message) && output.stdout.is_empty(), "{complaint}");
    }
}
