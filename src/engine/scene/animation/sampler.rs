//! Key frames and their interpolation (Khronos Group, "glTF 2.0 Specification", 2021, §3.11 and Appendix C).

use std::ops::{Add, Mul};
use std::sync::Arc;

use glam::{DQuat, DVec3, DVec4};

/// Ascending times of key frames, in seconds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KeyTimes(Arc<[f64]>);

/// Position of a time between two key frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KeySpan {
    /// Index of the last key frame at or before the time; the first one for earlier times.
    pub(super) key: usize,
    /// Fraction of the way to the next key frame, in [0, 1). It is 0 before the first and after the last key frame.
    pub(super) share: f64,
    /// Time between the two key frames, in seconds; 0 where `share` has no meaning.
    pub(super) length_s: f64,
}

impl KeyTimes {
    /// Creates key times.
    ///
    /// # Errors
    /// Returns a reason if there are none, or if they are negative, not finite or not in strictly ascending order.
    pub(crate) fn new(times_s: Vec<f64>) -> Result<Self, String> {
        let Some(first) = times_s.first() else { return Err("it has no key frames".to_owned()) };
        if *first < 0.0 {
            return Err(format!("its first key frame is at a negative time, {first} s"));
        }
        if let Some(key) = times_s.iter().position(|time_s| !time_s.is_finite()) {
            return Err(format!("the time of key frame {key} is not finite"));
        }
        match times_s.windows(2).position(|pair| pair[0] >= pair[1]) {
            Some(key) => Err(format!("key frame {} is not later than the one before", key + 1)),
            None => Ok(Self(times_s.into())),
        }
    }

    /// Returns the number of key frames, at least 1.
    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns the time of the last key frame, in seconds.
    pub(super) fn end_s(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }

    /// Finds the key frames around a time.
    pub(super) fn span(&self, time_s: f64) -> KeySpan {
        let key = self.0.partition_point(|key_s| *key_s <= time_s).saturating_sub(1);
        match self.0[key..] {
            [from, to, ..] if time_s > from => {
                KeySpan { key, share: (time_s - from) / (to - from), length_s: to - from }
            }
            _ => KeySpan { key, share: 0.0, length_s: 0.0 },
        }
    }
}

/// Interpolation between two key frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolation {
    /// Keeps the value of the earlier key frame.
    Step,
    /// Linear, and along the shorter arc for rotations.
    Linear,
    /// Cubic Hermite spline. Each key frame has three values: in-tangent, value and out-tangent.
    CubicSpline,
}

impl Interpolation {
    /// Returns the number of values per key frame.
    pub(crate) fn values_per_key(self) -> usize {
        match self {
            Self::Step | Self::Linear => 1,
            Self::CubicSpline => 3,
        }
    }
}

/// Type of value that can be interpolated.
pub(crate) trait KeyValue: Copy {
    /// Whether all components are finite.
    fn is_finite(self) -> bool;

    /// Returns the value at fraction `share` between two others.
    fn between(self, to: Self, share: f64) -> Self;

    /// Returns the sum of four values with these weights, as a valid value.
    fn weighted(values: [Self; 4], weights: [f64; 4]) -> Self;
}

/// Returns a weighted sum of four values.
fn sum<T: Copy + Mul<f64, Output = T> + Add<Output = T>>([a, b, c, d]: [T; 4], weights: [f64; 4]) -> T {
    a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
}

/// Implements [`KeyValue`] for a type that is interpolated linearly.
macro_rules! linear_key_value {
    ($value:ty) => {
        impl KeyValue for $value {
            fn is_finite(self) -> bool {
                self.is_finite()
            }

            fn between(self, to: Self, share: f64) -> Self {
                self * (1.0 - share) + to * share
            }

            fn weighted(values: [Self; 4], weights: [f64; 4]) -> Self {
                sum(values, weights)
            }
        }
    };
}

linear_key_value!(f64);
linear_key_value!(DVec3);

impl KeyValue for DQuat {
    fn is_finite(self) -> bool {
        self.is_finite()
    }

    /// Spherical linear interpolation along the shorter arc (glTF 2.0, Appendix C.4).
    fn between(self, to: Self, share: f64) -> Self {
        let cos = self.dot(to);
        let angle = cos.abs().min(1.0).acos();
        let sin = angle.sin();
        // Below this angle the weights of linear interpolation differ by less than the rounding error.
        let [from_weight, to_weight] = if sin < 1e-8 {
            [1.0 - share, share]
        } else {
            [(angle * (1.0 - share)).sin() / sin, (angle * share).sin() / sin]
        };
        unit(DVec4::from(self) * from_weight + DVec4::from(to) * (cos.signum() * to_weight))
    }

    fn weighted(values: [Self; 4], weights: [f64; 4]) -> Self {
        unit(sum(values.map(DVec4::from), weights))
    }
}

/// Returns the unit quaternion in the direction of a vector, or the identity for a vector without direction.
pub(crate) fn unit(quaternion: DVec4) -> DQuat {
    let largest = quaternion.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        DQuat::from_vec4((quaternion / largest).normalize())
    } else {
        DQuat::IDENTITY
    }
}

/// Values over time, given by key frames.
#[derive(Clone, Debug)]
pub(crate) struct Sampler<T> {
    times: KeyTimes,
    values: Arc<[T]>,
    interpolation: Interpolation,
}

impl<T: KeyValue> Sampler<T> {
    /// Creates a sampler.
    ///
    /// # Errors
    /// Returns a reason if the number of values does not fit the key times, or if a value is not finite.
    pub(crate) fn new(times: KeyTimes, values: Vec<T>, interpolation: Interpolation) -> Result<Self, String> {
        let needed = times.count().saturating_mul(interpolation.values_per_key());
        if values.len() != needed {
            return Err(format!("it has {} values instead of {needed} for its key frames", values.len()));
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(format!("its value {index} is not finite")),
            None => Ok(Self { times, values: values.into(), interpolation }),
        }
    }

    /// Returns the time of the last key frame, in seconds.
    pub(super) fn end_s(&self) -> f64 {
        self.times.end_s()
    }

    /// Returns the value at a time. Before the first and after the last key frame, it is the value of that key frame.
    pub(super) fn at(&self, time_s: f64) -> T {
        let KeySpan { key, share, length_s } = self.times.span(time_s);
        match self.interpolation {
            Interpolation::Step => self.values[key],
            Interpolation::Linear if share == 0.0 => self.values[key],
            Interpolation::Linear => self.values[key].between(self.values[key + 1], share),
            Interpolation::CubicSpline if share == 0.0 => self.values[3 * key + 1],
            Interpolation::CubicSpline => {
                let [value, tangent, next_tangent, next] = [1, 2, 3, 4].map(|offset| self.values[3 * key + offset]);
                T::weighted([value, tangent, next, next_tangent], hermite(share, length_s))
            }
        }
    }

    /// Returns the sampler with every value replaced by the result of `change`.
    pub(super) fn map(&self, change: impl Fn(T) -> T) -> Self {
        Self { values: self.values.iter().map(|value| change(*value)).collect(), ..self.clone() }
    }

    /// Returns the sampler with the value of every key frame replaced by the result of `change`. Tangents stay.
    pub(crate) fn map_keys(&self, change: impl Fn(T) -> T) -> Self {
        let per_key = self.interpolation.values_per_key();
        let change = |(index, value): (usize, &T)| if index % per_key == per_key / 2 { change(*value) } else { *value };
        Self { values: self.values.iter().enumerate().map(change).collect(), ..self.clone() }
    }

    /// Returns the memory used by the values, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.values) + self.times.count() * size_of::<f64>()
    }
}

/// Returns the weights of value, out-tangent, next value and its in-tangent (glTF 2.0, Appendix C.5).
fn hermite(share: f64, length_s: f64) -> [f64; 4] {
    let (square, cube) = (share * share, share * share * share);
    [
        2.0 * cube - 3.0 * square + 1.0,
        length_s * (cube - 2.0 * square + share),
        -2.0 * cube + 3.0 * square,
        length_s * (cube - square),
    ]
}
