//! Numeric values of one fragment in the inspector: depth, vertices, edges, transparency and shading.

use eframe::egui::{self, RichText, Ui};

use super::{codes, to_color};
use crate::inspect::pixel::Absent;
use crate::inspect::pixel::{ShadingRecord, TextureMap};
use crate::inspect::{DepthRecord, FragmentRecord};
use crate::pipeline::settings::{Arithmetic, Choice as _};
use crate::scene::Transparency;
use crate::ui::format;
use crate::ui::theme::{self, tokens};
use crate::ui::widgets::{section_header, swatch, value_row};

/// Tooltip that explains the resolution of the depth buffer.
const STEP_HELP: &str = "Distance along the line of sight, in world units, from the fragment's depth to the next \
                         storable depth: surfaces closer together than this may z-fight";

/// Draws all values computed for a fragment.
pub(super) fn numbers(ui: &mut Ui, fragment: &FragmentRecord) {
    section_header(ui, "Depth", |_| {});
    depth_rows(ui, "Depth of the fragment", fragment.depth, "Value stored if the fragment passes the depth test");
    if let Some(bias) = fragment.depth_bias {
        float_row(
            ui,
            "Depth bias",
            bias,
            "Offset added to all depths of the triangle before the depth test; the sum is clamped to 0…1",
        );
    }
    match fragment.stored_depth {
        Some(stored) => {
            depth_rows(ui, "Depth in the buffer", stored, "Content of the depth buffer before this fragment");
            let step = format::f32_full(fragment.depth.resolution as f32);
            value_row(ui, "Depth resolution", &step, STEP_HELP);
        }
        None => {
            value_row(ui, "Depth in the buffer", "–", "Without a depth test, no depth is stored");
        }
    }
    section_header(ui, "Corners", |_| {});
    corner_table(ui, fragment);
    section_header(ui, "Edges", |_| {});
    let (exact, unit) = match fragment.arithmetic {
        Arithmetic::Fixed => (
            "Exact edge value in 1/65536 px²",
            "Twice the area of the triangle: exactly the sum of the three edge values",
        ),
        Arithmetic::Exact => (
            "Edge value in px² times a power of two; its sign is exact",
            "Twice the area of the triangle: the sum of the three edge values, up to rounding",
        ),
        Arithmetic::F32 | Arithmetic::F64 => (
            "Edge value in px² times a power of two, rounded",
            "Twice the area of the triangle: the sum of the three edge values, up to rounding",
        ),
    };
    for (i, edge) in fragment.edges.into_iter().enumerate() {
        let help = format!("{exact}: above zero is inside, zero lies on the edge");
        value_row(ui, &format!("Edge opposite v{i}"), &format::edge(edge), &help);
    }
    value_row(ui, "Twice the area", &format::edge(fragment.doubled_area), unit);
    let triangle = fragment.triangle.0.to_string();
    value_row(ui, "Triangle", &triangle, "Number of the triangle in the scene, in drawing order, from 0");
    value_row(
        ui,
        "Triangle slider",
        &(fragment.submission + 1).to_string(),
        "First position of the triangle slider at which this fragment is drawn",
    );
    if let Some(alpha) = fragment.alpha {
        let help = if fragment.transparency == Transparency::Blended {
            "Opacity of the fragment over the surfaces behind it: opacity of the material × alpha of the texture"
        } else {
            "Alpha of the texture; below one half the alpha test discards the fragment"
        };
        section_header(ui, "Transparency", |_| {});
        float_row(ui, "Alpha", alpha, help);
    }
    if let Some(shading) = &fragment.shading {
        shading_numbers(ui, shading);
    }
}

/// Draws the known values of a triangle that has no fragment at this pixel.
pub(super) fn absent_numbers(ui: &mut Ui, absent: &Absent) {
    section_header(ui, "Triangle without a fragment", |_| {});
    value_row(ui, "Triangle", &absent.triangle.0.to_string(), "Number of the triangle in the scene, from 0");
    if let Some(distance) = absent.distance_px {
        let help = "Distance from the pixel's centre to the nearest point of the triangle, computed in fixed point \
                    with snapped vertices";
        value_row(ui, "Distance, px", &format!("{distance:.6}"), help);
    }
    for (i, edge) in absent.edges.into_iter().flatten().enumerate() {
        let help = "Edge value at the pixel's centre: below zero is outside, zero lies on the edge";
        value_row(ui, &format!("Edge opposite v{i}"), &format::edge(edge), help);
    }
}

/// Draws a depth value, and the stored integer if the depth format stores integers.
fn depth_rows(ui: &mut Ui, label: &str, depth: DepthRecord, help: &str) {
    float_row(ui, label, depth.value, help);
    if let Some(code) = depth.code {
        value_row(ui, "Stored as integer", &code.to_string(), "The integer that the buffer stores for this depth");
    }
}

fn float_row(ui: &mut Ui, label: &str, value: f32, help: &str) {
    value_row(ui, label, &format::f32_full(value), &format!("{help}. Bits: {}", format::bits(value)));
}

fn corner_table(ui: &mut Ui, fragment: &FragmentRecord) {
    egui::Grid::new("corners").num_columns(5).spacing([8.0, 2.0]).show(ui, |ui| {
        for heading in ["", "x px", "y px", "depth", "1/w"] {
            ui.label(RichText::new(heading).small().color(tokens(ui).text_weak));
        }
        ui.end_row();
        for (i, color) in theme::WEIGHTS.into_iter().enumerate() {
            ui.label(RichText::new(format!("v{i}")).monospace().color(color));
            let [x, y] = fragment.corners_px[i];
            let texts = [
                format::fixed(f64::from(x), 3),
                format::fixed(f64::from(y), 3),
                format::fixed(f64::from(fragment.corner_depths[i]), 5),
                format!("{:.3e}", fragment.inv_w[i]),
            ];
            for text in texts {
                ui.label(RichText::new(text).monospace());
            }
            ui.end_row();
        }
    });
}

fn shading_numbers(ui: &mut Ui, shading: &ShadingRecord) {
    section_header(ui, "Shading", |_| {});
    if let Some([u, v]) = shading.uv {
        value_row(ui, "Texture coordinates", &format!("{u:.6}  {v:.6}"), "Texture coordinates: u to the right, v down");
    }
    if let Some([x, y, z]) = shading.normal {
        value_row(ui, "Normal", &format!("{x:.3} {y:.3} {z:.3}"), "Unit normal in world space");
    }
    if let Some(cosine) = shading.cosine {
        float_row(ui, "N·L", cosine, "Cosine of the angle between normal and light direction");
    }
    if let Some(light) = shading.light {
        float_row(ui, "Light", light, "Factor by which lighting multiplies the surface colour");
    }
    if let Some(highlight) = shading.highlight {
        float_row(ui, "Highlight", highlight, "Factor of the specular colour: max(0, N·H)^Ns");
    }
    if let Some([r, g, b]) = shading.emission {
        value_row(ui, "Emission", &format!("{r:.4}  {g:.4}  {b:.4}"), "Emitted light, added after lighting is applied");
    }
    for texel in &shading.texels {
        // Wraps in a narrow panel, where the weight would be cut off.
        let row = ui.horizontal_wrapped(|ui| {
            swatch(ui, to_color(texel.color));
            let level = if texel.level > 0 { format!("level {} ", texel.level) } else { String::new() };
            let place = format!("{level}texel {}, {}", texel.tap.x, texel.tap.y);
            ui.label(RichText::new(place).monospace());
            ui.label(RichText::new(format!("× {}", format::f32_full(texel.tap.weight))).monospace());
            if texel.map != TextureMap::Color {
                ui.weak(texel.map.name());
            }
        });
        row.response.on_hover_text(texel.map.help());
    }
    if let Some(below) = shading.below {
        ui.horizontal(|ui| {
            swatch(ui, to_color(below));
            ui.label(RichText::new(format!("behind   {}", codes(below))).monospace());
        });
    }
    ui.horizontal(|ui| {
        swatch(ui, to_color(shading.color));
        ui.label(RichText::new(format!("written  {}", codes(shading.color))).monospace());
    });
}
