use std::sync::Arc;

use super::filter::PastFilter;
use super::steps::FrameSteps;
use super::*;
use crate::chain::{Frame, MotionBuffers, Recipe, Renderer};
use crate::measure::shot::{CameraMotion, Shot};
use crate::pipeline::motion::FrameView;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::scene::{CameraPath, builtin};
use crate::upscale::{HistoryFilter, HistoryOptions, Rectification, Upscaling};

const SIZE: Viewport = Viewport { width: 48, height: 28 };

fn clip(scene: &str, upscaler: Upscaling, last: u32) -> HistoryClip {
    let scene = Arc::new(builtin::by_id(scene).unwrap().build());
    let path = CameraMotion::along(CameraPath::preset("turntable"));
    HistoryClip {
        view: ClipView::Moving(Shot::from_start(Arc::clone(&scene), scene.home, path, 30.0)),
        recipe: Recipe { upscaler, ..Recipe::default() },
        viewport: SIZE,
        last,
    }
}

fn frames(clip: &HistoryClip) -> Vec<Frame> {
    let mut renderer = Renderer::default();
    (0..=clip.last).map(|number| clip.draw(&mut renderer, number)).collect()
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y)))
}

fn found(clip: HistoryClip, pixel: (u32, u32)) -> PixelHistory {
    let mut search = TemporalSearch::new(clip, pixel).unwrap();
    while search.step() {}
    search.finish()
}

/// Methods with history, with every filter and with locks.
fn methods() -> Vec<Upscaling> {
    let mut methods: Vec<_> = Upscaling::every().filter(|how| how.upscaler().reads().history).collect();
    let taa = Upscaling::new("taa", 2).unwrap();
    methods.push(taa.with_history(HistoryOptions { filter: HistoryFilter::Bilinear, ..HistoryOptions::DEFAULT }));
    methods
}

/// Checks that every `step`-th pixel of every frame is blended from the filtered history and that the upscaler stored
/// the blended colour. By induction, the chain of steps then gives the bits of every pixel.
fn check_links(clip: &HistoryClip, step: usize) {
    let how = clip.recipe.upscaler;
    let frames = frames(clip);
    let mut read = 0;
    for (number, pair) in frames.windows(2).enumerate() {
        let [frame, next] = pair else { continue };
        let stored = next.history.as_deref().unwrap();
        let drawn = frame.as_drawn(&frame.drawn.color);
        let steps = FrameSteps::new(how, &drawn, (SIZE.width, SIZE.height), Some(stored));
        for at in pixels().skip(number % step).step_by(step) {
            let what = || format!("{} frame {number} {at:?}", how.label());
            let Some(found) = steps.at(at) else {
                assert_eq!(frame.blended_codes(at), stored.color(at), "{}", what());
                continue;
            };
            if stored.accumulated.is_some() {
                assert_eq!(found.step.blended(), stored.color(at), "{}", what());
            } else {
                assert_eq!(found.step.codes().map(f32::from), stored.color(at), "{}", what());
            }
            let (Ok(past), Some(history)) = (&found.step.past, frame.history.as_deref()) else { continue };
            let filter = PastFilter::new(how, past, (SIZE.width, SIZE.height), steps.is_still);
            assert_eq!(history.rounded(filter.read(|at| history.color(at))), past.read, "{}", what());
            read += 1;
        }
    }
    assert!(read > 100, "{}: {read}", how.label());
}

#[test]
fn every_link_of_the_chain_has_the_bits_of_the_upscaler() {
    let taa = Upscaling::new("taa", 2).unwrap();
    for scene in ["chess-motion", "cubes"] {
        check_links(&clip(scene, taa, 10), 1);
    }
    for how in methods() {
        check_links(&clip("chess-motion", how, 4), 7);
    }
}

#[test]
fn samples_changes_and_rest_add_up_to_the_pixel() {
    for how in methods() {
        for pixel in [(31, 9), (25, 20)] {
            let Some(past) = found(clip("chess-motion", how, 4), pixel).past_frames else { continue };
            assert!(past.is_reproduced, "{} {pixel:?}", how.label());
            let shares: f64 = past.frames.iter().map(|frame| frame.share).sum();
            assert!((shares + past.rest - 1.0).abs() < 1e-5, "{} {pixel:?}: {shares}", how.label());
            let white = if how.light() == crate::upscale::FilterSpace::Bytes { 255.0 } else { 1.0 };
            for channel in 0..3 {
                let of = |frame: &FrameShare| frame.samples[channel] + frame.rectification[channel];
                let sum = past.frames.iter().map(of).sum::<f64>() + past.rest_color[channel];
                let error = (sum - f64::from(past.color[channel])).abs();
                assert!(error < 1e-5 * white, "{} {pixel:?}: {sum} {:?}", how.label(), past.color);
            }
        }
    }
}

#[test]
fn a_still_view_weights_all_frames_alike() {
    let scene = Arc::new(builtin::by_id("chess").unwrap().build());
    let view = ClipView::Still { camera: scene.home, scene };
    let recipe = Recipe { upscaler: Upscaling::new("accumulation", 1).unwrap(), ..Recipe::default() };
    let history = found(HistoryClip { view, recipe, viewport: SIZE, last: 7 }, (24, 14));
    let past = history.past_frames.unwrap();
    assert_eq!(past.frames.len(), 8);
    for (frame, number) in past.frames.iter().zip((0..8).rev()) {
        assert_eq!((frame.frame, frame.pixels, frame.position_px), (number, 1, [24.5, 14.5]));
        assert!((frame.share - 0.125).abs() < 1e-6 && frame.rectification == [0.0; 3], "{frame:?}");
    }
    assert_eq!(history.pixel_frames.len(), 8);
    // Without motion, the picture of a frame is the mean of all samples up to it.
    let [first, second] = [&history.pixel_frames[0], &history.pixel_frames[1]];
    assert_eq!((first.history, first.result), (None, first.samples));
    assert_eq!((second.history, second.share), (Some(first.result), 0.5));
}

#[test]
fn following_in_parts_gives_the_same_chain() {
    let clip = clip("chess-motion", Upscaling::new("taa", 2).unwrap(), 9);
    let drawn = frames(&clip);
    let mut whole = chain::Chain::new(clip.recipe.upscaler, (26, 14));
    for (number, frame) in (0..10).zip(&drawn).rev() {
        let stored = drawn.get(number as usize + 1).and_then(|next| next.history.as_deref());
        whole.follow(number, frame, stored);
    }
    let mut search = TemporalSearch::new(clip, (26, 14)).unwrap();
    search.limit_frames_together(3);
    while search.step() {}
    assert_eq!(whole.finish(None), search.finish().past_frames);
}

#[test]
fn without_rectification_old_frames_decay_by_the_published_share() {
    let options = HistoryOptions { rectification: Rectification::None, ..HistoryOptions::DEFAULT };
    let how = Upscaling::new("taa", 1).unwrap().with_history(options);
    let past = found(clip("chess-motion", how, 30), (24, 20)).past_frames.unwrap();
    // Once the history has the maximum weight, a frame has 1/10 of the pixel, and 9/10 of that in each later frame.
    for (frame, age) in past.frames.iter().zip(0..12) {
        let expected = 0.1 * 0.9_f64.powi(age);
        assert!((frame.share - expected).abs() < 0.15 * expected, "{age}: {frame:?}");
    }
}

#[test]
fn masks_and_scores_agree_with_counting_steps() {
    for how in
        [("taa", 2), ("fsr2", 2), ("checkerboard-temporal", 1)].map(|(id, scale)| Upscaling::new(id, scale).unwrap())
    {
        let clip = clip("chess-motion", how, 5);
        let frame = frames(&clip).pop().unwrap();
        let [(scene, camera), (scene_before, camera_before)] = [5, 4].map(|number| clip.view.at(number));
        let now = FrameView { scene: &scene, camera: &camera };
        let before = FrameView { scene: &scene_before, camera: &camera_before };
        let motion = MotionBuffers::between(now, before, &clip.recipe, SIZE).unwrap();
        let masks = HistoryMasks::of(&scene, &clip.recipe, &frame).unwrap();
        let inputs = frame.as_drawn(&frame.drawn.color);
        let mut counts = [[0; 2]; 2];
        for at in pixels() {
            let step = how.upscaler().history_steps(how, &inputs)(at);
            let is_rejected = step.is_some_and(|step| step.past.is_err());
            let is_clamped = step.is_some_and(|step| step.past.is_ok_and(|past| past.read != past.rectified));
            let is_stale = motion.is_disoccluded(at.0, at.1);
            assert_eq!(masks.is_disoccluded(at), is_stale, "{at:?}");
            assert_eq!(masks.contains(HistoryMask::Rejected, at), is_rejected, "{at:?}");
            assert_eq!(masks.contains(HistoryMask::Rectified, at), is_clamped, "{at:?}");
            counts[usize::from(is_rejected)][usize::from(is_stale)] += 1;
        }
        let [[_, missed], [wrong, right]] = counts;
        let score = masks.score(HistoryMask::Rejected);
        assert_eq!((score.marked, score.disoccluded, score.both), (right + wrong, right + missed, right));
        assert!(right > 0, "{}", how.label());
        assert_eq!(
            MaskScore::of_rejection(&clip.recipe, &frame, |at| motion.is_disoccluded(at.0, at.1), u32::MAX),
            Some(score)
        );
        // Every second row and column: 336 of 1344 pixels.
        let spaced = pixels().filter(|(x, y)| x % 2 == 0 && y % 2 == 0);
        let marked = spaced.filter(|at| masks.contains(HistoryMask::Rejected, *at)).count() as u32;
        assert_eq!(
            MaskScore::of_rejection(&clip.recipe, &frame, |_| false, 400).map(|score| score.marked),
            Some(marked)
        );
        let has_locks = masks.score(HistoryMask::Locked).marked > 0;
        assert_eq!(has_locks, how.method() == "fsr2", "{}", how.label());
    }
    let still = clip("chess-motion", Upscaling::new("taa", 2).unwrap(), 0);
    let (scene, _) = still.view.at(0);
    assert!(HistoryMasks::of(&scene, &still.recipe, &frames(&still)[0]).is_none());
    assert!(MaskScore::of_rejection(&still.recipe, &frames(&still)[0], |_| false, u32::MAX).is_none());
    assert_eq!(MaskScore { mask: HistoryMask::Locked, marked: 0, disoccluded: 4, both: 0 }.precision(), None);
    assert_eq!(MaskScore { mask: HistoryMask::ALL[0], marked: 2, disoccluded: 4, both: 1 }.recall(), Some(0.25));
}

#[test]
fn outcomes_are_told_with_their_reason() {
    let history = found(clip("chess-motion", Upscaling::new("taa", 2).unwrap(), 8), (20, 14));
    let past = history.past_frames.unwrap();
    assert!(past.remark().contains("gives the bits"), "{}", past.remark());
    let first = past.frames.last().unwrap();
    assert!(first.frame == 0 && first.outcome(past.space).contains("there is no previous frame"), "{first:?}");
    assert_eq!(history.masks.len(), HistoryMask::ALL.len());
}

#[test]
fn methods_without_history_and_pixels_outside_have_no_search() {
    assert!(TemporalSearch::new(clip("cubes", Upscaling::NATIVE, 2), (0, 0)).is_none());
    assert!(TemporalSearch::new(clip("cubes", Upscaling::new("taa", 1).unwrap(), 2), (48, 0)).is_none());
}
