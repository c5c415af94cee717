//! Triangles in each fate bin, and a text filter for them.

use super::{Fates, FragmentFate, ObjectFates, TriangleFate};
use crate::pipeline::settings::Choice as _;
use crate::scene::TriangleId;

/// A selectable bin of triangles that share a fate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bin {
    /// Triangles with this fate.
    Triangles(TriangleFate),
    /// Triangles with at least one fragment that met this fate.
    Fragments(FragmentFate),
}

impl Bin {
    /// Returns the display name of the bin, in lower case.
    pub fn label(self) -> String {
        match self {
            Self::Triangles(fate) => fate.name().to_lowercase(),
            Self::Fragments(fate) => format!("with fragments: {}", fate.name().to_lowercase()),
        }
    }
}

/// Filter for the triangles of a bin. An empty filter accepts every triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FateFilter {
    /// Required triangle number; `None` accepts every number.
    id: Option<u32>,
    /// Lower bound (inclusive) and upper bound (exclusive) of the triangle's screen area, in px².
    area: [Option<f64>; 2],
    /// Whether only triangles that were clipped by a frustum plane are accepted.
    is_cut: bool,
    /// Whether only triangles with a NaN or infinite normal or texture coordinate are accepted.
    is_broken: bool,
    /// Text in lower case that the name of the object or of its material must contain; empty accepts every name.
    name: String,
}

impl FateFilter {
    /// Parses a filter from words such as `tri 123`, `area<1`, `area>=20`, `is:cut`, `is:broken` and parts of a name,
    /// in any order.
    pub fn parse(text: &str) -> Self {
        let mut filter = Self::default();
        // Joins a bound that contains spaces, such as “area < 1”, into one word. “area” without a bound may be part of
        // a name.
        let joined = ["area <", "area >", "area< ", "area> ", "area<= ", "area>= "]
            .iter()
            .fold(text.to_lowercase(), |text, spaced| text.replace(spaced, &spaced.replace(' ', "")));
        let mut words = joined.split_whitespace().peekable();
        let mut name = Vec::new();
        while let Some(word) = words.next() {
            let number = |word: &str| word.trim_start_matches('#').parse().ok();
            if let Some((end, value)) = area_bound(word) {
                filter.area[end] = Some(value);
            } else if ["tri", "triangle"].contains(&word) && words.peek().is_some_and(|next| number(next).is_some()) {
                filter.id = words.next().and_then(number);
            } else if let Some(id) = word.strip_prefix('#').and_then(|digits| digits.parse().ok()) {
                filter.id = Some(id);
            } else if word == "is:cut" {
                filter.is_cut = true;
            } else if word == "is:broken" {
                filter.is_broken = true;
            } else {
                name.push(word);
            }
        }
        filter.name = name.join(" ");
        filter
    }

    fn passes(&self, fates: &Fates, triangle: TriangleId) -> bool {
        let [least, most] = self.area;
        let asks_area = least.is_some() || most.is_some();
        // A triangle without a shape on the screen has no area and fails every area bound.
        let in_range = |area: f64| least.is_none_or(|least| area >= least) && most.is_none_or(|most| area < most);
        self.id.is_none_or(|id| id == triangle.0)
            && (!asks_area || fates.area_px(triangle).is_some_and(in_range))
            && (!self.is_cut || fates.cut.contains(triangle))
            && (!self.is_broken || fates.broken.contains(triangle))
    }

    fn names(&self, object: &ObjectFates) -> bool {
        [&object.name, &object.material].iter().any(|name| name.to_lowercase().contains(&self.name))
    }
}

/// Parses a word such as `area<1` into the index of the bound (0 lower, 1 upper) and its value.
fn area_bound(word: &str) -> Option<(usize, f64)> {
    let rest = word.strip_prefix("area")?;
    let (end, number) = match rest.strip_prefix('<') {
        Some(number) => (1, number),
        None => (0, rest.strip_prefix('>')?),
    };
    let value: f64 = number.trim_start_matches('=').parse().ok()?;
    value.is_finite().then_some((end, value))
}

impl Fates {
    /// Returns the triangles that pass a filter, in scene order. `None` as bin or object means all bins or all objects.
    pub fn members(&self, bin: Option<Bin>, object: Option<usize>, filter: &FateFilter) -> Vec<TriangleId> {
        let is_asked = |place: usize| object.is_none_or(|object| object == place) && filter.names(&self.objects[place]);
        let objects = (0..self.objects.len()).filter(|place| is_asked(*place)).map(|place| &self.objects[place]);
        let ids = objects.flat_map(|object| object.first.0..object.first.0 + object.triangles.sum() as u32);
        ids.map(TriangleId).filter(|id| self.is_in(*id, bin) && filter.passes(self, *id)).collect()
    }

    fn is_in(&self, TriangleId(id): TriangleId, bin: Option<Bin>) -> bool {
        match bin {
            None => true,
            Some(Bin::Triangles(fate)) => self.triangles[id as usize] == fate,
            Some(Bin::Fragments(fate)) => self.fragments[id as usize].of(fate) > 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_bounds_are_parsed_with_any_spacing_and_names_are_unchanged() {
        for text in ["area<1.5", "area <1.5", "area< 1.5", "Area < 1.5"] {
            assert_eq!(
                FateFilter::parse(text),
                FateFilter { area: [None, Some(1.5)], ..FateFilter::default() },
                "{text}"
            );
        }
        for text in ["area>=20", "area >= 20", "area > 20"] {
            assert_eq!(
                FateFilter::parse(text),
                FateFilter { area: [Some(20.0), None], ..FateFilter::default() },
                "{text}"
            );
        }
        for name in ["area light", "a > b", "x = y"] {
            assert_eq!(FateFilter::parse(name), FateFilter { name: name.to_owned(), ..FateFilter::default() });
        }
        let both = FateFilter { area: [None, Some(2.0)], name: "area light".to_owned(), ..FateFilter::default() };
        assert_eq!(FateFilter::parse("area light area < 2"), both);
    }
}
