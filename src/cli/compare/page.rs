//! Comparison of picture files as an HTML page.

use std::path::Path;

use crate::image::{Image, Rgba8};
use crate::measure::picture_error::ValueScale;
use crate::pipeline::settings::Choice as _;
use crate::report::pictures::{MetricTable, PictureFigure, PicturePage};

use super::print::{tone_line, verdict, viewing_line};
use super::{CompareArgs, Inputs, Measured, difference_of, layer, tone, value_of};
use crate::cli::failure::Failure;
use crate::cli::output;

/// Writes the page: the pictures, the difference of A and B, and the errors.
pub(super) fn write(
    args: &CompareArgs,
    inputs: &Inputs<'_>,
    measured: &[Measured],
    path: &Path,
) -> Result<(), Failure> {
    let mut figures = Vec::new();
    for input in inputs.all() {
        figures.push(PictureFigure {
            label: format!("{}: {}", input.role, output::display(input.path)),
            picture: tone(args).displayed(&input.picture, layer(args, input)?).into(),
            lines: vec![input.picture.description()],
            command: None,
        });
    }
    let difference: Image<Rgba8> = difference_of(args, inputs)?;
    figures.push(PictureFigure {
        label: format!("Difference of A and B: {}, × {}", args.difference.name().to_lowercase(), args.gain),
        picture: difference.into(),
        lines: Vec::new(),
        command: None,
    });
    let [a, b] = [&inputs.a, &inputs.b].map(|input| output::display(input.path));
    let scale = measured.first().map(|measured| measured.scale).map_or("", ValueScale::name);
    let page = PicturePage {
        title: format!("Comparison: {a} and {b}"),
        summary: vec![
            format!("Values: {scale}"),
            verdict(inputs, measured),
            tone_line(args, measured),
            viewing_line(args, measured),
        ],
        figures,
        metrics: Some(metrics(measured)),
        command: Some(output::command_line()),
    };
    output::write_page(path, page.html())
}

/// Returns the errors as a table with a column for each measured pair.
fn metrics(measured: &[Measured]) -> MetricTable {
    let column = |Measured { of, against, .. }: &Measured| format!("{of} against {against}");
    let metrics = measured.first().into_iter().flat_map(|measured| &measured.errors.metrics);
    let rows = metrics.map(|(metric, _)| {
        let value = |measured: &Measured| {
            value_of(&measured.errors, *metric).map_or_else(|| "–".to_owned(), |value| metric.format(value))
        };
        std::iter::once(metric.name().to_owned()).chain(measured.iter().map(value)).collect()
    });
    MetricTable { columns: measured.iter().map(column).collect(), rows: rows.collect() }
}
