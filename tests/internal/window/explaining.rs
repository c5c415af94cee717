//! Tests of the panel that explains another renderer's picture.

use std::path::Path;
use std::sync::Arc;

use rasterscope::chain::Renderer;
use rasterscope::explain::{Setup, by_id};
use rasterscope::image::file::write_png;
use rasterscope::image::pfm::{Floats, write_pfm};
use rasterscope::image::{Image, Rgba8};
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::file_command::FileCommand;
use rasterscope::ui::session::picture_role::PictureRole;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

/// Returns the picture on the canvas as a renderer with a fault draws it.
fn faulty(bench: &Bench, fault: &str) -> Image<Rgba8> {
    let session = bench.session();
    let correct = Setup::new(session.scene.clone(), session.state.camera, session.state.recipe, session.viewport());
    correct.with([by_id(fault).unwrap()]).draw(&mut Renderer::default())
}

fn open_as_b(bench: &mut Bench, path: &Path) {
    open(bench, PictureRole::Tile(1), path);
}

fn open(bench: &mut Bench, role: PictureRole, path: &Path) {
    let command = FileCommand::OpenPicture(role, path.to_owned());
    bench.window.state_mut().queue(vec![Command::File(command)]);
    bench.rest();
}

#[test]
fn a_fault_of_an_opened_picture_is_named_and_drawn_as_c() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("theirs.png");
    let mut bench = Bench::small("cubes");
    let theirs = faulty(&bench, "depth-test-reversed");
    write_png(&path, &theirs).unwrap();
    bench.show_panel(Panel::OtherRenderer);
    assert!(bench.mentions("The program finds the faults"));
    open_as_b(&mut bench, &path);
    bench.show_panel(Panel::OtherRenderer);
    assert!(bench.mentions("“theirs.png” should show this scene"));
    bench.click("Explain");
    assert!(bench.says("The depth test is reversed: the farthest surface wins"));
    let compared = bench.session().features.comparison.compared.as_ref().unwrap();
    assert_eq!(*compared.tiles[2].picture, theirs, "C is ours with the fault");

    bench.session_mut().pick = Some((30, 20));
    bench.rest();
    let [r, g, b, _] = theirs.at(30, 20);
    assert!(bench.says(&format!("{r:3} {g:3} {b:3}  ours with the faults")));

    bench.click("Apply settings");
    assert_eq!(*bench.session().view.as_ref().unwrap().frame.image(), theirs);
    assert!(bench.mentions("outdated"), "the settings have changed since the search");
}

#[test]
fn an_explanation_belongs_to_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("theirs.png");
    let mut bench = Bench::small("cubes");
    write_png(&path, &faulty(&bench, "flip-vertical")).unwrap();
    open_as_b(&mut bench, &path);
    bench.show_panel(Panel::OtherRenderer);
    bench.click("Explain");
    let found = Arc::clone(bench.session().features.explaining.found.as_ref().expect("it was explained"));
    assert_eq!(found.explanation.causes[0].fault.id, "flip-vertical");
    bench.window.state_mut().queue(vec![Command::File(FileCommand::OpenBuiltin("triangle".to_owned()))]);
    bench.rest();
    assert!(bench.session().features.explaining.found.is_none());
}

#[test]
fn depths_and_ids_are_opened_checked_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let mut bench = Bench::small("triangle");
    let theirs = faulty(&bench, "flip-vertical");
    write_png(&file("theirs.png"), &theirs).unwrap();
    let (width, height) = theirs.size();
    write_pfm(&file("depth.pfm"), &Floats::One(Image::from_fn(width, height, |x, _| x as f32))).unwrap();
    write_pfm(&file("small.pfm"), &Floats::One(Image::from_fn(3, 2, |x, _| x as f32))).unwrap();
    write_pfm(&file("flat.pfm"), &Floats::One(Image::filled(width, height, 0.5))).unwrap();
    open_as_b(&mut bench, &file("theirs.png"));
    bench.show_panel(Panel::OtherRenderer);

    open(&mut bench, PictureRole::Depths, &file("theirs.png"));
    let error = |bench: &Bench| bench.session().features.messages.error.clone().expect("it is reported");
    assert!(error(&bench).ends_with("theirs.png: it has colours, not depths"));
    open(&mut bench, PictureRole::Depths, &file("flat.pfm"));
    assert!(error(&bench).ends_with("flat.pfm: all its depths are equal, so nothing can be learned from them"));
    open(&mut bench, PictureRole::Depths, &file("small.pfm"));
    bench.click("Explain");
    assert_eq!(error(&bench), format!("small.pfm: it has 3 × 2 px, but the picture {width} × {height}"));
    assert!(bench.session().features.explaining.found.is_none());
    bench.click("Close the depths");

    open(&mut bench, PictureRole::Depths, &file("depth.pfm"));
    open(&mut bench, PictureRole::Ids, &file("theirs.png"));
    assert!(bench.says("Depths: depth.pfm") && bench.says("Ids: theirs.png"));
    bench.click("Explain");
    let found = bench.session().features.explaining.found.clone().expect("it was explained");
    assert_eq!(found.explanation.causes[0].fault.id, "flip-vertical");
    let [depth, ids] =
        [found.explanation.depth.clone().unwrap().to_string(), found.explanation.ids.clone().unwrap().to_string()];
    assert!(bench.says(&depth) && bench.says(&ids));
}
