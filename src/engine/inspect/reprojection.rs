//! Reprojection error: difference between the colour of a pixel and the colour at its position in the preceding frame.

use crate::chain::{Frame, MotionBuffers, Recipe};
use crate::image::{Image, Rgba8};
use crate::scene::Scene;

/// Position of every rasterized pixel in the preceding frame, in pixels of that frame from the top left corner.
pub(super) fn previous_position_px(motion: &MotionBuffers, (x, y): (u32, u32)) -> [f32; 2] {
    let [across, down] = motion.vector_px(x, y);
    [x as f32 + 0.5 + across, y as f32 + 0.5 + down]
}

/// Returns the reprojection error of every rasterized pixel in sRGB codes: the largest absolute difference of the
/// channels between its colour and the bilinearly filtered colour at its position in the preceding frame. NaN if the
/// position is outside that frame. Both frames are drawn without history, anti-aliasing and post filter. Returns `None`
/// if no frame precedes.
pub(super) fn errors(scene: &Scene, recipe: &Recipe, frame: &Frame, motion: &MotionBuffers) -> Option<Image<f32>> {
    let [now, before] = frame.colors_of_both(scene, recipe)?;
    let (width, height) = now.size();
    Some(Image::from_fn(width, height, |x, y| {
        let read = bilinear(&before, previous_position_px(motion, (x, y)));
        read.map_or(f32::NAN, |read| largest_difference(now.at(x, y), read))
    }))
}

fn largest_difference(codes: Rgba8, read: [f32; 3]) -> f32 {
    codes.into_iter().zip(read).map(|(code, read)| (f32::from(code) - read).abs()).fold(0.0, f32::max)
}

/// Returns the colour at a position in pixels, in sRGB codes; `None` outside the picture. The border is repeated.
fn bilinear(picture: &Image<Rgba8>, [x, y]: [f32; 2]) -> Option<[f32; 3]> {
    let (width, height) = picture.size();
    // NaN fails every comparison, so it is not inside.
    let is_inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32;
    if !is_inside {
        return None;
    }
    let [(left, right), (top, down)] = [x, y].map(|at| {
        let floor = (at - 0.5).floor();
        (floor as i64, at - 0.5 - floor)
    });
    let weighted = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(across, along)| {
        let horizontal = if across == 1 { right } else { 1.0 - right };
        let vertical = if along == 1 { down } else { 1.0 - down };
        (picture.at_clamped(left + across, top + along), horizontal * vertical)
    });
    let channel = |index: usize| weighted.iter().map(|(color, weight)| f32::from(color[index]) * weight).sum();
    Some([0, 1, 2].map(channel))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::{PrecedingView, run};
    use crate::inspect::Buffer;
    use crate::inspect::buffers::capture;
    use crate::inspect::view::{Value, range, value};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 64, height: 36 };

    #[test]
    fn previous_positions_and_errors_agree_with_two_pictures() {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let (first, second) = (scene.at(0.5), scene.at(0.6));
        let mut camera = scene.home;
        camera.orbit(0.03, 0.01);
        let recipe = Recipe::default();
        let before = run(&first, &scene.home, &recipe, SIZE, &mut ());
        let mut now = run(&second, &camera, &recipe, SIZE, &mut ());
        now.before = Some(PrecedingView { scene: first, camera: scene.home });
        let buffers = capture(&second, &recipe, &now);
        let buffers = buffers.completed_for(Buffer::ReprojectionError, &second, &recipe, &now);
        let number = |buffer, (x, y)| match value(buffer, &now, Some(&buffers), x, y) {
            Value::Number(number) => Some(f64::from(number)),
            _ => None,
        };
        let (mut inside, mut outside) = (0, 0);
        for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
            let at = (x, y);
            let place = [Buffer::PreviousX, Buffer::PreviousY].map(|buffer| number(buffer, at).unwrap());
            let motion = [Buffer::MotionX, Buffer::MotionY].map(|buffer| number(buffer, at).unwrap());
            assert!((place[0] - motion[0] - f64::from(x) - 0.5).abs() < 1e-5, "{at:?}");
            assert!((place[1] - motion[1] - f64::from(y) - 0.5).abs() < 1e-5, "{at:?}");
            let is_inside = (0.0..64.0).contains(&place[0]) && (0.0..36.0).contains(&place[1]);
            let error = number(Buffer::ReprojectionError, at);
            assert_eq!(error.is_some(), is_inside, "{at:?}");
            outside += u32::from(!is_inside);
            let Some(error) = error else { continue };
            inside += 1;
            let mut read = [0.0; 3];
            for (i, j) in (0..2).flat_map(|j| (0..2).map(move |i| (i, j))) {
                let corner = place.map(|at| (at - 0.5).floor());
                let corner = [corner[0] + f64::from(i), corner[1] + f64::from(j)];
                let weight = (1.0 - (place[0] - 0.5 - corner[0]).abs()) * (1.0 - (place[1] - 0.5 - corner[1]).abs());
                let color = before.image().at_clamped(corner[0] as i64, corner[1] as i64);
                (0..3).for_each(|channel| read[channel] += weight * f64::from(color[channel]));
            }
            let own = now.image().at(x, y);
            let expected = (0..3).map(|channel| (f64::from(own[channel]) - read[channel]).abs()).fold(0.0, f64::max);
            assert!((error - expected).abs() < 0.01, "{at:?}: {error} {expected}");
        }
        assert!(inside > 1000 && outside > 10, "{inside} {outside}");
        let range = range(Buffer::ReprojectionError, &now, Some(&buffers)).unwrap();
        assert!(range.low == 0.0 && range.high > 20.0, "{range:?}");
    }
}
