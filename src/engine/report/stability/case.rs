//! Test case as plain data, in the format of case files, so that every finding of a report can be saved and opened
//! again.
//!
//! A case file is one JSON object: `id`, `class`, `note`, `kind`, and the data that this kind requires. Every number is
//! the exact value of an f32, printed with all digits, so that readers with exact arithmetic see what was drawn. NaN
//! and infinities, which JSON does not support, are the strings `"NaN"`, `"Infinity"` and `"-Infinity"`.

use serde::{Deserialize, Serialize};

use super::oracle::{DepthMapping, DepthStorage, ScreenCorner};
use super::wire;
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;

/// Numerically hard test case for one part of the engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilityCase {
    /// Unique id of the case, shown in reports.
    pub id: String,
    /// Id of the class that the case belongs to.
    pub(crate) class: String,
    /// Description of the property that makes the case hard.
    #[serde(default)]
    pub(crate) note: String,
    /// Kind of the case and its data.
    #[serde(flatten)]
    pub(crate) body: Body,
}

/// Kind of a case and its data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Body {
    /// Coverage of one or more screen-space triangles, each drawn separately.
    TriCoverage(Coverage),
    /// Weights, depth and attributes at some pixels of a screen-space triangle.
    TriAttr(AttributeCase),
    /// Depths of two coplanar triangles that cover the same pixels.
    CoplanarPair(CoplanarPairCase),
    /// Coverage, weights and depth of one or more clip-space triangles, each drawn separately.
    ClipTri(ClipSpace),
    /// Depths that a depth buffer stores for distances in ascending order.
    Depth(DepthCase),
    /// Random pairs of points at nearly equal distances. A depth buffer may lose the order of the two.
    DepthPairs(DepthPairs),
}

/// Screen-space triangles whose coverage is tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Coverage {
    /// Image width, in pixels.
    pub(crate) width: u32,
    /// Image height, in pixels.
    pub(crate) height: u32,
    /// Fill rule for pixel centres on edges.
    #[serde(with = "crate::case::rule")]
    pub(crate) rule: FillRule,
    /// Vertices in pixels, x right and y down; every triangle is drawn separately.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) triangles: Vec<[[f32; 2]; 3]>,
    /// Whether the triangles together cover every pixel of the image exactly once.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) exactly_once: bool,
}

/// A screen-space triangle with attributes to interpolate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct AttributeCase {
    /// Image width, in pixels.
    pub(crate) width: u32,
    /// Image height, in pixels.
    pub(crate) height: u32,
    /// Vertices of the triangle.
    #[serde(with = "wire::corners")]
    pub(crate) vertices: [ScreenCorner; 3],
    /// Columns and rows of the pixels to evaluate; their centres lie inside the triangle.
    pub(crate) eval: Vec<[u32; 2]>,
}

/// Two coplanar triangles, whose depths should be equal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CoplanarPairCase {
    /// Image width, in pixels.
    pub(crate) width: u32,
    /// Image height, in pixels.
    pub(crate) height: u32,
    /// Vertices of the first triangle.
    #[serde(with = "wire::corners")]
    pub(crate) first: [ScreenCorner; 3],
    /// Vertices of the second triangle.
    #[serde(with = "wire::corners")]
    pub(crate) second: [ScreenCorner; 3],
    /// Columns and rows of the pixels to evaluate; their centres lie inside both triangles.
    pub(crate) eval: Vec<[u32; 2]>,
}

/// Clip-space triangles to clip, project and rasterize. The view volume has 0 ≤ z ≤ w, and y points up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClipSpace {
    /// Image width, in pixels.
    pub(crate) width: u32,
    /// Image height, in pixels.
    pub(crate) height: u32,
    /// Clip-space vertices (x, y, z, w); every triangle is drawn separately.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) triangles: Vec<[[f32; 4]; 3]>,
}

/// View-space distances and the depth buffer that stores them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DepthCase {
    /// Mapping from a distance to a depth in [0, 1].
    pub(crate) mapping: DepthMapping,
    /// Storage format of the depth buffer.
    pub(crate) format: DepthStorage,
    /// Distance of the near plane from the eye, in view-space units.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) near: f32,
    /// Distance of the far plane from the eye, in view-space units; `None` for infinity.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) far: Option<f32>,
    /// View-space distances to store, in ascending order.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) z: Vec<f32>,
}

/// Random pairs of points at distances z and z · (1 + `gap`) from the eye, each pair in its own random view. z is
/// log-uniformly distributed between the near and the far plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DepthPairs {
    /// Mapping from a distance to a depth in [0, 1].
    pub(crate) mapping: DepthMapping,
    /// Storage format of the depth buffer.
    pub(crate) format: DepthStorage,
    /// Distance of the near plane from the eye, in view-space units.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) near: f32,
    /// Distance of the far plane from the eye, in view-space units.
    #[serde(serialize_with = "wire::serialize", deserialize_with = "wire::deserialize")]
    pub(crate) far: f32,
    /// Relative difference between the view-space distances of a pair's two points, as a fraction of the smaller
    /// distance.
    pub(crate) gap: f64,
    /// Number of random pairs.
    pub(crate) pairs: u32,
    /// Seed of the random number generator.
    pub(crate) seed: u64,
}

impl StabilityCase {
    /// Returns the image size of the case; `None` for cases without an image.
    pub(crate) fn viewport(&self) -> Option<Viewport> {
        let (width, height) = match &self.body {
            Body::TriCoverage(c) => (c.width, c.height),
            Body::TriAttr(c) => (c.width, c.height),
            Body::CoplanarPair(c) => (c.width, c.height),
            Body::ClipTri(c) => (c.width, c.height),
            Body::Depth(_) | Body::DepthPairs(_) => return None,
        };
        Some(Viewport { width, height })
    }

    /// Returns the number of triangles in the case; 0 for depth cases.
    pub(crate) fn triangle_count(&self) -> usize {
        match &self.body {
            Body::TriCoverage(c) => c.triangles.len(),
            Body::ClipTri(c) => c.triangles.len(),
            Body::TriAttr(_) => 1,
            Body::CoplanarPair(_) => 2,
            Body::Depth(_) | Body::DepthPairs(_) => 0,
        }
    }

    /// Returns a depth case with its mapping and storage format replaced; other kinds of cases are returned unchanged.
    pub(crate) fn stored_as(mut self, mapping: DepthMapping, format: DepthStorage) -> Self {
        match &mut self.body {
            Body::Depth(depth) => {
                depth.far = depth.far.filter(|_| mapping.has_far_plane());
                (depth.mapping, depth.format) = (mapping, format);
            }
            Body::DepthPairs(pairs) => (pairs.mapping, pairs.format) = (mapping, format),
            _ => {}
        }
        self
    }

    /// Returns the case reduced to the parts with the given indices. Parts are triangles, evaluated pixels or
    /// distances, depending on the kind of case. A partial mesh is no longer expected to cover the image. Cases of
    /// random pairs are returned unchanged.
    pub(crate) fn only(&self, parts: &[usize]) -> Self {
        let mut case = Self { id: format!("{}-part", self.id), ..self.clone() };
        match &mut case.body {
            Body::TriCoverage(c) => {
                c.exactly_once &= parts.len() == c.triangles.len();
                keep(&mut c.triangles, parts);
            }
            Body::ClipTri(c) => keep(&mut c.triangles, parts),
            Body::TriAttr(c) => keep(&mut c.eval, parts),
            Body::CoplanarPair(c) => keep(&mut c.eval, parts),
            Body::Depth(c) => keep(&mut c.z, parts),
            Body::DepthPairs(_) => return self.clone(),
        }
        case
    }

    /// Serialises the case as JSON.
    pub fn to_json(&self) -> String {
        // Serialisation of a case cannot fail: map keys are strings, and numbers are finite or written as strings.
        serde_json::to_string(self).unwrap_or_default()
    }
}

fn keep<T: Clone>(list: &mut Vec<T>, parts: &[usize]) {
    *list = parts.iter().filter_map(|part| list.get(*part).cloned()).collect();
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn coverage() -> StabilityCase {
        StabilityCase {
            id: "a-0".into(),
            class: "a".into(),
            note: String::new(),
            body: Body::TriCoverage(Coverage {
                width: 8,
                height: 4,
                rule: FillRule::TopLeft,
                triangles: vec![[[0.1, 2.0], [f32::NAN, -3e38], [f32::NEG_INFINITY, 1e-45]]; 3],
                exactly_once: true,
            }),
        }
    }

    #[test]
    fn numbers_are_written_with_all_digits_of_the_float() {
        let written: Value = serde_json::from_str(&coverage().to_json()).unwrap();
        assert_eq!(written["kind"], "tri_coverage");
        assert_eq!(written["rule"], "top_left");
        assert_eq!(written["exactly_once"], true);
        let [[x, _], [nan, _], [infinity, tiny]] =
            [0, 1, 2].map(|c| [0, 1].map(|i| written["triangles"][0][c][i].clone()));
        assert_eq!(x, json!(f64::from(0.1_f32)));
        assert_eq!((nan, infinity), (json!("NaN"), json!("-Infinity")));
        assert_eq!(tiny, json!(f64::from(1e-45_f32)));
    }

    #[test]
    fn cases_round_trip_bit_for_bit() {
        let corner = ScreenCorner { x: 0.1, y: -7.5, z: 0.3, w: 1e30, uv: [1e6, -0.7] };
        let bodies = [
            coverage().body,
            Body::TriAttr(AttributeCase { width: 8, height: 4, vertices: [corner; 3], eval: vec![[1, 2], [3, 3]] }),
            Body::ClipTri(ClipSpace { width: 8, height: 4, triangles: vec![[[0.3, -0.0, f32::INFINITY, 1.0]; 3]] }),
            Body::Depth(DepthCase {
                mapping: DepthMapping::ReversedInf,
                format: DepthStorage::Unorm24,
                near: 0.1,
                far: None,
                z: vec![0.3, 7.0],
            }),
        ];
        for body in bodies {
            let case = StabilityCase { id: "x".into(), class: "y".into(), note: "z".into(), body };
            let read: StabilityCase = serde_json::from_str(&case.to_json()).unwrap();
            assert_eq!(format!("{read:?}"), format!("{case:?}"), "NaN is no reason to differ");
        }
    }

    #[test]
    fn case_files_may_contain_non_finite_corners() {
        use crate::case::{Answer, Case as FileCase, Control, Options, Task};
        let corners = [[0.3, -0.0, f32::INFINITY, 1.0], [f32::NAN, 1e-45, 0.5, 2.0], [-f32::INFINITY, 3e38, 0.0, 1.0]];
        let body = Body::ClipTri(ClipSpace { width: 8, height: 4, triangles: vec![corners] });
        let answer = |case: &FileCase| crate::case::answer(case, Options::default(), &Control::default());
        let bits = |corners: [[f32; 4]; 3]| corners.map(|corner| corner.map(f32::to_bits));
        let read = |case: &StabilityCase| FileCase::parse(case.to_json().as_bytes(), "x.json".as_ref()).unwrap();

        let clipped = read(&StabilityCase { body, ..coverage() });
        let Task::ClipTri(task) = &clipped.task else { panic!("{clipped:?}") };
        assert_eq!(task.corners(0).map(bits), Some(bits(corners)));
        let Ok(Answer::ClipTri(drawn)) = answer(&clipped) else { panic!("not answered") };
        assert!(drawn.triangles[0].spans.is_empty(), "a triangle with non-finite corners covers nothing");

        let Ok(Answer::TriCoverage(drawn)) = answer(&read(&coverage())) else { panic!("not answered") };
        assert!(drawn.triangles.iter().all(|covered| covered.spans.is_empty()));
    }

    #[test]
    fn a_part_of_a_mesh_need_not_cover_the_image() {
        let Body::TriCoverage(part) = coverage().only(&[1]).body else { unreachable!("still a coverage case") };
        assert_eq!((part.triangles.len(), part.exactly_once), (1, false));
    }
}
