//! Circles, pixel by pixel, in integer arithmetic only (Bresenham 1977, in the midpoint form).
//!
//! The algorithm walks one octant, from the top (0, r) to the diagonal. x grows by one each step, and y shrinks by one
//! if the midpoint between the two candidates lies outside the circle. This is decided by the sign of D = F(x + 1, y −
//! ½), where F(x, y) = x² + y² − r². The decision variable D is updated by additions. Its fractional part is always ¼
//! and never changes the sign, so it is dropped. The other seven octants are reflections.

/// Iterator over the pixels of a circle; see [`midpoint_circle`].
#[derive(Clone, Debug)]
pub struct MidpointCircle {
    center: (i32, i32),
    /// Position in the octant, relative to the centre. The walk ends when x > y.
    x: i64,
    y: i64,
    decision: i64,
    /// Reflection of the next pixel, as a bit set of [`SWAPPED`], [`LEFT`] and [`BELOW`].
    reflection: u8,
}

/// Reflection bit: x and y are swapped, after any change of sign.
const SWAPPED: u8 = 1;

/// Reflection bit: x is negated.
const LEFT: u8 = 2;

/// Reflection bit: y is negated.
const BELOW: u8 = 4;

const REFLECTIONS: u8 = 8;

/// Returns the pixels of a circle centred on a pixel, without duplicates.
///
/// The order follows the octant: first all reflections of the topmost pixel, and last those at the diagonals. A radius
/// of 0 gives only the centre pixel.
///
/// # Examples
/// ```
/// use rasterscope_engine::flat2d::circle::midpoint_circle;
///
/// let pixels: Vec<_> = midpoint_circle((10, 10), 3).collect();
/// assert_eq!(pixels.len(), 16);
/// assert!(pixels.contains(&(10, 13)) && pixels.contains(&(12, 12)));
///
/// let dot: Vec<_> = midpoint_circle((10, 10), 0).collect();
/// assert_eq!(dot, [(10, 10)]);
/// ```
pub fn midpoint_circle(center: (i32, i32), radius: u32) -> MidpointCircle {
    let radius = i64::from(radius);
    MidpointCircle { center, x: 0, y: radius, decision: 1 - radius, reflection: 0 }
}

impl MidpointCircle {
    /// Returns the current position in the octant, relative to the centre, or `None` after the last position.
    pub(crate) fn octant(&self) -> Option<(i64, i64)> {
        (self.x <= self.y).then_some((self.x, self.y))
    }

    /// Returns the decision variable. It is ≥ 0 if the next midpoint lies outside the circle, so that y decreases.
    pub(crate) fn decision(&self) -> i64 {
        self.decision
    }

    fn step(&mut self) {
        if self.decision < 0 {
            self.decision += 2 * self.x + 3;
        } else {
            self.decision += 2 * (self.x - self.y) + 5;
            self.y -= 1;
        }
        self.x += 1;
        self.reflection = 0;
    }

    /// Returns whether to skip this reflection of the current pixel, because another reflection gives the same pixel.
    fn is_repeated(&self, reflection: u8) -> bool {
        let on_mirror = |which: u8, on: bool| reflection & which != 0 && on;
        on_mirror(SWAPPED, self.x == self.y) || on_mirror(LEFT, self.x == 0) || on_mirror(BELOW, self.y == 0)
    }

    fn reflected(&self, reflection: u8) -> (i64, i64) {
        let is = |which: u8| reflection & which != 0;
        let x = if is(LEFT) { -self.x } else { self.x };
        let y = if is(BELOW) { -self.y } else { self.y };
        let (x, y) = if is(SWAPPED) { (y, x) } else { (x, y) };
        (i64::from(self.center.0) + x, i64::from(self.center.1) + y)
    }
}

impl Iterator for MidpointCircle {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<(i64, i64)> {
        loop {
            self.octant()?;
            if self.reflection == REFLECTIONS {
                self.step();
                continue;
            }
            let reflection = self.reflection;
            self.reflection += 1;
            if !self.is_repeated(reflection) {
                return Some(self.reflected(reflection));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn circle(radius: u32) -> Vec<(i64, i64)> {
        midpoint_circle((0, 0), radius).collect()
    }

    /// Returns the pixels nearest to the true circle. In the octant x ≤ y, tries all rows of each column; the other
    /// octants are reflections.
    fn nearest_pixels(radius: i64) -> HashSet<(i64, i64)> {
        let octant = (0..=radius).filter_map(|x| {
            // (y − ½)² < r² − x² < (y + ½)², multiplied by four.
            let square = 4 * (radius * radius - x * x);
            let y = (0..=radius).find(|y| (2 * y + 1).pow(2) > square)?;
            (x <= y).then_some((x, y))
        });
        let mirrored =
            octant.flat_map(|(x, y)| [(x, y), (y, x)]).flat_map(|(x, y)| [(x, y), (-x, y), (x, -y), (-x, -y)]);
        mirrored.collect()
    }

    #[test]
    fn pixels_are_those_nearest_to_the_true_circle() {
        for radius in (0..300).chain([1_000, 1_449]) {
            let pixels: HashSet<_> = circle(radius).into_iter().collect();
            assert_eq!(pixels, nearest_pixels(radius.into()), "radius {radius}");
        }
    }

    #[test]
    fn every_pixel_comes_once() {
        for radius in 0..300 {
            let pixels = circle(radius);
            assert_eq!(pixels.iter().collect::<HashSet<_>>().len(), pixels.len(), "radius {radius}");
        }
    }

    #[test]
    fn the_centre_shifts_the_circle() {
        let shifted: Vec<_> = midpoint_circle((7, -3), 20).collect();
        assert_eq!(shifted, circle(20).into_iter().map(|(x, y)| (x + 7, y - 3)).collect::<Vec<_>>());
    }

    #[test]
    fn the_largest_circle_of_all_can_be_walked() {
        let radius = i64::from(u32::MAX);
        let mut walk = midpoint_circle((i32::MAX, i32::MIN), u32::MAX);
        let on_circle = |(x, y): (i64, i64)| {
            let (x, y) = (i128::from(x) - i128::from(i32::MAX), i128::from(y) - i128::from(i32::MIN));
            (x * x + y * y - i128::from(radius).pow(2)).abs() <= i128::from(2 * radius)
        };
        assert!((0..1_000_000).all(|_| walk.next().is_some_and(on_circle)));
    }

    #[test]
    fn the_state_predicts_the_next_step() {
        let mut walk = midpoint_circle((0, 0), 50);
        while let Some((x, y)) = walk.octant() {
            let midpoint_is_outside = (x + 1).pow(2) * 4 + (2 * y - 1).pow(2) >= 4 * 50 * 50;
            assert_eq!(walk.decision() >= 0, midpoint_is_outside, "at ({x}, {y})");
            walk.step();
        }
        assert_eq!(walk.next(), None);
    }
}
