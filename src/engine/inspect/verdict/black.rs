//! Explanation of a black pixel: the factors of its colour that are close to zero.

use glam::Vec3;

use super::flaw::{LOST_NORMALS, lost_normals};
use super::instance_of;
use crate::chain::Recipe;
use crate::image::color::decode_rgb;
use crate::inspect::lesson::{BLACK_CODE, is_black};
use crate::inspect::pixel::{FragmentRecord, PixelReport, ShadingRecord, TextureMap};
use crate::pipeline::settings::{ColorSpace, Settings};
use crate::pipeline::shade::to_working_space;
use crate::pipeline::shading::{Input, ShadingKind, cel};
use crate::scene::{Instance, Scene};

/// Explains a black pixel. Returns `None` if it is not black, or if its visible fragment is partly transparent.
pub(super) fn why(report: &PixelReport, scene: &Scene, recipe: &Recipe) -> Option<String> {
    let visible = report.visible().filter(|fragment| fragment.covers_all())?;
    let shading = visible.shading.as_ref().filter(|shading| is_black(shading.color))?;
    let (_, instance) = instance_of(scene, visible.triangle)?;
    let settings = &recipe.pipeline;
    let why = match settings.shading.kind() {
        ShadingKind::Material => factors(scene, settings, instance, visible, shading),
        ShadingKind::Surface if settings.shading.reads(Input::VertexColor) => {
            vec![format!("the vertex colours here are {}", numbers(shading.vertex_color?.into()))]
        }
        ShadingKind::Quantity | ShadingKind::Surface | ShadingKind::Flat => {
            return Some(number_shown(settings, visible));
        }
    };
    let why = if why.is_empty() { product(scene, settings, instance, shading) } else { why.join(", and ") };
    Some(format!("Black: {why}."))
}

/// Whether a colour factor is so small that it alone makes the product black, in the colour space of the settings.
fn is_nothing(factor: f32, settings: &Settings) -> bool {
    let code = f32::from(BLACK_CODE) / 255.0;
    let limit = if settings.color_space == ColorSpace::Linear { decode_rgb(Vec3::splat(code)).x } else { code };
    factor <= limit
}

/// Describes each factor that alone makes the pixel's colour black, and states its value.
fn factors(
    scene: &Scene,
    settings: &Settings,
    instance: &Instance,
    visible: &FragmentRecord,
    shading: &ShadingRecord,
) -> Vec<String> {
    let material = scene.library.material(instance.material);
    let nothing = |factor: f32| is_nothing(factor, settings);
    let mut found = Vec::new();
    let own = material.diffuse * instance.tint;
    if nothing(to_working_space(own, settings.color_space).max_element()) {
        let whose = if instance.tint == Vec3::ONE { "" } else { " times the tint of the object" };
        let color = format!("the colour of its material “{}”{whose}", material.name);
        found.push(match &material.missing_texture {
            Some(file) => {
                format!("the texture “{file}” could not be read, and the fallback, {color}, is {}", numbers(own))
            }
            None => format!("{color} is {}", numbers(own)),
        });
    }
    if let Some(color) = shading.vertex_color.map(Vec3::from).filter(|color| nothing(color.max_element())) {
        found.push(format!("the vertex colours here are {}", numbers(color)));
    }
    let brightest =
        shading.texels_of(TextureMap::Color).filter(|texel| texel.tap.weight > 0.0).map(|texel| texel.color);
    if let Some([r, g, b, _]) = brightest.max_by_key(|[r, g, b, _]| *r.max(g).max(b)).filter(|color| is_black(*color)) {
        found.push(format!("every texel that it reads is black, the brightest {r} {g} {b}"));
    }
    if shading.light.is_some_and(nothing) {
        found.push(darkness(settings, shading, &lost_normals(visible, scene)));
    }
    found
}

/// Explains why a fragment receives no light. `lost` names the corners of its triangle whose normals the loader
/// discarded.
fn darkness(settings: &Settings, shading: &ShadingRecord, lost: &[&str]) -> String {
    let ambient = settings.light.ambient;
    let reads = |input| settings.shading.reads(input);
    let has_none = shading.normal == Some([0.0; 3]) || reads(Input::VertexLight);
    match shading.cosine {
        _ if has_none && lost.len() == 3 => {
            format!(
                "the normal at its corners {LOST_NORMALS}, so it receives no direct light, and light.ambient is \
                 {ambient}"
            )
        }
        _ if reads(Input::VertexLight) => {
            format!(
                "the light at its corners is close to 0: they face away from the light, and light.ambient is {ambient}"
            )
        }
        _ if shading.normal == Some([0.0; 3]) => {
            format!("it has no normal, so it receives no direct light, and light.ambient is {ambient}")
        }
        Some(cosine) if reads(Input::DarkTexture) => {
            format!("N·L is {cosine:.3}, not above {}: the dark side", cel::THRESHOLD)
        }
        Some(cosine) => {
            format!("N·L is {cosine:.3}: it faces away from the light, and light.ambient is {ambient}")
        }
        None => format!("it receives no light, and light.ambient is {ambient}"),
    }
}

/// Describes a product of colour factors that is black although no single factor is.
fn product(scene: &Scene, settings: &Settings, instance: &Instance, shading: &ShadingRecord) -> String {
    let material = scene.library.material(instance.material);
    let mut factors = vec![format!("material {}", numbers(material.diffuse * instance.tint))];
    factors.extend(shading.vertex_color.map(|color| format!("vertex colour {}", numbers(color.into()))));
    let weightiest = shading.texels_of(TextureMap::Color).max_by(|a, b| a.tap.weight.total_cmp(&b.tap.weight));
    factors.extend(weightiest.map(|texel| {
        let [r, g, b, _] = texel.color;
        format!("texel {r} {g} {b}")
    }));
    if settings.shading.is_lit() {
        factors.extend(shading.light.map(|light| format!("light {light:.3}")));
    }
    format!("a product of dark factors: {}", factors.join(" × "))
}

/// Explains a black pixel in a shading mode that shows a quantity as a colour.
fn number_shown(settings: &Settings, visible: &FragmentRecord) -> String {
    if settings.shading.reads(Input::Depth) {
        return format!("Black: the shading shows depth, which is {} here.", visible.depth);
    }
    "Black: the shading shows a quantity as a colour, and here it is close to 0.".to_owned()
}

/// Formats a colour as its three components in parentheses, rounded to three decimals.
fn numbers(color: Vec3) -> String {
    let [r, g, b] = color.to_array().map(|c| (c * 1000.0).round() / 1000.0);
    format!("({r}, {g}, {b})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::image::Image;
    use crate::inspect::inspect;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::{Camera, Library, Material, Mesh, MeshData, Texture};

    const VIEW: Viewport = Viewport { width: 9, height: 9 };

    /// Returns the verdict at the centre of one front-facing triangle with this material.
    fn verdict(material: impl FnOnce(&mut Library) -> Material, colors: Vec<Vec3>, settings: &[&str]) -> String {
        let mut recipe = Recipe::default();
        recipe.set_all(settings).unwrap();
        let mut library = Library::default();
        let material = material(&mut library);
        let mesh = MeshData {
            positions: vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::Y],
            uvs: vec![glam::Vec2::splat(0.5); 3],
            colors,
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        };
        let (mesh, material) = (library.add_mesh(Mesh::new(mesh).unwrap()), library.add_material(material));
        let world_from_model = glam::Mat4::IDENTITY;
        let instances = vec![Instance { name: "cow".into(), mesh, material, world_from_model, tint: Vec3::ONE }];
        let home = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
        let scene = Scene {
            name: "test".into(),
            library,
            instances,
            background: [40; 3],
            home,
            views: Vec::new(),
            light: None,
            animation: None,
        };
        let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        inspect(&scene, &recipe, &frame, 4, 4).unwrap().verdict
    }

    fn white(_: &mut Library) -> Material {
        Material::plain("white", Vec3::ONE)
    }

    fn after_black(verdict: &str) -> &str {
        let why = verdict.split_once("Black: ").map_or("", |(_, why)| why);
        why.strip_suffix(" Won by triangle 0 of “cow”, the only one here.").unwrap_or(why)
    }

    #[test]
    fn each_black_factor_is_named_with_its_number() {
        let away = ["light.direction=0,0,-1", "light.ambient=0"];
        let dark = verdict(white, Vec::new(), &away);
        assert_eq!(after_black(&dark), "N·L is -1.000: it faces away from the light, and light.ambient is 0.");
        let gouraud = verdict(white, Vec::new(), &[away[0], away[1], "shading=gouraud"]);
        assert!(after_black(&gouraud).starts_with("the light at its corners is close to 0"), "{gouraud}");
        let soot = verdict(|_| Material::plain("soot", Vec3::new(0.0, 0.01, 0.0)), Vec::new(), &[]);
        assert_eq!(after_black(&soot), "the colour of its material “soot” is (0, 0.01, 0).");
        let painted = verdict(white, vec![Vec3::ZERO; 3], &[]);
        assert_eq!(after_black(&painted), "the vertex colours here are (0, 0, 0).");
        let texture = |library: &mut Library| {
            let image = Image::filled(2, 2, [3, 4, 5, 255]);
            Material::textured("coal", library.add_texture(Texture::new(image).unwrap()))
        };
        assert_eq!(
            after_black(&verdict(texture, Vec::new(), &[])),
            "every texel that it reads is black, the brightest 3 4 5."
        );
        let both = verdict(|_| Material::plain("soot", Vec3::ZERO), Vec::new(), &away);
        assert!(both.contains("“soot” is (0, 0, 0), and N·L is -1.000"), "{both}");
    }

    #[test]
    fn a_product_of_dark_factors_is_explained_and_a_bright_pixel_is_not() {
        let dim = |_: &mut Library| Material::plain("dim", Vec3::splat(0.1));
        let why = verdict(dim, vec![Vec3::splat(0.2); 3], &[]);
        assert!(after_black(&why).starts_with("a product of dark factors: material (0.1, 0.1, 0.1) × vertex"), "{why}");
        assert_eq!(after_black(&verdict(white, Vec::new(), &[])), "");
    }
}
