//! Tests of keys and transport while the lab is open.

use super::*;
use crate::ui::session::appearance::AppearanceChange;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;

fn open(page: Page) -> Lab {
    let mut lab = Lab::default();
    lab.apply(LabChange::Open(true));
    lab.apply(LabChange::Page(page));
    lab
}

/// Passes a command to the lab as the session does. Returns the command if it is not for the lab.
fn give(lab: &mut Lab, command: Command) -> Option<Command> {
    match lab.claim(command)? {
        Command::Lab(change) => {
            lab.apply(change);
            None
        }
        other => Some(other),
    }
}

#[test]
fn pipeline_keys_step_the_lab_only_while_it_is_open() {
    let mut lab = Lab::default();
    assert_eq!(lab.claim(Command::StepTriangle(1)), Some(Command::StepTriangle(1)));
    let mut lab = open(Page::Lines);
    let all = lab.recording.steps.len();
    assert_eq!(lab.step, all, "a page begins with its finished picture");
    assert_eq!(give(&mut lab, Command::LimitTriangles(Some(0))), None);
    assert_eq!(lab.step, 0);
    give(&mut lab, Command::StepTriangle(1));
    give(&mut lab, Command::NudgePick(1, 0));
    assert_eq!(lab.step, 2);
    give(&mut lab, Command::StepTriangle(-9));
    assert_eq!(lab.step, 0);
    give(&mut lab, Command::LimitTriangles(None));
    assert_eq!(lab.step, all);
    assert_eq!(give(&mut lab, Command::ChooseUpscaler(3)), None, "it has no meaning in the lab");
    assert_eq!(give(&mut lab, Command::Undo), None, "undo would change settings that are not visible");
    assert_eq!(
        give(&mut lab, Command::Appearance(AppearanceChange::ToggleTheme)),
        Some(Command::Appearance(AppearanceChange::ToggleTheme))
    );
    assert_eq!(lab.claim(Command::File(FileCommand::SavePicture)), Some(Command::Lab(LabChange::Save("png"))));
    give(&mut lab, Command::File(FileCommand::OpenBuiltin("cubes".into())));
    assert!(!lab.open, "opening a scene closes the lab");
}

#[test]
fn an_opened_picture_becomes_the_canvas() {
    let path = PathBuf::from("drawn.PNG");
    let mut lab = open(Page::Lines);
    let asked = lab.claim(Command::File(FileCommand::Open(path.clone())));
    assert_eq!(asked, Some(Command::Lab(LabChange::Picture(path.clone()))), "the session reads the file");
    lab.show_picture(&Image::filled(8, 8, [0, 0, 0, 255]));
    assert_eq!(lab.page, Page::Sampling, "lines have no canvas");
    lab.apply(LabChange::Page(Page::SeedFill));
    let before = lab.lesson().clone();
    lab.show_picture(&Image::filled(8, 8, [0, 0, 0, 255]));
    assert!(lab.page == Page::SeedFill && *lab.lesson() != before);
    let mut closed = Lab::default();
    assert_eq!(
        give(&mut closed, Command::File(FileCommand::Open(path.clone()))),
        Some(Command::File(FileCommand::Open(path)))
    );
}

#[test]
fn playback_stops_at_either_end() {
    let mut lab = open(Page::SeedFill);
    let all = lab.recording.steps.len();
    lab.apply(LabChange::Speed(10.0));
    lab.apply(LabChange::TogglePlay);
    assert_eq!((lab.step, lab.playing), (0, 1), "playing at the end restarts from the beginning");
    lab.apply(LabChange::Tick(0.05));
    assert_eq!(lab.step, 0, "half a step does not advance");
    lab.apply(LabChange::Tick(0.05));
    assert_eq!(lab.step, 1);
    (0..1_000).for_each(|_| drop(lab.apply(LabChange::Tick(0.2))));
    assert_eq!((lab.step, lab.playing), (all, 0));
    lab.apply(LabChange::Play(-1));
    lab.apply(LabChange::Tick(0.2));
    assert_eq!(lab.step, all - 2);
    (0..1_000).for_each(|_| drop(lab.apply(LabChange::Tick(0.2))));
    assert_eq!((lab.step, lab.playing), (0, 0));
}

#[test]
fn pages_keep_their_changes_until_they_are_reset() {
    let mut lab = open(Page::Lines);
    let first = lab.lesson().clone();
    let mut lesson = first.clone();
    lesson.move_handle(0, glam::DVec2::new(9.5, 9.5));
    lab.apply(LabChange::Set(Box::new(lesson.clone())));
    assert_ne!(lesson, first);
    lab.apply(LabChange::Page(Page::Circles));
    assert_eq!(lab.lesson().page(), Page::Circles);
    lab.apply(LabChange::Page(Page::Lines));
    assert_eq!(*lab.lesson(), lesson);
    assert_eq!(*lab.recording, lesson.record());
    lab.apply(LabChange::Reset);
    assert_eq!(*lab.lesson(), first);
}
