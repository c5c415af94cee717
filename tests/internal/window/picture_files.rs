//! Tests of picture files in a comparison: opening, dropping, exact values, tone, layers, reference, sequences, and
//! reloading.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::{Event, Key, Role};
use egui_kittest::kittest::Queryable as _;
use exr::image::write::WritableImage as _;
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples};
use rasterscope::image::file::write_png;
use rasterscope::image::pfm::{Floats, write_pfm};
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::view::Range;
use rasterscope::measure::against::figures;
use rasterscope::measure::tone::{Tone, ToneCurve};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::compare::compute::Compared;
use rasterscope::ui::session::compare::files::PictureLook;
use rasterscope::ui::session::compare::{CompareChange, Mode};
use rasterscope::ui::session::file_command::FileCommand;
use rasterscope::ui::session::picture_role::PictureRole;
use rasterscope::ui::session::sequences::SequenceChange;
use rasterscope::ui::session::workspace::Panel;
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
    bench.session().features.comparison.compared.as_ref().expect("something is compared")
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
    assert_eq!(bench.session().features.messages.error, None);
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
    assert_eq!(bench.session().features.comparison.mode, Mode::Wipe);
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
    let opened =
        |bench: &Bench| bench.session().features.comparison.opened(&bench.session().state.tiles, role).unwrap();
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
    let error = bench.session().features.messages.error.clone().expect("it is reported");
    assert!(error.contains("broken.exr: cannot decode this OpenEXR file"), "{error}");
    assert!(!bench.session().features.comparison.is_on());
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
        let tiles = bench.session().features.comparison.compared.as_ref().map(|compared| &compared.tiles);
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
    assert_eq!(bench.session().features.messages.error, None);
    std::fs::write(&path, &whole).unwrap();
    wait(&mut bench, "the finished picture is shown", |bench| shows(bench, 3));
}

/// Creates a folder with the frames 3, 4 and 6 of a sequence; `blue` is that of frame 3 and increases by one per file.
fn sequence(blue: u8) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (index, frame) in [3, 4, 6].into_iter().enumerate() {
        saved(folder.path(), &format!("f{frame:04}.png"), &gradient(blue + index as u8));
    }
    folder
}

/// Returns the blue of each compared picture.
fn blues(bench: &Bench) -> Vec<u8> {
    compared(bench).tiles.iter().map(|tile| tile.picture.at(0, 0)[2]).collect()
}

#[test]
fn sequences_are_stepped_together_and_shifted() {
    let (ours, theirs) = (sequence(10), sequence(20));
    let mut bench = Bench::small("triangle");
    open(&mut bench, PictureRole::Tile(0), ours.path().join("f####.png"));
    open(&mut bench, PictureRole::Tile(1), theirs.path().to_owned());
    assert_eq!((bench.session().sequence_range(), blues(&bench)), (Some((3, 6)), vec![10, 20]));
    bench.press(Key::Period);
    assert_eq!(blues(&bench), [11, 21]);
    assert!(bench.says("A f0004.png") && bench.says("B f0004.png"));
    let differing = |bench: &Bench| compared(bench).tiles[1].measured.as_ref().unwrap().figures.unwrap().codes.max_abs;
    assert_eq!(differing(&bench), 10, "each frame is measured");
    bench.press(Key::Period);
    assert_eq!(blues(&bench), [11, 21], "frame 5 is missing, and frame 4 stays");
    bench.press(Key::End);
    assert_eq!(blues(&bench), [12, 22]);
    let shift = SequenceChange::Shift(theirs.path().to_owned(), -3);
    bench.window.state_mut().queue(vec![Command::Sequence(shift)]);
    bench.rest();
    assert_eq!((bench.session().sequence_range(), blues(&bench)), (Some((3, 9)), vec![12, 20]));
    bench.click("Go to the first frame  (Home)");
    assert_eq!(blues(&bench), [10, 20]);
    bench.press(Key::T);
    assert_eq!(bench.session().sequence_range(), None, "without a comparison the keys step through triangles");
}

#[test]
fn playing_shows_every_frame_and_begins_again() {
    let folder = sequence(50);
    let mut bench = Bench::small("triangle");
    open(&mut bench, PictureRole::Tile(1), folder.path().to_owned());
    bench.session_mut().features.sequences.speed = 60.0;
    bench.window.key_press(Key::Space);
    let mut shown = Vec::new();
    for _ in 0..200 {
        bench.window.step();
        shown.push(compared(&bench).tiles[1].picture.at(0, 0)[2]);
        shown.dedup();
    }
    assert!(bench.session().features.sequences.is_playing);
    assert!(shown.len() >= 5, "{shown:?}");
    let next = |blue: u8| if blue == 52 { 50 } else { blue + 1 };
    assert!(shown.windows(2).all(|pair| pair[1] == next(pair[0])), "{shown:?}");
}

#[test]
fn a_frame_that_cannot_be_read_is_named_and_the_frame_before_it_stays() {
    let folder = sequence(70);
    std::fs::write(folder.path().join("f0005.png"), "no picture").unwrap();
    let mut bench = Bench::small("triangle");
    open(&mut bench, PictureRole::Tile(1), folder.path().to_owned());
    bench.press(Key::Period);
    bench.press(Key::Period);
    assert_eq!(blues(&bench)[1], 71);
    let log = &bench.session().features.messages.log;
    assert!(log.iter().any(|line| line.text.contains("f0005.png") && line.text.contains("the frame before it stays")));
    bench.press(Key::Period);
    assert_eq!(blues(&bench)[1], 72);
    let none = FileCommand::OpenPicture(PictureRole::Tile(1), folder.path().join("g#.png"));
    bench.window.state_mut().queue(vec![Command::File(none)]);
    bench.rest();
    let error = bench.session().features.messages.error.clone().expect("it is reported");
    assert!(error.ends_with("g#.png: no file has a name of this pattern"), "{error}");
}

#[test]
fn the_layer_and_the_range_of_data_are_chosen_in_the_panel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.exr");
    let values = |factor: f32| FlatSamples::F32((0..48 * 30).map(|index| index as f32 * factor).collect());
    let channels = [("B", 0.0), ("G", 0.0), ("R", 0.0), ("Z", 0.5)];
    let channels = channels.map(|(name, factor)| AnyChannel::new(name, values(factor)));
    let image = exr::prelude::Image::from_channels((48, 30), AnyChannels::sort(channels.into_iter().collect()));
    image.write().to_file(&path).unwrap();
    let mut bench = Bench::small("triangle");
    open(&mut bench, PictureRole::Tile(1), path);
    bench.show_panel(Panel::PictureFiles);
    let black = |bench: &Bench| compared(bench).tiles[1].picture.pixels().iter().all(|pixel| *pixel == [0, 0, 0, 255]);
    assert!(black(&bench));
    bench.choose("Layer of B", "Z");
    let codes = |bench: &Bench| [(0, 0), (47, 29)].map(|(x, y)| compared(bench).tiles[1].picture.at(x, y)[0]);
    assert_eq!(codes(&bench), [0, 255], "from the smallest to the largest depth");
    assert!(bench.mentions("719.5"), "the largest depth is in the table");
    let role = PictureRole::Tile(1);
    let opened = bench.session().features.comparison.opened(&bench.session().state.tiles, role).unwrap();
    let look = PictureLook { range: Some(Range { low: 0.0, high: 1439.0 }), ..opened.look().clone() };
    bench.window.state_mut().queue(vec![Command::Compare(CompareChange::Look(opened.path.clone(), look))]);
    bench.rest();
    assert_eq!(codes(&bench), [0, 128]);
    bench.click("Fit");
    assert_eq!(codes(&bench), [0, 255]);
}

#[test]
fn errors_of_stored_values_are_in_the_panel() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    for (role, name, value) in [(PictureRole::Tile(0), "a.pfm", 0.25), (PictureRole::Tile(1), "b.pfm", 2.25)] {
        let path = folder.path().join(name);
        write_pfm(&path, &Floats::Three(Image::filled(48, 30, [value; 3]))).unwrap();
        open(&mut bench, role, path);
    }
    bench.show_panel(Panel::PictureFiles);
    assert!(bench.says("Stored values against a.pfm"));
    // Values above 1 count, although they are shown as 1.
    assert!(bench.says("MSE 4.000000") && bench.says("PSNR -6.0206 dB") && bench.says("Largest difference 2.000000"));
}
