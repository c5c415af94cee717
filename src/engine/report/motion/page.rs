//! HTML page of a motion report: the table, and the error of every frame.

use std::fmt::Write as _;

use super::{GHOST_FRAMES, MotionReport};
use crate::report::html::{command_section, document, escaped, partial, table};
use crate::report::plot::{Plot, PlotAxis, svg, tick};

/// Style of the plot of errors over time.
const STYLE: &str = "svg .curve { fill: none; stroke-width: 1.6; } svg .curve:hover { stroke-width: 4; }\n";

/// Largest number of curves: those of the methods with the smallest mean error. More cannot be told apart.
const CURVES: usize = 8;

pub(super) fn html(report: &MotionReport, command: &str) -> String {
    let MotionReport { scene, size_px: [width, height], frames, frames_per_second, samples_per_pixel, .. } = report;
    let mut body = format!(
        "<h1>Upscalers in motion: {}</h1>\n{}<p>{frames} frames of {width} × {height} px at {frames_per_second} frames \
         per second, each compared with its reference of {samples_per_pixel} samples per pixel. {:.2} % of the pixels \
         are disoccluded.</p>\n",
        escaped(scene),
        partial(report.partial),
        report.disoccluded_share * 100.0
    );
    let rows = report.rows();
    let _ = write!(
        body,
        "<section>\n<h2>Methods</h2>\n{}<p class=\"soft\">JOD: ColorVideoVDP, 10 for no visible difference, at {} pixels \
         per degree. Flicker: change of the error along the motion, in luma codes. Ghosting: FLIP error within \
         {GHOST_FRAMES} frames after a disocclusion minus that of all other pixels.</p>\n</section>\n",
        table(&MotionReport::HEADS, rows, false),
        report.pixels_per_degree
    );
    let _ = write!(body, "<section>\n<h2>Error over time</h2>\n{}</section>\n", curves(report));
    body.push_str(&command_section(command));
    document("Upscalers in motion", STYLE, &body)
}

/// Returns the plot of the FLIP error of every frame, and its key.
fn curves(report: &MotionReport) -> String {
    let mut methods: Vec<_> = report.methods.iter().collect();
    methods.sort_by(|a, b| a.error.mean.flip.total_cmp(&b.error.mean.flip));
    methods.truncate(CURVES);
    let errors = methods.iter().flat_map(|method| method.errors.iter().map(|error| error.flip));
    let x = PlotAxis { low: 0.0, high: f64::from(report.frames.max(2) - 1), is_log: false };
    let plot = Plot { x, y: PlotAxis::from_zero(errors), lane: 0.0 };
    let mut content = plot.axes("frame", "mean FLIP error", tick);
    let mut key = String::new();
    for (number, method) in methods.iter().enumerate() {
        let color = format!("hsl({} 65% 50%)", number * 360 / CURVES);
        let points = method
            .errors
            .iter()
            .zip(0..)
            .map(|(error, frame)| format!("{:.1},{:.1}", plot.x(f64::from(frame)), plot.y(error.flip)));
        let _ = write!(
            content,
            "<g><title>{}</title><polyline class=\"curve\" stroke=\"{color}\" points=\"{}\"/></g>",
            escaped(&method.label),
            points.collect::<Vec<_>>().join(" ")
        );
        let _ = write!(key, "<li style=\"color: {color}\">{}</li>", escaped(&method.label));
    }
    format!("{}<ul>{key}</ul>\n", svg("Error over time", &content))
}
