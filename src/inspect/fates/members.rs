//! Who is in a bin, and who of those answers to a few words.

use super::{Fates, FragmentFate, ObjectFates, TriangleFate};
use crate::pipeline::settings::Choice as _;
use crate::scene::TriangleId;

/// A bin that a person can choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bin {
    /// Triangles that ended so.
    Triangles(TriangleFate),
    /// Triangles with fragments that ended so.
    Fragments(FragmentFate),
}

impl Bin {
    /// What its members have in common.
    pub fn label(self) -> String {
        match self {
            Self::Triangles(fate) => fate.name().to_lowercase(),
            Self::Fragments(fate) => format!("with fragments: {}", fate.name().to_lowercase()),
        }
    }
}

/// What members have to answer to. Nothing asked for is answered by all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filter {
    /// Number of the triangle.
    id: Option<u32>,
    /// Area on the screen at least and at most, px².
    area: [Option<f64>; 2],
    /// Whether it must have been cut by a plane of the view.
    is_cut: bool,
    /// Whether a normal or texture coordinate must have been NaN or infinite.
    is_broken: bool,
    /// Part of the name of the object or of its material, in lower case.
    name: String,
}

impl Filter {
    /// Reads words such as `tri 123`, `area<1`, `area>=20`, `is:cut`, `is:broken` and parts of a name, in any order.
    pub fn parse(text: &str) -> Self {
        let mut filter = Self::default();
        // A bound is one word however it is spaced; "area" may be a word of a name, too.
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
        // What has no shape on the screen has no area either.
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

/// A word such as `area<1`: 0 for the least or 1 for the most, and the value.
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
    /// The triangles of a bin, or all, of one object, or of all, that pass a filter; in the order of the scene.
    pub fn members(&self, bin: Option<Bin>, object: Option<usize>, filter: &Filter) -> Vec<TriangleId> {
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
    fn bounds_are_read_however_they_are_spaced_and_names_are_left_alone() {
        for text in ["area<1.5", "area <1.5", "area< 1.5", "Area < 1.5"] {
            assert_eq!(Filter::parse(text), Filter { area: [None, Some(1.5)], ..Filter::default() }, "{text}");
        }
        for text in ["area>=20", "area >= 20", "area > 20"] {
            assert_eq!(Filter::parse(text), Filter { area: [Some(20.0), None], ..Filter::default() }, "{text}");
        }
        for name in ["area light", "a > b", "x = y"] {
            assert_eq!(Filter::parse(name), Filter { name: name.to_owned(), ..Filter::default() });
        }
        let both = Filter { area: [None, Some(2.0)], name: "area light".to_owned(), ..Filter::default() };
        assert_eq!(Filter::parse("area light area < 2"), both);
    }
}
