//! Checkpoints: saved histories of a shot, from which a frame is drawn again without all frames from frame 0 on.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use super::shot::{ShotInputs, ShotRenderer};
use crate::chain::{Frame, KeepDepth, SavedHistory};

/// Number of frames between two checkpoints. The frames directly before a frame that is drawn again are all saved.
pub const SPACING: u32 = 8;

/// Distance from the frame saved last, in frames, beyond which checkpoints are thinned out evenly. Nearer ones are
/// thinned out in proportion to their distance.
const NEAR: u32 = 4 * SPACING;

/// Maximum number of checkpoints, which limits the poses of the scene that small pictures keep.
const MOST: usize = 128;

/// Saved histories of one shot with one recipe and size, within a limit of memory.
#[derive(Debug)]
pub struct Checkpoints {
    inputs: Option<ShotInputs>,
    /// Histories, keyed by the number of frames that they hold.
    saved: BTreeMap<u32, Checkpoint>,
    /// Sum of the memory of all checkpoints, in bytes.
    bytes: usize,
    /// Maximum memory of all checkpoints, in bytes.
    limit: usize,
}

#[derive(Debug)]
struct Checkpoint {
    history: SavedHistory,
    bytes: usize,
}

impl Checkpoints {
    /// Creates an empty set of checkpoints that use at most `limit` bytes.
    pub fn within(limit: usize) -> Self {
        Self { inputs: None, saved: BTreeMap::new(), bytes: 0, limit }
    }

    /// Sets the maximum memory in bytes, and removes checkpoints that exceed it.
    pub fn limit(&mut self, limit: usize) {
        self.limit = limit;
        let last = self.saved.last_key_value().map_or(0, |(frames, _)| *frames);
        self.thin_out(last);
    }

    /// Returns the number of frames to draw before frame `number`. Starts from the nearest checkpoint, the `drawn` frames of
    /// a renderer, or frame 0.
    pub fn missing(&self, inputs: &ShotInputs, number: u32, drawn: u32) -> u32 {
        let nearest =
            self.saved.range(..=number).next_back().filter(|_| self.are_of(inputs)).map(|(frames, _)| *frames);
        let drawn = Some(drawn).filter(|drawn| *drawn <= number);
        number - nearest.max(drawn).unwrap_or(0)
    }

    /// Whether [`Self::catch_up`] is likely to complete the history of frame `number` soon: some of the frames of these inputs
    /// are known, and few are missing. After a change of the inputs, it draws no frames, because the next change may follow
    /// at once, as while the camera moves.
    pub fn is_near(&self, inputs: &ShotInputs, number: u32, drawn: u32) -> bool {
        let is_known = number == 0 || drawn > 0 || self.are_of(inputs) && !self.saved.is_empty();
        is_known && self.missing(inputs, number, drawn) <= SPACING
    }

    /// Completes the history of frame `number` if it [is near](Self::is_near), and stops after the first frame that ends
    /// later than `time` from now. Returns whether the history is complete.
    pub fn catch_up(&mut self, renderer: &mut ShotRenderer, number: u32, time: Duration) -> bool {
        if !self.is_near(renderer.inputs(), number, renderer.history_frames()) {
            return false;
        }
        let since = Instant::now();
        while self.warm_up(renderer, number) {
            if since.elapsed() >= time && renderer.history_frames() < number {
                return false;
            }
        }
        true
    }

    /// Draws frame `number` after the frames that are missing from its history, and saves the new history.
    pub fn draw(&mut self, renderer: &mut ShotRenderer, number: u32, keep_depth: KeepDepth) -> Frame {
        while self.warm_up(renderer, number) {}
        let frame = renderer.draw(number, keep_depth);
        self.save_spaced(renderer.inputs(), number + 1, renderer.history());
        frame
    }

    /// Draws one frame that is missing from the history of frame `number`, like [`ShotRenderer::warm_up`], but from the
    /// nearest checkpoint on. Saves the new history if frames near `number` are likely to need it.
    pub fn warm_up(&mut self, renderer: &mut ShotRenderer, number: u32) -> bool {
        self.discard_others(renderer.inputs());
        let drawn = renderer.history_frames();
        if let Some((frames, nearest)) = self.saved.range(..=number).next_back()
            && (drawn > number || drawn < *frames)
        {
            renderer.restore_history(*frames, nearest.history.clone());
        }
        let is_drawn = renderer.warm_up(number);
        let frames = renderer.history_frames();
        if let Some(history) = renderer.history().filter(|_| is_drawn && number - frames < SPACING) {
            self.insert(frames, history);
        } else if is_drawn {
            self.save_spaced(renderer.inputs(), frames, renderer.history());
        }
        is_drawn
    }

    /// Saves the history of `frames` frames if checkpoints should have this number of frames. Discards those of other
    /// inputs.
    pub fn save_spaced(&mut self, inputs: &ShotInputs, frames: u32, history: Option<SavedHistory>) {
        self.discard_others(inputs);
        if let Some(history) = history.filter(|_| frames.is_multiple_of(SPACING)) {
            self.insert(frames, history);
        }
    }

    /// Discards all checkpoints, and the scene that they show, unless they are those of `inputs`.
    pub fn keep_only(&mut self, inputs: Option<&ShotInputs>) {
        if !inputs.is_some_and(|inputs| self.are_of(inputs)) {
            *self = Self::within(self.limit);
        }
    }

    fn are_of(&self, inputs: &ShotInputs) -> bool {
        self.inputs.as_ref().is_some_and(|own| own.is_same(inputs))
    }

    fn discard_others(&mut self, inputs: &ShotInputs) {
        self.keep_only(Some(inputs));
        self.inputs.get_or_insert_with(|| inputs.clone());
    }

    fn insert(&mut self, frames: u32, history: SavedHistory) {
        let Some(inputs) = &self.inputs else { return };
        let bytes = history.bytes(&inputs.shot.scene);
        self.bytes += bytes;
        let old = self.saved.insert(frames, Checkpoint { history, bytes });
        self.bytes -= old.map_or(0, |old| old.bytes);
        self.thin_out(frames);
    }

    /// Removes checkpoints until they are within the limits. `last` is the number of frames of the one saved last.
    fn thin_out(&mut self, last: u32) {
        while self.bytes > self.limit || self.saved.len() > MOST {
            let Some(removed) = self.least_useful(last).and_then(|frames| self.saved.remove(&frames)) else { return };
            self.bytes -= removed.bytes;
        }
    }

    /// Returns the key of the checkpoint without which the fewest frames are missing, relative to its distance from the
    /// one saved last.
    fn least_useful(&self, last: u32) -> Option<u32> {
        let keys: Vec<u32> = self.saved.keys().copied().collect();
        let usefulness = |place: usize| {
            let before = place.checked_sub(1).map_or(0, |before| keys[before]);
            let after = keys.get(place + 1).copied().unwrap_or(keys[place] + SPACING);
            f64::from(after - before) / f64::from(keys[place].abs_diff(last).clamp(1, NEAR))
        };
        (0..keys.len()).min_by(|a, b| usefulness(*a).total_cmp(&usefulness(*b))).map(|place| keys[place])
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::image::{Image, Rgba8};
    use crate::measure::shot::{CameraMotion, Shot};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::{CameraPath, builtin};
    use crate::upscale::Upscaling;

    const FRAMES: u32 = 44;

    fn inputs(scene: &str, method: &str) -> ShotInputs {
        let scene = Arc::new(builtin::by_id(scene).unwrap().build());
        let motion = CameraMotion::along(CameraPath::preset("turntable"));
        let recipe = Recipe { upscaler: Upscaling::new(method, 2).unwrap(), ..Recipe::default() };
        let shot = Shot::from_start(Arc::clone(&scene), scene.home, motion, 30.0);
        ShotInputs { shot, recipe, viewport: Viewport { width: 32, height: 18 } }
    }

    /// Draws a frame from the nearest checkpoint on. Returns the picture and the number of frames drawn before it.
    fn draw(checkpoints: &mut Checkpoints, renderer: &mut ShotRenderer, number: u32) -> (Image<Rgba8>, u32) {
        let mut missing = 0;
        while checkpoints.warm_up(renderer, number) {
            missing += 1;
        }
        (checkpoints.draw(renderer, number, KeepDepth::No).image().clone(), missing)
    }

    /// Frames drawn one after the other, without checkpoints.
    fn consecutive(inputs: &ShotInputs) -> Vec<Image<Rgba8>> {
        let mut renderer = ShotRenderer::new(inputs.clone());
        (0..FRAMES).map(|number| renderer.draw(number, KeepDepth::No).image().clone()).collect()
    }

    fn bytes_of_one(inputs: &ShotInputs) -> usize {
        let mut renderer = ShotRenderer::new(inputs.clone());
        renderer.draw(0, KeepDepth::No);
        renderer.history().unwrap().bytes(&inputs.shot.scene)
    }

    #[test]
    fn frames_are_those_of_consecutive_drawing_in_both_directions() {
        for (scene, method) in
            [("chess-motion", "taa"), ("walker", "fsr2"), ("chess", "sgsr2"), ("fence", "accumulation")]
        {
            let inputs = inputs(scene, method);
            let expected = consecutive(&inputs);
            for limit in [usize::MAX, 5 * bytes_of_one(&inputs)] {
                let mut checkpoints = Checkpoints::within(limit);
                let mut renderer = ShotRenderer::new(inputs.clone());
                let jumps = [20, 5, 43, 19, 20, 0, 18];
                for number in (0..FRAMES).chain((0..FRAMES).rev()).chain(jumps) {
                    let (picture, _) = draw(&mut checkpoints, &mut renderer, number);
                    assert!(picture == expected[number as usize], "{scene} {method} frame {number}");
                    assert!(checkpoints.bytes <= limit);
                }
            }
        }
    }

    #[test]
    fn few_frames_are_missing_before_the_preceding_frame() {
        let inputs = inputs("chess-motion", "taa");
        let mut checkpoints = Checkpoints::within(usize::MAX);
        let mut renderer = ShotRenderer::new(inputs.clone());
        let forwards: u32 = (0..FRAMES).map(|number| draw(&mut checkpoints, &mut renderer, number).1).sum();
        assert_eq!(forwards, 0);
        let backwards: Vec<_> =
            (0..FRAMES - 1).rev().map(|number| draw(&mut checkpoints, &mut renderer, number).1).collect();
        assert!(backwards.iter().all(|missing| *missing < SPACING), "{backwards:?}");
        assert!(backwards.iter().sum::<u32>() <= FRAMES, "each frame is drawn at most once more: {backwards:?}");
    }

    #[test]
    fn within_a_limit_near_frames_keep_more_checkpoints_than_distant_ones() {
        let inputs = inputs("chess-motion", "taa");
        let one = bytes_of_one(&inputs);
        let mut checkpoints = Checkpoints::within(4 * one);
        let mut renderer = ShotRenderer::new(inputs.clone());
        for number in 0..FRAMES + 40 {
            draw(&mut checkpoints, &mut renderer, number);
        }
        let keys: Vec<_> = checkpoints.saved.keys().copied().collect();
        assert_eq!(keys.len(), 4);
        assert_eq!(keys.last(), Some(&(FRAMES + 36)));
        assert!(keys.windows(2).map(|pair| pair[1] - pair[0]).is_sorted_by(|a, b| a >= b), "{keys:?}");
        checkpoints.limit(one);
        assert_eq!((checkpoints.saved.len(), checkpoints.bytes), (1, one));
    }

    #[test]
    fn other_inputs_discard_all_checkpoints() {
        let inputs = inputs("chess-motion", "taa");
        let filled = || {
            let mut checkpoints = Checkpoints::within(usize::MAX);
            let mut renderer = ShotRenderer::new(inputs.clone());
            for number in 0..20 {
                draw(&mut checkpoints, &mut renderer, number);
            }
            assert_eq!(checkpoints.missing(&inputs, 20, 0), 4);
            checkpoints
        };
        let mut turned = inputs.clone();
        turned.shot.camera.orbit(0.1, 0.0);
        let mut other_recipe = inputs.clone();
        other_recipe.recipe.set("shading=normals").unwrap();
        let mut other_size = inputs.clone();
        other_size.viewport.width += 1;
        let other_path =
            ShotInputs { shot: Shot { motion: CameraMotion::Still, ..inputs.shot.clone() }, ..inputs.clone() };
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let other_scene = ShotInputs { shot: Shot { scene, ..inputs.shot.clone() }, ..inputs.clone() };
        for other in [turned, other_recipe, other_size, other_path, other_scene] {
            let mut checkpoints = filled();
            assert_eq!(checkpoints.missing(&other, 20, 0), 20);
            let expected = ShotRenderer::new(other.clone()).draw(20, KeepDepth::No).image().clone();
            let (picture, missing) = draw(&mut checkpoints, &mut ShotRenderer::new(other), 20);
            assert!(missing == 20 && picture == expected);
            assert_eq!(checkpoints.missing(&inputs, 20, 0), 20, "those of the first inputs are gone");
        }
    }

    #[test]
    fn only_known_inputs_catch_up_and_only_within_the_time() {
        let inputs = inputs("chess-motion", "taa");
        let mut checkpoints = Checkpoints::within(usize::MAX);
        let mut renderer = ShotRenderer::new(inputs.clone());
        assert!(!checkpoints.catch_up(&mut renderer, 5, Duration::MAX));
        assert_eq!((renderer.history_frames(), checkpoints.missing(&inputs, 5, 0)), (0, 5), "nothing was drawn");
        assert!(checkpoints.catch_up(&mut renderer, 0, Duration::ZERO), "frame 0 has no history");
        checkpoints.draw(&mut renderer, 0, KeepDepth::No);
        assert!(!checkpoints.catch_up(&mut renderer, 5, Duration::ZERO));
        assert_eq!(renderer.history_frames(), 2);
        assert!(checkpoints.catch_up(&mut renderer, 3, Duration::ZERO), "the last missing frame completes the history");
        assert!(checkpoints.catch_up(&mut renderer, 5, Duration::MAX));
        assert!(!checkpoints.catch_up(&mut renderer, 14, Duration::MAX), "too many frames are missing");
        assert_eq!(renderer.history_frames(), 5);
        let mut other = ShotRenderer::new(inputs.clone());
        assert!(checkpoints.catch_up(&mut other, 4, Duration::ZERO), "the checkpoints belong to these inputs");
        let picture = checkpoints.draw(&mut other, 4, KeepDepth::No).image().clone();
        assert!(picture == consecutive(&inputs)[4]);
        checkpoints.keep_only(Some(&inputs));
        assert_eq!(checkpoints.missing(&inputs, 4, 0), 0);
        checkpoints.keep_only(None);
        assert_eq!((checkpoints.missing(&inputs, 4, 0), checkpoints.bytes), (4, 0));
    }

    #[test]
    fn without_a_limit_of_memory_the_number_of_checkpoints_is_limited() {
        let inputs = inputs("chess-motion", "taa");
        let mut checkpoints = Checkpoints::within(usize::MAX);
        let mut renderer = ShotRenderer::new(inputs.clone());
        renderer.draw(0, KeepDepth::No);
        let last = 2 * MOST as u32 * SPACING;
        for frames in (SPACING..=last).step_by(SPACING as usize) {
            checkpoints.save_spaced(&inputs, frames, renderer.history());
        }
        assert_eq!(checkpoints.saved.len(), MOST);
        assert!(checkpoints.saved.contains_key(&last));
    }

    #[test]
    fn the_memory_of_a_checkpoint_contains_moved_meshes() {
        let rigid = bytes_of_one(&inputs("chess-motion", "taa"));
        let deformed = inputs("walker", "taa");
        assert!(bytes_of_one(&deformed) > rigid, "a deformed scene has meshes of its own in every pose");
    }
}
