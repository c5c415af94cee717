//! Lab page on sampling shapes and patterns at pixels: sources of aliasing, and remedies.

use std::f32::consts::{FRAC_PI_4, SQRT_2};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Duration;

use glam::DVec2;

use super::picture::{brightness, siemens_star};
use super::recording::{
    Ink, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, number, pair, time_of,
};
use crate::antialias::area::triangle_area;
use crate::antialias::weight::{Weight, weighted_coverage};
use crate::flat2d::convolve::Mask;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Scene that the page samples.
    pub SamplingScene {
        Edge = "edge", "An edge", "A straight edge at any angle. The exact area on one side is known for each pixel.";
        ZonePlate = "zone-plate", "Zone plate",
            "Rings that get finer outwards: their period falls below two pixels at a third of the width from the \
            centre.";
        ChessBoard = "chess-board", "Receding chessboard", "Squares that shrink toward the horizon.";
        Wheel = "wheel", "Turning wheel", "Eight spokes; each step is one frame of an animation.";
        Picture = "picture", "A picture",
            "The picture that was last opened or dropped here, in grey; a Siemens star by default.";
    }
}

choice! {
    /// Method that computes the value of a pixel.
    pub SamplingMethod {
        Point = "point", "One point", "The value at the pixel's centre.";
        Grid = "grid", "n × n points", "The mean of a regular grid of points in the pixel.";
        Jittered = "jittered", "n × n, jittered",
            "The mean of n × n points, each at a random position in its cell: aliasing becomes noise.";
        AreaBox = "area-box", "Area, box", "The mean over the area of the pixel.";
        AreaPyramid = "area-pyramid", "Area, pyramid",
            "A weighted mean, largest at the centre; reaches into the neighbours.";
        AreaCone = "area-cone", "Area, cone",
            "A weighted mean that is equal in all directions; reaches into the neighbours.";
        Blur = "blur", "One point, then blur", "The point-sampled picture convolved with a 3 × 3 mask: details are lost.";
        Sharpen = "sharpen", "One point, then sharpen",
            "The point-sampled picture convolved with a mask whose outer weights are negative.";
        Motion = "motion", "One point, then motion blur",
            "The point-sampled picture convolved with a mask along a diagonal, like motion during the exposure.";
    }
}

impl SamplingMethod {
    fn mask(self) -> Option<Mask> {
        match self {
            Self::Blur => Some(Mask::binomial()),
            Self::Sharpen => Some(Mask::sharpen(SHARPENING)),
            Self::Motion => Some(Mask::motion(MOTION_PX, FRAC_PI_4)),
            _ => None,
        }
    }

    fn weight(self) -> Option<Weight> {
        match self {
            Self::AreaBox => Some(Weight::Box),
            Self::AreaPyramid => Some(Weight::Pyramid),
            Self::AreaCone => Some(Weight::Cone),
            _ => None,
        }
    }
}

/// Sharpening strength. The unsharp mask multiplies the difference between a pixel and the mean of its four neighbours
/// by this factor, and adds the product to the pixel.
const SHARPENING: f32 = 4.0;

/// Path length of the motion blur, in pixels. The path runs from the centre of a diagonal neighbour, through the
/// pixel's own centre, to the opposite neighbour's centre.
const MOTION_PX: f32 = 2.0 * SQRT_2;

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (48, 36);

/// Number of sample points per filter radius along each axis, for integrating filter-weighted means numerically.
const DENSE: u32 = 12;

/// Number of sample points per axis for reference values that have no closed form. No method uses the same number.
const TRUTH: u32 = 43;

/// Number of recorded frames of the wheel.
const FRAMES: u32 = 48;

/// Number of spokes of the wheel.
const SPOKES: f64 = 8.0;

/// Input and settings of the lab page on sampling.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingLesson {
    /// Image function that is sampled at each pixel.
    pub scene: SamplingScene,
    /// Method that computes the pixels.
    pub method: SamplingMethod,
    /// Number of sample points per axis within a pixel.
    pub points: u32,
    /// Direction of the edge, in degrees.
    pub angle_degrees: f32,
    /// A point on the edge, or the centre of the pattern, in pixels.
    pub(crate) middle: DVec2,
    /// Turns of the wheel per frame.
    pub turns_per_frame: f32,
    /// Column and row of the pixel whose values are shown.
    pub(crate) chosen: (u32, u32),
    /// Picture of [`SamplingScene::Picture`]: values in [0, 1], stretched over the whole grid.
    pub(crate) source: Arc<Image<f64>>,
}

impl Default for SamplingLesson {
    fn default() -> Self {
        Self {
            scene: SamplingScene::Edge,
            method: SamplingMethod::Grid,
            points: 4,
            angle_degrees: 20.0,
            middle: DVec2::new(24.0, 18.0),
            turns_per_frame: 0.115,
            chosen: (26, 18),
            source: Arc::new(siemens_star()),
        }
    }
}

impl SamplingLesson {
    /// Returns the value of the scene at a position, in [0, 1]; `turn` is the rotation of the wheel in full turns.
    fn value(&self, place: DVec2, turn: f64) -> f64 {
        let from_middle = place - self.middle;
        match self.scene {
            SamplingScene::Edge => f64::from(from_middle.dot(self.normal()) >= 0.0),
            SamplingScene::ZonePlate => {
                // The local frequency, in cycles per pixel, is 2 · `chirp` times the radius. It reaches ½ at a radius
                // of a third of the grid's width.
                let chirp = 0.25 / (f64::from(SIZE.0) / 3.0);
                0.5 + 0.5 * (TAU * chirp * from_middle.length_squared()).cos()
            }
            SamplingScene::ChessBoard => {
                let below = place.y - (self.middle.y - 0.35 * f64::from(SIZE.1));
                if below <= 0.0 {
                    return 0.5;
                }
                let distance = 40.0 / below;
                let square = (from_middle.x * distance / 9.0).floor() + (distance * 3.0).floor();
                square.rem_euclid(2.0)
            }
            SamplingScene::Wheel => {
                let radius = from_middle.length();
                let spoke = (from_middle.to_angle() / TAU - turn) * SPOKES;
                let rim = (14.5..16.0).contains(&radius) || radius < 2.0;
                f64::from(rim || radius < 14.5 && spoke.rem_euclid(1.0) < 0.3)
            }
            SamplingScene::Picture => {
                let grid = DVec2::new(SIZE.0.into(), SIZE.1.into());
                let size = DVec2::new(self.source.width().into(), self.source.height().into());
                let texel = ((place + grid / 2.0 - self.middle) / grid * size).floor();
                self.source.at_clamped(texel.x as i64, texel.y as i64)
            }
        }
    }

    /// Returns the unit normal of the edge, pointing towards the covered side.
    fn normal(&self) -> DVec2 {
        DVec2::from_angle(f64::from(self.angle_degrees).to_radians()).perp()
    }

    /// Returns the covered half-plane of the edge, as a square far larger than the grid.
    fn half_plane(&self) -> [DVec2; 4] {
        const FAR: f64 = 1_000.0;
        let (normal, along) = (self.normal() * FAR, self.normal().perp() * FAR);
        [self.middle - along, self.middle + along, self.middle + along + normal, self.middle - along + normal]
    }

    /// Returns the mean value over `count` × `count` sample points of a pixel, in a regular or jittered grid.
    fn mean(&self, (x, y): (u32, u32), count: u32, jittered: bool, turn: f64) -> f64 {
        let mut random = fastrand::Rng::with_seed(u64::from(y * SIZE.0 + x));
        let mut offset = |cell: u32| {
            let within = if jittered { random.f64() } else { 0.5 };
            (f64::from(cell) + within) / f64::from(count)
        };
        let mut sum = 0.0;
        for (row, column) in (0..count).flat_map(|row| (0..count).map(move |column| (row, column))) {
            sum += self.value(DVec2::new(f64::from(x) + offset(column), f64::from(y) + offset(row)), turn);
        }
        sum / f64::from(count * count)
    }

    /// Returns the filter-weighted mean around a pixel: exact for the edge, by numerical integration for other scenes.
    fn weighted(&self, (x, y): (u32, u32), weight: Weight, turn: f64) -> f64 {
        let center = DVec2::new(x.into(), y.into()) + 0.5;
        if self.scene == SamplingScene::Edge {
            return weighted_coverage(&self.half_plane(), center, weight);
        }
        let count = DENSE * 2;
        let at = |i: u32| ((f64::from(i) + 0.5) / f64::from(count) * 2.0 - 1.0) * weight.radius_px();
        let (mut sum, mut whole) = (0.0, 0.0);
        for (row, column) in (0..count).flat_map(|row| (0..count).map(move |column| (row, column))) {
            let place = DVec2::new(at(column), at(row));
            let height = weight.at(place);
            whole += height;
            if height > 0.0 {
                sum += height * self.value(center + place, turn);
            }
        }
        sum / whole
    }

    /// Returns the picture that a method computes with the wheel rotated by `turn` full turns.
    fn picture(&self, method: SamplingMethod, turn: f64) -> Image<f64> {
        if let Some(mask) = method.mask() {
            return mask.apply_to_numbers(&self.picture(SamplingMethod::Point, turn));
        }
        Image::from_fn(SIZE.0, SIZE.1, |x, y| match (method.weight(), method) {
            (Some(weight), _) => self.weighted((x, y), weight, turn),
            (None, SamplingMethod::Grid) => self.mean((x, y), self.points, false, turn),
            (None, SamplingMethod::Jittered) => self.mean((x, y), self.points, true, turn),
            (None, _) => self.mean((x, y), 1, false, turn),
        })
    }

    /// Returns the mean of the source picture over a pixel's square, weighting texels by their area inside the square.
    fn texel_mean(&self, (x, y): (u32, u32)) -> f64 {
        let along = |pixel: u32, middle: f64, side: u32, texels: u32| {
            let per_px = f64::from(texels) / f64::from(side);
            let from = (f64::from(pixel) + f64::from(side) / 2.0 - middle) * per_px;
            let to = from + per_px;
            let share = move |texel: i64| ((texel + 1) as f64).min(to) - (texel as f64).max(from);
            (from.floor() as i64..to.ceil() as i64).map(move |texel| (texel, share(texel) / per_px))
        };
        let columns = || along(x, self.middle.x, SIZE.0, self.source.width());
        let rows = along(y, self.middle.y, SIZE.1, self.source.height());
        rows.flat_map(|row| columns().map(move |column| (column, row)))
            .map(|((column, wide), (row, high))| wide * high * self.source.at_clamped(column, row))
            .sum()
    }

    /// Returns the reference: the mean value over each pixel's square. It is exact for the edge and for pictures, and a
    /// mean of many sample points for other scenes.
    fn truth(&self) -> Image<f64> {
        match self.scene {
            SamplingScene::Edge => {}
            SamplingScene::Picture => return Image::from_fn(SIZE.0, SIZE.1, |x, y| self.texel_mean((x, y))),
            _ => return Image::from_fn(SIZE.0, SIZE.1, |x, y| self.mean((x, y), TRUTH, false, 0.0)),
        }
        let [a, b, c, d] = self.half_plane();
        let mut truth = Image::filled(SIZE.0, SIZE.1, 0.0);
        for (x, y, area) in
            [[a, b, c], [a, c, d]].into_iter().flat_map(|corners| triangle_area(corners, SIZE.0, SIZE.1))
        {
            truth.set(x, y, truth.at(x, y) + area);
        }
        truth
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(SIZE);
        if self.scene == SamplingScene::Wheel {
            recording.collect((0..FRAMES).map(|frame| self.frame_step(frame)));
            let true_turns = f64::from(self.turns_per_frame);
            // All spokes look alike, so the wheel appears to make the smallest rotation that gives the same picture.
            let per_spoke = (true_turns * SPOKES + 0.5).rem_euclid(1.0) - 0.5;
            recording.fact("turns per frame", number(true_turns, 3));
            recording.fact("apparent turns", number(per_spoke / SPOKES, 3));
            recording.fact("fastest unaliased", format!("{} turns per frame", number(0.5 / SPOKES, 4)));
            return recording;
        }
        let (picture, truth) = (self.picture(self.method, 0.0), self.truth());
        recording.collect((0..SIZE.1).map(|y| self.row_step(y, &picture, &truth)));
        if self.scene == SamplingScene::Edge {
            let along = self.normal().perp() * 100.0;
            recording.figure.push(Mark::Line(self.middle - along, self.middle + along, Tone::Ideal));
        }
        let (x, y) = self.chosen;
        let corner = DVec2::new(x.into(), y.into());
        recording.figure.push(Mark::Outline(
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|c| corner + DVec2::from(c)).to_vec(),
            Tone::B,
        ));
        recording.fact("root mean square error", number(root_mean_square(&picture, &truth), 5));
        recording.fact("sum of the picture", number(picture.pixels().iter().sum(), 2));
        recording.fact("true sum", number(truth.pixels().iter().sum(), 2));
        self.add_chosen_values(&mut recording, &picture, &truth);
        recording
    }

    /// Adds the values of the chosen pixel to the results shown for the run.
    fn add_chosen_values(&self, recording: &mut Recording, picture: &Image<f64>, truth: &Image<f64>) {
        let (x, y) = self.chosen;
        recording.facts.push((format!("pixel ({x}, {y})"), number(picture.at(x, y), 5)));
        recording.fact("its reference", number(truth.at(x, y), 5));
        if let Some(mask) = self.method.mask() {
            let points = self.picture(SamplingMethod::Point, 0.0);
            let terms: Vec<_> = mask.terms_at(&points, self.chosen).collect();
            let side = 2 * mask.reach() as usize + 1;
            for (row, terms) in terms.chunks(side).enumerate() {
                let terms: Vec<_> = terms
                    .iter()
                    .map(|(weight, value)| format!("{} × {}", number(*weight, 3), number(*value, 2)))
                    .collect();
                recording.facts.push((format!("mask, row {}", row + 1), terms.join(" + ")));
            }
        }
    }

    fn row_step(&self, y: u32, picture: &Image<f64>, truth: &Image<f64>) -> RecordedStep {
        let off = (0..SIZE.0).map(|x| (picture.at(x, y) - truth.at(x, y)).abs()).fold(0.0, f64::max);
        RecordedStep {
            cells: (0..SIZE.0)
                .map(|x| cell((x.into(), y.into()), Ink::Share(picture.at(x, y).clamp(0.0, 1.0))))
                .collect(),
            marks: self.sample_marks(y),
            description: format!("Row {y}: the largest error of a pixel is {} of the full range.", number(off, 3)),
            state: vec![pair("row", y.to_string()), pair("greatest error", number(off, 5))],
        }
    }

    /// Returns marks at the sample points of the pixel in row `y` and the chosen column; none for jittered and
    /// filter-weighted methods.
    fn sample_marks(&self, y: u32) -> Vec<Mark> {
        let x = self.chosen.0;
        let corner = DVec2::new(x.into(), y.into());
        let count = match self.method {
            SamplingMethod::Grid => self.points,
            _ if self.method.weight().is_some() || self.method == SamplingMethod::Jittered => return Vec::new(),
            _ => 1,
        };
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(count);
        let points = (0..count).flat_map(|row| (0..count).map(move |column| DVec2::new(at(column), at(row))));
        points.map(|point| Mark::Dot(corner + point, Tone::Weak)).collect()
    }

    fn frame_step(&self, frame: u32) -> RecordedStep {
        let turn = f64::from(frame) * f64::from(self.turns_per_frame);
        let picture = self.picture(self.method, turn);
        let places = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let spoke = DVec2::from_angle((turn + 0.15 / SPOKES) * TAU) * 14.5;
        RecordedStep {
            cells: places
                .map(|(x, y)| cell((x.into(), y.into()), Ink::Share(picture.at(x, y).clamp(0.0, 1.0))))
                .collect(),
            marks: vec![Mark::Line(self.middle, self.middle + spoke, Tone::Focus)],
            description: format!("Frame {frame}: the marked spoke has turned {} times.", number(turn, 3)),
            state: vec![
                pair("frame", frame.to_string()),
                pair("turns", number(turn, 3)),
                pair("angle", format!("{}°", number((turn.fract() * 2.0 * PI).to_degrees(), 1))),
            ],
        }
    }

    pub(super) fn walk(&self) -> usize {
        self.picture(self.method, 0.0).pixels().len()
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.scene {
            SamplingScene::Edge => {
                "One point per pixel gives jagged edges: each pixel is all or nothing. The correct value is the \
                 covered area. More points approximate it better: n × n points give n² + 1 levels of grey in general, \
                 and fewer for an edge along the grid. Jittered points have no unfavourable angles, but noise. Area \
                 sampling computes the area without points. Turn the edge until it is nearly horizontal and compare; \
                 the blurred edge is smooth, but wider than the correct one."
            }
            SamplingScene::ZonePlate => {
                "Toward the border the period of the rings is below two pixels. A wave needs more than two samples per \
                 period; with fewer, the samples also fit a coarser wave, and the picture shows rings that do not \
                 exist: aliasing. Supersampling by n × n points moves this limit outwards by the factor n; blurring \
                 afterwards cannot separate false rings from true ones."
            }
            SamplingScene::ChessBoard => {
                "Toward the horizon the squares shrink below a pixel and moiré appears: large patterns that do not \
                 exist. With area sampling the far squares fade to grey, which is the correct mean. Texture filtering \
                 does the same for distant surfaces."
            }
            SamplingScene::Wheel => {
                "Frames sample time as pixels sample space. With eight equal spokes, a wheel that turns by more than a \
                 sixteenth per frame appears to turn slower, stand still, or run backwards. Follow the marked spoke \
                 with single steps, then play. More points per pixel do not help; more frames per second, or a longer \
                 exposure (motion blur), would."
            }
            SamplingScene::Picture => {
                "Scaling a picture down is sampling, too. With one point per pixel, a few pixels of the large picture \
                 are kept and the others are lost, which breaks thin lines and turns fine patterns into coarse ones. \
                 The mean over each pixel's area uses all of them. Open or drop any picture here. On the Siemens star, \
                 the wedges are separate at the rim; toward the middle, only false patterns remain."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        vec![self.middle]
    }

    pub(super) fn move_handle(&mut self, _: usize, to: DVec2) {
        self.middle = (to * 4.0).round() / 4.0;
    }

    /// Selects the picture scene and makes `picture` its source.
    pub(crate) fn set_picture(&mut self, picture: &Image<Rgba8>) {
        (self.scene, self.source) = (SamplingScene::Picture, Arc::new(brightness(picture)));
    }

    /// Selects the pixel whose values are shown; positions outside the grid are ignored.
    pub fn choose(&mut self, (x, y): (u32, u32)) {
        if x < SIZE.0 && y < SIZE.1 {
            self.chosen = (x, y);
        }
    }

    /// Compares the errors and run times of all methods on the current scene.
    pub(super) fn compare(&self) -> MethodComparison {
        let truth = self.truth();
        let rival = |method: SamplingMethod| {
            let error = root_mean_square(&self.picture(method, 0.0), &truth);
            MethodResult { name: method.name(), error, time: time_of(|| self.picture(method, 0.0).pixels().len()) }
        };
        let rivals: Vec<_> = SamplingMethod::ALL.iter().map(|method| rival(*method)).collect();
        let task = format!(
            "{} on {} × {} px, {} points per axis",
            self.scene.name().to_lowercase(),
            SIZE.0,
            SIZE.1,
            self.points
        );
        let blur = rivals.iter().find(|rival| rival.name == SamplingMethod::Blur.name());
        let note = blur.map(|blur| self.error_in_time_of(blur, &truth));
        MethodComparison { task, error: "root mean square error", methods: rivals, note }
    }

    /// Describes, as a sentence, the error of supersampling with as many points as fit into the run time of `blur`.
    fn error_in_time_of(&self, blur: &MethodResult, truth: &Image<f64>) -> String {
        /// Largest number of sample points per axis to try; this many points take longer than any blur.
        const MAX_POINTS: u32 = 8;
        let timed = |points| {
            let lesson = Self { points, ..self.clone() };
            (points, time_of(|| lesson.picture(SamplingMethod::Grid, 0.0).pixels().len()), lesson)
        };
        let affordable = (2..=MAX_POINTS).map(timed).take_while(|(_, time, _)| *time <= blur.time).last();
        let micros = |time: Duration| format!("{} µs", number(time.as_secs_f64() * 1e6, 1));
        match affordable {
            None => format!("At equal time: blur takes {}, which is less than 2 × 2 points take.", micros(blur.time)),
            Some((points, time, lesson)) => format!(
                "At equal time: {points} × {points} points take {} with error {}; one point and blur take {} with \
                    error {}.",
                micros(time),
                number(root_mean_square(&lesson.picture(SamplingMethod::Grid, 0.0), truth), 4),
                micros(blur.time),
                number(blur.error, 4)
            ),
        }
    }
}

fn root_mean_square(picture: &Image<f64>, truth: &Image<f64>) -> f64 {
    let sum: f64 = picture.pixels().iter().zip(truth.pixels()).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / truth.pixels().len() as f64).sqrt()
}
