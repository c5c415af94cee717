//! Boundary points between neighbouring samples that show different visible surfaces.

use glam::DVec2;

use super::visible::{StackId, Visibility};
use crate::pipeline::Geometry;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{DepthTest, Settings};

/// A point on the boundary of two regions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoundaryPoint {
    /// Position of the point on the screen, in samples.
    pub(super) place: DVec2,
    /// Unit normal of the straight line that the boundary follows at the point. `None` if the boundary follows no line,
    /// such as at the border of a transparent part of a texture.
    pub(super) normal: Option<DVec2>,
}

/// Input of the boundary search: the screen triangles, and the surfaces that each sample shows.
pub(super) struct Surfaces<'a> {
    pub(super) visibility: &'a Visibility,
    pub(super) geometry: &'a Geometry,
    pub(super) settings: &'a Settings,
}

impl Surfaces<'_> {
    /// Adds the point between two samples at which the stack of visible surfaces changes. Adds two points if one
    /// surface ends before the other begins. All positions are in samples.
    pub(super) fn find_crossings(&self, path: [DVec2; 2], stacks: [StackId; 2], found: &mut Vec<BoundaryPoint>) {
        let [first, second] = self.changing(stacks).map(|index| index.map(|index| self.side(index, path)));
        let events = match (first, second) {
            (Some(first), Some(second)) => change(&first, &second),
            (Some(only), None) => [only.exit, None],
            (None, Some(only)) => [only.enter, None],
            (None, None) => [None, None],
        };
        let crossing =
            |along: f64, normal: Option<DVec2>| BoundaryPoint { place: path[0].lerp(path[1], along), normal };
        if events == [None, None] {
            found.push(crossing(0.5, None));
        }
        let events = events.into_iter().flatten();
        found.extend(events.map(|Event { along, normal }| crossing(along.clamp(0.0, 1.0), normal.try_normalize())));
    }

    /// Returns one surface of each sample; the boundary lies between these two surfaces.
    ///
    /// If the samples show different opaque surfaces, returns these. Otherwise returns, for each sample, the topmost
    /// surface that the other sample does not show. If a sample has no such surface, its opaque surface is returned
    /// instead. If the samples show the same surfaces in different orders, returns the topmost surfaces that differ.
    fn changing(&self, [first, second]: [StackId; 2]) -> [Option<u32>; 2] {
        let [first, second] = [first, second].map(|stack| self.visibility.surfaces(stack).collect::<Vec<_>>());
        let opaque = |stack: &[u32]| stack.last().copied().filter(|index| !self.is_blended(*index));
        let lowest = [opaque(&first), opaque(&second)];
        if lowest[0] != lowest[1] {
            return lowest;
        }
        let missing = |of: &[u32], from: &[u32]| of.iter().find(|index| !from.contains(index)).copied();
        match (missing(&first, &second), missing(&second, &first)) {
            (Some(one), other) => [Some(one), other.or(lowest[1])],
            (None, Some(other)) => [lowest[0], Some(other)],
            // The same surfaces in a different order: they intersect.
            (None, None) => {
                let differing = first.iter().zip(&second).find(|(one, other)| one != other);
                differing.map_or([None, None], |(one, other)| [Some(*one), Some(*other)])
            }
        }
    }

    fn is_blended(&self, index: u32) -> bool {
        self.geometry.is_blended(&self.geometry.triangles[index as usize])
    }

    fn side(&self, index: u32, path: [DVec2; 2]) -> PathTriangle {
        let triangle = &self.geometry.triangles[index as usize];
        let corners = triangle.corners_in(self.settings.arithmetic).map(|[x, y]| DVec2::new(x.into(), y.into()));
        let [enter, exit] = events(corners, path);
        let plane = AffineFunction::through(corners, self.priorities(triangle, index));
        PathTriangle { enter, exit, gradient: plane.gradient, priority: path.map(|place| plane.at(place)) }
    }

    /// Returns the occlusion priorities at the corners of a triangle. Priorities are affine on the screen; a triangle
    /// occludes another one where its priority is greater.
    fn priorities(&self, triangle: &ScreenTriangle, index: u32) -> [f64; 3] {
        let toward_viewer = |sign: f64| {
            let sign = if self.settings.reversed() { -sign } else { sign };
            triangle.vertices.each_ref().map(|vertex| {
                // A depth that is linear in space is not affine on the screen, but 1/w is.
                if triangle.depth.is_linear_in_space() { sign * f64::from(vertex.inv_w) } else { -sign * vertex.depth }
            })
        };
        match self.settings.depth_test {
            DepthTest::Less | DepthTest::LessEqual => toward_viewer(1.0),
            DepthTest::Greater => toward_viewer(-1.0),
            DepthTest::Off | DepthTest::Always => [f64::from(index); 3],
        }
    }
}

/// Point at which the path between two samples crosses a triangle's boundary or the intersection line of two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Event {
    /// Position along the path, in [0, 1].
    along: f64,
    /// Normal of the crossed line, not normalised.
    normal: DVec2,
}

/// Crossings and occlusion priorities of a triangle along the path between two samples.
#[derive(Clone, Copy, Debug)]
struct PathTriangle {
    /// Point where the path enters the triangle; `None` if the path begins inside.
    enter: Option<Event>,
    /// Point where the path leaves the triangle; `None` if the path ends inside.
    exit: Option<Event>,
    /// Gradient of the occlusion priority on the screen, per sample.
    gradient: DVec2,
    /// Occlusion priorities at the start and end of the path.
    priority: [f64; 2],
}

/// Returns the point at which `first`, visible at the start of the path, is replaced by `second`, visible at the end.
/// Returns two points if `first` ends before `second` begins.
fn change(first: &PathTriangle, second: &PathTriangle) -> [Option<Event>; 2] {
    let lead = |along: f64| {
        let at = |side: &PathTriangle| side.priority[0] + (side.priority[1] - side.priority[0]) * along;
        at(first) - at(second)
    };
    // The surfaces may overlap from the point where the second begins to the point where the first ends.
    let (begin, end) = (second.enter.map_or(0.0, |event| event.along), first.exit.map_or(1.0, |event| event.along));
    if let (Some(enter), Some(exit)) = (second.enter, first.exit)
        && enter.along >= exit.along
    {
        // The second surface begins exactly where the first one ends, or after a gap that no sample shows.
        return [Some(exit), Some(enter)];
    }
    let (at_begin, at_end) = (lead(begin), lead(end));
    if let Some(enter) = second.enter.filter(|_| at_begin <= 0.0) {
        return [Some(enter), None];
    }
    if let Some(exit) = first.exit.filter(|_| at_end >= 0.0) {
        return [Some(exit), None];
    }
    let intersection = || Event {
        along: begin + (end - begin) * at_begin / (at_begin - at_end),
        normal: first.gradient - second.gradient,
    };
    [(at_begin > 0.0 && at_end < 0.0).then(intersection), None]
}

/// Returns the points where a path enters and leaves a triangle. An endpoint of the path on an edge counts as outside.
fn events(corners: [DVec2; 3], [from, to]: [DVec2; 2]) -> [Option<Event>; 2] {
    let turn = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).signum();
    let (mut enter, mut exit) = (None::<Event>, None::<Event>);
    for (corner, next) in corners.into_iter().zip(corners.into_iter().cycle().skip(1)) {
        let inward = (next - corner).perp() * turn;
        let (before, after) = (inward.dot(from - corner), inward.dot(to - corner));
        let event = || Event { along: before / (before - after), normal: inward };
        if before <= 0.0 && after > before {
            enter = Some(event()).into_iter().chain(enter).max_by(|a, b| a.along.total_cmp(&b.along));
        }
        if after <= 0.0 && before > after {
            exit = Some(event()).into_iter().chain(exit).min_by(|a, b| a.along.total_cmp(&b.along));
        }
    }
    [enter, exit]
}

/// An affine function of the screen position.
#[derive(Clone, Copy, Debug)]
struct AffineFunction {
    origin: DVec2,
    at_origin: f64,
    gradient: DVec2,
}

impl AffineFunction {
    /// Returns the affine function with these values at the corners of a triangle.
    fn through(corners: [DVec2; 3], values: [f64; 3]) -> Self {
        let [origin, b, c] = corners;
        let (to_b, to_c) = (b - origin, c - origin);
        let (rise_b, rise_c) = (values[1] - values[0], values[2] - values[0]);
        let gradient = (to_b.perp() * rise_c - to_c.perp() * rise_b) / to_b.perp_dot(to_c);
        Self { origin, at_origin: values[0], gradient }
    }

    fn at(&self, place: DVec2) -> f64 {
        self.at_origin + self.gradient.dot(place - self.origin)
    }
}
