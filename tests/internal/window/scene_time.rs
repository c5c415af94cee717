//! Tests of the time of animated scenes in the window.

use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers};
use rasterscope::chain::KeepDepth;
use rasterscope::inspect::{Buffer, view};
use rasterscope::measure::shot::{CameraMotion, Shot, ShotInputs, ShotRenderer};
use rasterscope::measure::stages::StageTimes;
use rasterscope::scene::{SceneSource, builtin};
use rasterscope::ui::engine::{Engine, Shown};
use rasterscope::ui::format;
use rasterscope::ui::session::PictureSize;
use rasterscope::ui::session::camera_path::CameraPathChange;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::compare::{CompareChange, Mode};
use rasterscope::ui::session::scene_time::SceneTimeChange;
use rasterscope::ui::worker::{Worker, WorkerRequest, WorkerResponse};
use rasterscope::upscale::Upscaling;

use super::bench::Bench;

fn apply(bench: &mut Bench, change: SceneTimeChange) {
    bench.window.state_mut().queue(vec![Command::SceneTime(change)]);
    bench.rest();
}

#[test]
fn steps_and_jumps_pose_the_scene_at_the_time_of_a_frame() {
    let mut bench = Bench::small("chess-motion");
    let first = bench.image();
    bench.press_with(Modifiers::ALT, Key::Period);
    assert_eq!((bench.session().scene_frame(), bench.session().scene.time_s()), (1, 1.0 / 30.0));
    bench.click("Show the next frame of the scene  (Alt+.)");
    assert!(bench.mentions("0.07 s"));
    assert!(bench.image() != first, "objects have moved");
    assert!(bench.image() == *bench.expected().image());
    apply(&mut bench, SceneTimeChange::FrameRate(60));
    assert_eq!(bench.session().scene_frame(), 4, "the time stays the same");
    apply(&mut bench, SceneTimeChange::Step(-5));
    let count = bench.session().scene_frame_count().unwrap();
    assert_eq!(bench.session().scene_frame(), count - 1, "before the beginning is the end");
    bench.click("Go to the first frame");
    assert!(bench.image() == first);
}

#[test]
fn playback_advances_by_single_frames_and_loops_or_stops() {
    let mut bench = Bench::small("chess-motion");
    let last = bench.session().scene_frame_count().unwrap() - 1;
    apply(&mut bench, SceneTimeChange::Go(last));
    let session = bench.session_mut();
    session.features.scene_time.is_playing = true;
    // However long a tick is, it shows the next frame at most.
    session.apply(Command::SceneTime(SceneTimeChange::Tick(10.0)));
    assert_eq!((session.scene_frame(), session.features.scene_time.is_playing), (0, true));
    // The frame must be on screen before the next one.
    session.apply(Command::SceneTime(SceneTimeChange::Tick(10.0)));
    assert_eq!(session.scene_frame(), 0);
    session.apply(Command::SceneTime(SceneTimeChange::Loop(false)));
    apply(&mut bench, SceneTimeChange::Go(last));
    let session = bench.session_mut();
    session.features.scene_time.is_playing = true;
    session.apply(Command::SceneTime(SceneTimeChange::Tick(10.0)));
    assert!(!session.features.scene_time.is_playing);
}

#[test]
fn motion_is_shown_since_the_preceding_frame_and_still_scenes_have_none() {
    let mut bench = Bench::small("chess-motion");
    apply(&mut bench, SceneTimeChange::Go(3));
    bench.session_mut().shown = Shown::Buffer(Buffer::MotionX);
    bench.rest();
    let shown = bench.view();
    let before = shown.frame.before.as_ref().unwrap();
    assert_eq!(before.scene.time_s(), 2.0 / 30.0);
    let (width, height) = shown.picture.size();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let value = |(x, y)| view::value(Buffer::MotionX, &shown.frame, shown.buffers.as_deref(), x, y);
    let moving = pixels.filter(|at| matches!(value(*at), view::Value::Number(px) if px != 0.0)).count();
    assert!(moving > 20 && moving < (width * height) as usize / 2, "{moving}");
    let mut still = Bench::small("triangle");
    assert!(still.session().scene_frame_count().is_none() && !still.mentions("Loop"));
    still.session_mut().shown = Shown::Buffer(Buffer::MotionX);
    still.rest();
    assert!(still.mentions("no motion: scene and camera are still"));
}

#[test]
fn a_frame_has_the_same_bits_however_it_is_reached() {
    let mut bench = Bench::small("chess-motion");
    bench.session_mut().state.size = PictureSize::Fixed(64, 36);
    bench.session_mut().state.recipe.upscaler = Upscaling::new("taa", 2).unwrap();
    bench.rest();
    let session = bench.session();
    let (scene, camera) = (Arc::clone(&session.scene), session.state.camera);
    let shot = Shot::from_start(scene, camera, CameraMotion::Still, 30.0);
    let inputs = |shot: Shot| ShotInputs { shot, recipe: session.state.recipe, viewport: session.viewport() };
    let frames = |shot: Shot| ShotRenderer::new(inputs(shot));
    let (mut expected, mut turned) = (frames(shot.clone()), {
        let mut camera = camera;
        camera.orbit(0.2, 0.0);
        frames(Shot { camera, ..shot })
    });
    let check = |bench: &Bench, number: u32, expected: &mut ShotRenderer| {
        let drawn = expected.draw(number, KeepDepth::No);
        assert_eq!(bench.session().scene_frame(), i64::from(number));
        assert!(bench.image() == *drawn.image() && !bench.view().needs_replay, "frame {number}");
    };
    check(&bench, 0, &mut expected);
    apply(&mut bench, SceneTimeChange::Go(4));
    check(&bench, 4, &mut expected);
    for (step, number) in [(1, 5), (-2, 3), (1, 4)] {
        apply(&mut bench, SceneTimeChange::Step(step));
        check(&bench, number, &mut expected);
    }
    bench.session_mut().features.scene_time.is_playing = true;
    for number in 5..7 {
        bench.session_mut().apply(Command::SceneTime(SceneTimeChange::Tick(10.0)));
        bench.session_mut().features.scene_time.is_playing = false;
        bench.rest();
        check(&bench, number, &mut expected);
    }
    // Other pictures of the same frame do not draw it again, other settings do.
    bench.session_mut().shown = Shown::Buffer(Buffer::MotionX);
    bench.rest();
    check(&bench, 6, &mut expected);
    let recipe = bench.session().state.recipe;
    bench.session_mut().state.recipe.upscaler = Upscaling::NATIVE;
    bench.rest();
    bench.session_mut().state.recipe = recipe;
    bench.rest();
    check(&bench, 6, &mut expected);
    bench.session_mut().state.camera.orbit(0.2, 0.0);
    bench.rest();
    check(&bench, 6, &mut turned);
    assert!(!bench.mentions("History of the frames shown"));
}

#[test]
fn a_recorded_path_has_the_frames_of_its_file() {
    let mut bench = Bench::small("triangle");
    bench.session_mut().state.recipe.upscaler = Upscaling::new("accumulation", 2).unwrap();
    for _ in 0..2 {
        bench.session_mut().apply(Command::CameraPath(CameraPathChange::Add));
        bench.session_mut().state.camera.orbit(0.4, 0.1);
    }
    bench.rest();
    apply(&mut bench, SceneTimeChange::Go(3));
    let session = bench.session();
    let path = session.features.camera_path.path();
    assert!(path.as_ref().is_some_and(|path| path.duration_s() == 2.0));
    let shot = Shot::from_start(Arc::clone(&session.scene), session.scene.home, CameraMotion::along(path), 30.0);
    let inputs = ShotInputs { shot, recipe: session.state.recipe, viewport: session.viewport() };
    let drawn = ShotRenderer::new(inputs).draw(3, KeepDepth::No);
    assert!(bench.image() == *drawn.image());
    assert_eq!(
        bench.view().frame.before.as_ref().map(|before| before.camera),
        drawn.before.map(|before| before.camera)
    );
}

#[test]
fn playback_along_a_path_waits_for_the_view_and_the_comparison() {
    let mut bench = Bench::small("triangle");
    for _ in 0..2 {
        bench.session_mut().apply(Command::CameraPath(CameraPathChange::Add));
        bench.session_mut().state.camera.orbit(0.4, 0.1);
    }
    bench.session_mut().apply(Command::Compare(CompareChange::Mode(Mode::Wipe)));
    apply(&mut bench, SceneTimeChange::Go(3));
    let (view, compared) = (bench.session().view.clone(), bench.session().features.comparison.compared.clone());
    apply(&mut bench, SceneTimeChange::Go(4));
    let session = bench.session_mut();
    session.features.scene_time.is_playing = true;
    let new = (session.view.clone(), session.features.comparison.compared.clone());
    for (view, compared) in [(new.0.clone(), compared), (view, new.1.clone())] {
        (session.view, session.features.comparison.compared) = (view, compared);
        session.apply(Command::SceneTime(SceneTimeChange::Tick(10.0)));
        assert_eq!(session.scene_frame(), 4, "a picture of frame 3 is on screen");
    }
    (session.view, session.features.comparison.compared) = new;
    session.apply(Command::SceneTime(SceneTimeChange::Tick(10.0)));
    assert_eq!(session.scene_frame(), 5);
}

#[test]
fn another_scene_ends_playback() {
    let mut bench = Bench::small("chess-motion");
    let session = bench.session_mut();
    session.features.scene_time.is_playing = true;
    let wheels = builtin::by_id("wheels").unwrap();
    session.show_scene(wheels.build(), SceneSource::Builtin(wheels));
    assert!(!session.features.scene_time.is_playing);
}

/// Starts a worker that draws frames and never times their stages, like one that has no time for it during playback.
fn drawing_worker() -> Worker {
    let (jobs, inbox) = channel();
    let (outbox, answers) = channel();
    std::thread::spawn(move || {
        let mut engine = Engine::default();
        for job in inbox {
            if let WorkerRequest::Show(request) = job
                && outbox.send(WorkerResponse::View(Box::new(engine.answer(*request)))).is_err()
            {
                return;
            }
        }
    });
    Worker::Thread { jobs, answers }
}

#[test]
fn stages_have_the_times_of_the_frames_that_play() {
    let mut bench = Bench::with_worker("chess-motion", drawing_worker());
    let begun = Instant::now();
    let wait = |bench: &mut Bench, what: &str, is_done: &dyn Fn(&Bench) -> bool| {
        while !is_done(bench) {
            assert!(begun.elapsed() < Duration::from_secs(20), "{what}");
            std::thread::sleep(Duration::from_millis(2));
            bench.window.step();
        }
    };
    wait(&mut bench, "the first frame is shown", &|bench| bench.session().view.is_some());
    assert!(bench.session().features.stages.times().is_none(), "the worker times no stages");
    bench.window.state_mut().queue(vec![Command::SceneTime(SceneTimeChange::TogglePlay)]);
    wait(&mut bench, "the stages have times", &|bench| bench.session().features.stages.times().is_some());
    assert!(bench.session().features.scene_time.is_playing);
    let times = bench.session().features.stages.times().unwrap();
    let recorded = StageTimes::recorded(&bench.view().request.recipe, &bench.view().frame);
    assert!(times.rasterize > Duration::ZERO && times.shade > Duration::ZERO);
    assert_eq!(times.frame, recorded.frame, "they are those of the first frame that plays");
    bench.window.step();
    for time in [times.transform, times.rasterize, times.shade, times.frame] {
        let text = format::ms(time.as_secs_f64() * 1e3);
        assert!(bench.says(&text), "{text}");
    }
}
