//! Search for a vertex: parsing its name and locating it in the picture.

use super::{SearchResult, named};
use crate::chain::{Frame, Recipe};
use crate::inspect::vertices::{ObjectVertices, plane_name};
use crate::scene::Scene;

/// Parses text such as "vertex 12 of knot", "v12 of knot" or "v12". Without a name, the vertex belongs to the object
/// with the number `near`, or to the only object. Returns `None` if the text does not have this form. The error states
/// which object or vertex does not exist.
pub(super) fn parse(text: &str, scene: &Scene, near: Option<u32>) -> Option<Result<(u32, u32), String>> {
    let text = text.trim().to_lowercase();
    let (number, name) = text.split_once(" of ").map_or((text.as_str(), None), |(number, name)| (number, Some(name)));
    let number = ["vertex", "v"].iter().find_map(|word| number.strip_prefix(word))?;
    let number: u32 = number.trim().parse().ok()?;
    Some(object(scene, name, near).and_then(|object| checked(scene, object, number)))
}

/// Returns the number of the object with this name. Without a name, returns `near` or the number of the only object.
fn object(scene: &Scene, name: Option<&str>, near: Option<u32>) -> Result<u32, String> {
    let Some(name) = name.map(str::trim) else {
        let only = (scene.instances.len() == 1).then_some(0);
        let which = || "No object given: pick one of its pixels, or enter “vertex 12 of NAME”".to_owned();
        return near.or(only).ok_or_else(which);
    };
    let exact = named(scene, |instance| instance.to_lowercase() == name);
    let all = || named(scene, |instance| instance.to_lowercase().contains(name));
    exact.first().copied().or_else(|| all().first().copied()).ok_or_else(|| format!("No object is named “{name}”"))
}

fn checked(scene: &Scene, object: u32, number: u32) -> Result<(u32, u32), String> {
    let instance = scene.instances.get(object as usize).ok_or("This object does not exist")?;
    let count = scene.library.mesh(instance.mesh).positions.len();
    if (number as usize) < count {
        Ok((object, number))
    } else {
        Err(format!("“{}” has {count} vertices, numbered from 0", instance.name))
    }
}

/// Returns the display name of a vertex, such as `Vertex 7 of “knot”`.
pub(super) fn words(scene: &Scene, object: u32, number: u32) -> String {
    let name = scene.instances.get(object as usize).map_or("", |instance| instance.name.as_str());
    format!("Vertex {number} of “{name}”")
}

/// Returns the pixel of a vertex in a frame, or the reason why the vertex has no pixel.
pub(super) fn find(scene: &Scene, recipe: &Recipe, frame: &Frame, (object, number): (u32, u32)) -> SearchResult {
    let words = words(scene, object, number);
    let size = frame.viewport;
    let vertices = ObjectVertices::new(scene, &frame.camera, &recipe.pipeline, size, object as usize);
    let Some(vertex) = vertices.and_then(|vertices| vertices.stages(number)) else {
        return SearchResult::Nowhere(format!("{words} does not exist"));
    };
    let beyond: Vec<_> = vertex.outcode.planes().map(plane_name).collect();
    let Some(screen) = vertex.screen.filter(|_| beyond.is_empty()) else {
        return SearchResult::Nowhere(if beyond.is_empty() {
            format!("{words} has no finite position in the picture")
        } else {
            format!("{words} lies outside the view, beyond: {}", beyond.join(", "))
        });
    };
    // Positions on the right and bottom border of the view lie past the last pixel.
    let [x, y] = screen.px;
    let pixel = ((x as u32).min(size.width - 1), (y as u32).min(size.height - 1));
    let mut text = format!("{words} lies at {x:.3}, {y:.3} px, {:.4} units from the eye", -vertex.view.z);
    if let Some(shown) = shown_distance(frame, pixel) {
        text += &format!("; the surface at this pixel is {shown:.4} units from the eye");
    }
    SearchResult::At(pixel, text)
}

/// Returns the distance from the eye to the visible surface at a pixel, along the view axis, in world units; `None`
/// without a stored depth.
fn shown_distance(frame: &Frame, (x, y): (u32, u32)) -> Option<f64> {
    let (column, row) = frame.sample_at(x, y)?;
    let depth = frame.drawn.depth.as_ref()?.at(column, row);
    (depth != frame.drawn.clear_depth).then(|| frame.depth_scale().distance_of(depth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::find::SearchTarget;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 64, height: 48 };

    #[test]
    fn vertices_are_parsed_by_number_and_object() {
        let scene = builtin::by_id("cubes").unwrap().build();
        let name = scene.instances[3].name.to_lowercase();
        for text in [format!("vertex 7 of {name}"), format!("V7 of {}", name.to_uppercase())] {
            let Some(Ok((object, 7))) = parse(&text, &scene, None) else { panic!("{text}") };
            assert_eq!(scene.instances[object as usize].name.to_lowercase(), name);
        }
        assert_eq!(parse("v 7", &scene, Some(5)), Some(Ok((5, 7))));
        assert!(parse("v7", &scene, None).unwrap().unwrap_err().contains("No object given"));
        assert!(parse("v999999", &scene, Some(5)).unwrap().unwrap_err().contains("vertices, numbered from 0"));
        assert!(parse("v7 of nothing", &scene, None).unwrap().unwrap_err().contains("nothing"));
        assert_eq!(parse("12,3", &scene, None), None);
        assert_eq!(parse("vase", &scene, None), None, "this may be the name of an object");
    }

    #[test]
    fn a_vertex_is_found_in_its_pixel_or_reported_as_outside() {
        let recipe = Recipe::default();
        let (mut inside, mut outside) = (0, 0);
        for id in ["cubes", "near-plane"] {
            let scene = builtin::by_id(id).unwrap().build();
            let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
            let clip_from_world =
                scene.home.clip_from_view(SIZE.aspect(), crate::scene::DepthMapping::STANDARD).as_dmat4()
                    * scene.home.view_from_world_f64();
            for object in 0..scene.instances.len() as u32 {
                let instance = &scene.instances[object as usize];
                for number in 0..scene.library.mesh(instance.mesh).positions.len() as u32 {
                    let model = scene.library.mesh(instance.mesh).positions[number as usize];
                    let clip = clip_from_world * instance.world_from_model.as_dmat4() * model.as_dvec3().extend(1.0);
                    let ndc = clip.truncate() / clip.w;
                    let found = super::super::find(&scene, &recipe, &frame, &SearchTarget::Vertex(object, number));
                    match found {
                        SearchResult::At((x, y), text) => {
                            let place = [(ndc.x * 0.5 + 0.5) * 64.0, (0.5 - ndc.y * 0.5) * 48.0];
                            let off = (place[0] - f64::from(x) - 0.5).abs().max((place[1] - f64::from(y) - 0.5).abs());
                            assert!(clip.w > 0.0 && off < 0.501, "{text}: {place:?}");
                            inside += 1;
                        }
                        SearchResult::Nowhere(text) => {
                            let is_out = clip.w <= 0.0 || ndc.abs().max_element() > 0.999 || ndc.z < 0.001;
                            assert!(is_out && text.contains("outside the view"), "{text}: {ndc}");
                            outside += 1;
                        }
                        other => panic!("{other:?}"),
                    }
                }
            }
        }
        assert!(inside > 100 && outside > 2, "{inside} {outside}");
    }
}
