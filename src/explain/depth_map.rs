//! The other renderer's depths as a function of our distances, whatever its depth mapping is.

use std::fmt::{self, Display, Formatter};

use rasterscope_engine::scene::Camera;

/// Largest number of pixels from which a function is fitted.
const MOST_SAMPLES: usize = 4096;

/// Number of groups of similar distances, whose medians determine the function.
const GROUPS: usize = 32;

/// Relative error of a distance at which two depths count as equal. At steep slopes, rounded vertices move depths.
const RELATIVE_ERROR: f64 = 2e-3;

/// Share of the range of depths that is the smallest step of float files.
const LEAST_STEP: f64 = 1e-6;

/// Greatest error of a known mapping, as a share of the range of depths.
const SAME_MAPPING: f64 = 0.01;

/// Kind of function of the distance along the line of sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// Linear in the distance.
    Linear,
    /// Linear in the reciprocal of the distance, as z/w of a perspective view.
    Reciprocal,
    /// Linear in the logarithm of the distance.
    Logarithmic,
}

impl Law {
    const ALL: [Self; 3] = [Self::Linear, Self::Reciprocal, Self::Logarithmic];

    fn of(self, distance: f64) -> f64 {
        match self {
            Self::Linear => distance,
            Self::Reciprocal => 1.0 / distance,
            Self::Logarithmic => distance.ln(),
        }
    }

    /// Returns the change of the function at a relative change of the distance of 1.
    fn change(self, distance: f64) -> f64 {
        match self {
            Self::Linear => distance,
            Self::Reciprocal => 1.0 / distance,
            Self::Logarithmic => 1.0,
        }
    }
}

/// Function from distances to depths: `offset` + `factor` · law(distance).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthMap {
    law: Law,
    offset: f64,
    factor: f64,
    /// Step between depths that the file or the depth buffer can store.
    step: f64,
}

impl DepthMap {
    /// Fits a function to pairs of distances and depths, most of which lie on it; `step` is that of the file.
    /// Returns `None` if no kind of function fits, as for depths that are all equal.
    pub(crate) fn fit(pairs: &[[f64; 2]], step: f64) -> Option<Self> {
        let stride = pairs.len().div_ceil(MOST_SAMPLES).max(1);
        let mut samples: Vec<[f64; 2]> = pairs.iter().copied().step_by(stride).collect();
        samples.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let groups = samples.chunks(samples.len().div_ceil(GROUPS).max(1));
        let middles: Vec<_> = groups
            .map(|group| [0, 1].map(|axis| median(group.iter().map(|pair| pair[axis]).collect()).unwrap_or_default()))
            .collect();
        let fits = Law::ALL.iter().filter_map(|law| Self::through(*law, &middles, step));
        fits.min_by_key(|map| samples.iter().filter(|[distance, depth]| map.differs(*distance, *depth)).count())
    }

    /// Returns the function of a kind through most of the points: the median of the slopes between all pairs (Theil
    /// and Sen).
    fn through(law: Law, points: &[[f64; 2]], step: f64) -> Option<Self> {
        let points: Vec<_> = points.iter().map(|[distance, depth]| [law.of(*distance), *depth]).collect();
        let pairs = points.iter().enumerate().flat_map(|(index, a)| points[index + 1..].iter().map(move |b| (a, b)));
        let slopes = pairs.filter(|(a, b)| a[0] != b[0]).map(|(a, b)| (b[1] - a[1]) / (b[0] - a[0]));
        let factor = median(slopes.collect())?;
        let offset = median(points.iter().map(|[x, y]| y - factor * x).collect())?;
        let range = factor * (points.first()?[0] - points.last()?[0]);
        (range.abs() > 2.0 * step).then_some(Self { law, offset, factor, step })
    }

    fn at(&self, distance: f64) -> f64 {
        self.offset + self.factor * self.law.of(distance)
    }

    /// Returns whether a depth is not that of a distance, up to rounding.
    pub(crate) fn differs(&self, distance: f64, depth: f64) -> bool {
        let tolerance = self.step + RELATIVE_ERROR * (self.factor * self.law.change(distance)).abs();
        let is_near = (depth - self.at(distance)).abs() <= tolerance;
        // Depths that are not finite differ.
        !is_near
    }

    /// Returns the name of the mapping, with knowledge of the planes of the view.
    pub(crate) fn name(&self, camera: &Camera) -> String {
        let (near, far) = (f64::from(camera.near), f64::from(camera.far));
        let z = |distance: f64| far / (far - near) * (1.0 - near / distance);
        let share = |distance: f64| (distance - near) / (far - near);
        let known: [(&str, &dyn Fn(f64) -> f64); 8] = [
            ("0 at the near plane, 1 at the far plane", &z),
            ("reversed, 1 at the near plane, 0 at the far plane", &|distance| 1.0 - z(distance)),
            ("reversed, with an infinite far plane", &|distance| near / distance),
            ("−1 at the near plane, 1 at the far plane (OpenGL)", &|distance| 2.0 * z(distance) - 1.0),
            ("linear, 0 at the near plane, 1 at the far plane", &share),
            ("linear, 1 at the near plane, 0 at the far plane", &|distance| 1.0 - share(distance)),
            ("the distance along the line of sight", &|distance| distance),
            ("the negative distance along the line of sight", &|distance| -distance),
        ];
        let places = [0.0, 0.25, 0.5, 0.75, 1.0].map(|place| near * (far / near).powf(place));
        let range = (self.at(near) - self.at(far)).abs();
        let is_same = |mapping: &dyn Fn(f64) -> f64| {
            places
                .iter()
                .all(|distance| (mapping(*distance) - self.at(*distance)).abs() <= SAME_MAPPING * range + self.step)
        };
        match known.iter().find(|(_, mapping)| is_same(mapping)) {
            Some((name, _)) => (*name).to_owned(),
            None => self.to_string(),
        }
    }
}

impl Display for DepthMap {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let law = match self.law {
            Law::Linear => "linear in the distance",
            Law::Reciprocal => "linear in the reciprocal of the distance",
            Law::Logarithmic => "linear in the logarithm of the distance",
        };
        let grows = (self.factor > 0.0) != (self.law == Law::Reciprocal);
        write!(f, "{law}, {} with it", if grows { "growing" } else { "falling" })
    }
}

/// Returns the number of bits of depths that are all multiples of 1/255 or 1/65535; `None` if they are finer.
pub(crate) fn bits(depths: &[f32]) -> Option<u8> {
    let all_multiples = |steps: f64, error: f64| {
        let mut finite = depths.iter().map(|depth| f64::from(*depth) * steps).filter(|depth| depth.is_finite());
        finite.all(|depth| (depth - depth.round()).abs() < error)
    };
    [(8, 255.0, 1e-3), (16, 65535.0, 0.02)]
        .into_iter()
        .find(|(_, steps, error)| all_multiples(*steps, *error))
        .map(|(bits, ..)| bits)
}

/// Returns the step of depths with a number of bits. Floats have a step that hides rounding.
pub(crate) fn step(depths: &[f32], bits: Option<u8>) -> f64 {
    if let Some(bits) = bits {
        return 1.0 / (f64::from(bits).exp2() - 1.0);
    }
    let finite = depths.iter().map(|depth| f64::from(*depth)).filter(|depth| depth.is_finite());
    let [low, high] = finite.fold([f64::MAX, f64::MIN], |[low, high], depth| [low.min(depth), high.max(depth)]);
    LEAST_STEP * (high - low).max(0.0)
}

/// Returns the median; `None` if there are no values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
