use clap::CommandFactory as _;

use crate::inspect::display::Display;
use crate::inspect::{Buffer, InspectionState, Intermediate, Stage};
use crate::pipeline::settings::Choice as _;
use crate::scene::{Projection, SceneSource};

use super::*;

/// Splits a line into words like a shell. Text in single quotes is literal, and so is a character after a backslash.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let (mut quoted, mut letters) = (false, line.chars());
    while let Some(letter) = letters.next() {
        let last = words.len() - 1;
        match letter {
            '\'' => quoted = !quoted,
            '\\' if !quoted => words[last].extend(letters.next()),
            ' ' if !quoted => words.push(String::new()),
            _ => words[last].push(letter),
        }
    }
    words
}

/// Parses a command line and returns the state that the window starts with.
fn arrive(line: &str) -> InspectionState {
    let cli = Cli::try_parse_from(words(line)).unwrap();
    let Some(CliCommand::Window(args)) = cli.command else { panic!("it opens the window") };
    let view = args.scene.view().unwrap();
    InspectionState {
        scene: view.source.name(),
        mirrored: view.mirrored,
        time_s: view.scene.time_s(),
        camera: view.camera,
        recipe: view.recipe,
        picture: args.seen.picture.map(|size| (size.width, size.height)),
        buffer: match args.seen.buffer {
            Some(parse::Either::First(buffer)) => buffer,
            _ => Buffer::Color,
        },
        stage: args.seen.stage,
        number: match args.seen.buffer {
            Some(parse::Either::Second(number)) => Some(number),
            _ => None,
        },
        display: args.seen.look.unwrap_or_default(),
        overlays: args.seen.overlay,
        triangles: args.seen.triangles,
        fragments: args.seen.fragments,
        pixel: args.at,
    }
}

fn places() -> Vec<InspectionState> {
    let camera = SceneSource::named("cubes".into()).load().unwrap().scene.home;
    let plain = InspectionState {
        scene: "cubes".into(),
        mirrored: false,
        time_s: 0.0,
        camera,
        recipe: crate::chain::Recipe::default(),
        picture: Some((320, 200)),
        buffer: Buffer::Color,
        stage: None,
        number: None,
        display: Display::default(),
        overlays: Vec::new(),
        triangles: None,
        fragments: None,
        pixel: None,
    };
    let mut turned =
        InspectionState { pixel: Some((3, 199)), buffer: Buffer::PerspectiveLambda, mirrored: true, ..plain.clone() };
    for _ in 0..7 {
        turned.camera.orbit(0.123, -0.045);
        turned.camera.dolly(0.97);
    }
    turned.recipe.set_all(&["upscaler.method=bicubic", "upscaler.scale=3", "light.direction=0.1,-7,1e-9"]).unwrap();
    let mut flat = InspectionState {
        stage: Some(Stage::Clip),
        buffer: Buffer::Color,
        display: "channels=gb".parse().unwrap(),
        overlays: vec!["wireframe".parse().unwrap()],
        triangles: Some(3),
        fragments: Some(2),
        ..turned.clone()
    };
    flat.camera.projection = Projection::Orthographic { height: 1.0 / 3.0 };
    let overlays = ["exact-owner", "facing=0.123", "triangle-size=0"].map(|text| text.parse().unwrap()).to_vec();
    let numbers = Intermediate::ALL.iter().map(|number| InspectionState {
        number: Some(*number),
        display: "range=-0.1..0.30000001,map=diverging,reversed".parse().unwrap(),
        overlays: overlays.clone(),
        ..plain.clone()
    });
    let numbers: Vec<_> = numbers.collect();
    let home = SceneSource::named("chess-motion".into()).load().unwrap().scene.home;
    let posed = InspectionState { scene: "chess-motion".into(), camera: home, time_s: 0.1, ..plain.clone() };
    [plain, turned, flat, posed].into_iter().chain(numbers).collect()
}

#[test]
fn a_copied_command_restores_the_same_state() {
    for place in places() {
        assert_eq!(arrive(&place.command_line()), place, "{}", place.command_line());
    }
}

#[test]
fn screenshot_render_and_pixel_accept_a_copied_command() {
    for place in places() {
        let line = InspectionState { pixel: Some((1, 2)), ..place }.command_line();
        for (command, more) in [("screenshot", "-o x.png"), ("render", "-o x.png"), ("pixel", "")] {
            let line = format!("{} {more}", line.replacen("window", command, 1));
            let cli = Cli::try_parse_from(words(line.trim_end()));
            assert!(cli.is_ok(), "{line}: {:?}", cli.err());
        }
    }
}

#[test]
fn an_invalid_camera_is_refused_with_the_reason() {
    let cli = Cli::try_parse_from(["rasterscope", "window", "--camera", r#"{"eye": [1, 2, 3]}"#]).unwrap();
    let Some(CliCommand::Window(args)) = cli.command else { panic!("it opens the window") };
    assert!(args.scene.view().unwrap_err().to_string().starts_with("--camera: missing field"));
}

#[test]
fn only_a_start_without_options_resumes_the_previous_state() {
    let takes_up = |line: &str| Cli::try_parse_from(words(line)).unwrap().start.view().unwrap().is_default;
    assert!(takes_up("rasterscope"));
    for asked in ["triangle", "--set wireframe=true", "--at 3,4", "--buffer depth", "--picture 320x200"] {
        assert!(!takes_up(&format!("rasterscope {asked}")), "{asked}");
    }
}

#[test]
fn every_command_has_a_summary_and_an_example_that_is_valid() {
    let commands = Cli::command();
    assert!(commands.get_subcommands().count() > 20);
    for command in commands.get_subcommands() {
        let name = command.get_name();
        let summary = command.get_about().unwrap_or_else(|| panic!("{name} has no summary")).to_string();
        assert!(summary.starts_with(char::is_uppercase) && !summary.contains("rguments"), "{name}: {summary}");
        let help = command.get_after_help().unwrap_or_else(|| panic!("{name} has no example")).to_string();
        let example = help.lines().next().and_then(|line| line.strip_prefix("Example: ")).unwrap_or_default();
        assert!(example.starts_with(&format!("rasterscope {name}")), "{name}: {example}");
        let parsed = Cli::try_parse_from(words(example));
        assert!(parsed.is_ok(), "{example}: {:?}", parsed.err());
    }
}
