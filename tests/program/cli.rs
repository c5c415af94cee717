//! Tests of the program through its command line: arguments, exit codes, standard output, standard error and files.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

use rasterscope::case::Task;
use rasterscope::chain::{Recipe, SettingKey};
use rasterscope::drawing::file::EXTENSIONS;
use rasterscope::image::{Image, Rgba8, file};
use rasterscope::inspect::assertions::Assertion;
use rasterscope::inspect::outline::OutlineKind;
use rasterscope::inspect::{Buffer, Intermediate, Stage};
use rasterscope::lab::Page;
use rasterscope::manual::Chapter;
use rasterscope::measure::motion::Turn;
use rasterscope::measure::reference::Reference;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::report::stability::catalogue;
use rasterscope::report::upscaling::sweep::{self, NamedView, UpscalingPlan};
use rasterscope::scene::{SceneSource, builtin};
#[cfg(feature = "ui")]
use rasterscope::ui::session::compare::compute::{CompareRequest, Comparer};
#[cfg(feature = "ui")]
use rasterscope::ui::session::compare::files::ComparedFiles;
use rasterscope::upscale;
use tempfile::TempDir;

const COMMANDS_WITH_SETTINGS: [&[&str]; 9] =
    [&[], &["render"], &["vector"], &["pixel"], &["check"], &["fates"], &["plan"], &["screenshot"], &["window"]];

/// Returns a command that runs the program in `folder`, without access to a display.
fn program(folder: &TempDir, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterscope"));
    command.args(args).current_dir(folder);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    command
}

fn run(folder: &TempDir, args: &[&str]) -> Output {
    program(folder, args).output().unwrap()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn stdout(output: &Output) -> &str {
    str::from_utf8(&output.stdout).unwrap()
}

fn stderr(output: &Output) -> &str {
    str::from_utf8(&output.stderr).unwrap()
}

#[track_caller]
fn assert_success(output: &Output) {
    assert!(output.status.success(), "{}: {}", output.status, stderr(output));
}

/// Checks for exit code `code`, no standard output, and one line on standard error that contains `culprit`.
#[track_caller]
fn assert_failure(output: &Output, code: i32, culprit: &str) {
    let complaint = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{complaint}");
    assert_eq!(stdout(output), "");
    assert_eq!(complaint.lines().count(), 1, "{complaint}");
    assert!(complaint.starts_with("error: ") && complaint.contains(culprit), "no `{culprit}` in: {complaint}");
    assert!(!complaint.contains("panicked"), "{complaint}");
}

fn picture(folder: &TempDir, name: &str) -> Image<Rgba8> {
    file::read(&folder.path().join(name)).unwrap()
}

fn is_one_color(image: &Image<Rgba8>) -> bool {
    image.pixels().iter().all(|pixel| *pixel == image.at(0, 0))
}

fn is_empty(folder: &Path) -> bool {
    fs::read_dir(folder).unwrap().next().is_none()
}

#[test]
fn help_names_every_setting() {
    let folder = folder();
    for command in COMMANDS_WITH_SETTINGS {
        let output = run(&folder, &[command, &["--help"]].concat());
        assert_success(&output);
        for key in SettingKey::ALL {
            assert!(stdout(&output).contains(&format!("{}: ", key.id())), "{command:?}: {key:?}");
        }
    }
}

#[test]
fn help_lists_ranges_and_exit_codes() {
    let folder = folder();
    let help = |args: &[&str]| stdout(&run(&folder, &[args, &["--help"]].concat())).to_owned();
    for (key, values) in [("light.ambient", "number, 0…1"), ("upscaler.scale", "1.3, 1.5, 1.7, 2, 3, 4")] {
        assert!(help(&["render"]).contains(&format!("{key}: {values}")), "{key}");
    }
    for command in COMMANDS_WITH_SETTINGS.into_iter().chain([&["scenes"][..], &["stability"]]) {
        assert_eq!(help(command).matches("Exit codes: 0 success; 1 ").count(), 1, "{command:?}");
    }
}

#[test]
fn the_manual_names_every_setting_scene_method_buffer_and_kind_and_class_of_cases() {
    let manual: String = Chapter::ALL.iter().map(|chapter| chapter.text()).collect();
    let settings = SettingKey::ALL.iter().map(|key| key.id().to_owned());
    let scenes = builtin::ALL.iter().map(|scene| scene.id.to_owned());
    let methods = upscale::BUILT_IN.iter().map(|upscaler| upscaler.id().to_owned());
    let buffers = Buffer::ALL.iter().map(|buffer| buffer.id().to_owned());
    let buffers = buffers.chain(Intermediate::ALL.iter().map(|number| number.id().to_owned()));
    let kinds = Task::KINDS.iter().map(|kind| (*kind).to_owned());
    let classes = catalogue::all().map(|class| class.id.to_owned());
    let assertions = Assertion::ALL.iter().map(|assertion| assertion.id().to_owned());
    let pages = Page::ALL.iter().map(|page| page.id().to_owned());
    let names =
        settings.chain(scenes).chain(methods).chain(buffers).chain(kinds).chain(classes).chain(pages).chain(assertions);
    for name in names {
        assert!(manual.contains(&format!("`{name}`")), "{name}");
    }
}

#[test]
fn check_succeeds_if_all_assertions_hold_and_names_the_violated_ones() {
    let folder = folder();
    let sound = run(&folder, &["check", "cubes", "--size", "60x40"]);
    assert_success(&sound);
    assert_eq!(stdout(&sound).lines().count(), 1 + Assertion::ALL.len(), "{}", stdout(&sound));
    let broken = ["check", "cubes", "--size", "60x40", "--rasterizer", "scanline-published"];
    let broken = [&broken[..], &["--assert", "owner", "--assert", "finite"]].concat();
    let output = run(&folder, &broken);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stderr(&output).trim(), "error: 1 of 2 assertions are violated");
    let lines: Vec<_> = stdout(&output).lines().collect();
    assert!(lines[1].starts_with("owner") && lines[2].contains("first at "), "{lines:?}");
    assert!(lines[3].starts_with("finite") && lines.len() == 4, "{lines:?}");
    let json = run(&folder, &[&broken[..], &["--json"]].concat());
    let found: serde_json::Value = serde_json::from_str(stdout(&json)).unwrap();
    assert_eq!((json.status.code(), found["findings"][0]["assertion"].as_str()), (Some(1), Some("owner")));
}

#[test]
fn pixel_names_the_triangle_that_is_not_drawn_and_why() {
    let folder = folder();
    let output = run(&folder, &["pixel", "back-facing", "--size", "160x100", "--at", "80,50"]);
    assert_success(&output);
    let text = stdout(&output);
    assert!(text.contains("Background: triangle 2 of “middle panel” covers it, but is back-facing"), "{text}");
    let json = run(&folder, &["pixel", "back-facing", "--size", "160x100", "--at", "80,50", "--json"]);
    let report: serde_json::Value = serde_json::from_str(stdout(&json)).unwrap();
    assert_eq!(report["absent"][0]["cause"], "back-facing");
}

/// Checks that the JSON of a measurement states the number of threads and, on Linux, the load of the machine.
fn assert_machine(machine: &serde_json::Value) {
    assert!(machine["threads"].as_u64().unwrap() >= 1);
    if cfg!(target_os = "linux") {
        assert!(machine["load_at_start"].is_f64() && machine["load_at_end"].is_f64(), "{machine}");
    }
}

#[test]
fn the_report_is_a_page_a_table_and_json_of_every_upscaler() {
    let folder = folder();
    let output =
        run(&folder, &["report", "triangle", "-o", "made/here", "--size", "40x30", "--rounds", "2", "--turn", "1"]);
    assert_success(&output);
    let read = |name: &str| fs::read_to_string(folder.path().join("made/here").join(name)).unwrap();
    let rows = upscale::Upscaling::every().count();
    assert_eq!(stdout(&output), format!("made/here/index.html: {rows} rows, with report.csv and report.json\n"));
    let (page, csv, json) = (read("index.html"), read("report.csv"), read("report.json"));
    assert_eq!(csv.lines().count(), rows + 1);
    let columns = csv.lines().next().unwrap().split(',').count();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let scene = &json["scenes"][0];
    assert_eq!((scene["rows"].as_array().unwrap().len(), columns), (rows, 44));
    assert_eq!(scene["rows"][0]["error"]["mse"].as_f64(), Some(0.0), "native");
    assert_eq!(scene["rows"][0]["motion"]["worst"]["mse"].as_f64(), Some(0.0), "native in motion");
    assert_eq!(scene["noise"]["pairs"], 5, "two rounds are one block of each of five recipes that are drawn twice");
    assert!(scene["noise"]["p90"].as_f64().unwrap() >= 0.0);
    assert_machine(&json["machine"]);
    for row in scene["rows"].as_array().unwrap() {
        let label = row["label"].as_str().unwrap();
        assert!(row["native_within_noise"].is_boolean() && row.get("within_noise_of").is_some(), "{label}");
        assert_eq!(row["motion"]["frames"], 16, "{label}");
    }
    assert!(page.contains("90th percentile of 5 A/A pairs"));
    assert_eq!(scene["shares"].as_array().unwrap().len(), 5);
    for upscaling in upscale::Upscaling::every() {
        assert!(page.contains(&upscaling.label()), "{}", upscaling.label());
    }
    assert!(page.matches("<svg ").count() >= 2 && page.contains("data:image/png;base64,"));
    assert!(!page.contains("://") && !page.contains("<script"), "nothing is loaded from elsewhere");
}

#[test]
fn reports_take_light_settings_and_size_from_their_scene_unless_options_give_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let numbers: [f32; 9] = [0., 0., 0., 1., 0., 0., 0., 1., 0.];
    fs::write(at("t.bin"), numbers.map(f32::to_le_bytes).concat()).unwrap();
    // The light shines along -z of its node, which is not turned: it comes from +z.
    let model = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional"}]}},
        "nodes": [{"mesh": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "t.bin", "byteLength": 36}],
    });
    fs::write(at("lit.gltf"), model.to_string()).unwrap();
    let camera = serde_json::json!({"eye": [0, 0, 3], "target": [0, 0, 0], "fov_y_degrees": 45, "near": 0.1, "far": 9});
    let project = |size: [u32; 2]| {
        let settings = ["light.direction=1,0,0", "shading=normals", "culling=none"];
        serde_json::json!({"rasterscope": 1, "scene": "lit.gltf", "camera": camera, "settings": settings, "size": size})
    };
    fs::write(at("p.rasterscope"), project([30, 20]).to_string()).unwrap();
    fs::write(at("other.rasterscope"), project([31, 20]).to_string()).unwrap();
    let report = |arguments: &[&str]| {
        let fixed = ["report", "-o", "out", "--rounds", "1", "--turn", "0"];
        assert_success(&run(&folder, &[&fixed[..], arguments].concat()));
        serde_json::from_slice::<serde_json::Value>(&fs::read(at("out/report.json")).unwrap()).unwrap()
    };
    let drawn = |report: &serde_json::Value, scene: usize| {
        let recipe = &report["scenes"][scene]["rows"][1]["recipe"];
        let numbers = recipe["light"]["direction"].as_array().unwrap().iter();
        let light: Vec<f64> = numbers.map(|number| number.as_f64().unwrap()).collect();
        (light, recipe["shading"].as_str().unwrap().to_owned())
    };
    let both = report(&["lit.gltf", "p.rasterscope"]);
    assert_eq!(both["size"], serde_json::json!([30, 20]));
    let (light, shading) = drawn(&both, 0);
    assert!(light[2] > 0.0 && light[..2] == [0.0, 0.0], "{light:?}");
    assert_ne!(shading, "normals", "a project does not change other scenes");
    assert_eq!(drawn(&both, 1), (vec![1.0, 0.0, 0.0], "normals".to_owned()));
    let set = report(&["p.rasterscope", "--set", "light.direction=0,1,0", "--size", "16x12"]);
    assert_eq!(
        (drawn(&set, 0), &set["size"]),
        ((vec![0.0, 1.0, 0.0], "normals".to_owned()), &serde_json::json!([16, 12]))
    );
    let differing = run(&folder, &["report", "-o", "out", "p.rasterscope", "other.rasterscope"]);
    assert_failure(&differing, 2, "the projects have different sizes; choose one with --size");
}

#[test]
fn all_built_in_scenes_are_listed_with_their_size() {
    let output = run(&folder(), &["scenes"]);
    assert_success(&output);
    assert_eq!(stdout(&output).lines().count(), builtin::ALL.len());
    for (line, scene) in stdout(&output).lines().zip(builtin::ALL) {
        let words: Vec<_> = line.split_whitespace().collect();
        assert_eq!(words[..2], [scene.id, &scene.build().triangle_count().to_string()]);
        assert!(line.ends_with(scene.summary));
    }
}

#[test]
fn every_built_in_scene_renders_to_a_picture_of_the_size_asked_for() {
    let folder = folder();
    for scene in builtin::ALL {
        let output = run(&folder, &["render", scene.id, "--size", "64x48", "-o", "out.png"]);
        assert_success(&output);
        assert_eq!(stdout(&output).lines().count(), 1);
        assert!(stdout(&output).starts_with("out.png: 64 × 48 px, "), "{}", stdout(&output));
        assert_eq!(stderr(&output), "");
        let image = picture(&folder, "out.png");
        assert_eq!(image.size(), (64, 48));
        assert!(!is_one_color(&image), "{}", scene.id);
    }
}

#[test]
fn every_buffer_is_a_picture_of_its_own() {
    let folder = folder();
    let images = Buffer::ALL.iter().map(|buffer| {
        let args = ["render", "fence", "--time", "0.6", "--size", "96x64", "--buffer", buffer.id(), "-o", "out.png"];
        assert_success(&run(&folder, &args));
        picture(&folder, "out.png")
    });
    let images: Vec<_> = images.collect();
    for (index, image) in images.iter().enumerate() {
        assert!(!is_one_color(image), "{}", Buffer::ALL[index].id());
        assert!(!images[..index].contains(image), "{} looks like another", Buffer::ALL[index].id());
    }
}

#[test]
fn t_junctions_are_counted_checked_and_named_at_the_pixels_that_they_open() {
    let folder = folder();
    // A triangle above an edge, and below it a fan whose rim leaves that edge by less than the tolerance.
    let rim: Vec<f32> = (1..8).map(|i| i as f32 * 0.25 - 1.0).collect();
    let mut model = "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\n".to_owned();
    rim.iter().for_each(|x| model += &format!("v {x} -0.0002 0\n"));
    model += "f 1 2 3\nf 5 1 4\nf 2 11 4\n";
    (5..11).for_each(|i| model += &format!("f {} {i} 4\n", i + 1));
    fs::write(folder.path().join("t.obj"), model).unwrap();
    let camera = r#"{"eye":[0.03,0,4],"target":[0.03,0,0],"up":[0.1,1,0],"height":0.4,"near":0.1,"far":100}"#;
    fs::write(folder.path().join("cam.json"), camera).unwrap();
    let scene = ["t.obj", "--camera", "cam.json", "--size", "200x150"];
    let run = |command: &[&str], rest: &[&str]| run(&folder, &[command, &scene, rest].concat());
    let output = run(&["render"], &["--buffer", "hits", "-o", "out.png"]);
    assert_success(&output);
    let line = |start: &str| stdout(&output).lines().find(|line| line.starts_with(start)).unwrap().to_owned();
    let counts = line("shared edges: ");
    let cracks: usize = counts.split(' ').nth(2).unwrap().parse().unwrap();
    assert!(cracks > 3 && counts.ends_with(&format!(" · {cracks} of them at T-junctions")), "{counts}");
    assert_eq!(line("mesh: "), "mesh: 7 T-junctions · 0 unwelded vertices");
    let crack = [48, 132, 255, 255];
    let image = picture(&folder, "out.png");
    let (x, y) = (0..150).flat_map(|y| (0..200).map(move |x| (x, y))).find(|(x, y)| image.at(*x, *y) == crack).unwrap();
    assert!(line("first at ").starts_with(&format!("first at {x},{y}: T-junction: v")));
    let output = run(&["pixel"], &["--at", &format!("{x},{y}")]);
    assert_success(&output);
    assert!(
        stdout(&output).contains("A crack: no triangle covers the gap between triangles 0 and "),
        "{}",
        stdout(&output)
    );
    assert!(stdout(&output).contains("T-junction: v"));
    let output = run(&["check"], &["--assert", "t-junctions"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).contains(&format!("first at {x},{y}, triangle 0: T-junction: ")), "{}", stdout(&output));
}

#[test]
fn the_hit_count_prints_cracks_and_double_hits_on_a_separate_line() {
    let folder = folder();
    for (rule, reported) in [
        ("top-left", "0 cracks · 0 double hits"),
        ("inclusive", "0 cracks · "),
        ("exclusive", " cracks · 0 double hits"),
    ] {
        let rule = format!("fill_rule={rule}");
        let args = ["render", "shared-edges", "--size", "64x48", "--buffer", "hits", "--set", &rule, "-o", "out.png"];
        let output = run(&folder, &args);
        assert_success(&output);
        let lines: Vec<_> = stdout(&output).lines().collect();
        assert!(lines[0].starts_with("out.png: ") && lines[1].contains(reported), "{lines:?}");
        let is_grey = |pixel: &Rgba8| pixel[0] == pixel[1] && pixel[1] == pixel[2];
        let marked = picture(&folder, "out.png").pixels().iter().filter(|pixel| !is_grey(pixel)).count();
        let numbers = lines[1].split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse::<usize>().ok());
        let faults: usize = numbers.take(2).sum();
        assert_eq!(marked, faults, "{}", lines[1]);
        assert_eq!(faults == 0, rule.ends_with("top-left"), "{}", lines[1]);
    }
}

#[test]
fn every_stage_is_a_picture_and_the_last_one_is_the_frame() {
    let folder = folder();
    let shot = |options: &[&str]| {
        assert_success(&run(&folder, &[&["render", "cubes", "--size", "64x48", "-o", "out.png"], options].concat()));
        picture(&folder, "out.png")
    };
    let stages: Vec<_> = Stage::ALL.iter().map(|stage| shot(&["--stage", stage.id()])).collect();
    for (image, stage) in stages.iter().zip(Stage::ALL) {
        assert_eq!(image.size(), (64, 48));
        assert!(!is_one_color(image), "{}", stage.id());
    }
    assert_eq!(stages.last(), Some(&shot(&[])));
    assert_ne!(stages.first(), stages.last());
    let both = run(&folder, &["render", "--stage", "clip", "--buffer", "depth", "-o", "out.png"]);
    assert_failure(&both, 2, "--buffer");
}

#[test]
fn times_are_one_line_per_stage_after_the_result() {
    let folder = folder();
    let output = run(&folder, &["render", "cubes", "--size", "64x48", "--times", "3", "-o", "out.png"]);
    assert_success(&output);
    let lines: Vec<_> = stdout(&output).lines().collect();
    assert!(lines[0].starts_with("out.png: ") && lines.len() > 3, "{lines:?}");
    let times = lines[1..].iter().map(|line| {
        let words: Vec<_> = line.split_whitespace().collect();
        let [.., time, "ms"] = words[..] else { panic!("{line}") };
        time.parse::<f64>().unwrap_or_else(|_| panic!("{line}"))
    });
    let times: Vec<f64> = times.collect();
    let (frame, stages) = times.split_last().expect("there are stages");
    assert!(lines[lines.len() - 1].starts_with("whole frame ") && times.iter().all(|ms| *ms >= 0.0), "{lines:?}");
    // Each line is rounded to half a microsecond.
    let rounding = 0.0006 * times.len() as f64;
    assert!((stages.iter().sum::<f64>() - frame).abs() < rounding, "{lines:?}");
    for frames in ["0", "1001", "many"] {
        assert_failure(&run(&folder, &["render", "--times", frames, "-o", "out.png"]), 2, frames);
    }
}

/// Checks that a method at a scale draws the same picture in `render`, in a report and in a comparison tile.
#[test]
fn reports_and_tiles_have_the_pictures_that_the_same_settings_draw() {
    // At most as large as the crop of a report, so that the crop is the whole picture.
    let viewport = Viewport { width: 61, height: 47 };
    let scene = SceneSource::named("cubes".into()).load().unwrap().scene;
    let subject =
        NamedView { name: scene.name.clone(), camera: scene.home, recipe: Recipe::default(), scene: Arc::new(scene) };
    let plan = UpscalingPlan {
        subjects: vec![subject.clone()],
        upscalers: upscale::Upscaling::every().collect(),
        viewport,
        rounds: 1,
        reference: Reference::Native,
        metric: rasterscope::measure::metric::Metric::Flip,
        turn: Turn::STILL,
    };
    let report = sweep::run(&plan, &|_| {}, &|| false).unwrap();
    let folder = folder();
    for row in &report.scenes[0].rows {
        let upscaler = row.recipe.upscaler;
        let settings =
            [format!("upscaler.method={}", upscaler.method()), format!("upscaler.scale={}", upscaler.scale())];
        let sets = ["--set", settings[0].as_str(), "--set", settings[1].as_str()];
        let rendered = &[&["render", "cubes", "--size", "61x47", "-o", "out.png"], &sets[..]].concat();
        assert_success(&run(&folder, rendered));
        let rendered = picture(&folder, "out.png");
        assert_eq!(rendered.size(), row.crop.size(), "{}", row.label);
        assert!(rendered == row.crop, "the report of {} has another picture", row.label);
        #[cfg(feature = "ui")]
        {
            let request = CompareRequest {
                scene: Arc::clone(&subject.scene),
                camera: subject.camera,
                sequence: None,
                viewport,
                recipes: vec![row.recipe],
                files: ComparedFiles::default(),
                reference: Reference::Native,
                region: None,
                difference: None,
            };
            let mut comparer = Comparer::default();
            assert!(*comparer.start(request).tiles[0].picture == rendered, "the tile of {} differs", row.label);
        }
    }
}

#[test]
fn settings_are_taken_in_any_order() {
    let folder = folder();
    let shot = |settings: [&str; 2]| {
        let sets = settings.map(|setting| ["--set", setting]).concat();
        assert_success(&run(&folder, &[&["render", "--size", "64x48", "-o", "out.png"], &sets[..]].concat()));
        picture(&folder, "out.png")
    };
    let (method, scale) = ("upscaler.method=bicubic", "upscaler.scale=4");
    assert_eq!(shot([scale, method]), shot([method, scale]));
}

#[test]
fn the_share_of_drawn_pixels_is_printed() {
    let args = ["render", "--size", "64x48", "--set", "upscaler.method=checkerboard", "-o", "out.png"];
    let output = run(&folder(), &args);
    assert!(stdout(&output).trim_end().ends_with("50.0 % of the pixels drawn"), "{}", stdout(&output));
}

/// Settings, besides every upscaling method, under which replayed pixels are compared with the rendered picture.
const MORE_SETTINGS: [&str; 4] = ["wireframe=true", "shading=gouraud", "background=#D04010", "depth-bias.slope=-2"];

#[test]
fn the_colour_of_a_replayed_pixel_is_the_rendered_one() {
    let folder = folder();
    let methods = upscale::BUILT_IN.iter().map(|upscaler| format!("upscaler.method={}", upscaler.id()));
    for setting in methods.chain(MORE_SETTINGS.map(str::to_owned)) {
        let options = ["cubes", "--size", "63x47", "--set", &setting];
        assert_success(&run(&folder, &[&["render", "-o", "out.png"], &options[..]].concat()));
        let image = picture(&folder, "out.png");
        for (x, y) in [(0, 0), (62, 46), (31, 23), (30, 20), (17, 30)] {
            let at = format!("{x},{y}");
            let output = run(&folder, &[&["pixel", "--json", "--at", &at], &options[..]].concat());
            assert_success(&output);
            let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(report["color"], serde_json::json!(image.at(x, y)), "{setting} at {at}");
        }
    }
}

#[test]
fn the_fragments_of_a_pixel_are_explained_as_text() {
    let output = run(&folder(), &["pixel", "interpenetrating", "--at", "32,24", "--size", "64x48"]);
    assert_success(&output);
    let text = stdout(&output);
    assert!(text.starts_with("pixel 32, 24: #"), "{text}");
    for part in ["Won by", "fragment 1 of 2", "fragment 2 of 2", "overwritten", "visible", "λ′", "edges"] {
        assert!(text.contains(part), "no `{part}` in:\n{text}");
    }
}

#[test]
fn the_earlier_frames_of_a_pixel_are_listed_with_their_shares() {
    let folder = folder();
    let frames = ["chess-motion", "--size", "96x54", "--set", "upscaler.method=taa"];
    assert_success(&run(&folder, &[&["render", "-o", "f.png", "--frames", "5..6"], &frames[..]].concat()));
    let [r, g, b, _] = picture(&folder, "f.0005.png").at(48, 27);
    let pixel = [&["pixel", "--at", "48,27", "--frame", "5"], &frames[..]].concat();
    let json = run(&folder, &[&pixel[..], &["--json"]].concat());
    assert_success(&json);
    let report: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let history = &report["temporal"];
    assert_eq!(history["pixel_frames"][5]["result"], serde_json::json!([r, g, b]));
    let past = &history["past_frames"];
    assert_eq!((&past["is_reproduced"], &past["frames"][0]["frame"]), (&true.into(), &5.into()));
    let shares: f64 = past["frames"].as_array().unwrap().iter().map(|frame| frame["share"].as_f64().unwrap()).sum();
    assert!((shares + past["rest"].as_f64().unwrap() - 1.0).abs() < 1e-4, "{past}");
    let text = run(&folder, &pixel);
    let text = stdout(&text);
    for part in ["contribution of every frame", "frame    5", "gives the bits of the pixel", "Rejected history: "] {
        assert!(text.contains(part), "no `{part}` in:\n{text}");
    }
}

#[test]
fn the_trace_of_a_pixel_ends_in_its_colour_in_words_and_as_json() {
    let folder = folder();
    let options = ["interpenetrating", "--size", "64x48"];
    assert_success(&run(&folder, &[&["render", "-o", "out.png"], &options[..]].concat()));
    let [r, g, b, _] = picture(&folder, "out.png").at(32, 24);
    let traced = |more: &[&str]| run(&folder, &[&["pixel", "--at", "32,24", "--trace"], more, &options[..]].concat());
    let output = traced(&[]);
    assert_success(&output);
    let text = stdout(&output);
    assert!(text.starts_with("calculation of pixel 32, 24: fragment "), "{text}");
    for part in
        ["Model: ", "Transform: ", "Coverage: ", "edge 2 · decision = inside", "λ0 on the screen", "depth test = "]
    {
        assert!(text.contains(part), "no `{part}` in:\n{text}");
    }
    let last = text.lines().rev().take(3).map(str::trim).collect::<Vec<_>>();
    for (line, (channel, code)) in last.iter().rev().zip([("red", r), ("green", g), ("blue", b)]) {
        assert!(line.starts_with(&format!("pixel {channel} = {code} [u8 0x{code:02X}]")), "{line}");
    }
    let output = traced(&["--json", "--fragment", "1"]);
    assert_success(&output);
    let trace: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&trace["fragment"], &trace["pixel"]), (&serde_json::json!(0), &serde_json::json!([32, 24])));
    let lines = trace["lines"].as_array().unwrap();
    let weight = lines.iter().find(|line| line["what"] == "weight 1").unwrap();
    assert!(weight["rounding_ulp"].as_f64().is_some_and(|ulps| ulps.abs() <= 0.5), "{weight}");
    assert_eq!((&weight["kind"], &weight["buffer"]), (&serde_json::json!("f32"), &serde_json::json!("weight-1")));
    assert_failure(&traced(&["--fragment", "9"]), 2, "--fragment 9");
}

#[test]
fn the_plan_lists_the_same_skipped_parts_and_reasons_as_text_and_as_json() {
    let folder = folder();
    let camera = r#"{"eye": [0, 0, 40], "target": [0, 0, 0], "fov_y_degrees": 60, "near": 0.1, "far": 100}"#;
    fs::write(folder.path().join("camera.json"), camera).unwrap();
    let args = ["plan", "cubes", "--size", "64x48", "--camera", "camera.json", "--set", "shading=texture"];
    let output = run(&folder, &args);
    assert_success(&output);
    let text = stdout(&output);
    assert!(text.starts_with("128 cubes, 64 × 48 px\n\n128 draws: "), "{text}");
    let reported = |part: &str| text.lines().find_map(|line| line.trim().strip_prefix(part)).map(str::trim);
    assert_eq!(reported("Vertices"), Some("run"));
    assert_eq!(reported("Clipping"), Some("skipped: the whole object is inside the view"));
    assert_eq!(reported("Normals"), Some("skipped: this shading reads no normal"));

    let output = run(&folder, &[&args[..], &["--json"]].concat());
    assert_success(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&json["size"], json["groups"].as_array().unwrap().len()), (&serde_json::json!([64, 48]), 1));
    let group = &json["groups"][0];
    assert_eq!((group["draws"].as_u64(), group["names"].as_array().unwrap().len()), (Some(128), 128));
    assert_eq!(group["transparency"], "opaque");
    let lines: Vec<_> = text.lines().skip(3).take_while(|line| !line.is_empty()).collect();
    let whole = json["frame"]["parts"].as_array().unwrap();
    assert_eq!(text.lines().count(), 3 + lines.len() + 2 + whole.len());
    assert_eq!((&whole[0]["part"], &whole[0]["runs"]), (&"every-pixel".into(), &true.into()));
    let parts = group["parts"].as_array().unwrap();
    assert_eq!(parts.len(), lines.len());
    for (part, line) in parts.iter().zip(lines) {
        assert_eq!(part["runs"].as_bool(), Some(line.ends_with(" run")), "{line}");
        assert!(part["reason"].as_str().is_none_or(|reason| line.ends_with(reason)), "{line}");
        assert_ne!(part["runs"].as_bool(), Some(part["reason"].is_string()), "{line}");
    }
}

#[test]
fn the_plan_table_lists_the_savings_of_every_scene() {
    let args = ["plan", "--table", "--rounds", "1", "--size", "32x24", "--set", "shading=texture"];
    let output = run(&folder(), &args);
    assert_success(&output);
    assert_eq!(stderr(&output), "", "progress is for terminals");
    let text = stdout(&output);
    for builtin in builtin::ALL {
        assert!(text.lines().any(|line| line.starts_with(&format!("{} ", builtin.id))), "{} in {text}", builtin.id);
    }
    assert!(!text.contains("PICTURE"), "{text}");
    assert!(text.lines().any(|line| line.starts_with("sheet in view ") && line.contains("needed")), "{text}");
    let output = run(&folder(), &[&args[..], &["--json"]].concat());
    assert_success(&output);
    let rows: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
    assert_eq!(rows.as_array().unwrap().len(), builtin::ALL.len() + 3);
    let behind = &rows.as_array().unwrap()[builtin::ALL.len() + 2];
    assert_eq!(behind["scene"], "sheet behind");
    assert_eq!(
        (&behind["savings"]["needed"], &behind["savings"]["savings"][0]["part"]),
        (&serde_json::json!([]), &"vertices".into())
    );
    assert_failure(&run(&folder(), &["plan", "chess", "--table"]), 2, "--table");
}

#[test]
fn draws_with_different_plans_are_listed_separately() {
    let output = run(&folder(), &["plan", "stained-glass", "--size", "64x48"]);
    assert_success(&output);
    let text = stdout(&output);
    for part in [
        "22 draws: leaf 0, leaf 1, leaf 2, … leaf 21\n",
        "draws: blue pane, green pane, red pane\n",
        "1 draw: bottle\n",
    ] {
        assert!(text.contains(part), "no `{part}` in:\n{text}");
    }
    assert_failure(&run(&folder(), &["plan", "nowhere.obj"]), 2, "nowhere.obj");
}

/// Arguments of the fastest stability report: one small class, with two rasterizers.
const SMALL_REPORT: [&str; 7] =
    ["stability", "--class", "needles", "--rasterizer", "scanline", "--rasterizer", "scanline-published"];

#[test]
fn a_stability_report_of_one_class_is_printed_as_text() {
    let output = run(&folder(), &[&SMALL_REPORT[..], &["--untimed"]].concat());
    assert_success(&output);
    assert_eq!(stderr(&output), "", "progress is for terminals");
    let lines: Vec<_> = stdout(&output).lines().collect();
    assert!(lines[0].starts_with("Stability report, seed 1, "), "{}", lines[0]);
    assert_eq!(
        lines.iter().filter(|line| line.starts_with("  needles ")).count(),
        5,
        "four kinds of arithmetic, and as published"
    );
    assert_eq!(lines.last(), Some(&"3 PASS, 2 MEASURED, 0 REFUSED"));
}

#[test]
fn a_stability_report_is_the_same_in_all_forms() {
    let folder = folder();
    let write = |options: &[&str], name: &str| {
        assert_success(&run(&folder, &[&SMALL_REPORT[..], options, &["-o", name]].concat()));
        fs::read_to_string(folder.path().join(name)).unwrap()
    };
    let json: serde_json::Value = serde_json::from_str(&write(&["--json"], "report.json")).unwrap();
    let cells = json["classes"][0]["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 5);
    let fixed = &cells[0];
    assert_eq!((fixed["rasterizer"].as_str(), fixed["arithmetic"].as_str()), (Some("scanline"), Some("fixed")));
    assert_eq!((fixed["verdict"].as_str(), fixed["measures"]["wrong"].as_f64()), (Some("PASS"), Some(0.0)));
    assert!(fixed["time"]["ns_per_pixel"]["median"].as_f64() > Some(0.0));
    assert_eq!(cells[4]["verdict"], "MEASURED");
    assert_eq!(cells[4]["worst"]["case"]["kind"], "tri_coverage");
    assert_eq!(write(&["--csv", "--untimed"], "report.csv").lines().count(), 6);
    let page = write(&["--html"], "report.html");
    assert!(page.starts_with("<!doctype html>") && page.contains("Error against time"));
}

#[test]
fn stability_names_unknown_classes_and_unwritable_files() {
    let folder = folder();
    assert_failure(&run(&folder, &["stability", "--class", "nonesuch"]), 2, "nonesuch");
    assert_failure(&run(&folder, &["stability", "--json", "--csv"]), 2, "--json");
    let target = "no/such/folder/report.txt";
    assert_failure(&run(&folder, &[&SMALL_REPORT[..], &["--untimed", "-o", target]].concat()), 2, target);
}

#[test]
fn depths_are_printed_with_their_code_and_their_step_in_world_units() {
    // The pixel shows a panel at distance 1000; the near plane is at 0.1 and the far plane at 100 000.
    let args = ["pixel", "z-fighting", "--at", "240,150", "--size", "1280x720", "--set"];
    let reported = |format: &str, options: &[&str]| {
        let output = run(&folder(), &[&args[..], &[&format!("depth-format={format}")], options].concat());
        assert_success(&output);
        stdout(&output).to_owned()
    };
    for (format, code) in [("f32", false), ("unorm16", true), ("unorm24", true), ("w-buffer", false)] {
        let text = reported(format, &[]);
        assert!(text.contains("One step of the depth buffer is "), "{format}:\n{text}");
        assert_eq!(text.contains("(code "), code, "{format}:\n{text}");
    }
    // One step of 1/65535 at w = 1000 is w²/n/65535, about 150 world units.
    let report: serde_json::Value = serde_json::from_str(&reported("unorm16", &["--json"])).unwrap();
    let depth = &report["final_depth"];
    let code = depth["code"].as_f64().unwrap();
    assert_eq!(depth["value"].as_f64().unwrap() as f32, (code / 65_535.0) as f32);
    assert!((100.0..250.0).contains(&depth["resolution"].as_f64().unwrap()), "{depth}");
}

#[test]
fn a_camera_file_changes_the_view() {
    let folder = folder();
    let camera = r#"{"eye": [3, 4, 9], "target": [0, 0, 0], "fov_y_degrees": 60, "near": 0.1, "far": 100}"#;
    fs::write(folder.path().join("camera.json"), camera).unwrap();
    assert_success(&run(&folder, &["render", "cubes", "--size", "64x48", "-o", "home.png"]));
    let args = ["render", "cubes", "--size", "64x48", "--camera", "camera.json", "-o", "moved.png"];
    assert_success(&run(&folder, &args));
    assert_ne!(picture(&folder, "home.png"), picture(&folder, "moved.png"));
}

#[test]
fn frames_of_a_sequence_depend_only_on_their_numbers() {
    let folder = folder();
    let render = |options: &[&str]| {
        let output = run(&folder, &[&["render", "chess-motion", "--size", "48x32"], options].concat());
        assert_success(&output);
        assert_eq!(stderr(&output), "");
        stdout(&output).to_owned()
    };
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let lines = render(&["--frames", "4", "--fps", "2", "-o", "all.png"]);
    assert!(lines.lines().count() == 4 && lines.starts_with("all.0000.png: 48 × 32 px"), "{lines}");
    render(&["--frames", "2..4", "--fps", "2", "-o", "part.##.png"]);
    assert_eq!(["part.02.png", "part.03.png"].map(bytes), ["all.0002.png", "all.0003.png"].map(bytes));
    render(&["--time", "1.5", "-o", "one.png"]);
    assert_eq!(bytes("one.png"), bytes("all.0003.png"));
    render(&["--time", "-2.5", "-o", "before.png"]);
    assert_eq!(bytes("before.png"), bytes("all.0003.png"));
    assert_ne!(bytes("all.0000.png"), bytes("all.0003.png"));
    render(&["--frames", "3..4", "--fps", "2", "--path", "shake", "-o", "shaken.png"]);
    assert_ne!(bytes("shaken.0003.png"), bytes("all.0003.png"));
}

#[test]
fn a_camera_path_is_followed_and_a_bad_one_is_named_with_its_line() {
    let folder = folder();
    let view = |z: u32| {
        format!(r#"{{"eye": [0, 1, {z}], "target": [0, 0, 0], "fov_y_degrees": 45, "near": 0.1, "far": 100}}"#)
    };
    let key = |time: u32, z: u32| format!(r#"{{"time_s": {time}, "camera": {}}}"#, view(z));
    let write = |second: &str| {
        let text = format!("{{\"version\": 1, \"keys\": [\n{},\n{second}\n]}}", key(0, 9));
        fs::write(folder.path().join("path.json"), text).unwrap();
    };
    let args = ["render", "cubes", "--size", "48x32", "--frames", "1..2", "--fps", "1", "--path", "path.json"];
    let args = [&args[..], &["-o", "out.png"]].concat();
    write(&key(1, 5));
    assert_success(&run(&folder, &args));
    let still = ["render", "cubes", "--size", "48x32", "--camera", &view(5), "-o", "still.png"];
    assert_success(&run(&folder, &still));
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("out.0001.png"), bytes("still.png"));
    write(&key(0, 5));
    assert_failure(&run(&folder, &args), 2, "path.json:3: time_s must be above that of the key view before");
}

#[test]
fn a_time_has_no_effect_on_a_still_scene() {
    let folder = folder();
    let output = run(&folder, &["render", "cubes", "--size", "48x32", "--time", "2", "-o", "out.png"]);
    assert_success(&output);
    assert_eq!(stderr(&output), "note: the scene does not move: --time has no effect\n");
}

#[test]
fn bad_input_is_one_line_that_names_the_culprit() {
    let inputs: [(&[&str], &str); 20] = [
        (&["--time", "soon"], "expected a time in seconds"),
        (&["--frames", "5..5"], "expected a number of frames"),
        (&["--frames", "2", "--fps", "0"], "expected a number of frames per second"),
        (&["--frames", "2", "--path", "dance"], "dance"),
        (&["--frames", "2", "--time", "1"], "--time"),
        (&["--set", "shadign=gouraud"], "error: --set `shadign` is not a setting"),
        (&["--set", "shading=phong"], "error: --set shading: `phong` is not one of texture, "),
        (&["--set", "shading"], "error: --set `shading` is not of the form key=value"),
        (&["--set", "light.direction=0,0,0"], "error: --set light.direction: must not be zero"),
        (&["--size", "0x48"], "0x48"),
        (&["--size", "16385x1"], "16385x1"),
        (&["--size", "16384x16384"], "16384x16384"),
        (&["--size", "big"], "big"),
        (&["--buffer", "stencil"], "stencil"),
        (&["--camera", "nowhere.json"], "nowhere.json"),
        (&["--bogus"], "--bogus"),
        (&["nowhere.obj"], "nowhere.obj"),
        (&["chss"], "chess"),
        (&["."], ".: "),
        (&["two", "scenes"], "scenes"),
    ];
    for (args, culprit) in inputs {
        let folder = folder();
        let output = run(&folder, &[&["render", "-o", "out.png"], args].concat());
        assert_failure(&output, 2, culprit);
        assert!(is_empty(folder.path()), "{args:?} left something behind");
    }
    assert_failure(&run(&folder(), &["render"]), 2, "--output");
}

#[test]
fn the_plain_start_and_the_window_refuse_bad_input_too() {
    for command in [&[][..], &["window"]] {
        for (args, culprit) in [(["nowhere.obj"].as_slice(), "nowhere.obj"), (&["--set", "shading=phong"], "phong")] {
            let folder = folder();
            assert_failure(&run(&folder, &[command, args].concat()), 2, culprit);
            assert!(is_empty(folder.path()));
        }
    }
}

#[test]
fn pixels_outside_of_the_picture_are_refused() {
    for at in ["64,0", "0,48", "-1,0", "0", "1,2,3", "1.5,2"] {
        let output = run(&folder(), &["pixel", "--size", "64x48", "--at", at]);
        assert_failure(&output, 2, at);
    }
}

#[test]
fn bad_camera_files_are_named_with_their_line() {
    for (text, place) in [
        ("{\n  \"eye\": [1, 2],\n  \"target\": [0, 0, 0]\n}", "camera.json:2:"),
        ("", "camera.json:1:"),
        ("{\n\"lens\": 3}", "lens"),
        (r#"{"eye": [0,0,0], "target": [0,0,0], "fov_y_degrees": 45, "near": 1, "far": 2}"#, "camera.json: "),
    ] {
        let folder = folder();
        fs::write(folder.path().join("camera.json"), text).unwrap();
        let args = ["render", "--size", "8x8", "--camera", "camera.json", "-o", "out.png"];
        assert_failure(&run(&folder, &args), 2, place);
    }
}

#[cfg(unix)]
#[test]
fn a_view_that_may_never_end_is_not_opened() {
    let output = run(&folder(), &["render", "--camera", "/dev/zero", "-o", "out.png"]);
    assert_failure(&output, 2, "/dev/zero: cannot read it: it is not a regular file");
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    for path in ["missing/out.png", "."] {
        assert_failure(&run(&folder(), &["render", "--size", "8x8", "-o", path]), 2, &format!("error: {path}: "));
    }
}

#[test]
fn warnings_of_the_loader_go_to_standard_error() {
    let folder = folder();
    let model = "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::write(folder.path().join("model.obj"), model).unwrap();
    let output = run(&folder, &["render", "model.obj", "--size", "16x16", "-o", "out.png"]);
    assert_success(&output);
    assert_eq!(stdout(&output).lines().count(), 1);
    assert!(stderr(&output).contains("missing.mtl"), "{}", stderr(&output));
    assert!(stderr(&output).lines().all(|line| line.starts_with("warning: ")), "{}", stderr(&output));
}

#[test]
fn a_broken_model_is_named_with_its_line() {
    let folder = folder();
    fs::write(folder.path().join("model.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").unwrap();
    assert_failure(&run(&folder, &["render", "model.obj", "-o", "out.png"]), 2, "model.obj:4: ");
}

#[test]
fn a_closed_standard_output_is_no_failure() {
    for args in [&["scenes"][..], &["--help"], &["pixel", "--size", "64x48", "--at", "3,3"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = program(&folder(), args).stdout(writer).output().unwrap();
        assert_success(&output);
        assert_eq!(stderr(&output), "");
    }
}

const LINE: &str = r#"{"id": "a line", "kind": "line", "p0": [1, 1], "p1": [4, 2], "last_pixel": true}"#;

const LINE_RESULT: &str = "{\"id\":\"a line\",\"pixels\":[[1,1],[2,1],[3,2],[4,2]]}\n";

const REFUSED: &str =
    r#"{"id": "refused", "kind": "upscale", "image": [[1, 2]], "scale": 4, "kernel": "gauss", "phase": "corner"}"#;

#[test]
fn a_case_is_answered_on_standard_output_or_into_a_file() {
    let folder = folder();
    fs::write(folder.path().join("case.json"), LINE).unwrap();
    let output = run(&folder, &["case", "case.json"]);
    assert_success(&output);
    assert_eq!(stdout(&output), LINE_RESULT);
    let output = run(&folder, &["case", "case.json", "-o", "result.json"]);
    assert_success(&output);
    assert_eq!(stdout(&output), "result.json: answered\n");
    assert_eq!(fs::read_to_string(folder.path().join("result.json")).unwrap(), LINE_RESULT);
}

#[test]
fn a_case_beyond_the_program_is_refused_in_words() {
    let folder = folder();
    fs::write(folder.path().join("case.json"), REFUSED).unwrap();
    let output = run(&folder, &["case", "case.json"]);
    assert_success(&output);
    assert_eq!(stdout(&output), "{\"id\":\"refused\",\"error\":\"no upscaler has the kernel `gauss`\"}\n");
    let output = run(&folder, &["case", "case.json", "-o", "result.json"]);
    assert_eq!(stdout(&output), "result.json: refused: no upscaler has the kernel `gauss`\n");
}

#[test]
fn corners_of_polygons_are_snapped_except_in_exact_arithmetic() {
    let folder = folder();
    // The left edge is slightly right of the first column's centres, but not on the 1/256 px grid.
    let polygon = r#"{"id": "p", "kind": "poly_fill", "width": 3, "height": 1, "rule": "nonzero",
        "contours": [[[0.5001, 0], [2, 0], [2, 1], [0.5001, 1]]]}"#;
    fs::write(folder.path().join("case.json"), polygon).unwrap();
    let result = |options: &[&str]| {
        let output = run(&folder, &[&["case", "case.json"], options].concat());
        assert_success(&output);
        stdout(&output).to_owned()
    };
    assert_eq!(result(&[]), "{\"id\":\"p\",\"snap_bits\":8,\"spans\":[[0,0,2]]}\n");
    assert_eq!(result(&["--arithmetic", "exact"]), "{\"id\":\"p\",\"snap_bits\":null,\"spans\":[[0,1,2]]}\n");
}

#[test]
fn broken_cases_are_reported_and_the_others_are_answered() {
    let folder = folder();
    for (name, text) in [("1", LINE), ("2", "{"), ("3", REFUSED), ("4", LINE), ("5", r#"{"id": "x", "kind": "cube"}"#)]
    {
        fs::write(folder.path().join(format!("{name}.json")), text).unwrap();
    }
    let cases = ["1.json", "2.json", "3.json", "4.json", "5.json", "6.json"];
    let output = run(&folder, &[&["case", "--out-dir", "results/new"], &cases[..]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stdout(&output), "results/new: 1 cases answered, 1 refused\n");
    let complaints: Vec<_> = stderr(&output).lines().collect();
    let starts = [
        "error: 2.json:1:1: EOF while parsing an object",
        "error: 4.json: an earlier case has the same id, `a line`",
        "error: 5.json: unknown kind `cube`, expected one of `tri_coverage`, ",
        "error: 6.json: cannot read it: ",
    ];
    assert_eq!(complaints.len(), starts.len(), "{complaints:?}");
    assert!(complaints.iter().zip(starts).all(|(line, start)| line.starts_with(start)), "{complaints:?}");
    let results = folder.path().join("results/new");
    assert_eq!(fs::read_to_string(results.join("a line.json")).unwrap(), LINE_RESULT);
    assert_eq!(fs::read_dir(results).unwrap().count(), 2);
}

#[test]
fn cases_that_cannot_be_used_are_one_line_each() {
    let folder = folder();
    fs::write(folder.path().join("case.json"), LINE).unwrap();
    fs::write(
        folder.path().join("wide.json"),
        r#"{"id": "w", "kind": "tri_area", "width": 1000000000, "height": 1,
        "triangle": [[0, 0], [1, 0], [0, 1]]}"#,
    )
    .unwrap();
    let inputs: [(&[&str], &str); 7] = [
        (&[], "CASE.json"),
        (&["nowhere.json"], "nowhere.json: cannot read it"),
        (&["."], ".: cannot read it: it is a folder"),
        (&["wide.json"], "wide.json: a picture of 1000000000 × 1 px: each side must be 1 to 16384"),
        (&["case.json", "case.json"], "2 cases need --out-dir"),
        (&["case.json", "-o", "missing/result.json"], "missing/result.json: cannot write it: "),
        (&["case.json", "--out-dir", "case.json"], "case.json: cannot write it: "),
    ];
    for (args, culprit) in inputs {
        assert_failure(&run(&folder, &[&["case"], args].concat()), 2, culprit);
    }
}

#[test]
fn a_window_that_cannot_open_is_an_error_of_its_own() {
    let folder = folder();
    let output = run(&folder, &["window"]);
    assert_failure(&output, 3, "window");
    assert!(is_empty(folder.path()));
}

#[cfg(not(feature = "ui"))]
#[test]
fn builds_without_the_workbench_say_so() {
    for args in [&[][..], &["screenshot", "-o", "out.png"]] {
        let folder = folder();
        assert_failure(&run(&folder, args), 3, "feature `ui`");
        assert!(is_empty(folder.path()));
    }
}

#[cfg(feature = "ui")]
mod workbench {
    use super::*;

    #[test]
    fn a_plain_start_without_a_display_leaves_a_picture() {
        let folder = folder();
        let output = run(&folder, &[]);
        assert_success(&output);
        assert_eq!(stdout(&output), "rasterscope.png: the workbench, 1280 × 800 px\n");
        assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
        assert!(stderr(&output).contains("no display"), "{}", stderr(&output));
        let image = picture(&folder, "rasterscope.png");
        assert_eq!(image.size(), (1280, 800));
        assert!(!is_one_color(&image));
    }

    #[test]
    fn if_neither_window_nor_picture_is_possible_both_reasons_are_printed() {
        let folder = folder();
        fs::create_dir(folder.path().join("rasterscope.png")).unwrap();
        let output = run(&folder, &[]);
        assert_eq!(output.status.code(), Some(2));
        let lines: Vec<_> = stderr(&output).lines().collect();
        assert!(lines[0].contains("no display") && lines[1].starts_with("error: rasterscope.png: "), "{lines:?}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_plain_start_with_a_dead_display_leaves_a_picture_too() {
        for (variable, value) in [("DISPLAY", ":4711"), ("WAYLAND_DISPLAY", "wayland-4711")] {
            let folder = folder();
            let output = program(&folder, &[]).env(variable, value).output().unwrap();
            assert_success(&output);
            assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
            assert!(!is_one_color(&picture(&folder, "rasterscope.png")));
            let output = program(&folder, &["window"]).env(variable, value).output().unwrap();
            assert_failure(&output, 3, "no window");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn warnings_are_printed_once_although_the_program_starts_over_on_x11() {
        let folder = folder();
        let model = "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        fs::write(folder.path().join("model.obj"), model).unwrap();
        let mut command = program(&folder, &["window", "model.obj"]);
        let output = command.env("WAYLAND_DISPLAY", "wayland-4711").env("DISPLAY", ":4711").output().unwrap();
        assert_eq!(output.status.code(), Some(3));
        let lines: Vec<_> = stderr(&output).lines().collect();
        let [warning, error] = lines[..] else { panic!("{lines:?}") };
        assert!(warning.contains("missing.mtl") && error.starts_with("error: no window"), "{lines:?}");
    }

    #[test]
    fn screenshots_have_the_size_asked_for_and_follow_the_options() {
        let folder = folder();
        let shot = |name: &str, options: &[&str]| {
            assert_success(&run(&folder, &[&["screenshot", "--size", "1000x640", "-o", name], options].concat()));
            picture(&folder, name)
        };
        let dark = shot("dark.png", &[]);
        assert_eq!(dark.size(), (1000, 640));
        for options in [&["--theme", "light"][..], &["--scale", "1.5"], &["slivers"], &["--set", "shading=normals"]] {
            let other = shot("other.png", options);
            assert_eq!(other.size(), (1000, 640), "{options:?}");
            assert_ne!(other, dark, "{options:?}");
        }
    }

    #[test]
    fn a_screenshot_may_show_a_page_of_the_lab() {
        let folder = folder();
        let shot = |options: &[&str]| {
            let args = [&["screenshot", "triangle", "--size", "1000x640", "-o", "lab.png"], options].concat();
            assert_success(&run(&folder, &args));
            picture(&folder, "lab.png")
        };
        let (pipeline, lines) = (shot(&[]), shot(&["--lab", "lines"]));
        assert!(lines != pipeline && lines != shot(&["--lab", "lines", "--lab-step", "3"]));
        assert_ne!(lines, shot(&["--lab", "seed-fill"]));
        let args = ["screenshot", "-o", "out.png"];
        assert_failure(&run(&folder, &[&args[..], &["--lab", "cooking"]].concat()), 2, "cooking");
        assert_failure(&run(&folder, &[&args[..], &["--lab-step", "3"]].concat()), 2, "--lab");
    }

    #[test]
    fn a_screenshot_may_be_as_wide_as_any_picture() {
        let folder = folder();
        assert_success(&run(&folder, &["screenshot", "triangle", "--size", "16384x640", "-o", "out.png"]));
        assert_eq!(picture(&folder, "out.png").size(), (16_384, 640));
    }

    #[test]
    fn a_pixel_outside_of_the_scenes_picture_is_refused_with_its_size() {
        let folder = folder();
        let args = ["screenshot", "triangle", "--size", "1000x640", "-o", "out.png", "--at"];
        assert_failure(&run(&folder, &[&args[..], &["1280,5"]].concat()), 2, "--at 1280,5: the scene's picture is ");
        assert!(is_empty(folder.path()));
        assert_success(&run(&folder, &[&args[..], &["5,5"]].concat()));
    }

    #[test]
    fn bad_options_of_a_screenshot_are_named() {
        for (option, value) in [("--scale", "9"), ("--scale", "nan"), ("--theme", "pink"), ("--size", "0x0")] {
            assert_failure(&run(&folder(), &["screenshot", "-o", "out.png", option, value]), 2, value);
        }
    }
}

#[test]
fn every_page_of_the_lab_is_printed_and_written() {
    let folder = folder();
    for page in Page::ALL {
        let reported = run(&folder, &["lab", page.id(), "--step", "3"]);
        assert_success(&reported);
        assert!(
            stdout(&reported).contains("    3  ") && !stdout(&reported).contains("    4  "),
            "{}",
            stdout(&reported)
        );
        let written = run(&folder, &["lab", page.id(), "--step", "3", "-o", "page.svg"]);
        assert_success(&written);
        assert!(stdout(&written).starts_with("page.svg: 3 of "), "{}", stdout(&written));
        assert!(fs::read_to_string(folder.path().join("page.svg")).unwrap().starts_with("<svg"));
    }
    let compared = run(&folder, &["lab", "lines", "--step", "0", "--compare"]);
    assert!(stdout(&compared).contains("greatest distance") && stdout(&compared).contains("µs"));
}

#[test]
fn the_lab_takes_pictures_of_every_format_it_writes() {
    let folder = folder();
    for end in ["png", "bmp", "jpg", "gif", "tiff"] {
        let name = format!("wall.{end}");
        assert_success(&run(&folder, &["lab", "seed-fill", "--step", "0", "-o", &name]));
        let filled = run(&folder, &["lab", "seed-fill", "--picture", &name]);
        assert_success(&filled);
        let default = run(&folder, &["lab", "seed-fill"]);
        assert_ne!(stdout(&filled), stdout(&default), "{end}");
    }
    assert_failure(&run(&folder, &["lab", "lines", "--picture", "wall.png"]), 2, "takes no picture");
    assert_failure(&run(&folder, &["lab", "sampling", "--picture", "none.png"]), 2, "none.png");
}

#[test]
fn a_scene_is_written_in_every_format_of_drawings() {
    let folder = folder();
    for (kind, (end, _)) in OutlineKind::ALL.iter().cycle().zip(EXTENSIONS) {
        let name = format!("cubes.{end}");
        let args = ["vector", "cubes", "--size", "80x60", "--kind", kind.id(), "-o", &name];
        let output = run(&folder, &args);
        assert_success(&output);
        assert!(stdout(&output).ends_with(" shapes on 80 × 60 px\n"), "{}", stdout(&output));
        assert!(fs::metadata(folder.path().join(&name)).unwrap().len() > 500, "{name}");
    }
    assert_failure(&run(&folder, &["vector", "cubes", "-o", "cubes.webp"]), 2, "cubes.webp");
    assert_failure(&run(&folder, &["lab", "lines", "-o", "nowhere/lines.svg"]), 2, "nowhere/lines.svg");
}

#[test]
fn bench_prints_the_cost_of_frames_as_text_and_as_json() {
    let size = ["bench", "cubes", "--size", "64x48", "--frames", "3"];
    let table = run(&folder(), &size);
    assert_success(&table);
    for word in
        ["whole frame", "cull and bin", "triangles kept", "ns per pixel", "the time of a memset of the frame size"]
    {
        assert!(stdout(&table).contains(word), "{word} in {}", stdout(&table));
    }
    for (execution, stage) in [("tiled", "shade"), ("classic", "pixels")] {
        let set = format!("execution={execution}");
        let options = ["--threads", "1", "--lanes", "baseline", "--json", "--set", set.as_str()];
        let output = run(&folder(), &[&size[..], &options[..]].concat());
        assert_success(&output);
        let report: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
        assert_eq!((report["execution"].as_str(), report["threads"].as_u64()), (Some(execution), Some(1)));
        assert!(report["frame_ms"]["median"].as_f64().unwrap() > 0.0);
        assert_eq!(report["noise"]["pairs"], 1, "three frames are one block");
        assert_machine(&report["machine"]);
        let stages = report["stages"].as_array().unwrap();
        assert!(stages.iter().any(|s| s["stage"] == stage), "{stages:?}");
        let sum: f64 = stages.iter().filter_map(|s| s["ms"]["median"].as_f64()).sum();
        let share = sum / report["frame_ms"]["median"].as_f64().unwrap();
        assert!((share - 1.0).abs() < 1e-6, "the stages add up to the median frame: {share}");
    }
    let turning = run(&folder(), &[&size[..], &["--turn", "-0.5"]].concat());
    assert_success(&turning);
    assert!(stdout(&turning).contains("3 frames, camera orbits by -0.5° per frame"), "{}", stdout(&turning));
    assert!(stdout(&turning).contains("90th percentile of 1 A/A pair"), "{}", stdout(&turning));
    let upscaled = run(&folder(), &[&size[..], &["--set", "upscaler.method=nearest", "--json"]].concat());
    let report: serde_json::Value = serde_json::from_str(stdout(&upscaled)).unwrap();
    assert_eq!((&report["turn"]["frames"], &report["error"]["motion"]["frames"]), (&16.into(), &16.into()));
    assert_failure(&run(&folder(), &["bench", "--threads", "0"]), 2, "--threads");
    assert_failure(&run(&folder(), &["bench", "--turn", "nan"]), 2, "--turn");
}

#[test]
fn a_bench_verifies_that_every_way_to_draw_gives_the_same_bits() {
    let args = ["bench", "chess", "--verify", "--size", "101x67", "--threads", "3"];
    let output = run(&folder(), &args);
    assert_success(&output);
    let lines: Vec<_> = stdout(&output).lines().skip(1).collect();
    assert!(lines.iter().any(|line| line.starts_with("baseline")), "{lines:?}");
    assert!(lines.iter().all(|line| line.ends_with("3 threads  equal")), "{lines:?}");
    let output = run(&folder(), &[&args[..], &["--json", "--set", "arithmetic=f32"]].concat());
    assert_success(&output);
    let report: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
    assert!(report["obstacle"].is_string() && report["ways"].as_array().unwrap().is_empty(), "{report}");
}

#[test]
fn diff_counts_the_pixels_that_two_pictures_differ_in() {
    let folder = folder();
    let draw = |rule: &str| {
        let set = format!("fill_rule={rule}");
        let name = format!("{rule}.png");
        assert_success(&run(&folder, &["render", "shared-edges", "--size", "96x64", "--set", &set, "-o", &name]));
        picture(&folder, &name)
    };
    let (before, after) = (draw("top-left"), draw("inclusive"));
    let changed: Vec<_> = before.pixels().iter().zip(after.pixels()).map(|(a, b)| a != b).collect();
    let count = changed.iter().filter(|changed| **changed).count();
    let common = ["diff", "shared-edges", "--size", "96x64", "--set", "fill_rule=inclusive", "--rounds", "1"];
    let reported =
        run(&folder, &[&common[..], &["--against", "fill_rule=top-left", "--json", "-o", "marked.png"]].concat());
    assert_success(&reported);
    let json: serde_json::Value = serde_json::from_str(stdout(&reported)).unwrap();
    assert!(count > 0);
    assert_eq!(json["changed_pixels"], count);
    assert_eq!(json["times"]["noise"]["pairs"], 2, "one round of both recipes twice");
    assert!(json["times"]["within_noise"].is_boolean() && json["partial"] == false);
    assert_machine(&json["machine"]);
    assert_eq!(json["fields"], serde_json::json!([["fill_rule", "top-left", "inclusive"]]));
    let marked = picture(&folder, "marked.png");
    for ((pixel, changed), of_b) in marked.pixels().iter().zip(&changed).zip(after.pixels()) {
        assert!(if *changed { pixel == of_b } else { pixel[0] == pixel[1] && pixel[1] == pixel[2] });
    }
    let none = run(&folder, &[&common[..], &["--against", "execution=classic"]].concat());
    assert!(stdout(&none).contains("color: 0 of 6144 pixels changed (0.0000 %)"), "{}", stdout(&none));
    let verdict = ["within noise", "larger than the noise"].iter().filter(|words| stdout(&none).contains(**words));
    assert_eq!(verdict.count(), 1, "{}", stdout(&none));
    assert!(stdout(&none).contains("90th percentile of 2 A/A pairs"), "{}", stdout(&none));
}

#[test]
fn an_invalid_setting_to_compare_with_is_named() {
    for args in [&["diff"][..], &["screenshot", "-o", "out.png"]] {
        let args = [args, &["--against", "fill_rule=x"]].concat();
        assert_failure(&run(&folder(), &args), 2, "--against fill_rule: ");
    }
}

#[test]
fn every_triangle_and_fragment_is_counted_in_one_bin_and_the_sums_match() {
    let size = ["--size", "64x48"];
    let reported = run(&folder(), &[&["fates", "near-plane"], &size[..]].concat());
    assert_success(&reported);
    for words in ["triangles", "fragments", "outside the view", "corridor", "All sums match"] {
        assert!(stdout(&reported).contains(words), "{words}: {}", stdout(&reported));
    }
    let json = run(&folder(), &[&["fates", "near-plane", "--json"], &size[..]].concat());
    let json: serde_json::Value = serde_json::from_str(stdout(&json)).unwrap();
    let sum = |of: &serde_json::Value| of.as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum::<u64>();
    let scene = builtin::by_id("near-plane").unwrap().build();
    assert_eq!(sum(&json["triangles"]), scene.triangle_count() as u64);
    assert_eq!(sum(&json["fragments"]), json["account"]["fragments_in"].as_u64().unwrap());
    assert_eq!(json["balanced"].as_bool(), Some(true));
    let objects = json["objects"].as_array().unwrap();
    assert_eq!(objects.len(), scene.instances.len());
    assert_eq!(objects.iter().map(|object| sum(&object["fragments"])).sum::<u64>(), sum(&json["fragments"]));
}

#[cfg(feature = "ui")]
#[test]
fn bench_times_the_picture_and_the_explanation_of_a_pixel_while_the_camera_orbits() {
    let args = ["bench", "cubes", "--answers", "--size", "64x48", "--frames", "3", "--threads", "1"];
    let reported = run(&folder(), &args);
    assert_success(&reported);
    assert!(stdout(&reported).contains("explanation of pixel 32, 24"), "{}", stdout(&reported));
    let json = run(&folder(), &[&args[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(stdout(&json)).unwrap();
    assert_eq!((json["answer_ms"]["n"].as_u64(), json["explained"].as_u64()), (Some(3), Some(3)));
}

#[test]
fn bench_measures_stepping_to_triangles_and_fragments() {
    let args = ["bench", "cubes", "--scrub", "--size", "64x48", "--frames", "2"];
    let reported = run(&folder(), &args);
    assert_success(&reported);
    for words in ["first pass", "copies", "one triangle forward", "one triangle back", "one fragment forward", "jump"] {
        assert!(stdout(&reported).contains(words), "{words}: {}", stdout(&reported));
    }
    let json = run(&folder(), &[&args[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(stdout(&json)).unwrap();
    assert_eq!(json["steps"].as_array().unwrap().len(), 4);
}
