//! Input and output files: outputs are written completely or not at all, inputs are never replaced, names from models
//! cannot control a terminal, and endless files do not block.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};

use rasterscope::disk;
use tempfile::TempDir;

const TRIANGLE: &str = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterscope"));
    command.args(args).current_dir(folder);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    command.output().unwrap()
}

fn text(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned()).concat()
}

/// Creates a folder with a textured model, a camera file and two cases.
fn inputs() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| fs::write(folder.path().join(name), content).unwrap();
    write("model.obj", &format!("mtllib model.mtl\n{TRIANGLE}o part\nusemtl m\nf 1/1 2/2 3/3\n"));
    write("model.mtl", "newmtl m\nmap_Kd texture.png\n");
    write("camera.json", r#"{"eye": [0, 0, 5], "target": [0, 0, 0], "fov_y_degrees": 45, "near": 0.1, "far": 100}"#);
    write("case.json", r#"{"id": "other", "kind": "line", "p0": [1, 1], "p1": [4, 2], "last_pixel": true}"#);
    write("other.json", r#"{"id": "third", "kind": "line", "p0": [1, 1], "p1": [4, 2], "last_pixel": true}"#);
    let texture = rasterscope::image::Image::from_pixels(2, 2, vec![[200, 100, 50, 255]; 4]);
    rasterscope::image::file::write_png(&folder.path().join("texture.png"), &texture).unwrap();
    folder
}

#[test]
fn a_reader_sees_the_old_file_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("output");
    let contents = [vec![b'a'; 3 << 20], vec![b'b'; 2 << 20]];
    disk::write(&path, &contents[0]).unwrap();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for round in 1..=24 {
                disk::write(&path, &contents[round % 2]).unwrap();
            }
            done.store(true, Ordering::Relaxed);
        });
        while !done.load(Ordering::Relaxed) {
            let seen = fs::read(&path).unwrap();
            assert!(contents.contains(&seen), "{} bytes, a part of a file", seen.len());
        }
    });
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
}

#[cfg(unix)]
#[test]
fn outputs_never_replace_an_input() {
    let folder = inputs();
    let at = |name: &str| folder.path().join(name);
    std::os::unix::fs::symlink("texture.png", at("link.png")).unwrap();
    let before: Vec<_> = ["model.obj", "model.mtl", "texture.png", "camera.json", "case.json", "other.json"]
        .map(|name| (name, fs::read(at(name)).unwrap()))
        .into();
    let render = ["render", "model.obj", "--camera", "camera.json", "--size", "16x16", "-o"];
    let probe = ["probe", "model.obj", "--size", "16x16", "--runs", "1", "-o"];
    let mut commands: Vec<Vec<&str>> = Vec::new();
    for output in ["model.obj", "model.mtl", "texture.png", "./camera.json", "link.png"] {
        commands.push([&render[..], &[output]].concat());
    }
    commands.push([&render[..], &["out.png", "--data", "model.mtl"]].concat());
    commands.push([&probe[..], &["texture.png"]].concat());
    commands.push(vec!["case", "case.json", "-o", "case.json"]);
    commands.push(vec!["case", "case.json", "other.json", "--out-dir", "."]);
    commands.push(vec!["lab", "seed-fill", "--picture", "texture.png", "-o", "texture.png"]);
    for command in commands {
        let output = run(folder.path(), &command);
        let said = text(&output);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {said}");
        assert!(said.contains("it is an input of this command"), "{command:?}: {said}");
        for (name, content) in &before {
            assert!(fs::read(at(name)).unwrap() == *content, "{command:?} changed {name}");
        }
    }
}

#[cfg(unix)]
#[test]
fn files_of_the_program_itself_are_read_and_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let [own, input] = ["own", "input"].map(|name| folder.path().join(name));
    disk::protect_inputs();
    for path in [&own, &input] {
        fs::write(path, "old").unwrap();
    }
    assert_eq!(disk::read_own(&own, 10).unwrap(), b"old");
    disk::write(&own, b"new").unwrap();
    assert_eq!(disk::read(&input, 10).unwrap(), b"old");
    assert!(disk::write(&input, b"new").unwrap_err().to_string().contains("input"));
    assert_eq!([&own, &input].map(|path| fs::read(path).unwrap()), [b"new", b"old"]);
}

#[test]
fn devices_and_redirected_output_are_written_to() {
    let folder = tempfile::tempdir().unwrap();
    let picture = ["render", "triangle", "--size", "16x16", "-o"];
    let output = run(folder.path(), &[&picture[..], &["/dev/stdout"]].concat());
    assert!(output.status.success() && output.stdout.starts_with(b"\x89PNG"), "{}", text(&output));
    assert!(run(folder.path(), &[&picture[..], &["/dev/null"]].concat()).status.success());
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

/// Returns whether a terminal or a title bar may interpret `c`; line ends are allowed, because the program prints them.
fn is_control(c: char) -> bool {
    c != '\n' && (c.is_control() || matches!(c as u32, 0x202A..=0x202E | 0x2066..=0x2069 | 0x200E..=0x200F | 0x61C))
}

#[test]
fn names_from_models_cannot_control_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let bad = "a\u{9b}31m\u{202e}b\u{2066}\u{85}c\u{7f}";
    let at = |name: &str| folder.path().join(name);
    fs::write(at("model.mtl"), format!("newmtl {bad}\nKd 1 0 0\nmap_Kd {bad}.png\n")).unwrap();
    let faces =
        format!("o {bad}\nusemtl {bad}\nf 1/1 2/2 3/3\no {bad}2\nusemtl missing{bad}\nf 1/1 2/2 3/3\n{bad} 1\n");
    // UTF-16 may contain any control character.
    let model =
        format!("mtllib model.mtl\nmtllib {bad}.mtl\n{TRIANGLE}{faces}").replace("a\u{9b}", "a\u{1b}]0;\u{7}\u{9b}");
    let name = format!("{bad}.obj");
    let utf16 = [0xFFFE_u16].into_iter().map(u16::swap_bytes).chain(model.encode_utf16()).flat_map(u16::to_le_bytes);
    fs::write(at(&name), utf16.collect::<Vec<_>>()).unwrap();
    let commands: [&[&str]; 8] = [
        &["fates", &name],
        &["plan", &name],
        &["check", &name, "--size", "32x32"],
        &["pixel", &name, "--at", "16,16", "--size", "32x32"],
        &["pixel", &name, "--at", "16,16", "--size", "32x32", "--json"],
        &["render", &name, "--size", "32x32", "-o", &format!("{bad}.png")],
        &["probe", &name, "--size", "32x32", "--runs", "1"],
        &["case", &name],
    ];
    for command in commands {
        let output = run(folder.path(), command);
        let said = text(&output);
        assert!(matches!(output.status.code(), Some(0..=2)) && !said.is_empty(), "{command:?}: {said}");
        if let Some(c) = said.chars().find(|c| is_control(*c)) {
            panic!("{command:?} prints {c:?} in {said:?}");
        }
    }
    // The names remain distinguishable, and the default material reports what was missing.
    let said = text(&run(folder.path(), &["fates", &name]));
    assert!(said.contains('\u{FFFD}') && said.contains("is not defined"), "{said}");
}

#[test]
fn messages_of_decoders_are_short_and_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let long = "k\\u001b[2J\\n".repeat(400);
    fs::write(at("case.json"), format!(r#"{{"id": "a", "kind": "{long}"}}"#)).unwrap();
    fs::write(at("camera.json"), format!(r#"{{"{long}": 1}}"#)).unwrap();
    for command in [&["case", "case.json"][..], &["fates", "triangle", "--camera", "camera.json"]] {
        let said = text(&run(folder.path(), command));
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.chars().count() < 700 && !said.trim_end().contains(is_control), "{said:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_and_files_of_proc_do_not_block() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    assert!(Command::new("mkfifo").arg(at("pipe.png")).status().unwrap().success());
    // A regular file of size 0 that blocks readers with permission to read it.
    std::os::unix::fs::symlink("/proc/kmsg", at("kmsg.png")).unwrap();
    for (texture, reason) in [("pipe.png", "it is not a regular file"), ("kmsg.png", "it is empty")] {
        fs::write(at("model.mtl"), format!("newmtl m\nmap_Kd {texture}\n")).unwrap();
        fs::write(at("model.obj"), format!("mtllib model.mtl\n{TRIANGLE}usemtl m\nf 1/1 2/2 3/3\n")).unwrap();
        let said = text(&run(folder.path(), &["fates", "model.obj"]));
        assert!(said.contains("texture not loaded") && said.contains(reason), "{said}");
    }
    for command in [
        &["fates", "pipe.png"][..],
        &["case", "pipe.png"],
        &["fates", "triangle", "--camera", "pipe.png"],
        &["lab", "seed-fill", "--picture", "pipe.png"],
        &["lab", "seed-fill", "--picture", "kmsg.png"],
    ] {
        let output = run(folder.path(), command);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {}", text(&output));
    }
}

/// Collects the source files below `folder` into `found`.
fn sources(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn only_one_module_opens_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    sources(&root, &mut found);
    assert!(found.len() > 100);
    let mut elsewhere = Vec::new();
    for path in found {
        let name = path.strip_prefix(&root).unwrap().display().to_string();
        // Test modules create files of their own.
        let is_test = name.ends_with("tests.rs") || name.contains("/tests/");
        if is_test || name == "engine/disk.rs" {
            continue;
        }
        let source = fs::read_to_string(&path).unwrap();
        let code = source.split("#[cfg(test)]\nmod tests").next().unwrap();
        // Examples in documentation may open files directly.
        let code: String = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        let calls = [
            "fs::write",
            "File::create",
            "File::open",
            "fs::read(",
            "OpenOptions",
            "save_with_format",
            "::open(&path)",
        ];
        elsewhere.extend(calls.iter().filter(|call| code.contains(**call)).map(|call| format!("{name}: {call}")));
    }
    assert!(elsewhere.is_empty(), "go through `disk`: {elsewhere:?}");
}

#[test]
fn pixels_of_the_smallest_pictures_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    for size in ["1x1", "2x1", "1x2", "2x2", "3x3"] {
        let (width, height) = size.split_once('x').unwrap();
        let last = format!("{},{}", width.parse::<u32>().unwrap() - 1, height.parse::<u32>().unwrap() - 1);
        for upscaler in rasterscope::upscale::BUILT_IN {
            let method = format!("upscaler.method={}", upscaler.id());
            for extra in [&[][..], &["--trace"], &["--json"]] {
                let command = ["pixel", "triangle", "--size", size, "--at", &last, "--set", &method];
                let output = run(folder.path(), &[&command[..], extra].concat());
                assert!(output.status.success(), "{size} {method} {extra:?}: {}", text(&output));
            }
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_measurement_writes_what_is_complete() {
    use std::process::Stdio;
    let folder = tempfile::tempdir().unwrap();
    let started = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rasterscope"));
        command.args(args).current_dir(folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    // More frames than any test waits for; the signal follows after the first frames were drawn.
    let child = started(&["bench", "triangle", "--size", "320x240", "--frames", "100000", "--json"]);
    let interrupt = || Command::new("sh").arg("-c").arg(format!("kill -INT {}", child.id())).status().unwrap();
    let cpu = || {
        let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap_or_default();
        stat.rsplit(") ")
            .next()
            .unwrap_or_default()
            .split(' ')
            .nth(11)
            .and_then(|ticks| ticks.parse().ok())
            .unwrap_or(0_u64)
    };
    // Waits at most 20 s; if the program ended early, the test fails below.
    for _ in 0..1000 {
        if cpu() >= 30 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(interrupt().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["partial"], true);
    assert!(report["frame_ms"]["n"].as_u64().unwrap() > 0);
    assert!(String::from_utf8_lossy(&output.stderr).contains("marked as partial"));
}

#[test]
fn long_measurements_check_their_output_before_they_begin() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    // Each of these commands would exceed the time of a test.
    for command in [
        &["report", "-o", "file/report", "--rounds", "1000"][..],
        &["scaling", "-o", "file/scaling", "--rounds", "1000"],
        &["stability", "-o", "missing/stability.txt"],
    ] {
        let output = run(folder.path(), command);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {}", text(&output));
    }
}

#[test]
fn licences_of_fonts_and_icons_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let said = text(&run(folder.path(), &["--version"]));
    for part in ["Lucide", "Hack", "NotoEmoji", "Ubuntu-Light", "emoji-icon-font"] {
        assert!(said.contains(part), "no licence of {part}");
    }
}
