//! Tests of the earlier frames of the picked pixel.

use std::sync::Arc;

use rasterscope::chain::{KeepDepth, RenderInputs, Renderer};
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::scene_time::SceneTimeChange;
use rasterscope::ui::session::temporal::TemporalChange;
use rasterscope::upscale::Upscaling;

use super::bench::Bench;

const PIXEL: (u32, u32) = (80, 45);

fn run(bench: &mut Bench, command: Command) {
    bench.window.state_mut().queue(vec![command]);
    bench.rest();
}

#[test]
fn earlier_frames_are_those_of_the_sequence_however_the_frame_is_reached() {
    let mut bench = Bench::small("chess-motion");
    bench.session_mut().state.recipe.upscaler = Upscaling::new("taa", 2).unwrap();
    run(&mut bench, Command::SceneTime(SceneTimeChange::Go(4)));
    let there = bench.place_of(PIXEL);
    bench.click_at(there);
    bench.rest();
    let direct = bench.session().features.temporal.history.clone().unwrap();
    assert!(bench.mentions("Earlier frames") && bench.mentions("gives the bits of the pixel"));
    for frame in [2, 3, 4] {
        run(&mut bench, Command::SceneTime(SceneTimeChange::Go(frame)));
    }
    let session = bench.session();
    assert_eq!(session.features.temporal.history.as_ref(), Some(&direct));
    let (scene, state, size) = (Arc::clone(&session.scene), &session.state, session.viewport());
    let mut renderer = Renderer::default();
    for (number, shown) in (0..).zip(&direct.pixel_frames) {
        let posed = scene.at(f64::from(number) / 30.0);
        let frame = renderer.render(
            RenderInputs { scene: &posed, camera: &state.camera, recipe: &state.recipe, viewport: size },
            KeepDepth::No,
        );
        let [r, g, b, _] = frame.image().at(PIXEL.0, PIXEL.1);
        assert_eq!((shown.frame, shown.result), (number, [r, g, b]));
    }
    assert_eq!(direct.pixel_frames.len(), 5);
}

#[test]
fn a_hidden_section_and_a_method_without_history_draw_no_frames() {
    let mut bench = Bench::small("cubes");
    bench.session_mut().state.recipe.upscaler = Upscaling::new("accumulation", 1).unwrap();
    let there = bench.place_of(PIXEL);
    bench.click_at(there);
    bench.rest();
    let history = bench.session().features.temporal.history.as_ref().unwrap();
    assert_eq!(history.pixel_frames.len(), 16, "a still view converges after 16 frames");
    run(&mut bench, Command::Temporal(TemporalChange::Toggle));
    assert!(bench.session().features.temporal.history.is_none() && bench.mentions("Earlier frames"));
    run(&mut bench, Command::Temporal(TemporalChange::Toggle));
    assert!(bench.session().features.temporal.history.is_some());
    bench.session_mut().state.recipe.upscaler = Upscaling::NATIVE;
    bench.rest();
    assert!(bench.session().features.temporal.history.is_none() && !bench.mentions("Earlier frames"));
}
