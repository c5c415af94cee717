//! `rasterscope render`: renders a frame, one of its buffers, or the picture after a stage to a PNG, or all buffers to
//! an OpenEXR file, and prints its cost. It also renders the frames of a scene or a camera in motion.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use crate::disk;
use crate::image::file::write_png;
use crate::image::pfm::{Floats, write_pfm};
use crate::image::{Image, Rgba8};
use crate::inspect::buffer_file::BufferSource;
use crate::inspect::buffers::Buffers;
use crate::inspect::display::{Display, ValueKind};
use crate::inspect::intermediate::{self, Captured};
use crate::inspect::overlays::{OverlayContext, OverlayLayer, Sheet, compose, csv};
use crate::inspect::planes::planes;
use crate::inspect::view::{Range, Value};
use crate::inspect::{Buffer, Intermediate, Stage, capture, stages, view};
use crate::measure::stages::{StageSummary, stage_times, summarize_stages};
use crate::pipeline::settings::Choice as _;
use crate::scene::Scene;
use crate::scene::seams::Seams;
use clap::Args;

use super::failure::Failure;
use super::parse::Either;
use super::progress::ProgressLine;
use super::scene_args::{DrawnFrame, FrameArgs};
use super::seen_args::moment;
use super::sequence_args::{SequenceArgs, SequenceFrame, SequenceRenderer};
use super::{output, parse};

/// Render one frame or one of its buffers to a PNG, or all its buffers to an OpenEXR file; with --frames, a sequence
#[derive(Args, Debug)]
#[command(after_help = super::example("render chess --buffer depth -o depth.png"))]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    frame: FrameArgs,

    /// Quantity to show in the picture
    #[arg(long, default_value = "color", value_parser = parse::either::<Buffer, Intermediate>())]
    buffer: Either<Buffer, Intermediate>,

    /// Show the picture after this pipeline stage instead of a buffer
    #[arg(long, conflicts_with = "buffer", value_parser = parse::choice::<Stage>())]
    stage: Option<Stage>,

    /// Number of rasterized triangles to draw; all if omitted
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,

    /// Number of fragments to draw of the last of these triangles; all if omitted
    #[arg(long, value_name = "N", requires = "triangles")]
    fragments: Option<usize>,

    /// Accepted and ignored, so that a copied command also works here: the picture has no picked pixel
    #[arg(long, value_name = "X,Y", hide = true)]
    at: Option<String>,

    /// Range (all, most, 0.25..0.5), colour map and channels of the shown quantity, as in
    /// range=most,map=magma,reversed,channels=rg
    #[arg(long, value_name = "LOOK")]
    look: Option<Display>,

    /// Overlay on the picture, with its opacity, and the length of normals as a fraction of the scene's size; prints
    /// its totals. May be given several times, bottom first
    #[arg(long, value_name = "OVERLAY[=OPACITY[,length=SHARE]]", value_parser = parse::layer())]
    overlay: Vec<OverlayLayer>,

    /// CSV file for the totals of all overlays
    #[arg(long, value_name = "FILE.csv", requires = "overlay")]
    totals: Option<PathBuf>,

    /// PFM file for the exact values of the buffer, as 32-bit floats
    #[arg(long, value_name = "FILE.pfm", conflicts_with = "stage")]
    data: Option<PathBuf>,

    /// Write all buffers as named channels of an OpenEXR file: linear colour, depth, ids, weights, counts, texture
    /// coordinates, normals and positions
    #[arg(long, conflicts_with_all = ["buffer", "stage", "look", "overlay", "totals", "data"])]
    buffers: bool,

    /// Number of frames to time; prints the median time of each stage, and the sum of the medians for the whole frame
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=1000))]
    times: Option<u32>,

    #[command(flatten)]
    sequence: SequenceArgs,

    /// PNG file to write, or OpenEXR file with --buffers. With --frames, the number of the frame is added to its name,
    /// or replaces a run of #
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Runs `render`: draws the frames, writes their pictures, and prints a summary line for each.
pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    check_output(args)?;
    let moment = moment(args.triangles, args.fragments);
    let Some(frames) = args.sequence.frames(&args.output)? else {
        return write_frame(args, &args.output, &args.frame.draw(moment)?);
    };
    let (view, size) = (args.frame.view()?, args.frame.size()?);
    let line = ProgressLine::new();
    let mut renderer = SequenceRenderer::new(frames.shot(&view), view.recipe, size);
    for SequenceFrame { number, output } in frames.iter() {
        line.show(&format!("frame {number}: {} of {}", number - frames.first() + 1, frames.count()));
        write_frame(args, &output, &renderer.draw(number, moment))?;
    }
    Ok(())
}

/// Writes the picture or the buffers of a drawn frame to a file, and prints a summary line.
fn write_frame(args: &RenderArgs, path: &Path, drawn: &DrawnFrame) -> Result<(), Failure> {
    if args.buffers {
        write_buffers(path, drawn)?;
        print_summary(path, drawn)?;
        return print_times(args, drawn);
    }
    let DrawnFrame { scene, camera, recipe, frame } = drawn;
    let (buffer, captured) = match (args.stage.and_then(Stage::buffer), args.buffer) {
        (Some(buffer), _) | (None, Either::First(buffer)) => (buffer, None),
        (None, Either::Second(number)) => (Buffer::Color, Some(intermediate::capture(scene, recipe, frame, number))),
    };
    let captured = captured.as_ref();
    let drawn_stage = args.stage.filter(|stage| stage.buffer().is_none());
    let stage = drawn_stage.map(|stage| stages::picture(scene, camera, recipe, frame, stage));
    let buffers = (stage.is_none() && buffer != Buffer::Color)
        .then(|| capture(scene, recipe, frame).completed_for(buffer, scene, recipe, frame));
    let reads_seams = args.overlay.iter().any(|layer| layer.overlay.reads_seams());
    let wants_seams = reads_seams || buffers.as_ref().is_some_and(|buffers| buffers.hits.is_some());
    let seams = wants_seams.then(|| Seams::of(scene));
    let buffers = match &seams {
        Some(seams) => buffers.map(|buffers| buffers.with_seams(scene, recipe, frame, seams)),
        None => buffers,
    };
    let hits = buffers.as_ref().and_then(|buffers| buffers.hits.as_ref());
    let shown = RenderedQuantity {
        buffer,
        captured,
        stage: stage.as_ref(),
        buffers: buffers.as_ref(),
        seams: seams.as_ref(),
        display: args.look.unwrap_or_default(),
        scene,
        recipe,
        frame,
        is_whole: args.triangles.is_none(),
    };
    let ends = captured.filter(|_| stage.is_none()).and_then(|_| shown.range());
    let sheets = shown.sheets(&args.overlay);
    let opacities = args.overlay.iter().map(|layer| layer.opacity);
    let image = &compose(&shown.colored(), sheets.iter().zip(opacities));
    write_png(path, image)?;
    if let Some(data) = &args.data {
        write_pfm(data, &shown.planes())?;
    }
    if let Some(table) = &args.totals {
        output::write(table, &csv(&sheets))?;
    }
    print_summary(path, drawn)?;
    if let Some(range) = ends {
        output::print(&format!("from {:?} (dark) to {:?} (bright)\n", range.low, range.high))?;
    }
    if let Some(hits) = hits {
        output::print(&format!("shared edges: {}\n", hits.summary()))?;
        let mesh = hits.mesh.map(|counts| format!("mesh: {}\n", counts.text()));
        output::print(&mesh.unwrap_or_default())?;
        let first = hits.faults.iter().find_map(|fault| Some((fault.x, fault.y, fault.junction?)));
        let first = first.map(|(x, y, junction)| format!("first at {x},{y}: {}\n", junction.text()));
        output::print(&first.unwrap_or_default())?;
    }
    output::print(&sheets.iter().map(totals).collect::<String>())?;
    print_times(args, drawn)
}

/// Checks that the output file has the suffix of its format.
fn check_output(args: &RenderArgs) -> Result<(), Failure> {
    let is_exr = args.output.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("exr"));
    let path = output::display(&args.output);
    match (args.buffers, is_exr) {
        (true, false) => {
            Err(Failure::Usage(format!("{path}: --buffers writes OpenEXR; name a file that ends in .exr")))
        }
        (false, true) => Err(Failure::Usage(format!("{path}: OpenEXR files hold all buffers; add --buffers"))),
        _ => Ok(()),
    }
}

/// Writes all buffers of the frame to an OpenEXR file.
fn write_buffers(path: &Path, drawn: &DrawnFrame) -> Result<(), Failure> {
    let DrawnFrame { scene, recipe, frame, .. } = drawn;
    let encoded = BufferSource { scene, recipe, frame }.encode(&output::command_line());
    let written = encoded.and_then(|bytes| disk::write(path, &bytes));
    written.map_err(|source| Failure::ResultFile { path: path.to_owned(), source })
}

/// Prints the output file, its size, the numbers of triangles and the cost of the frame.
fn print_summary(path: &Path, DrawnFrame { scene, frame, .. }: &DrawnFrame) -> Result<(), Failure> {
    output::print(&format!(
        "{}: {} × {} px, triangles: {} in, {} drawn; {:.1} ms, {:.1} % of the pixels drawn\n",
        output::display(path),
        frame.viewport.width,
        frame.viewport.height,
        scene.triangle_count(),
        frame.rasterized(),
        frame.times.total.as_secs_f64() * 1e3,
        frame.drawn_share() * 100.0,
    ))
}

/// Quantity shown in the picture, with the data from which it is computed.
struct RenderedQuantity<'a> {
    buffer: Buffer,
    /// Intermediate value shown instead of the buffer.
    captured: Option<&'a Captured>,
    /// Picture after a stage, shown instead of the buffer or the intermediate value.
    stage: Option<&'a Image<Rgba8>>,
    /// Captured buffers of the frame; `None` for the colour buffer.
    buffers: Option<&'a Buffers>,
    /// Open seams of the scene; `None` if no buffer or overlay reads them.
    seams: Option<&'a Seams>,
    display: Display,
    scene: &'a Scene,
    recipe: &'a Recipe,
    frame: &'a Frame,
    /// Whether all triangles of the frame were drawn, not only the first ones.
    is_whole: bool,
}

impl RenderedQuantity<'_> {
    fn value(&self, x: u32, y: u32) -> Value {
        match (self.stage, self.captured) {
            (Some(stage), _) => Value::Color(stage.at(x, y)),
            (None, Some(captured)) => captured.value(self.frame, x, y),
            (None, None) => view::value(self.buffer, self.frame, self.buffers, x, y),
        }
    }

    /// Returns the range of values that the colour map shows; `None` if the rendered quantity has no range.
    fn range(&self) -> Option<Range> {
        let (size, value) = (self.frame.image().size(), |x: u32, y: u32| self.value(x, y));
        match (self.stage, self.captured) {
            (Some(_), _) => self.display.range_of(ValueKind::Colors, size, || None, value),
            (None, Some(captured)) => self.display.range_of(ValueKind::Numbers, size, || captured.range(), value),
            (None, None) => self.display.range(self.buffer, self.frame, self.buffers),
        }
    }

    /// Returns the picture of the rendered quantity, without overlays.
    fn colored(&self) -> Image<Rgba8> {
        let as_at_first = self.display == Display::default();
        match (self.stage, self.captured) {
            (Some(stage), _) if as_at_first => stage.clone(),
            (None, None) => self.display.picture(self.buffer, self.frame, self.buffers, self.range()),
            _ => self.display.picture_of(None, self.frame.image().size(), self.range(), |x, y| self.value(x, y)),
        }
    }

    /// Computes the overlays that `layers` select.
    fn sheets(&self, layers: &[OverlayLayer]) -> Vec<Sheet> {
        let watched = OnceLock::new();
        let context = OverlayContext {
            scene: self.scene,
            recipe: self.recipe,
            frame: self.frame,
            is_whole: self.is_whole,
            stats_cache: &watched,
            seams: self.seams,
            shown: &|x, y| self.value(x, y),
            range: self.range(),
        };
        layers.iter().map(|layer| layer.sheet(&context)).collect()
    }

    /// Returns the exact values of the rendered quantity at all pixels.
    fn planes(&self) -> Floats {
        planes(self.frame.image().size(), |x, y| self.value(x, y))
    }
}

/// Formats the totals of an overlay, one total per line.
fn totals(sheet: &Sheet) -> String {
    let id = sheet.overlay.id();
    if let Some(why) = &sheet.absence {
        return format!("{id}: nothing to show: {why}\n");
    }
    sheet
        .totals
        .iter()
        .map(|total| format!("{id}: {} {} {}", total.name, total.number, total.unit).trim_end().to_owned() + "\n")
        .collect()
}

/// Prints the median time of each stage over the frames of `--times`, and the sum of these medians. Without `--times`,
/// prints nothing.
fn print_times(args: &RenderArgs, DrawnFrame { scene, camera, recipe, frame }: &DrawnFrame) -> Result<(), Failure> {
    let Some(frames) = args.times else { return Ok(()) };
    let mut renderer = Renderer::default();
    let times = (0..frames).map(|_| {
        let frame = renderer.render(RenderInputs { scene, camera, recipe, viewport: frame.viewport }, KeepDepth::Yes);
        let times = stage_times(scene, camera, recipe, &frame).named();
        renderer.recycle(frame);
        times
    });
    let stages = summarize_stages(&times.collect::<Vec<_>>()).unwrap_or_default();
    let line = |name: &str, ms: f64| format!("{name:11} {ms:8.3} ms\n");
    let lines: String = stages.iter().map(|StageSummary { stage, ms }| line(stage, ms.median)).collect();
    output::print(&(lines + &line("whole frame", stages.iter().map(|stage| stage.ms.median).sum())))
}
