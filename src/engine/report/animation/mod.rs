//! Animated pictures (GIF and APNG) of several methods over the frames of a clip, with their names in the picture.

mod encode;
mod letters;

use std::io;

use crate::chain::{KeepDepth, Recipe, RenderInputs, Renderer};
use crate::image::{Image, Rgba8};
use crate::measure::motion::Turn;
use crate::measure::shot::Shot;
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::Viewport;
use encode::Encoder;
use letters::{HEIGHT, Lettering};

/// Margin around a name, in pixels of its letters.
const MARGIN: u32 = 3;

/// Width of the gap between pictures side by side, in pixels.
const GAP_PX: u32 = 4;

/// Background of names and gaps.
const BACKGROUND: Rgba8 = [24, 24, 24, 255];

/// Colour of the letters that name a method.
const INK: Rgba8 = [240, 240, 240, 255];

/// Largest number of pixels of all frames of an animation. GIF and APNG have no means to store more in a file of sensible
/// size.
const MAX_PIXELS: u64 = 1 << 31;

choice! {
    /// Arrangement of the methods of an animation.
    pub Arrangement {
        SideBySide = "side-by-side", "Side by side", "All methods in every frame, from left to right.";
        InTurn = "in-turn", "In turn", "The whole clip by the first method, then by the next one, at the same place.";
    }
}

choice! {
    /// File format of an animation.
    pub AnimationFormat {
        Gif = "gif", "GIF", "256 colours per frame.";
        Apng = "png", "APNG", "Exact colours, in larger files.";
    }
}

/// Method of an animation.
#[derive(Clone, Debug)]
pub struct AnimatedMethod {
    /// Name in the picture.
    pub label: String,
    /// Recipe for drawing its frames.
    pub recipe: Recipe,
}

/// Content of an animation.
#[derive(Clone, Debug)]
pub struct AnimationPlan {
    /// Scene and camera of every frame.
    pub shot: Shot,
    /// Methods in the order of the animation, at least one.
    pub methods: Vec<AnimatedMethod>,
    /// Size of the picture of one method, in pixels.
    pub viewport: Viewport,
    /// Number of frames of the clip, at least 1.
    pub frames: u32,
    /// Arrangement of the methods.
    pub arrangement: Arrangement,
    /// Format in which the animation is written.
    pub format: AnimationFormat,
}

impl AnimationPlan {
    /// Returns the number of frames of the animation.
    fn total(&self) -> u32 {
        match self.arrangement {
            Arrangement::SideBySide => self.frames,
            Arrangement::InTurn => self.frames.saturating_mul(self.methods.len() as u32),
        }
    }

    /// Checks that there is something to draw and that the animation is not too large.
    ///
    /// # Errors
    /// Returns the reason.
    pub fn check(&self) -> Result<(), String> {
        if self.methods.is_empty() || self.frames == 0 {
            return Err("an animation has at least one method and one frame".to_owned());
        }
        let picture = u64::from(self.viewport.width) * u64::from(self.viewport.height);
        let pixels = picture.saturating_mul(u64::from(self.frames)).saturating_mul(self.methods.len() as u64);
        if pixels > MAX_PIXELS {
            return Err(format!("the animation has {pixels} pixels, at most {MAX_PIXELS} are possible"));
        }
        Ok(())
    }
}

/// Draws and encodes an animation that repeats endlessly. `go_on` receives the number of finished frames and their total,
/// and returns whether to continue. Returns `None` if it does not.
///
/// Methods with history draw [`Turn::WARM_UP`] frames before the clip, as in measurements.
///
/// # Errors
/// Returns an error if the plan fails its check or if a frame cannot be encoded.
pub fn animate(plan: &AnimationPlan, go_on: &mut dyn FnMut(u32, u32) -> bool) -> io::Result<Option<Vec<u8>>> {
    plan.check().map_err(io::Error::other)?;
    let groups: Vec<&[AnimatedMethod]> = match plan.arrangement {
        Arrangement::SideBySide => vec![&plan.methods[..]],
        Arrangement::InTurn => plan.methods.chunks(1).collect(),
    };
    let (mut encoder, mut finished) = (None, 0);
    for group in groups {
        let mut players: Vec<_> = group.iter().map(Player::new).collect();
        for number in 0..plan.frames {
            if !go_on(finished, plan.total()) {
                return Ok(None);
            }
            let pictures: Vec<_> = players.iter_mut().map(|player| player.draw(plan, number.into())).collect();
            let frame = side_by_side(&pictures);
            let encoder = match &mut encoder {
                Some(encoder) => encoder,
                none => none.insert(Encoder::new(plan, frame.size())?),
            };
            encoder.add(&frame)?;
            finished += 1;
        }
    }
    encoder.map(Encoder::finish).transpose()
}

/// Method whose frames are being drawn.
struct Player<'a> {
    method: &'a AnimatedMethod,
    renderer: Renderer,
    /// Number of the next frame of a method with history.
    next: i64,
}

impl<'a> Player<'a> {
    fn new(method: &'a AnimatedMethod) -> Self {
        let reads_history = method.recipe.upscaler.upscaler().reads().history;
        let next = if reads_history { -i64::from(Turn::WARM_UP) } else { 0 };
        Self { method, renderer: Renderer::default(), next }
    }

    /// Draws a frame with the name of the method above it. Numbers must ascend by 1 from 0 on.
    fn draw(&mut self, plan: &AnimationPlan, number: i64) -> Image<Rgba8> {
        loop {
            let (scene, camera) = plan.shot.view(self.next);
            let frame = self.renderer.render(
                RenderInputs { scene: &scene, camera: &camera, recipe: &self.method.recipe, viewport: plan.viewport },
                KeepDepth::No,
            );
            self.next += 1;
            let named = (self.next > number).then(|| named(frame.image(), &self.method.label));
            self.renderer.recycle(frame);
            if let Some(named) = named {
                return named;
            }
        }
    }
}

/// Returns a picture with a name in a strip above it. Letters are larger in larger pictures.
fn named(picture: &Image<Rgba8>, name: &str) -> Image<Rgba8> {
    let (width, height) = picture.size();
    let size = (width / 320).clamp(1, 4);
    let strip = (HEIGHT + 2 * MARGIN) * size;
    let mut named = Image::filled(width, strip + height, BACKGROUND);
    let first = strip as usize * width as usize;
    named.pixels_mut()[first..].copy_from_slice(picture.pixels());
    Lettering { text: name, corner: [MARGIN * size; 2], size, color: INK }.draw(&mut named);
    named
}

/// Returns pictures of equal size from left to right, with gaps between them.
fn side_by_side(pictures: &[Image<Rgba8>]) -> Image<Rgba8> {
    let (width, height) = pictures.first().map_or((1, 1), Image::size);
    let count = pictures.len().max(1) as u32;
    Image::from_fn(count * (width + GAP_PX) - GAP_PX, height, |x, y| {
        let (place, column) = (x / (width + GAP_PX), x % (width + GAP_PX));
        let picture = pictures.get(place as usize).filter(|_| column < width);
        picture.map_or(BACKGROUND, |picture| picture.at(column, y))
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::sync::Arc;

    use image::AnimationDecoder as _;
    use image::codecs::gif::GifDecoder;
    use image::codecs::png::PngDecoder;

    use super::*;
    use crate::measure::shot::CameraMotion;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    fn plan(arrangement: Arrangement, format: AnimationFormat) -> AnimationPlan {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let methods = [("native", 1), ("taa", 2)].map(|(method, scale)| {
            let upscaler = Upscaling::new(method, scale).unwrap();
            AnimatedMethod { label: upscaler.label(), recipe: Recipe { upscaler, ..Recipe::default() } }
        });
        AnimationPlan {
            shot: Shot::from_start(Arc::clone(&scene), scene.home, CameraMotion::Still, 30.0),
            methods: methods.to_vec(),
            viewport: Viewport { width: 64, height: 36 },
            frames: 2,
            arrangement,
            format,
        }
    }

    fn encoded(plan: &AnimationPlan) -> Vec<u8> {
        animate(plan, &mut |_, _| true).unwrap().unwrap()
    }

    /// Returns the pixels of a decoded frame from a column on, without the strip of the name.
    fn part(frame: &image::Frame, left: u32) -> Image<Rgba8> {
        let strip = HEIGHT + 2 * MARGIN;
        Image::from_fn(64, 36, |x, y| frame.buffer().get_pixel(left + x, strip + y).0)
    }

    /// Draws a frame of a method in the way of the measurements.
    fn expected(plan: &AnimationPlan, method: usize, number: i64) -> Image<Rgba8> {
        let mut renderer = Renderer::default();
        let recipe = plan.methods[method].recipe;
        let first = if method == 0 { number } else { -i64::from(Turn::WARM_UP) };
        let mut picture = None;
        for frame in first..=number {
            let (scene, camera) = plan.shot.view(frame);
            let frame = renderer.render(
                RenderInputs { scene: &scene, camera: &camera, recipe: &recipe, viewport: plan.viewport },
                KeepDepth::No,
            );
            picture = Some(frame.image().clone());
            renderer.recycle(frame);
        }
        picture.unwrap()
    }

    #[test]
    fn an_apng_has_the_pictures_of_both_methods_bit_for_bit() {
        let plan = plan(Arrangement::SideBySide, AnimationFormat::Apng);
        let decoder = PngDecoder::new(Cursor::new(encoded(&plan))).unwrap().apng().unwrap();
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 2);
        for (number, frame) in (0..).zip(&frames) {
            assert_eq!(frame.buffer().dimensions(), (2 * 64 + GAP_PX, 36 + HEIGHT + 2 * MARGIN));
            let (numerator, denominator) = frame.delay().numer_denom_ms();
            assert_eq!(30 * numerator, 1000 * denominator, "a thirtieth of a second");
            for (method, left) in [(0, 0), (1, 64 + GAP_PX)] {
                assert!(part(frame, left) == expected(&plan, method, number), "method {method}, frame {number}");
            }
        }
    }

    #[test]
    fn a_gif_plays_one_method_after_the_other_and_repeats() {
        let plan = plan(Arrangement::InTurn, AnimationFormat::Gif);
        let bytes = encoded(&plan);
        assert!(bytes.windows(11).any(|part| part == b"NETSCAPE2.0"), "it repeats");
        let frames = GifDecoder::new(Cursor::new(bytes)).unwrap().into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 4);
        for (index, frame) in frames.iter().enumerate() {
            let (drawn, wanted) = (part(frame, 0), expected(&plan, index / 2, (index % 2) as i64));
            let differences = drawn.pixels().iter().zip(wanted.pixels()).map(|(a, b)| u64::from(a[1].abs_diff(b[1])));
            let mean = differences.sum::<u64>() as f64 / wanted.pixels().len() as f64;
            assert!(mean < 6.0, "256 colours: frame {index} is off by {mean}");
        }
    }

    #[test]
    fn a_cancelled_animation_has_no_file_and_a_large_one_is_refused() {
        let mut plan = plan(Arrangement::InTurn, AnimationFormat::Gif);
        let mut asked = Vec::new();
        let result = animate(&plan, &mut |done, of| {
            asked.push((done, of));
            done < 3
        });
        assert!(result.unwrap().is_none());
        assert_eq!(asked, [(0, 4), (1, 4), (2, 4), (3, 4)]);
        plan.frames = u32::MAX;
        assert!(animate(&plan, &mut |_, _| true).is_err());
    }
}
