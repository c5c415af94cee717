//! Upscaling report as a self-contained HTML page, without scripts, in the light or dark theme of the reader's system.

use std::io;

use super::measurements::NativeTimes;
use super::plot;
use super::skipping::PixelShareTimes;
use super::sweep::{SceneReport, UpscalingReport, UpscalingRow};
use crate::measure::error::ImageError;
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::measure::noise::WITHIN;
use crate::measure::rounds::WARM_UP_ROUNDS;
use crate::pipeline::settings::Choice as _;
use crate::report::html::{document, escaped, image_source, partial, tiles};
use crate::upscale::Anchor;

/// CSS rules specific to this page.
const STYLE: &str = include_str!("page.css");

/// Formats the upscaling report as an HTML page.
///
/// # Errors
///
/// Fails if a crop cannot be encoded as PNG.
pub fn page(report: &UpscalingReport) -> io::Result<String> {
    let mut body = head(report);
    for scene in &report.scenes {
        body += &section(report, scene)?;
    }
    body += &method(report);
    Ok(document("Error against run time", STYLE, &body))
}

fn head(report: &UpscalingReport) -> String {
    let [width, height] = report.size;
    let methods = report.scenes.first().map_or(0, |scene| scene.rows.len());
    let figures = [
        (report.scenes.len().to_string(), if report.scenes.len() == 1 { "scene" } else { "scenes" }),
        (methods.to_string(), "upscalers and scales"),
        (format!("{width} × {height}"), "pixels"),
        (report.rounds.to_string(), "interleaved rounds"),
        (report.threads.to_string(), "threads"),
    ];
    format!(
        "<h1>Error against run time</h1>\n<p class=\"soft\">Time saved by drawing fewer samples and upscaling, and \
         the resulting error. Every error is relative to one reference: <b>{}</b>. Rasterscope {}.</p>\n{}{}",
        escaped(report.reference),
        escaped(report.machines.version()),
        partial(report.partial),
        tiles(figures)
    )
}

fn section(report: &UpscalingReport, scene: &SceneReport) -> io::Result<String> {
    let native = scene.rows.iter().find(|row| row.recipe.upscaler.is_native());
    let best = scene.rows.iter().filter(|row| row.is_on_front()).count();
    Ok(format!(
        "<section>\n<h2>{}</h2>\n<p class=\"soft\">{} triangles. Down and to the left is better; {best} of {} points \
         are on the Pareto front, joined by the dashed line. Grey points are dominated, or their time advantage over \
         a more accurate point is within noise. Bars extend from the 10th to the 90th percentile; thin lines join the \
         scales of one method. Noise floor of the times: {}. {}{}</p>\n<div \
         class=\"panels\"><figure>{}</figure>{}</div>\n{}<h3>Table</h3>\n{}<h3>Region of the largest differences</h3>\n\
         <p class=\"soft\">{} × {} px from column {}, row {}, enlarged without filtering.</p>\n{}</section>\n",
        escaped(&scene.scene),
        scene.triangles,
        scene.rows.len(),
        scene.noise.words(),
        anchors(&scene.rows),
        scales(&scene.rows),
        plot::tradeoff(scene, report.metric),
        scene.shares.as_deref().map(|times| shares(times, scene.shares_machine.as_deref())).unwrap_or_default(),
        native.map(|native| sixteenth(&scene.rows, native, report.metric)).unwrap_or_default(),
        table(report, &scene.rows),
        scene.crop.right - scene.crop.left,
        scene.crop.bottom - scene.crop.top,
        scene.crop.left,
        scene.crop.top,
        crops(&scene.rows)?
    ))
}

/// Returns a sentence that lists the upscaling methods by anchor, which is the position of the sample in its block.
/// Returns an empty string if all methods have the same anchor.
fn anchors(rows: &[UpscalingRow]) -> String {
    let names = |anchor: Anchor| {
        let mut names: Vec<_> = Vec::new();
        for row in rows.iter().filter(|row| !row.recipe.upscaler.is_native() && row.recipe.upscaler.anchor() == anchor)
        {
            names.push(row.recipe.upscaler.upscaler().name());
        }
        names.dedup();
        names.join(", ")
    };
    let anchored: Vec<_> = Anchor::ALL.iter().map(|anchor| (anchor.name(), names(*anchor))).collect();
    if anchored.iter().filter(|(_, names)| !names.is_empty()).count() < 2 {
        return String::new();
    }
    let parts: Vec<_> =
        anchored.iter().map(|(anchor, names)| format!("{}: {}", escaped(anchor), escaped(names))).collect();
    format!("Anchors differ: the position of the sample in its block depends on the method. {}.", parts.join("; "))
}

/// Returns a sentence about times from different shards; empty if all rows were timed in the same rounds.
fn scales(rows: &[UpscalingRow]) -> &'static str {
    if rows.iter().all(|row| row.scale == 1.0) {
        return "";
    }
    " The rows were timed in several runs, each with the native frame in the same rounds. The plot and the ranking compare \
     their times as multiples of it; the table lists them as measured."
}

/// `machine` is the machine that measured the times, if there are several in the report.
fn shares(shares: &[PixelShareTimes], machine: Option<&str>) -> String {
    format!(
        "<figure>{}<div class=\"legend key\"><span class=\"skip\"><i></i>skipping pixels inside the loop</span><span \
         class=\"visit\"><i></i>visiting only the wanted pixels</span><span class=\"dashed\"><i></i>time of \
         rasterization; the rest is shading</span></div><figcaption>Both loops draw the same samples, triangle by \
         triangle on one thread, with the same edge functions, depth test and shading. Skipping inside the loop saves \
         only shading: the loop still visits every pixel, so the dashed line hardly falls.{}</figcaption></figure>",
        plot::shares(shares),
        machine.map(|machine| format!(" Measured on {}.", escaped(machine))).unwrap_or_default()
    )
}

/// Returns an HTML section that compares native rendering with the recipes that draw at most 1/16 of the pixels.
/// Returns an empty string if there are no such recipes.
fn sixteenth(rows: &[UpscalingRow], native: &UpscalingRow, metric: Metric) -> String {
    /// Largest fraction of drawn pixels that counts as 1/16. The tolerance covers block sizes that do not divide the
    /// image and therefore draw slightly more.
    const AT_MOST: f64 = 1.05 / 16.0;
    let mut few: Vec<&UpscalingRow> = rows.iter().filter(|row| row.drawn <= AT_MOST).collect();
    if few.is_empty() {
        return String::new();
    }
    few.sort_by(|a, b| a.error_in_motion(metric).total_cmp(&b.error_in_motion(metric)));
    let lines: String = few
        .into_iter()
        .map(|row| {
            let pixels = |native: NativeTimes| native.pixels / row.parts_ms.pixels.max(f64::MIN_POSITIVE);
            let cells = [
                format!("{:.3}", row.frame_ms.median),
                faster(row),
                row.native_ms.map(pixels).map_or_else(|| "–".to_owned(), |times| format!("{times:.1}×")),
                format!("{:.3}", row.parts_ms.upscale),
                format!("{:.4}", row.motion.mean.flip),
                format!("{:.2}", row.motion.mean.codes.psnr_db),
            ];
            let cells = cells.map(|cell| format!("<td>{cell}</td>")).concat();
            let dot = format!("<span class=\"dot\" {}></span>", plot::color(row));
            format!("<tr><td>{dot}{}</td>{cells}</tr>\n", escaped(&row.label))
        })
        .collect();
    format!(
        "<h3>A sixteenth of the pixels</h3>\n<p class=\"soft\">Compared with the native frame of {:.3} ms. The cost of \
         geometry does not depend on the number of pixels, and upscaling adds cost, so the gain depends on the share \
         of the frame time that is spent on pixels, {:.0} % here.</p>\n<div class=\"scroll\"><table \
         class=\"rows\">\n<thead><tr><th>upscaler</th><th>median ms</th><th>speed-up, frame</th><th>speed-up, \
         pixels</th><th>upscale ms</th><th>FLIP in motion</th><th>PSNR in motion, dB</th></tr></thead>\n\
         <tbody>\n{lines}</tbody></table></div>\n",
        native.frame_ms.median,
        100.0 * native.parts_ms.pixels / native.frame_ms.median.max(f64::MIN_POSITIVE)
    )
}

fn table(report: &UpscalingReport, rows: &[UpscalingRow]) -> String {
    let mut order: Vec<&UpscalingRow> = rows.iter().collect();
    order.sort_by(|a, b| a.comparable_ms().total_cmp(&b.comparable_ms()));
    let transfers = rows.iter().any(transfers);
    let columns = Columns { transfers, further: further(report.metric) };
    let lines: String = order.into_iter().map(|row| line(row, columns)).collect();
    let machine = if report.machines.are_several() { "<th class=\"words\">machine</th>" } else { "" };
    let transfer = if transfers { "<th>transfer</th>" } else { "" };
    let metric = columns.further.map_or_else(String::new, |metric| format!("<th>{} in motion</th>", metric.name()));
    format!(
        "{}<p class=\"soft\">{} The columns after them show errors of the still view.</p>\n<div class=\"scroll\"><table \
         class=\"rows\">\n<thead><tr><th>upscaler</th><th>anchor</th><th>light</th><th>drawn</th><th>median \
         ms</th><th>p10</th><th>p90</th><th>speed-up</th><th>geometry</th><th>pixels</th><th>upscale</th>{transfer}{metric}<th>FLIP in \
         motion</th><th>worst frame</th><th>PSNR in motion, dB</th><th>FLIP</th><th>PSNR \
         dB</th><th>SSIM</th><th>MSE</th><th>max</th><th>differing px</th><th class=\"words\">dominated \
         by</th>{machine}</tr></thead>\n<tbody>\n{lines}</tbody></table></div>\n",
        failures(rows),
        motion(report)
    )
}

/// Returns the failures of upscalers as HTML paragraphs.
fn failures(rows: &[UpscalingRow]) -> String {
    let mut texts: Vec<_> = rows.iter().filter_map(|row| row.failure.as_deref()).collect();
    texts.dedup();
    texts.iter().map(|text| format!("<p><b>Failure:</b> {}</p>\n", escaped(text))).collect()
}

/// Whether the upscaler of a row transfers pictures to another process.
fn transfers(row: &UpscalingRow) -> bool {
    row.recipe.upscaler.upscaler().process().is_some()
}

/// Returns a sentence that describes the camera motion during the error measurement.
fn motion(report: &UpscalingReport) -> String {
    let Turn { degrees, frames, .. } = report.turn;
    if report.turn.is_still() {
        return "The view is still: errors in motion equal those of the still view.".to_owned();
    }
    format!(
        "Errors in motion are means over {frames} frames while the camera orbits by {degrees}° per frame, each against \
         the reference of the same frame; methods with a history get {} frames to warm up.",
        Turn::WARM_UP
    )
}

/// Columns of the table that only some reports have.
#[derive(Clone, Copy)]
struct Columns {
    /// Whether there are transfers to and from processes.
    transfers: bool,
    /// Metric of the error axis, if the table has no other column for it.
    further: Option<Metric>,
}

/// Returns the metric of the error axis if the table has no column for it otherwise.
fn further(metric: Metric) -> Option<Metric> {
    (!matches!(metric, Metric::Flip | Metric::Psnr)).then_some(metric)
}

fn line(row: &UpscalingRow, columns: Columns) -> String {
    let (ms, codes, parts) = (row.frame_ms, row.error.codes, row.parts_ms);
    let psnr = |codes: ImageError| match codes.mse {
        0.0 => "identical".to_owned(),
        _ => format!("{:.2}", codes.psnr_db),
    };
    let (style, by) = match (&row.dominated_by, &row.within_noise_of) {
        (Some(by), _) => ("beaten", escaped(by)),
        (None, Some(of)) => ("beaten", format!("{WITHIN} of {}", escaped(of))),
        (None, None) => ("best", "none".to_owned()),
    };
    let transfer = if columns.transfers { format!("</td><td>{:.3}", parts.transfer) } else { String::new() };
    let value = |metric: Metric| format!("</td><td>{}", metric.format(row.motion.mean.value(metric)));
    let metric = columns.further.map_or_else(String::new, value);
    let cells = [
        row.recipe.upscaler.anchor().id().to_owned(),
        row.recipe.upscaler.light().id().to_owned(),
        format!("{:.1} %", row.drawn * 100.0),
        format!("{:.3}", ms.median),
        format!("{:.3}", ms.p10),
        format!("{:.3}", ms.p90),
        faster(row),
        format!("{:.3}", parts.geometry),
        format!("{:.3}", parts.pixels),
        format!("{:.3}", parts.upscale) + &transfer + &metric,
        format!("{:.4}", row.motion.mean.flip),
        format!("{:.4}", row.motion.worst.flip),
        psnr(row.motion.mean.codes),
        format!("{:.4}", row.error.flip),
        psnr(codes),
        format!("{:.4}", codes.ssim),
        format!("{:.2}", codes.mse),
        codes.max_abs.to_string(),
        codes.differing_pixels.to_string(),
    ];
    format!(
        "<tr class=\"{style}\"><td><span class=\"dot\" {}></span>{}</td>{}<td class=\"words\">{}</td>{}</tr>\n",
        plot::color(row),
        escaped(&row.label),
        cells.map(|cell| format!("<td>{cell}</td>")).concat(),
        by,
        row.machine.as_deref().map(|by| format!("<td class=\"words\">{}</td>", escaped(by))).unwrap_or_default()
    )
}

/// Returns the speed-up relative to native rendering in the same rounds as HTML, greyed out and labelled if the difference
/// is within noise.
fn faster(row: &UpscalingRow) -> String {
    let Some(native) = row.native_ms else { return "–".to_owned() };
    let text = format!("{:.2}×", native.frame / row.frame_ms.median.max(f64::MIN_POSITIVE));
    if row.native_within_noise { format!("<span class=\"noise\">{text} {WITHIN}</span>") } else { text }
}

/// Returns the crops of native rendering and of every other method at its largest scale, as HTML figures.
fn crops(rows: &[UpscalingRow]) -> io::Result<String> {
    let mut figures = String::new();
    for family in rows.chunk_by(|a, b| a.recipe.upscaler.method() == b.recipe.upscaler.method()) {
        let Some(row) = family.last() else { continue };
        figures += &format!(
            "<figure><img alt=\"{label}\" src=\"{}\"><figcaption><b>{label}</b> · FLIP {:.4} · {:.2} \
             ms</figcaption></figure>\n",
            image_source(&row.crop)?,
            row.error.flip,
            row.frame_ms.median,
            label = escaped(&row.label)
        );
    }
    Ok(format!("<div class=\"crops\">\n{figures}</div>\n"))
}

fn method(report: &UpscalingReport) -> String {
    format!(
        "<section>\n<h2>How it was measured</h2>\n<p>{}; {} threads draw.</p>\n<p>Each round draws one frame of the \
         sequence by every recipe, in a newly shuffled order, after {WARM_UP_ROUNDS} warm-up rounds; all in one \
         process. Times are medians over {} rounds, which draw the frames whose error is measured, with the same \
         history. Recipes spread over the list are drawn twice per round as A/A pairs; the noise floor is the 90th \
         percentile of the relative differences of such pairs, each of medians over a block of rounds. {} Reading \
         files and measuring errors are not timed.</p>\n<p>Rows are ranked by {}. FLIP is the mean over all pixels, at 67 pixels per degree: \
         0 is equal, 1 black against white. PSNR and MSE use sRGB codes. SSIM has a Gaussian window of 11 × 11 px, σ \
         1.5, on luma. A reference of one sample per pixel is aliased itself, so a method that smooths has an error \
         against it.</p>\n</section>\n",
        escaped(&report.machines.summary()),
        report.threads,
        report.rounds,
        motion(report),
        report.metric.name()
    )
}
