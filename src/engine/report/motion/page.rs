//! HTML page of a motion report: the table, the error of every frame, and the pictures of all methods in each frame.
//!
//! A click on a frame of the plot follows a link to the pictures of the frame, so that the page needs no script.

use std::fmt::Write as _;

use super::sheet::FrameSheet;
use super::{GHOST_FRAMES, MethodInMotion, MotionReport};
use crate::report::html::{command_section, document, escaped, partial, table};
use crate::report::plot::{BOTTOM, HEIGHT, Plot, PlotAxis, TOP, svg, tick};

/// Style of the plot and of the pictures.
const STYLE: &str = include_str!("page.css");

/// Largest number of curves: those of the methods with the smallest mean error. More cannot be told apart.
const CURVES: usize = 8;

/// Largest number of points of a curve. Each point of a longer clip shows the largest error of several frames.
const MAX_POINTS: usize = 720;

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
    let _ = write!(
        body,
        "<section>\n<h2>Methods</h2>\n{}<p class=\"soft\">{}JOD: ColorVideoVDP, 10 for no visible difference, at {} \
         pixels per degree. Flicker: change of the error along the motion, in luma codes. Ghosting: FLIP error within \
         {GHOST_FRAMES} frames after a disocclusion minus that of all other pixels. Lag: frames by which moving surfaces \
         are behind the reference. Rejection: agreement of the pixels whose history is rejected with the exact \
         disocclusion.</p>\n</section>\n",
        table(&MotionReport::HEADS, report.rows(), false),
        report.noise.map_or_else(String::new, |noise| format!("Noise floor of the times: {}. ", noise.words())),
        report.pixels_per_degree
    );
    let _ = write!(
        body,
        "<section>\n<h2>Error over time</h2>\n{}{}</section>\n",
        if report.sheets.is_empty() { "" } else { "<p class=\"soft\">Click a frame to see its pictures.</p>\n" },
        curves(report)
    );
    body.push_str(&frames_section(report));
    body.push_str(&command_section(command));
    document("Upscalers in motion", STYLE, &body)
}

/// Returns the methods with a curve, in ascending order of their mean errors.
fn plotted(report: &MotionReport) -> Vec<&MethodInMotion> {
    let mut methods: Vec<_> = report.methods.iter().collect();
    methods.sort_by(|a, b| a.error.mean.flip.total_cmp(&b.error.mean.flip));
    methods.truncate(CURVES);
    methods
}

/// Returns the plot of the FLIP error of every frame, and its key.
fn curves(report: &MotionReport) -> String {
    let methods = plotted(report);
    let errors = methods.iter().flat_map(|method| method.errors.iter().map(|error| error.flip));
    let x = PlotAxis { low: 0.0, high: f64::from(report.frames.max(2) - 1), is_log: false };
    let plot = Plot { x, y: PlotAxis::from_zero(errors), lane: 0.0 };
    let mut content = plot.axes("frame", "mean FLIP error", tick);
    report.sheets.iter().for_each(|sheet| content += &frame_link(report, &plot, sheet.frame));
    let mut key = String::new();
    for (number, method) in methods.iter().enumerate() {
        let color = format!("hsl({} 65% 50%)", number * 360 / CURVES);
        let label = escaped(&method.label);
        let points = curve(method).into_iter().map(|(x, y)| format!("{:.1},{:.1}", plot.x(x), plot.y(y)));
        let points = points.collect::<Vec<_>>().join(" ");
        let _ = write!(content, "<polyline class=\"curve\" stroke=\"{color}\" points=\"{points}\"/>");
        let marks =
            report.sheets.iter().filter_map(|sheet| Some((sheet.frame, method.errors.get(sheet.frame as usize)?)));
        for (frame, error) in marks {
            let _ = write!(
                content,
                "<a href=\"#frame-{frame}\"><circle class=\"point\" fill=\"{color}\" cx=\"{:.1}\" cy=\"{:.1}\"><title>{label}, \
                 frame {frame}: FLIP {:.4}</title></circle></a>",
                plot.x(frame.into()),
                plot.y(error.flip),
                error.flip
            );
        }
        let _ = write!(key, "<li style=\"color: {color}\">{label}</li>");
    }
    format!("<div class=\"over-time\">{}<ul class=\"key\">{key}</ul></div>\n", svg("Error over time", &content))
}

/// Returns frame numbers and errors of a curve, at most [`MAX_POINTS`].
fn curve(method: &MethodInMotion) -> Vec<(f64, f64)> {
    let frames_per_point = method.errors.len().div_ceil(MAX_POINTS).max(1);
    let points = method.errors.chunks(frames_per_point).zip((0_u32..).step_by(frames_per_point));
    points
        .map(|(errors, frame)| (f64::from(frame), errors.iter().map(|error| error.flip).fold(0.0, f64::max)))
        .collect()
}

/// Returns the column of the plot that is a link to the pictures of a frame.
fn frame_link(report: &MotionReport, plot: &Plot, frame: u32) -> String {
    let half = (plot.x(f64::from(super::sheet::step(report.frames))) - plot.x(0.0)) / 2.0;
    format!(
        "<a href=\"#frame-{frame}\"><rect class=\"hit\" x=\"{:.1}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"><title>Frame \
         {frame}</title></rect></a>",
        plot.x(frame.into()) - half,
        2.0 * half,
        HEIGHT - BOTTOM - TOP
    )
}

/// Returns the pictures of every frame, of which the page shows one, and the errors of every frame as a table.
fn frames_section(report: &MotionReport) -> String {
    let Some(first) = worst_frame(report) else { return String::new() };
    let mut html = "<div class=\"frames\">\n".to_owned();
    for (number, sheet) in report.sheets.iter().enumerate() {
        let class = if sheet.frame == first { "frame first" } else { "frame" };
        let to = |index: Option<usize>, name: &str| {
            let sheet = index.and_then(|index| report.sheets.get(index));
            sheet.map_or_else(String::new, |sheet| format!(" <a href=\"#frame-{}\">{name}</a>", sheet.frame))
        };
        let _ = write!(
            html,
            "<section class=\"{class}\" id=\"frame-{frame}\" style=\"--sheet: url({source})\">\n<h2>Frame {frame}</h2>\n<p \
             class=\"soft\">Picture and FLIP error (black: none, white: 1); for the reference, disoccluded pixels in \
             white.{previous}{next}</p>\n<div class=\"strips\">\n{strips}</div>\n</section>\n",
            frame = sheet.frame,
            source = sheet.source(),
            previous = to(number.checked_sub(1), "Previous frame"),
            next = to(Some(number + 1), "Next frame"),
            strips = strips(report, sheet)
        );
    }
    html + "</div>\n" + &error_table(report)
}

/// Returns the frame with pictures whose mean error over all methods is largest, or `None` without pictures.
fn worst_frame(report: &MotionReport) -> Option<u32> {
    let error =
        |frame: u32| report.methods.iter().filter_map(move |method| Some(method.errors.get(frame as usize)?.flip));
    let frames = report.sheets.iter().map(|sheet| sheet.frame);
    frames.max_by(|a, b| error(*a).sum::<f64>().total_cmp(&error(*b).sum()))
}

/// Returns the rows of a contact sheet with their names and errors.
fn strips(report: &MotionReport, sheet: &FrameSheet) -> String {
    let methods = report.methods.iter().map(|method| {
        let error = method.errors.get(sheet.frame as usize);
        let words = |flip: f64, psnr: f64| format!("FLIP {flip:.4}, PSNR {psnr:.2} dB");
        (&*method.label, error.map_or_else(String::new, |error| words(error.flip, error.codes.psnr_db)))
    });
    let all = std::iter::once(("Reference", String::new())).chain(methods).zip(0..);
    let strip = |((label, words), row): ((&str, String), u32)| {
        format!(
            "<figure><div class=\"strip\" role=\"img\" aria-label=\"{label}\" style=\"aspect-ratio: {:.4}; \
             background-position: 0 {:.3}%\"></div><figcaption><b>{label}</b> {words}</figcaption></figure>\n",
            sheet.aspect(),
            sheet.position_percent(row),
            label = escaped(label)
        )
    };
    all.map(strip).collect()
}

/// Returns the FLIP errors of the frames with pictures as a table.
fn error_table(report: &MotionReport) -> String {
    let heads: Vec<_> = std::iter::once("frame").chain(report.methods.iter().map(|method| &*method.label)).collect();
    let row = |sheet: &FrameSheet| {
        let errors = report.methods.iter().map(|method| method.errors.get(sheet.frame as usize));
        let cells = errors.map(|error| error.map_or_else(String::new, |error| format!("{:.4}", error.flip)));
        std::iter::once(sheet.frame.to_string()).chain(cells).collect()
    };
    format!(
        "<section>\n<h2>FLIP of every frame</h2>\n{}</section>\n",
        table(&heads, report.sheets.iter().map(row), false)
    )
}
