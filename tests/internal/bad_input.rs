//! Loading of broken, hostile and unusual files. Each one fails, loads with warnings or loads silently, as its row in
//! `INDEX.md` allows, and none causes a panic, a hang, excessive memory or silently wrong geometry.

#![expect(clippy::print_stderr, reason = "the tables print their counts")]

use crate::internal::samples;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, mpsc};
use std::time::Duration;

use crate::internal::sound::sound;
use glam::{Vec2, Vec3};
use rasterscope::chain::{Recipe, run};
use rasterscope::image::{Image, file};
use rasterscope::inspect::inspect;
use rasterscope::pipeline::settings::{Culling, Settings};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::obj::{self, TrMeaning};
use rasterscope::scene::{LoadControl, Loaded, MemoryLimit, Mesh, SceneError};

const LONGEST: Duration = Duration::from_secs(10);

/// Row of `INDEX.md`: a file and the allowed results of loading it.
struct Row {
    file: String,
    /// Allowed results: `ERR`, `WARN` or `LOAD`.
    allowed: Vec<String>,
    why: String,
}

/// OBJ text of a square with texture coordinates.
const TEXTURED_SQUARE: &str = "mtllib square.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                               vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

fn rows(index: &str) -> Vec<Row> {
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    index
        .lines()
        .filter(|line| line.starts_with("| obj/") || line.starts_with("| images"))
        .map(cells)
        .map(|cells| Row {
            file: cells[1].clone(),
            allowed: cells[3]
                .split('/')
                // The table says: "showing a partial picture is also fine".
                .chain(cells[4].contains("partial picture is also fine").then_some("LOAD"))
                .map(str::to_owned)
                .collect(),
            why: cells[4].clone(),
        })
        .collect()
}

impl Row {
    fn is_picture(&self) -> bool {
        self.file.starts_with("images")
    }

    fn name(&self) -> &str {
        self.file.rsplit('/').next().unwrap()
    }

    /// Returns the path of the model to load: the file itself, or a model that uses the picture as a texture. If the
    /// folder `wrap` has no such model, writes one to `scratch`, with a copy of the picture.
    fn model(&self, bad: &Path, scratch: &Path) -> PathBuf {
        let file = bad.join(&self.file);
        if !self.is_picture() {
            return file;
        }
        let beside = file.with_file_name(format!("wrap/{}.obj", self.name()));
        if beside.is_file() {
            return beside;
        }
        std::fs::copy(&file, scratch.join(self.name())).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let library = format!("newmtl m\nKd 1 1 1\nmap_Kd {}\n", self.name());
        std::fs::write(scratch.join("square.mtl"), library).unwrap();
        std::fs::write(scratch.join("square.obj"), TEXTURED_SQUARE).unwrap();
        scratch.join("square.obj")
    }

    /// Returns the line of the file at which the table expects the fault.
    fn line(&self) -> Option<usize> {
        let (_, rest) = self.why.split_once("line ")?;
        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    }
}

/// Loads a model on a separate thread, and returns an error if the loader panics or hangs.
fn load(model: &Path) -> Result<Result<Loaded, SceneError>, String> {
    let (sender, receiver) = mpsc::channel();
    let path = model.to_owned();
    std::thread::spawn(move || {
        let _ = sender.send(obj::load(&path));
    });
    receiver.recv_timeout(LONGEST).map_err(|e| match e {
        mpsc::RecvTimeoutError::Timeout => format!("longer than {LONGEST:?}"),
        mpsc::RecvTimeoutError::Disconnected => "panicked".to_owned(),
    })
}

fn check(row: &Row, bad: &Path) -> Result<&'static str, String> {
    let scratch = tempfile::tempdir().unwrap();
    let outcome = load(&row.model(bad, scratch.path()))?;
    let (code, messages) = match &outcome {
        Err(error) => ("ERR", vec![error.to_string()]),
        Ok(loaded) if loaded.warnings.is_empty() => ("LOAD", vec![]),
        Ok(loaded) => ("WARN", loaded.warnings.iter().map(ToString::to_string).collect()),
    };
    if !row.allowed.iter().any(|allowed| allowed == code) {
        return Err(format!("{code} instead of {:?}: {messages:?}", row.allowed));
    }
    if code != "LOAD" {
        let wanted = match row.line() {
            Some(line) if !row.is_picture() => format!("{}:{line}:", row.name()),
            _ if row.is_picture() || code == "ERR" => row.name().to_owned(),
            _ => ": ".to_owned(),
        };
        if !messages.iter().any(|m| m.contains(&wanted)) {
            return Err(format!("no message names {wanted}: {messages:?}"));
        }
    }
    if messages.iter().any(|m| m.contains('\n') || m.len() > 600) {
        return Err(format!("a message is not one clear line: {messages:?}"));
    }
    outcome.map_or(Ok(()), |loaded| sound(&loaded)).map(|()| code)
}

fn areas(mesh: &Mesh) -> f32 {
    let corner = |i: u32| mesh.positions[i as usize];
    let area = |[a, b, c]: &[u32; 3]| (corner(*b) - corner(*a)).cross(corner(*c) - corner(*a)).length() * 0.5;
    mesh.triangles.iter().map(area).sum()
}

fn area(loaded: &Loaded) -> f32 {
    loaded.scene.library.meshes().iter().map(|mesh| areas(mesh)).sum()
}

/// Returns the peak resident memory of this process so far, in bytes; `None` if the system does not report it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

/// Checks all files listed in `INDEX.md` of a folder, and that the list has `count` rows.
fn check_table(bad: &Path, count: usize) {
    let index = bad.join("INDEX.md");
    let rows = rows(&std::fs::read_to_string(&index).unwrap_or_else(|e| panic!("{}: {e}", index.display())));
    assert_eq!(rows.len(), count, "rows of the table");
    let results: Vec<_> = rows.iter().map(|row| (row, check(row, bad))).collect();
    let count = |code: &str| results.iter().filter(|(_, r)| r.as_ref().is_ok_and(|c| *c == code)).count();
    let failures: Vec<_> =
        results.iter().filter_map(|(row, r)| r.as_ref().err().map(|e| format!("{}: {e}", row.file))).collect();
    eprintln!(
        "{} of {} as allowed: {} failed, {} loaded with warnings, {} loaded silently",
        rows.len() - failures.len(),
        rows.len(),
        count("ERR"),
        count("WARN"),
        count("LOAD"),
    );
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_listed_file_loads_or_fails_as_its_row_allows() {
    check_table(&samples::own().join("bad"), 127);
    if let Some(folder) = samples::external() {
        check_table(&folder.join("bad"), 106);
    }
    if let Some(peak) = peak_memory() {
        eprintln!("peak memory {} MiB", peak >> 20);
        assert!(peak < 1_000_000_000, "{peak} bytes at the peak");
    }
}

/// Names of files in one folder whose loaded geometry is known.
struct Known<'a> {
    folder: PathBuf,
    /// File of a concave polygon, and the area of the polygon.
    concave: (&'a str, f32),
    /// File of a triangle of area ½ and a polyline.
    lines: &'a str,
    /// File whose line 4 has an index above 2³² that would be valid modulo 2³².
    index_over_u32: &'a str,
    /// File of a polygon of many corners on the unit circle.
    round: &'a str,
    /// File that names `/etc/os-release` as its material library.
    library_outside: &'a str,
}

fn check_known(known: &Known<'_>) {
    let sample = |name: &str| obj::load(&known.folder.join(name));
    let (concave, expected) = known.concave;
    assert!((area(&sample(concave).unwrap()) - expected).abs() < 1e-4);

    let lines = sample(known.lines).unwrap();
    assert_eq!((lines.scene.triangle_count(), area(&lines)), (1, 0.5));

    assert!(matches!(sample(known.index_over_u32), Err(SceneError::Line { line: 4, .. })));

    let polygon = sample(known.round).unwrap();
    assert!((area(&polygon) - std::f32::consts::PI).abs() < 1e-4);

    let outside = sample(known.library_outside).unwrap();
    let reported = outside.warnings.iter().map(ToString::to_string).collect::<String>();
    let secret = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    assert!(secret.lines().filter(|line| !line.is_empty()).all(|line| !reported.contains(line)), "{reported}");
}

#[test]
fn files_with_known_geometry_load_with_it() {
    check_known(&Known {
        folder: samples::own().join("bad/obj"),
        concave: ("concave.obj", 12.0),
        lines: "lines-are-no-faces.obj",
        index_over_u32: "index-over-u32.obj",
        round: "large-polygon.obj",
        library_outside: "library-outside.obj",
    });
    if let Some(folder) = samples::external() {
        check_known(&Known {
            folder: folder.join("bad/obj"),
            concave: ("s49_concave_polygon.obj", 10.0),
            lines: "s60_lines_are_not_faces.obj",
            index_over_u32: "s04_index_over_u32.obj",
            round: "s29_polygon_20k.obj",
            library_outside: "s25_mtllib_traversal.obj",
        });
    }
}

/// Checks that each texture coordinate of a model is (x, 1 − y) of its position, and the number of textured triangles.
fn check_texture_coordinates(model: &Path, triangles_with_uv: usize) {
    let loaded = obj::load(model).unwrap();
    let with_uv: Vec<_> = loaded.scene.library.meshes().iter().filter(|m| !m.uvs.is_empty()).collect();
    let triangles = with_uv.iter().map(|m| m.triangles.len()).sum::<usize>();
    assert_eq!(triangles, triangles_with_uv, "{}", model.display());
    for mesh in with_uv {
        for (position, uv) in mesh.positions.iter().zip(&mesh.uvs) {
            assert_eq!(*uv, Vec2::new(position.x, 1.0 - position.y), "{}", model.display());
        }
    }
}

#[test]
fn texture_coordinates_stay_at_their_corners() {
    let own = samples::own().join("bad/obj");
    check_texture_coordinates(&own.join("mixed-corners.obj"), 0);
    check_texture_coordinates(&own.join("uv-starts-late.obj"), 1);
    if let Some(folder) = samples::external() {
        check_texture_coordinates(&folder.join("bad/obj/s39_mixed_corner_forms.obj"), 0);
        check_texture_coordinates(&folder.join("bad/obj/s59_uv_starts_late.obj"), 1);
    }
}

/// Checks that the mean colours of two pictures differ by less than 4 codes per channel.
fn check_mean_colour(picture: &Path, original: &Path) {
    let [picture, original] =
        [picture, original].map(|path| file::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())));
    let mean = |image: &Image<[u8; 4]>, channel: usize| {
        let sum: u64 = image.pixels().iter().map(|p| u64::from(p[channel])).sum();
        sum as f32 / image.pixels().len() as f32
    };
    for channel in 0..3 {
        let (got, wanted) = (mean(&picture, channel), mean(&original, channel));
        assert!((got - wanted).abs() < 4.0, "channel {channel}: {got} instead of {wanted}");
    }
}

#[test]
fn a_cmyk_picture_has_the_colours_of_the_original() {
    let own = samples::own().join("bad/images-valid");
    check_mean_colour(&own.join("cmyk.jpg"), &own.join("cmyk-as-rgb.png"));
    if let Some(folder) = samples::external() {
        check_mean_colour(&folder.join("bad/images-valid/s_cmyk.jpg"), &folder.join("images/chelsea.png"));
    }
}

/// Writes the files to a new folder and loads the first one.
fn load_texts(files: &[(&str, &str)]) -> Result<Loaded, String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    load(&folder.path().join(files[0].0)).unwrap().map_err(|e| e.to_string())
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const FACE: &str = "f 1 2 3\n";

#[test]
fn faults_in_the_model_are_errors_with_file_and_line() {
    for (text, line, why) in [
        ("v nan 0 0\n", ":1:", "finite"),
        ("vn nan nan nan\n", ":1:", "finite"),
        ("v 1e300 0 0\n", ":1:", "finite"),
        ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ":1:", "no face that can be drawn"),
        ("v 0,5 0 0\n", ":1:", "point"),
        ("v 0 0 0\nv 1 0\n", ":2:", "three coordinates"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", ":4:", "does not exist"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967299\n", ":4:", "does not exist"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", ":4:", "start at 1"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n", ":4:", "before the first"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\", ":4:", "fewer than three"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n", ":4:", "lines"),
        ("", "", "no faces"),
        ("<html>", "", "web page"),
        ("version https://git-lfs.github.com/spec/v1\n", "", "git lfs"),
    ] {
        let message = load_texts(&[("a.obj", text)]).unwrap_err();
        assert!(message.contains(&format!("a.obj{line}")) && message.contains(why), "{text:?}: {message}");
    }
}

#[test]
fn faults_in_materials_are_warnings_with_file_and_line() {
    let model = format!("mtllib a.mtl\nusemtl m\n{TRIANGLE}{FACE}");
    for (library, place, why) in [
        ("newmtl m\nKd abc 0 0\n", "a.mtl:2:", "not a number"),
        ("newmtl m\nd 7\n", "a.mtl:2:", "clamped"),
        ("newmtl m\nTr nan\n", "a.mtl:2:", "finite"),
        ("Kd 1 0 0\nnewmtl m\n", "a.mtl:1:", "before any"),
        ("newmtl other\n", "a.obj:2:", "\"m\" is not defined"),
        ("newmtl m\nmap_Kd a.mtl\n", "a.mtl:2:", "looks like text"),
        ("newmtl m\nmap_Kd nowhere.png\n", "a.mtl:2:", "nowhere.png"),
        ("newmtl m\nmap_Kd .\n", "a.mtl:2:", "folder"),
    ] {
        let loaded = load_texts(&[("a.obj", &model), ("a.mtl", library)]).unwrap();
        let reported: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
        assert!(reported.iter().any(|w| w.contains(place) && w.contains(why)), "{library:?}: {reported:?}");
        assert_eq!(sound(&loaded), Ok(()));
    }
}

#[test]
fn a_missing_texture_is_recorded_and_named_in_the_verdict_of_its_pixels() {
    let model = format!("mtllib a.mtl\nusemtl m\n{TRIANGLE}{FACE}");
    let library = "newmtl m\nKd 0 0 0\nmap_Kd nowhere.png\n";
    let Loaded { scene, .. } = load_texts(&[("a.obj", &model), ("a.mtl", library)]).unwrap();
    assert_eq!(scene.library.materials()[0].missing_texture.as_deref(), Some("nowhere.png"));
    let recipe = Recipe { pipeline: Settings { culling: Culling::None, ..Settings::default() }, ..Recipe::default() };
    let frame = run(&scene, &scene.home, &recipe, Viewport { width: 33, height: 33 }, &mut ());
    let reported = (0..33 * 33).filter_map(|i| inspect(&scene, &recipe, &frame, i % 33, i / 33));
    let verdict = reported.map(|report| report.verdict).find(|verdict| verdict.contains("Won by")).unwrap();
    let why = "Black: the texture “nowhere.png” could not be read, and the fallback, the colour of its material “m”, \
               is (0, 0, 0). Won by";
    assert!(verdict.starts_with(why), "{verdict}");
}

#[test]
fn material_libraries_outside_the_folder_or_without_end_are_not_read() {
    for name in ["/dev/zero", "../a.mtl", "x/../../a.mtl", "..\\a.mtl", "C:\\a.mtl", ".", "nowhere.mtl", "a.obj"] {
        let model = format!("mtllib {name}\n{TRIANGLE}{FACE}");
        let loaded = load_texts(&[("a.obj", &model)]).unwrap();
        assert!(!loaded.warnings.is_empty(), "{name}");
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_and_pipes_are_not_read() {
    let (inside, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    std::fs::write(outside.path().join("a.mtl"), "newmtl m\n").unwrap();
    std::os::unix::fs::symlink(outside.path().join("a.mtl"), inside.path().join("a.mtl")).unwrap();
    let model = inside.path().join("a.obj");
    std::fs::write(&model, format!("mtllib a.mtl\n{TRIANGLE}{FACE}")).unwrap();
    let loaded = load(&model).unwrap().unwrap();
    assert!(loaded.warnings[0].text.contains("outside"), "{}", loaded.warnings[0]);

    let pipe = inside.path().join("pipe.obj");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    assert!(load(&pipe).unwrap().unwrap_err().to_string().contains("not a regular file"));
}

#[test]
fn short_colours_opacities_and_texture_options_are_understood() {
    let model = format!("mtllib  my lib.mtl\nusemtl m 1\n{TRIANGLE}{FACE}");
    let library = "newmtl m 1\nKd 0.5 # grey\nTr 0.9\nd 0.25\nmap_Kd -blendu on -o 1 2 sub\\my picture.png -bm 2\n";
    let loaded = load_texts(&[("a.obj", &model), ("my lib.mtl", library)]).unwrap();
    let material = &loaded.scene.library.materials()[0];
    assert_eq!((material.diffuse, material.opacity), (Vec3::splat(0.5), 0.25));
    assert!(loaded.warnings.iter().any(|w| w.text.contains("sub/my picture.png: cannot")), "{:?}", loaded.warnings);
}

#[test]
fn odd_but_sound_models_load_silently() {
    for text in [
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r".to_owned(),
        format!("\u{feff}{TRIANGLE}{FACE}"),
        format!("{FACE}{TRIANGLE}"),
        format!("{TRIANGLE}f 1 2 \\\n3 # end"),
        format!("{TRIANGLE}f 1// 2// 3//"),
        format!("# {}\n{TRIANGLE}{FACE}", "x".repeat(100_000)),
        format!("o\ng\n{TRIANGLE}s off\n{FACE}"),
    ] {
        let loaded = load_texts(&[("a.obj", &text)]).unwrap();
        assert_eq!((loaded.scene.triangle_count(), loaded.warnings), (1, vec![]));
    }
}

#[test]
fn the_largest_coordinates_give_a_finite_scene() {
    let loaded = load_texts(&[("a.obj", "v 3e38 0 0\nv -3e38 0 0\nv 0 3e38 0\nf 1 2 3\n")]).unwrap();
    assert_eq!(sound(&loaded), Ok(()));
    assert!(loaded.warnings[0].text.contains("scaled"), "{}", loaded.warnings[0]);
}

/// Returns the OBJ text of a grid of `side`² vertices and 2·(`side` − 1)² triangles.
fn grid(side: usize) -> String {
    let vertices = (0..side * side).map(|i| format!("v {} {} 0\n", i % side, i / side)).collect::<String>();
    let corners = (0..(side - 1) * (side - 1)).map(|i| i / (side - 1) * side + i % (side - 1) + 1);
    let faces = corners.map(|a| format!("f {a} {} {}\nf {a} {} {}\n", a + 1, a + side + 1, a + side + 1, a + side));
    vertices + &faces.collect::<String>()
}

#[test]
fn a_load_ends_at_the_memory_limit_and_when_it_is_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.obj");
    std::fs::write(&path, grid(240)).unwrap();
    let load = |control: LoadControl<'_>| obj::load_with(&path, TrMeaning::Auto, control);
    let error = load(LoadControl::quiet(MemoryLimit::mib(4))).unwrap_err().to_string();
    assert!(error.contains("needs more than the memory limit of 4 MiB; raise it with `--memory`"), "{error}");
    assert!(load(LoadControl::quiet(MemoryLimit::mib(64))).is_ok());

    let shares = Mutex::new(Vec::new());
    let progress = |share| shares.lock().unwrap().push(share);
    load(LoadControl { progress: &progress, ..LoadControl::quiet(MemoryLimit::default()) }).unwrap();
    let shares = shares.into_inner().unwrap();
    assert!(shares.len() > 40 && shares.is_sorted() && shares[shares.len() - 1] == 1.0, "{shares:?}");
    // Wherever loading is cancelled, it ends before the next progress report.
    for wanted in [0.0, 0.2, 0.5, 0.8, 0.9, 0.98] {
        let (cancel, reports) = (AtomicBool::new(false), AtomicUsize::new(0));
        let progress = |share| {
            if share >= wanted {
                cancel.store(true, Ordering::Relaxed);
                reports.fetch_add(1, Ordering::Relaxed);
            }
        };
        let result = load(LoadControl { memory: MemoryLimit::default(), progress: &progress, cancel: &cancel });
        assert!(matches!(result, Err(SceneError::Cancelled { .. })), "{wanted}");
        assert_eq!(reports.into_inner(), 1, "{wanted}");
    }
}

#[test]
fn textures_beyond_the_memory_limit_are_not_decoded() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Image::from_pixels(2048, 2048, vec![[1, 2, 3, 255]; 1 << 22]);
    file::write_png(&folder.path().join("t0.png"), &picture).unwrap();
    let (mut materials, mut faces) = (String::new(), String::new());
    for i in 0..50 {
        if i > 0 {
            std::fs::copy(folder.path().join("t0.png"), folder.path().join(format!("t{i}.png"))).unwrap();
        }
        materials += &format!("newmtl m{i}\nmap_Kd t{i}.png\n");
        faces += &format!("usemtl m{i}\nf 1/1 2/1 3/1\n");
    }
    std::fs::write(folder.path().join("a.mtl"), materials).unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n{faces}")).unwrap();
    // 2²² texels of 32 bytes are 128 MiB: three such textures fit.
    let Loaded { scene, warnings, .. } =
        obj::load_with(&path, TrMeaning::Auto, LoadControl::quiet(MemoryLimit::mib(400))).unwrap();
    assert_eq!(scene.library.textures().len(), 3);
    let left_out: Vec<_> = warnings.iter().filter(|w| w.text.contains("2048 × 2048 texels")).collect();
    assert_eq!(left_out.len(), 47);
    assert!(left_out[0].to_string().contains("a.mtl:8: texture not loaded"), "{}", left_out[0]);
}

#[test]
fn textures_that_are_not_rendered_take_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let heights = Image::from_pixels(1024, 1024, vec![[7, 7, 7, 255]; 1 << 20]);
    let color = Image::from_pixels(1024, 1024, vec![[7, 8, 9, 255]; 1 << 20]);
    let mut materials = String::new();
    for i in 0..4 {
        file::write_png(&folder.path().join(format!("heights{i}.png")), &heights).unwrap();
        materials += &format!("newmtl m{i}\nmap_Bump heights{i}.png\n");
    }
    file::write_png(&folder.path().join("color.png"), &color).unwrap();
    std::fs::write(folder.path().join("a.mtl"), materials + "newmtl m\nmap_Kd color.png\n").unwrap();
    let path = folder.path().join("a.obj");
    let faces: String = ["m0", "m1", "m2", "m3", "m"].map(|name| format!("usemtl {name}\nf 1/1 2/1 3/1\n")).concat();
    std::fs::write(&path, format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n{faces}")).unwrap();
    let loaded = obj::load_with(&path, TrMeaning::Auto, LoadControl::quiet(MemoryLimit::mib(40))).unwrap();
    assert_eq!(loaded.scene.library.textures().len(), 1, "{:?}", loaded.warnings);
}

#[test]
fn attributes_are_interpolated_where_a_face_crosses_itself() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0 1 1 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n\
                f 1/1 2/2 3/3 4/4\n";
    let loaded = load_texts(&[("a.obj", text)]).unwrap();
    assert_eq!(loaded.warnings[0].text, "face that crosses itself; filled by its winding numbers");
    let mesh = &loaded.scene.library.meshes()[0];
    assert_eq!(mesh.triangles.len(), 2);
    let middle = mesh.positions.iter().position(|p| (*p - Vec3::new(0.5, 0.5, 0.0)).length() < 1e-6).unwrap();
    assert!((mesh.uvs[middle] - Vec2::new(0.5, 0.5)).length() < 1e-6);
    // The self-intersection lies on the edge from the green to the blue corner.
    assert!((mesh.colors[middle] - Vec3::new(0.0, 0.5, 0.5)).length() < 1e-6, "{}", mesh.colors[middle]);
}

#[test]
fn polygons_of_any_size_are_triangulated() {
    for count in [1_000, 100_000] {
        let mut text = String::new();
        for i in 0..count {
            let (y, x) = (f64::from(i) / f64::from(count) * std::f64::consts::TAU).sin_cos();
            let radius = if i % 4 < 2 { 0.9 } else { 1.0 };
            text += &format!("v {} {} 0\n", x * radius, y * radius);
        }
        text += "f";
        (1..=count).for_each(|i| text += &format!(" {i}"));
        let loaded = load_texts(&[("a.obj", &text)]).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!(loaded.scene.triangle_count(), count as usize - 2);
    }
}
