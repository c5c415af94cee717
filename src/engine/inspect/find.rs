//! Search for an object, triangle or vertex in a frame: a pixel where it is visible, or the reason why there is none.

mod vertex;

use crate::chain::{Frame, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::pipeline::LastStage;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Scene, TriangleId};

/// Target of a search in a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SearchTarget {
    /// A pixel, by column and row.
    Pixel(u32, u32),
    /// A pixel to centre in the canvas: column, row, and magnification in percent.
    View(u32, u32, u32),
    /// A triangle of the scene.
    Triangle(TriangleId),
    /// A vertex, by the number of its object and its number within the object.
    Vertex(u32, u32),
    /// An object name as entered, and the indices of all matching instances.
    Object(String, Vec<u32>),
}

/// Range of valid magnifications, in percent.
const PERCENT: std::ops::RangeInclusive<u32> = 4..=25_600;

/// Result of a search for a target in a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SearchResult {
    /// The target is visible. Contains its most central visible pixel and the number of its visible samples.
    Visible((u32, u32), usize),
    /// The target is hidden everywhere. Contains its most central pixel and the number of samples that it covers.
    Hidden((u32, u32), usize),
    /// The target is a vertex. Contains its pixel, and a description of its position and distance from the eye.
    At((u32, u32), String),
    /// The target has no pixel in the picture. Contains the reason.
    Nowhere(String),
}

impl SearchTarget {
    /// Parses a target such as "12,34", "800% 12,34", "tri 56", "vertex 7 of knot", or the name of an object or a part
    /// of it. A vertex without an object name belongs to the object with the number `near`. The error states what was
    /// not found.
    pub fn parse(
        text: &str,
        scene: &Scene,
        Viewport { width, height }: Viewport,
        near: Option<u32>,
    ) -> Result<Self, String> {
        if let Some((x, y)) = parse_pixel(text) {
            return if x < width && y < height {
                Ok(Self::Pixel(x, y))
            } else {
                Err(format!("Outside the picture, whose last pixel is {},{}", width - 1, height - 1))
            };
        }
        if let Some((percent, place)) = parse_enlargement(text)
            && let Some((x, y)) = parse_pixel(&place)
        {
            return if PERCENT.contains(&percent) {
                Ok(Self::View(x.min(width.saturating_sub(1)), y.min(height.saturating_sub(1)), percent))
            } else {
                Err(format!("The zoom must lie between {} and {} %", PERCENT.start(), PERCENT.end()))
            };
        }
        if let Some(number) = parse_triangle(text) {
            let count = scene.triangle_count();
            return match u32::try_from(number).ok().filter(|_| (number as usize) < count) {
                Some(id) => Ok(Self::Triangle(TriangleId(id))),
                None => Err(format!("The scene has {count} triangles, numbered from 0")),
            };
        }
        if let Some(found) = vertex::parse(text, scene, near) {
            return found.map(|(object, number)| Self::Vertex(object, number));
        }
        let name = text.trim().to_lowercase();
        if name.is_empty() {
            return Err(String::new());
        }
        // An exact match takes precedence over names that merely contain the text.
        let exact = named(scene, |instance| instance.to_lowercase() == name);
        let found =
            if exact.is_empty() { named(scene, |instance| instance.to_lowercase().contains(&name)) } else { exact };
        if found.is_empty() {
            return Err(format!("No object is named “{}”", text.trim()));
        }
        Ok(Self::Object(text.trim().to_owned(), found))
    }

    /// Returns the display name of the target.
    pub fn words(&self) -> String {
        match self {
            Self::Pixel(x, y) | Self::View(x, y, _) => format!("Pixel {x}, {y}"),
            Self::Triangle(id) => format!("Triangle {}", id.0),
            Self::Vertex(_, number) => format!("Vertex {number}"),
            Self::Object(name, numbers) if numbers.len() == 1 => format!("“{name}”"),
            Self::Object(name, numbers) => format!("“{name}” ({} objects)", numbers.len()),
        }
    }
}

fn named(scene: &Scene, is_meant: impl Fn(&str) -> bool) -> Vec<u32> {
    let instances = scene.instances.iter().zip(0..);
    instances.filter(|(instance, _)| is_meant(&instance.name)).map(|(_, number)| number).collect()
}

/// Parses a column and a row separated by a comma, semicolon or space.
fn parse_pixel(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.split([',', ';', ' ']).filter(|part| !part.is_empty()).map(str::parse);
    let (x, y) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    numbers.next().is_none().then_some((x, y))
}

/// Parses "800% 12,34" into the percentage and the remaining text.
fn parse_enlargement(text: &str) -> Option<(u32, String)> {
    let (percent, place) = text.split_once('%')?;
    Some((percent.trim().parse().ok()?, place.to_owned()))
}

/// Parses a triangle number from "tri 12", "triangle 12", "t12" or "#12".
fn parse_triangle(text: &str) -> Option<u64> {
    let text = text.trim().to_lowercase();
    let number = ["triangle", "tri", "t", "#"].iter().find_map(|word| text.strip_prefix(word))?;
    number.trim().parse().ok()
}

/// Searches for a target in a frame by drawing its triangles again.
pub fn find(scene: &Scene, recipe: &Recipe, frame: &Frame, wanted: &SearchTarget) -> SearchResult {
    let is_wanted: &dyn Fn(&ScreenTriangle) -> bool = match wanted {
        SearchTarget::Pixel(x, y) | SearchTarget::View(x, y, _) => return SearchResult::Visible((*x, *y), 1),
        SearchTarget::Vertex(object, number) => return vertex::find(scene, recipe, frame, (*object, *number)),
        SearchTarget::Triangle(id) => &|triangle| triangle.id == *id,
        SearchTarget::Object(_, numbers) => &|triangle| numbers.contains(&triangle.instance),
    };
    if !frame.geometry().triangles.iter().any(is_wanted) {
        let words = wanted.words();
        return SearchResult::Nowhere(format!(
            "{words} is not rasterized: it is culled, clipped away, or outside the view"
        ));
    }
    let (width, height) = frame.drawn.color.size();
    let mut search = TargetSamples {
        is_wanted,
        covered: Image::filled(width, height, false),
        seen: Image::filled(width, height, false),
    };
    redraw(scene, recipe, frame, LastStage::Shade, &mut search);
    let TargetSamples { covered, seen, .. } = search;
    let in_the_middle = |mask: &Image<bool>| most_central(mask).map(|(sample, count)| (frame.pixel_of(sample), count));
    match (in_the_middle(&seen), in_the_middle(&covered)) {
        (Some((pixel, count)), _) => SearchResult::Visible(pixel, count),
        (None, Some((pixel, count))) => SearchResult::Hidden(pixel, count),
        (None, None) => SearchResult::Nowhere(format!("{} covers no pixel centre in this view", wanted.words())),
    }
}

/// Observer that marks two sets of samples: those that a wanted triangle covers, and those at which a wanted triangle
/// was the last one shaded.
struct TargetSamples<'a> {
    is_wanted: &'a dyn Fn(&ScreenTriangle) -> bool,
    covered: Image<bool>,
    seen: Image<bool>,
}

impl Observer for TargetSamples<'_> {
    fn covered(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        if (self.is_wanted)(triangle) {
            self.covered.set(sample.column, sample.row, true);
        }
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        self.seen.set(fragment.sample.column, fragment.sample.row, (self.is_wanted)(triangle));
    }
}

/// Returns the marked sample nearest to the mean position of all marked samples, and the number of marked samples.
/// Returns `None` if no sample is marked.
fn most_central(mask: &Image<bool>) -> Option<((u32, u32), usize)> {
    let (width, height) = mask.size();
    let marked =
        || (0..height).flat_map(|row| (0..width).map(move |column| (column, row))).filter(|(x, y)| mask.at(*x, *y));
    let (count, sum) =
        marked().fold((0, (0, 0)), |(count, (x, y)), (u, v)| (count + 1, (x + u64::from(u), y + u64::from(v))));
    let middle = (sum.0.checked_div(count)?, sum.1.checked_div(count)?);
    let distance =
        |(x, y): &(u32, u32)| u64::from(*x).abs_diff(middle.0).pow(2) + u64::from(*y).abs_diff(middle.1).pow(2);
    marked().min_by_key(distance).map(|sample| (sample, count as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::capture;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 48, height: 32 };

    #[test]
    fn pixels_are_parsed_with_any_usual_separator() {
        for text in ["12,34", "12 34", " 12 , 34 ", "12;34"] {
            assert_eq!(parse_pixel(text), Some((12, 34)), "{text}");
        }
        assert_eq!(parse_pixel("12"), None);
        assert_eq!(parse_pixel("1,2,3"), None);
        assert_eq!(parse_pixel("-1,2"), None);
    }

    #[test]
    fn triangles_and_objects_are_parsed_and_missing_ones_are_reported() {
        let scene = builtin::by_id("cubes").unwrap().build();
        let parse = |text: &str| SearchTarget::parse(text, &scene, SIZE, None);
        for text in ["tri 7", "Triangle 7", "t7", "#7"] {
            assert_eq!(parse(text), Ok(SearchTarget::Triangle(TriangleId(7))), "{text}");
        }
        assert!(parse("tri 1536").unwrap_err().contains("1536 triangles"));
        assert_eq!(parse("800% 12,30"), Ok(SearchTarget::View(12, 30, 800)));
        assert!(parse("1 % 0,0").unwrap_err().contains("25600 %"));
        assert!(parse("48,0").unwrap_err().contains("47,31"));
        assert!(parse("no such thing").unwrap_err().contains("no such thing"));
        let name = scene.instances[3].name.clone();
        let Ok(SearchTarget::Object(_, numbers)) = parse(&name.to_uppercase()) else { panic!("{name} is an object") };
        assert!(numbers.contains(&3));
    }

    #[test]
    fn a_triangle_is_found_visible_hidden_or_nowhere() {
        let scene = builtin::by_id("cubes").unwrap().build();
        let recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
        let buffers = capture(&scene, &recipe, &frame);
        let (mut seen, mut hidden, mut nowhere) = (0, 0, 0);
        for id in (0..1536).step_by(31).map(TriangleId) {
            let winners = buffers.triangle.pixels().iter().filter(|winner| **winner == id).count();
            match find(&scene, &recipe, &frame, &SearchTarget::Triangle(id)) {
                SearchResult::Visible((x, y), count) => {
                    assert_eq!((buffers.triangle.at(x, y), count), (id, winners));
                    seen += 1;
                }
                SearchResult::Hidden(..) => {
                    assert_eq!(winners, 0);
                    hidden += 1;
                }
                SearchResult::Nowhere(_) => {
                    assert_eq!(winners, 0);
                    nowhere += 1;
                }
                SearchResult::At(..) => panic!("a triangle is not a vertex"),
            }
        }
        assert!(seen > 3 && hidden + nowhere > 3, "{seen} {hidden} {nowhere}");
    }

    #[test]
    fn a_triangle_in_a_smaller_raster_image_is_found_at_a_pixel_of_the_full_picture() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let mut recipe = Recipe::default();
        for upscaler in ["nearest", "bilinear", "checkerboard"] {
            recipe.set(&format!("upscaler.method={upscaler}")).unwrap();
            let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
            let SearchResult::Visible((x, y), _) =
                find(&scene, &recipe, &frame, &SearchTarget::Triangle(TriangleId(0)))
            else {
                panic!("the triangle fills the picture")
            };
            assert!(x < SIZE.width && y < SIZE.height);
            let [r, g, b, _] = frame.image().at(x, y);
            assert_ne!([r, g, b], scene.background, "{upscaler}: {x}, {y}");
        }
    }
}
