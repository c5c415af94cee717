//! Tests of exported files: buffers as OpenEXR, HTML pages that name the command that writes them again, and projects.

use std::path::Path;
use std::process::{Command, Output};

use rasterscope::chain::{Frame, Recipe, RenderInputs, Renderer};
use rasterscope::image::picture::{Picture, Sample};
use rasterscope::inspect::buffers::BufferChannels;
use rasterscope::inspect::view::{Value, value};
use rasterscope::inspect::{Buffer, capture, inspect};
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Scene, SceneSource};
use std::sync::Arc;
use tempfile::TempDir;

/// Size of the pictures in these tests, as the option `--size`.
const SIZE: &str = "72x54";

const VIEWPORT: Viewport = Viewport { width: 72, height: 54 };

/// Largest size of a page, in bytes.
const MAX_PAGE: usize = 2_000_000;

fn run(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rasterscope")).args(args).current_dir(folder).output().unwrap()
}

#[track_caller]
fn succeed(folder: &Path, args: &[&str]) {
    let output = run(folder, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn drawn(settings: &[&str]) -> (Arc<Scene>, Recipe, Frame) {
    let scene = Arc::new(SceneSource::named("chess".into()).load().unwrap().scene);
    let mut recipe = Recipe::default();
    settings.iter().for_each(|setting| recipe.set(setting).unwrap());
    let frame = Renderer::default().render_converged(RenderInputs {
        scene: &scene,
        camera: &scene.home,
        recipe: &recipe,
        viewport: VIEWPORT,
    });
    (scene, recipe, frame)
}

/// Reads the sample of a channel at a pixel.
fn sample(picture: &Picture, name: &str, (x, y): (u32, u32)) -> Sample {
    let channel = picture.channels().iter().find(|channel| channel.name == name);
    channel.unwrap_or_else(|| panic!("{name}: {}", picture.description())).sample(x, y).unwrap()
}

fn float(picture: &Picture, name: &str, pixel: (u32, u32)) -> f32 {
    match sample(picture, name, pixel) {
        Sample::F32(value) => value,
        other => panic!("{name}: {other:?}"),
    }
}

fn integer(picture: &Picture, name: &str, pixel: (u32, u32)) -> u32 {
    match sample(picture, name, pixel) {
        Sample::U32(value) => value,
        other => panic!("{name}: {other:?}"),
    }
}

/// Linear light of an sRGB code, by the formula of the standard.
fn linear(code: u8) -> f64 {
    let encoded = f64::from(code) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn buffers_in_a_file_are_bit_for_bit_those_of_the_inspector() {
    for settings in [&["shading=lambert"][..], &["upscaler.method=bilinear", "upscaler.scale=2"], &["depth_test=off"]] {
        let folder = folder();
        let mut args = vec!["render", "chess", "--buffers", "-o", "b.exr", "--size", SIZE];
        settings.iter().for_each(|setting| args.extend(["--set", setting]));
        succeed(folder.path(), &args);
        let picture = Picture::read(&folder.path().join("b.exr")).unwrap();
        let (scene, recipe, frame) = drawn(settings);
        let buffers = capture(&scene, &recipe, &frame).completed_for(Buffer::Hits, &scene, &recipe, &frame);
        for pixel @ (x, y) in (0..VIEWPORT.height).flat_map(|y| (0..VIEWPORT.width).map(move |x| (x, y))) {
            let shown = |buffer| value(buffer, &frame, Some(&buffers), x, y);
            let bits = |name: &str| float(&picture, name, pixel).to_bits();
            let none = |name: &str| float(&picture, name, pixel).is_nan();
            for buffer in Buffer::ALL.iter().filter(|buffer| !buffer.is_motion()) {
                match (buffer.channels(), shown(*buffer)) {
                    (BufferChannels::Color([red, green, blue, alpha]), _) => {
                        for (channel, name) in [red, green, blue].into_iter().enumerate() {
                            let expected = linear(frame.image().at(x, y)[channel]);
                            assert!(
                                (f64::from(float(&picture, name, pixel)) - expected).abs() < 1e-6,
                                "{name} {pixel:?}"
                            );
                        }
                        assert_eq!(float(&picture, alpha, pixel), 1.0);
                    }
                    (BufferChannels::Number(name), Value::Number(number)) => {
                        assert_eq!(bits(name), number.to_bits(), "{name} {pixel:?}");
                    }
                    (BufferChannels::Number(name), _) => assert!(none(name), "{name} {pixel:?}"),
                    (BufferChannels::Weights(names), Value::Weights(weights)) => {
                        assert_eq!(names.map(bits), weights.map(f32::to_bits), "{names:?} {pixel:?}");
                    }
                    (BufferChannels::Weights(names), _) => assert!(names.into_iter().all(none), "{names:?} {pixel:?}"),
                    (BufferChannels::Count(name) | BufferChannels::Triangle(name), value) => {
                        let count = match value {
                            Value::Count(count) => count,
                            Value::Triangle(id) => id.0,
                            _ => u32::MAX,
                        };
                        assert_eq!(integer(&picture, name, pixel), count, "{name} {pixel:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn surfaces_in_a_file_are_those_of_the_replayed_pixels() {
    let folder = folder();
    let args = ["render", "chess", "--buffers", "-o", "b.exr", "--size", SIZE, "--set", "shading=lambert"];
    succeed(folder.path(), &args);
    let picture = Picture::read(&folder.path().join("b.exr")).unwrap();
    let (scene, recipe, frame) = drawn(&["shading=lambert"]);
    let mut compared = 0;
    for pixel @ (x, y) in
        (0..VIEWPORT.height).step_by(5).flat_map(|y| (0..VIEWPORT.width).step_by(3).map(move |x| (x, y)))
    {
        let report = inspect(&scene, &recipe, &frame, x, y).unwrap();
        let all = |layer: &str, names: &str| -> Vec<f32> {
            names.chars().map(|name| float(&picture, &format!("{layer}.{name}"), pixel)).collect()
        };
        let Some(visible) = report.visible() else {
            assert_eq!(integer(&picture, "id.object", pixel), u32::MAX);
            assert!(all("normal", "XYZ").iter().chain(&all("position", "XYZ")).all(|value| value.is_nan()));
            continue;
        };
        let object = integer(&picture, "id.object", pixel) as usize;
        assert_eq!(scene.instances[object].name, visible.instance, "{pixel:?}");
        let shading = visible.shading.as_ref().unwrap();
        let same = |values: Vec<f32>, expected: Option<&[f32]>| match expected {
            Some(expected) => assert_eq!(values, expected, "{pixel:?}"),
            None => assert!(values.iter().all(|value| value.is_nan()), "{pixel:?}"),
        };
        same(all("normal", "XYZ"), shading.normal.as_ref().map(|normal| &normal[..]));
        same(all("uv", "UV"), shading.uv.as_ref().map(|uv| &uv[..]));
        // The camera projects the position to the pixel, and sees it at the distance.
        let position: [f32; 3] = all("position", "XYZ").try_into().unwrap();
        let position = glam::DVec3::from_array(position.map(f64::from));
        let aspect = VIEWPORT.width as f32 / VIEWPORT.height as f32;
        let clip =
            scene.home.clip_from_world_f64(aspect, recipe.pipeline.depth_format.mapping()) * position.extend(1.0);
        let place = [(clip.x / clip.w + 1.0) / 2.0 * 72.0, (1.0 - clip.y / clip.w) / 2.0 * 54.0];
        // Corners are snapped to 1/256 px.
        let off = [place[0] - f64::from(x) - 0.5, place[1] - f64::from(y) - 0.5];
        assert!(off.iter().all(|off| off.abs() < 0.02), "{pixel:?}: {off:?}");
        let distance = f64::from(float(&picture, "distance", pixel));
        assert!((distance / clip.w - 1.0).abs() < 1e-3, "{pixel:?}: {distance} {}", clip.w);
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn files_of_buffers_are_compared_layer_by_layer() {
    let folder = folder();
    let render = |name: &str, setting: &str| {
        let args = ["render", "chess", "--buffers", "-o", name, "--size", SIZE, "--set", setting];
        succeed(folder.path(), &args);
    };
    render("a.exr", "shading=lambert");
    render("b.exr", "shading=normals");
    for (layer, differs) in [("RGBA", true), ("Z", false), ("id.object", false), ("position.Y", false)] {
        let output = run(folder.path(), &["compare", "a.exr", "b.exr", "--layer", layer, "--max", "max=0"]);
        assert_eq!(
            output.status.code(),
            Some(i32::from(differs)),
            "{layer}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn the_suffix_and_the_option_must_agree() {
    let folder = folder();
    for (args, words) in [
        (&["render", "chess", "--buffers", "-o", "a.png"][..], "name a file that ends in .exr"),
        (&["render", "chess", "-o", "a.exr"], "add --buffers"),
        (&["render", "chess", "--buffers", "--buffer", "depth", "-o", "a.exr"], "cannot be used with"),
    ] {
        let output = run(folder.path(), args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains(words) && message.lines().count() == 1, "{message}");
    }
}

/// Returns the command that a page shows at its end, as a browser copies it.
fn command_of(page: &str) -> String {
    let (_, rest) = page.split_once("This command writes this page again.</p>\n<pre>").expect("a command");
    let (command, _) = rest.split_once("</pre>").unwrap();
    command.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

/// Checks that a page is small, loads nothing, and is written again by the command that it shows.
#[track_caller]
fn check_page(folder: &Path, name: &str) -> String {
    let path = folder.join(name);
    let page = std::fs::read_to_string(&path).unwrap();
    assert!(page.len() <= MAX_PAGE, "{name}: {} bytes", page.len());
    assert!(page.contains("default-src 'none'") && page.contains("prefers-color-scheme: dark"));
    for address in ["src=\"http", "href=\"http", "@import", "url("] {
        assert!(!page.contains(address), "{name}: {address}");
    }
    assert!(!page.contains("<script>alert"), "{name}: unescaped");
    std::fs::remove_file(&path).unwrap();
    let programs = self::folder();
    std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_rasterscope"), programs.path().join("rasterscope")).unwrap();
    let search = format!("{}:{}", programs.path().display(), std::env::var("PATH").unwrap_or_default());
    let output = Command::new("sh").args(["-c", &command_of(&page)]).current_dir(folder).env("PATH", search).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}: {}", command_of(&page), String::from_utf8_lossy(&output.stderr));
    let again = std::fs::read_to_string(&path).unwrap();
    assert!(again == page, "{name}: the command writes another page");
    page
}

/// File name that would be a script if it were not escaped.
const ATTACK: &str = "<script>alert('1')<|script> & co";

#[test]
fn a_camera_path_of_a_pixel_needs_the_number_of_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["pixel", "triangle", "--at", "1,1", "--size", "16x9", "--path", "turntable"];
    let output = run(folder.path(), &args);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--path needs --frame"));
    succeed(folder.path(), &[&args[..], &["--frame", "1"]].concat());
}

#[cfg(unix)]
#[test]
fn the_page_of_a_pixel_is_written_again_by_its_command() {
    let folder = folder();
    let model = format!("{ATTACK}.obj");
    let text = "o <script>alert(1)</script>\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join(&model), text).unwrap();
    succeed(folder.path(), &["pixel", &model, "--at", "36,27", "--size", SIZE, "--html", "p.html"]);
    let page = check_page(folder.path(), "p.html");
    assert!(page.contains("&lt;script&gt;alert"), "the names are shown");
    let args = ["pixel", "interpenetrating", "--at", "36,27", "--size", SIZE, "--html", "z.html", "--fragment", "1"];
    succeed(folder.path(), &args);
    let page = check_page(folder.path(), "z.html");
    let output = run(folder.path(), &["pixel", "interpenetrating", "--at", "36,27", "--size", SIZE, "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for text in [report["verdict"].as_str().unwrap(), report["fragments"][0]["reason"].as_str().unwrap()] {
        assert!(page.contains(&text.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;")), "{text}");
    }
    assert!(page.contains("Fragment 1 of 2, line by line."));
}

#[cfg(unix)]
#[test]
fn pages_of_comparisons_are_written_again_by_their_commands() {
    let folder = folder();
    let name = format!("{ATTACK}.png");
    for (name, setting) in [(name.as_str(), "filter=point"), ("b.png", "filter=bilinear")] {
        succeed(folder.path(), &["render", "chess", "--size", "640x360", "--set", setting, "-o", name]);
    }
    succeed(folder.path(), &["compare", &name, "b.png", "--reference", "b.png", "-o", "c.html"]);
    let page = check_page(folder.path(), "c.html");
    assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 4);
    assert!(page.contains("<th>A against reference</th><th>B against reference</th>"));
    let settings = ["--set", "filter=point", "--against", "filter=bilinear"];
    let args = ["diff", "chess", "--size", "160x90", "--rounds", "0", "--turn", "0", "-o", "d.html"];
    succeed(folder.path(), &[&args[..], &settings].concat());
    let page = check_page(folder.path(), "d.html");
    assert!(page.contains("filter: bilinear") && page.contains("filter: point"));
}

#[cfg(unix)]
#[test]
fn pages_of_lab_runs_are_written_again_by_their_commands() {
    let folder = folder();
    succeed(folder.path(), &["lab", "polygons", "--step", "9", "-o", "run.html"]);
    let page = check_page(folder.path(), "run.html");
    assert_eq!(page.matches("data-row=").count(), 9);
    let printed = run(folder.path(), &["lab", "polygons", "--step", "9"]);
    let last = String::from_utf8(printed.stdout).unwrap().lines().nth(8).unwrap()[7..].to_owned();
    assert!(page.contains(&format!("<td>9</td><td>{last}</td>")), "{last}");
}

/// Project of the chess scene with settings, a camera and a picked pixel of its own.
const PROJECT: &str = r#"{
  "rasterscope": 1,
  "scene": "chess",
  "camera": {"eye": [3, 4, 9], "target": [0, 1, 0], "fov_y_degrees": 30, "near": 0.5, "far": 100},
  "settings": ["shading=lambert", "filter=point"],
  "size": [72, 54],
  "pick": [36, 27]
}"#;

#[test]
fn commands_take_scene_camera_settings_size_and_pixel_from_a_project() {
    let folder = folder();
    std::fs::write(folder.path().join("p.rasterscope"), PROJECT).unwrap();
    let camera = r#"{"eye": [3, 4, 9], "target": [0, 1, 0], "fov_y_degrees": 30, "near": 0.5, "far": 100}"#;
    let explicit = ["chess", "--camera", camera, "--set", "shading=lambert", "--set", "filter=point"];
    let print = |args: &[&str]| {
        let output = run(folder.path(), args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let of_project = print(&["pixel", "p.rasterscope"]);
    assert_eq!(of_project, print(&[&["pixel"], &explicit[..], &["--at", "36,27", "--size", SIZE]].concat()));
    assert_eq!(print(&["fates", "p.rasterscope"]), print(&[&["fates"], &explicit[..], &["--size", SIZE]].concat()));
    // Explicit options win.
    let changed = ["--set", "shading=normals", "--size", "40x30", "--at", "7,8"];
    assert_eq!(
        print(&[&["pixel", "p.rasterscope"], &changed[..]].concat()),
        print(&[&["pixel"], &explicit[..], &changed].concat())
    );
    for (name, args) in [("a.png", vec!["render", "p.rasterscope"]), ("b.png", [&["render"], &explicit[..]].concat())] {
        let size = if name == "b.png" { &["--size", SIZE][..] } else { &[] };
        print(&[&args[..], size, &["-o", name]].concat());
    }
    let [a, b] = ["a.png", "b.png"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(a == b, "the pictures are equal");
}

#[test]
fn a_damaged_project_is_one_sentence_and_exit_code_2() {
    let folder = folder();
    for (from, to, words) in [
        ("\"rasterscope\": 1", "\"rasterscope\": 9", "p.rasterscope:2: the project has version 9"),
        ("\"pick\"", "\"colour\"", "p.rasterscope:7: unknown field `colour`"),
        ("chess", "models/none.obj", "none.obj: cannot read it"),
        ("30, \"near\"", "\"30\", \"near\"", "p.rasterscope:4: invalid type"),
    ] {
        std::fs::write(folder.path().join("p.rasterscope"), PROJECT.replacen(from, to, 1)).unwrap();
        let output = run(folder.path(), &["render", "p.rasterscope", "-o", "a.png"]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(words) && message.lines().count() == 1, "{message}");
    }
    let unregistered = PROJECT.replace("\"filter=point\"", "\"upscaler.method=theirs\", \"upscaler.scale=2\"");
    std::fs::write(folder.path().join("p.rasterscope"), unregistered).unwrap();
    let output = run(folder.path(), &["render", "p.rasterscope", "-o", "a.png"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && message.contains("`theirs` is not registered"), "{message}");
}
