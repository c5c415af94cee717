//! Upscalers that run as external processes, by the command line.

use std::fs;
use std::time::Duration;

use rasterscope::chain::Recipe;
use rasterscope::inspect::{Buffer, InspectionState};
use rasterscope::scene::builtin;
use rasterscope::upscale::process::register_process;

use super::{errors, example, run};

/// Whether Python is on this machine. If not, the test says that it checks nothing.
fn has_python() -> bool {
    let found = std::process::Command::new("python3").arg("--version").output().is_ok_and(|o| o.status.success());
    if !found {
        let text = "not run: there is no python3 on this machine\n";
        drop(std::io::Write::write_all(&mut std::io::stderr(), text.as_bytes()));
    }
    found
}

/// Returns the option that adds the example as an upscaler.
fn nearest_in_python(options: &str) -> String {
    format!("--upscaler-process=py-nearest{options}=python3 '{}'", example("nearest_upscaler.py").display())
}

#[test]
fn the_example_in_python_equals_nearest() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // Odd sizes cut the last block, and both formats must return the same codes.
    for (options, anchor, size) in
        [("", "corner", "64x36"), (":2,f32,depth", "centre", "61x35"), (":2,4,depth", "corner", "61x35")]
    {
        let process = nearest_in_python(options);
        let mut pictures = Vec::new();
        for method in ["nearest", "py-nearest"] {
            let file = format!("{method}.png");
            let (method, anchor) = (format!("upscaler.method={method}"), format!("upscaler.anchor={anchor}"));
            let settings = ["--set", &method, "--set", &anchor, "--set", "upscaler.scale=2"];
            let fixed = ["render", "cubes", "--size", size, "-o", &file, &process, "--upscaler-timeout", "20"];
            let output = run(&folder, &[&fixed[..], &settings].concat());
            assert!(output.status.success(), "{:?}", errors(&output));
            pictures.push(fs::read(folder.path().join(file)).unwrap());
        }
        assert!(pictures[0] == pictures[1], "{options}");
    }
}

#[test]
fn report_and_bench_list_the_time_of_the_transfer() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let process = nearest_in_python("");
    let common = ["--size", "32x18", &process, "--upscaler-timeout", "20"];
    let output =
        run(&folder, &[&["report", "triangle", "-o", "r", "--rounds", "1", "--turn", "0"][..], &common].concat());
    assert!(output.status.success(), "{:?}", errors(&output));
    let read = |name: &str| fs::read_to_string(folder.path().join("r").join(name)).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    let rows = report["scenes"][0]["rows"].as_array().unwrap();
    let row = |label: &str| rows.iter().find(|row| row["label"] == label).unwrap();
    let ms = |label: &str, part: &str| row(label)["parts_ms"][part].as_f64().unwrap();
    assert!(ms("py-nearest", "transfer") > 0.0 && ms("py-nearest", "upscale") > 0.0);
    assert_eq!(ms("Nearest ×2", "transfer"), 0.0);
    assert_eq!(row("py-nearest")["motion"]["mean"], row("Nearest ×2")["motion"]["mean"]);
    let table = read("report.csv");
    assert!(table.starts_with("scene,") && table.contains(",upscale_ms,transfer_ms,"));
    assert!(table.lines().any(|line| line.contains(",py-nearest,2,corner,")));
    assert!(read("index.html").contains("<th>transfer</th>"));

    let bench = ["bench", "triangle", "--frames", "3", "--set", "upscaler.method=py-nearest"];
    let output = run(&folder, &[&bench[..], &common].concat());
    assert!(String::from_utf8_lossy(&output.stdout).lines().any(|line| line.starts_with("transfer  ")), "{output:?}");
}

#[test]
fn a_failure_is_reported_once_with_exit_code_2_and_nothing_else_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let process = "--upscaler-process=broken=/no/such/program --fast";
    let picture = |method: &str| {
        let (method, file) = (format!("upscaler.method={method}"), format!("{method}.png"));
        let output = run(
            &folder,
            &[
                "render",
                "cubes",
                "--size",
                "64x36",
                "-o",
                &file,
                process,
                "--set",
                &method,
                "--set",
                "upscaler.scale=2",
            ],
        );
        (output, fs::read(folder.path().join(file)).unwrap())
    };
    let (failed, filled) = picture("broken");
    let (_, nearest) = picture("nearest");
    assert_eq!(failed.status.code(), Some(2));
    let lines = errors(&failed);
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].starts_with("error: upscaler `broken`, process `/no/such/program --fast`: it cannot be started"));

    let report = ["report", "triangle", "-o", "r", "--rounds", "1", "--turn", "0", "--size", "32x18", process];
    let output = run(&folder, &report);
    assert_eq!((output.status.code(), errors(&output).len()), (Some(2), 1), "{:?}", errors(&output));
    let page = fs::read_to_string(folder.path().join("r/index.html")).unwrap();
    assert_eq!(page.matches("<b>Failure:</b> upscaler `broken`").count(), 1);
    assert!(page.contains("Bicubic ×4") && page.contains("broken"));
    assert!(filled == nearest, "the picture is filled in by nearest neighbour");
}

#[cfg(unix)]
#[test]
fn the_inspector_reports_the_pixel_of_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    // Answers the opening message and one frame of 9 × 6 px at ×2: all pixels are transparent black.
    let script = "head -c 20 >/dev/null; printf 'RSUPSCAL\\001\\000\\000\\000'; head -c 96 >/dev/null; \
                  printf '\\000\\000\\000\\000\\011\\000\\000\\000\\006\\000\\000\\000'; head -c 216 /dev/zero";
    fs::write(folder.path().join("black.sh"), script).unwrap();
    let view = ["pixel", "cubes", "--size", "9x6", "--at", "4,3", "--json", "--upscaler-process", "black=sh black.sh"];
    let output = run(&folder, &[&view[..], &["--set", "upscaler.method=black"]].concat());
    assert!(output.status.success(), "{:?}", errors(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["color"], serde_json::json!([0, 0, 0, 0]), "{report}");
    assert_ne!(report["sources"][0]["color"], report["color"], "the sample is not black");
}

#[test]
fn a_copied_view_names_the_process() {
    let spec = "copied:2=python3 'my net.py'";
    register_process(&spec.parse().unwrap(), Duration::from_secs(2)).unwrap();
    let scene = builtin::by_id("cubes").unwrap().build();
    let mut recipe = Recipe::default();
    recipe.set("upscaler.method=copied").unwrap();
    let state = InspectionState {
        scene: "cubes".into(),
        mirrored: false,
        time_s: 0.0,
        camera: scene.home,
        recipe,
        picture: None,
        buffer: Buffer::Color,
        stage: None,
        number: None,
        display: Default::default(),
        overlays: Vec::new(),
        triangles: None,
        fragments: None,
        pixel: None,
    };
    let line = state.command_line();
    assert!(line.contains(r"--upscaler-process 'copied:2=python3 '\''my net.py'\'''"), "{line}");
    assert!(line.contains("--set upscaler.method=copied"), "{line}");
}

#[test]
fn unusable_options_are_explained_and_start_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for (option, words) in [
        ("nearest=true", "there is already an upscaler `nearest`"),
        ("My Net=true", "is not an id of an upscaler"),
        ("net:7=true", "`7` is neither a scale"),
        ("net", "expected ID=COMMAND"),
    ] {
        let output = run(&folder, &["render", "cubes", "-o", "x.png", "--upscaler-process", option]);
        assert_eq!(output.status.code(), Some(2), "{option}");
        assert!(errors(&output).concat().contains(words), "{option}: {:?}", errors(&output));
    }
    let output = run(&folder, &["render", "cubes", "-o", "x.png", "--set", "upscaler.method=net"]);
    assert!(errors(&output).concat().contains("`net` is not one of native, "), "{:?}", errors(&output));
    assert!(!folder.path().join("x.png").exists());
}
