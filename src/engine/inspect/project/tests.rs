use std::fs;

use super::*;
use crate::measure::difference::Difference;
use crate::measure::reference::Reference;
use crate::measure::region::PixelRegion;
use crate::measure::tone::Tone;
use crate::pipeline::settings::Choice as _;
use crate::scene::builtin;

fn project() -> Project {
    let home = builtin::by_id("chess").unwrap().build().home;
    let mut recipe = Recipe::default();
    for setting in ["shading=gouraud", "light.direction=0.1,0.7,-0.3", "upscaler.method=bicubic", "upscaler.scale=4"] {
        recipe.set(setting).unwrap();
    }
    let state = InspectionState {
        scene: "chess".into(),
        mirrored: true,
        time_s: 0.7,
        camera: Camera { eye: home.eye * 1.1, near: 0.1 + 0.2, ..home },
        recipe,
        picture: None,
        buffer: Buffer::Depth,
        stage: Some(Stage::Shade),
        number: Some(Intermediate::U),
        display: "map=magma,range=0.25..0.5".parse().unwrap(),
        overlays: vec!["facing=0.25".parse().unwrap()],
        triangles: Some(7),
        fragments: Some(3),
        pixel: Some((12, 34)),
    };
    let mut project = Project::new(state, TrMeaning::Opacity, Viewport { width: 321, height: 201 });
    project.workspace = Some("inspect".to_owned());
    project.probe = Some(Probe { ulps: 3, ..Probe::default() });
    let keys = [0.0, 1.25].map(|time_s| KeyView { time_s, camera: Camera { far: 50.0 + time_s as f32 / 3.0, ..home } });
    project.camera_path = Some(StoredPath { keys: keys.to_vec(), follows: false, time_s: 0.1 + 0.2 });
    project.comparison = Some(Comparison {
        view: ComparisonView::Wipe,
        tiles: vec![
            ComparedTile { settings: recipe, file: None },
            ComparedTile { settings: Recipe::default(), file: Some("/pictures/b.exr".into()) },
        ],
        active: 0,
        reference: Reference::ALL[0],
        reference_file: Some("/pictures/frames/f.####.png".into()),
        difference: Difference::Absolute,
        gain: 16,
        wipe: 0.3,
        region: Some(PixelRegion { left: 1, top: 2, right: 30, bottom: 40 }),
        files: vec![
            ComparedFile {
                file: "/pictures/b.exr".into(),
                layer: Some("diffuse.left".to_owned()),
                range: Some((-0.1, 0.7)),
                shift: 0,
            },
            ComparedFile { file: "/pictures/frames/f.####.png".into(), layer: None, range: None, shift: -12 },
        ],
        playback: Some(FilePlayback { frame: 1001, speed: 23.976 }),
        tone: Tone { exposure: 1.5, ..Tone::default() },
    });
    project
}

/// Writes a project file with this content and reads it.
fn read(content: &[u8]) -> Result<LoadedProject, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.rasterscope");
    fs::write(&path, content).unwrap();
    Project::read(&path).map_err(|error| error.to_string().rsplit_once("p.rasterscope").unwrap().1.to_owned())
}

#[test]
fn a_project_comes_back_as_it_was_saved() {
    let saved = project();
    let bytes = saved.clone().encode(Path::new("/projects")).unwrap();
    let LoadedProject { project, warnings } = read(&bytes).unwrap();
    assert_eq!(project, saved);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert!(bytes.len() < 4000, "{}", String::from_utf8_lossy(&bytes));
}

#[test]
fn the_time_is_stored_unless_it_is_zero_and_old_projects_show_time_zero() {
    let text = |time_s: f64| {
        let project = Project { time_s, camera_path: None, ..project() };
        String::from_utf8(project.encode(Path::new("/projects")).unwrap()).unwrap()
    };
    assert!(text(0.1).contains("\"time_s\": 0.1") && !text(0.0).contains("time_s"));
    assert_eq!(read(text(0.0).as_bytes()).unwrap().project.state().time_s, 0.0);
    assert_eq!(read(text(0.1).as_bytes()).unwrap().project.state().time_s, 0.1);
}

#[test]
fn a_moved_project_finds_its_model_and_a_changed_model_gives_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (folder.path().join("old"), folder.path().join("new"));
    fs::create_dir_all(old.join("models")).unwrap();
    let model = old.join("models/a.obj");
    fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let saved = Project { scene: model, comparison: None, ..project() };
    fs::write(old.join("p.rasterscope"), saved.encode(&old).unwrap()).unwrap();
    fs::rename(&old, &new).unwrap();
    let path = new.join("p.rasterscope");
    let LoadedProject { project, warnings } = Project::read(&path).unwrap();
    assert_eq!(project.state().scene, new.join("models/a.obj"));
    assert!(matches!(project.source(), SceneSource::File(_, TrMeaning::Opacity)));
    assert!(warnings.is_empty(), "{warnings:?}");
    fs::write(new.join("models/a.obj"), "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let warnings = Project::read(&path).unwrap().warnings;
    assert!(warnings.iter().any(|warning| warning.text.contains("a.obj has changed")), "{warnings:?}");
}

#[test]
fn damaged_files_give_one_sentence_with_the_line() {
    let text = String::from_utf8(project().encode(Path::new("/projects")).unwrap()).unwrap();
    let line = |needle: &str| 1 + text.lines().position(|line| line.contains(needle)).unwrap();
    for (from, to, message) in [
        ("\"rasterscope\": 1", "\"rasterscope\": 2", "has version 2; this program reads up to version 1"),
        ("\"rasterscope\": 1", "\"rasterscop\": 1", "not a project of Rasterscope"),
        ("\"pick\"", "\"picked\"", "unknown field `picked`"),
        ("\"ulps\"", "\"ulp\"", "unknown field `ulp`"),
        ("\"shading=gouraud\"", "\"shading=golden\"", "golden"),
        ("\"eye\"", "\"ear\"", "unknown field `ear`"),
        ("\"wipe\": 0.3", "\"wipe\": 1.3", "the wipe must be from 0 to 1"),
        ("\"gain\": 16", "\"gain\": -16", "invalid value"),
        ("\"shift\": -12", "\"shift\": -1000001", "the shift of "),
        ("\"shift\": -12", "\"shift\": -9223372036854775808", "the shift of "),
        ("\"speed\": 23.976", "\"speed\": 0", "the speed must be above 0 and at most 1000 frames per second"),
        ("-0.1", "7.5", "must be two finite numbers, the smaller one first"),
        ("\"layer\"", "\"layers\"", "unknown field `layers`"),
        ("\"depth\"", "\"depths\"", "unknown variant `depths`"),
        ("\"mirrored\": true", "\"mirrored\": 1", "expected a boolean"),
    ] {
        let damaged = text.replacen(from, to, 1);
        assert_ne!(damaged, text, "{from}");
        let error = read(damaged.as_bytes()).unwrap_err();
        assert!(error.contains(message) && !error.contains('\n'), "{from}: {error}");
        // A value is complete at the end of its list, so the line is not always that of the text.
        let named: Option<usize> = error[1..].split(':').next().and_then(|line| line.parse().ok());
        assert!(named.is_none_or(|named| named >= 1 && named <= text.lines().count()), "{error}");
        if message.starts_with("unknown field") {
            assert_eq!(named, Some(line(from)), "{error}");
        }
    }
    let error = read(&text.as_bytes()[..text.len() / 2]).unwrap_err();
    assert!(error.contains("EOF"), "{error}");
}

#[test]
fn an_unknown_upscaler_becomes_native_resolution_with_a_warning() {
    let text = String::from_utf8(project().encode(Path::new("/projects")).unwrap()).unwrap();
    let text = text.replace("upscaler.method=bicubic", "upscaler.method=from-elsewhere");
    let LoadedProject { project, warnings } = read(text.as_bytes()).unwrap();
    assert!(project.state().recipe.upscaler.is_native());
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].text.contains("`from-elsewhere` is not registered"), "{warnings:?}");
}

#[test]
fn mutated_files_never_panic() {
    let bytes = project().encode(Path::new("/projects")).unwrap();
    let mut random = fastrand::Rng::with_seed(11);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.rasterscope");
    let mut read = 0;
    for _ in 0..2000 {
        let mut mutated = bytes.clone();
        for _ in 0..random.usize(1..4) {
            let place = random.usize(..mutated.len());
            match random.u8(..4) {
                0 => mutated.truncate(place.max(1)),
                1 => drop(mutated.remove(place)),
                2 => mutated.insert(place, *b"0123456789-.e\",:[]{}".get(random.usize(..20)).unwrap()),
                _ => mutated[place] = random.u8(..),
            }
        }
        fs::write(&path, &mutated).unwrap();
        match Project::read(&path) {
            Ok(LoadedProject { project, .. }) => {
                read += 1;
                assert_eq!(project.state().check(), Ok(()));
            }
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    assert!(read > 20, "{read}");
}
