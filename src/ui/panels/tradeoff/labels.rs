//! Placement of names beside points of a plot without overlaps.

use eframe::egui::{Pos2, Rect, Vec2, pos2, vec2};

/// Distance between a point and its label, in points.
const GAP: f32 = 8.0;

/// Half the width of the square around a point that labels leave free, in points.
const POINT: f32 = 5.0;

/// Places a label of each size beside its point, in the order of the list. Returns `None` for a label that would overlap
/// an earlier label or one of `obstacles`, or extend beyond `frame`, at each of the possible places.
pub(super) fn place(labels: &[(Pos2, Vec2)], obstacles: &[Rect], frame: Rect) -> Vec<Option<Rect>> {
    let mut placed = obstacles.to_vec();
    let mut places = Vec::with_capacity(labels.len());
    for (at, size) in labels {
        let is_free = |rect: &Rect| frame.contains_rect(*rect) && placed.iter().all(|other| !other.intersects(*rect));
        let place = candidates(*at, *size).into_iter().find(is_free);
        placed.extend(place);
        places.push(place);
    }
    places
}

/// Returns the square around a point that labels leave free.
pub(super) fn around(point: Pos2) -> Rect {
    Rect::from_center_size(point, Vec2::splat(2.0 * POINT))
}

/// Returns the possible places of a label, the best first. A falling staircase through the points leaves the first five
/// free.
fn candidates(at: Pos2, size: Vec2) -> [Rect; 8] {
    let (x, y) = (GAP + size.x / 2.0, POINT + 2.0 + size.y / 2.0);
    let offsets = [(x, -y), (-x, y), (-x, 0.0), (x, y), (0.0, y), (x, 0.0), (-x, -y), (0.0, -y)];
    offsets.map(|(x, y)| Rect::from_center_size(pos2(at.x, at.y) + vec2(x, y), size))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect { min: Pos2::ZERO, max: pos2(200.0, 100.0) };
    const SIZE: Vec2 = vec2(60.0, 12.0);

    #[test]
    fn labels_are_within_the_plot_and_do_not_overlap() {
        let points = [pos2(100.0, 50.0), pos2(105.0, 52.0), pos2(195.0, 5.0), pos2(102.0, 70.0)];
        let labels = points.map(|point| (point, SIZE));
        let places: Vec<_> = place(&labels, &points.map(around), FRAME).into_iter().flatten().collect();
        assert!(places.len() >= 3);
        for (index, place) in places.iter().enumerate() {
            assert!(FRAME.contains_rect(*place));
            assert!(points.iter().all(|point| !place.contains(*point)));
            assert!(places[..index].iter().all(|other| !other.intersects(*place)));
        }
    }

    #[test]
    fn a_label_without_space_is_omitted() {
        let at = pos2(100.0, 50.0);
        assert_eq!(place(&[(at, vec2(300.0, 12.0))], &[around(at)], FRAME), [None]);
        let right = place(&[(at, SIZE)], &[around(at)], FRAME)[0].unwrap();
        assert!(right.left() > at.x && right.bottom() < at.y);
    }
}
