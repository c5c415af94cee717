//! Tests of picture files in a comparison: opening, dropping, exact values, tone, reference, and reloading.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::{Event, Key, Role};
use egui_kittest::kittest::Queryable as _;
use rasterscope::image::file::write_png;
use rasterscope::image::pfm::{Floats, write_pfm};
use rasterscope::image::{Image, Rgba8};
use rasterscope::measure::against::figures;
use rasterscope::measure::tone::{Tone, ToneCurve};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::ui::command::Command;
use rasterscope::ui::compare::compute::Compared;
use rasterscope::ui::compare::files::PictureRole;
use rasterscope::ui::compare::{CompareChange, Mode};
use rasterscope::ui::files::FileCommand;
use rasterscope::ui::worker::Worker;

use super::bench::Bench;

fn gradient(blue: u8) -> Image<Rgba8> {
    Image::from_fn(48, 30, |x, y| [(x * 5) as u8, (y * 8) as u8, blue, 255])
}

fn saved(folder: &Path, name: &str, picture: &Image<Rgba8>) -> PathBuf {
    let path = folder.join(name);
    write_png(&path, picture).unwrap();
    path
}

fn compared(bench: &Bench) -> &Compared {
    bench.session().compared.as_ref().expect("something is compared")
}

fn open(bench: &mut Bench, role: PictureRole, path: PathBuf) {
    bench.window.state_mut().queue(vec![Command::File(FileCommand::OpenPicture(role, path))]);
    bench.rest();
}

#[test]
fn a_typed_path_opens_a_picture_as_b_which_is_compared_like_a_drawn_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(folder.path(), "other.png", &gradient(9));
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    bench.click("Open picture…");
    bench.click("As B…");
    bench.window.event(Event::Text(path.display().to_string()));
    bench.rest();
    bench.press(Key::Enter);
    assert_eq!(bench.session().messages.error, None);
    assert_eq!(bench.session().viewport(), Viewport { width: 48, height: 30 }, "drawn pictures take its size");
    let [a, b] = &compared(&bench).tiles[..] else { panic!("two tiles") };
    assert_eq!(*b.picture, gradient(9));
    let measured = b.measured.as_ref().and_then(|measured| measured.figures).expect("measured");
    let (expected, _) = figures(&gradient(9), &a.picture).unwrap();
    assert_eq!(measured, expected, "the reference is native, as A");
    assert!(bench.says("File of B: other.png"));
    bench.press(Key::D);
    assert!(compared(&bench).difference.is_some());
    bench.press(Key::W);
    assert_eq!(bench.session().comparison.mode, Mode::Wipe);
    bench.click("Close the file of B and draw the scene");
    assert_ne!(*compared(&bench).tiles[1].picture, gradient(9));
    bench.window.state_mut().queue(vec![Command::Undo]);
    bench.rest();
    assert_eq!(*compared(&bench).tiles[1].picture, gradient(9));
}

#[test]
fn a_reference_file_is_measured_against_and_swapping_keeps_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    for (role, name, blue) in
        [(PictureRole::Tile(0), "a.png", 5), (PictureRole::Tile(1), "b.png", 80), (PictureRole::Reference, "r.png", 0)]
    {
        open(&mut bench, role, saved(folder.path(), name, &gradient(blue)));
    }
    let errors = |bench: &Bench| -> Vec<u8> {
        let tiles = compared(bench).tiles.iter();
        tiles.map(|tile| tile.measured.as_ref().unwrap().figures.unwrap().codes.max_abs).collect()
    };
    assert_eq!(errors(&bench), [5, 80]);
    bench.press(Key::S);
    assert_eq!(errors(&bench), [80, 5]);
    bench.click("Close the reference file and draw the reference");
    assert_eq!(errors(&bench), [0, 75], "A is a file and becomes the reference");
}

#[test]
fn a_dropped_float_picture_has_exact_values_and_an_exposure_for_display_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bright.pfm");
    write_pfm(&path, &Floats::Three(Image::filled(48, 30, [0.1, 4.5, f32::INFINITY]))).unwrap();
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    bench.drop_file(&path);
    let role = PictureRole::Tile(1);
    let opened = |bench: &Bench| bench.session().comparison.opened(&bench.session().state.tiles, role).unwrap();
    assert_eq!(opened(&bench).values_at((3, 4)), "R 0.1  G 4.5  B inf");
    let before = compared(&bench).tiles[1].picture.clone();
    assert!(bench.window.query_by_role_and_label(Role::ComboBox, "Tone curve").is_some());
    let tone = Tone { exposure: -2.0, curve: ToneCurve::Reinhard };
    bench.window.state_mut().queue(vec![Command::Compare(CompareChange::Tone(tone))]);
    bench.rest();
    assert_ne!(*compared(&bench).tiles[1].picture, *before);
    assert_eq!(opened(&bench).values_at((3, 4)), "R 0.1  G 4.5  B inf");
}

#[test]
fn a_bad_picture_is_named_and_the_comparison_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.exr");
    std::fs::write(&path, b"\x76\x2F\x31\x01broken").unwrap();
    let mut bench = Bench::small("triangle");
    open(&mut bench, PictureRole::Tile(1), path);
    let error = bench.session().messages.error.clone().expect("it is reported");
    assert!(error.contains("broken.exr: cannot decode this OpenEXR file"), "{error}");
    assert!(!bench.session().comparison.is_on());
}

/// Runs frames until `is_done`, and returns the time that this took. Panics after 20 seconds.
fn wait(bench: &mut Bench, what: &str, is_done: impl Fn(&Bench) -> bool) -> Duration {
    let begun = Instant::now();
    while !is_done(bench) {
        assert!(begun.elapsed() < Duration::from_secs(20), "{what}");
        std::thread::sleep(Duration::from_millis(5));
        bench.window.step();
    }
    begun.elapsed()
}

#[test]
fn a_changed_file_is_shown_again_and_an_unfinished_one_keeps_the_old_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(folder.path(), "watched.png", &gradient(1));
    let mut bench = Bench::with_worker("triangle", Worker::spawn(|| {}));
    bench.window.state_mut().queue(vec![Command::File(FileCommand::OpenPicture(PictureRole::Tile(1), path.clone()))]);
    let shows = |bench: &Bench, blue: u8| {
        let tiles = bench.session().compared.as_ref().map(|compared| &compared.tiles);
        tiles.and_then(|tiles| tiles.get(1)).is_some_and(|tile| *tile.picture == gradient(blue))
    };
    wait(&mut bench, "the picture is opened", |bench| shows(bench, 1));
    // Another program replaces the file at once.
    saved(folder.path(), "watched.png", &gradient(2));
    wait(&mut bench, "the new picture is shown", |bench| shows(bench, 2));
    // Another program writes the file in two parts.
    let whole = rasterscope::image::file::encode_png(&gradient(3)).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_millis(600) {
        bench.window.step();
        assert!(shows(&bench, 2), "the old picture stays");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(bench.session().messages.error, None);
    std::fs::write(&path, &whole).unwrap();
    wait(&mut bench, "the finished picture is shown", |bench| shows(bench, 3));
}
