//! Upscaling report as comma-separated values: one line per scene and recipe.

use super::sweep::{SceneReport, UpscalingReport, UpscalingRow};
use crate::pipeline::settings::Choice as _;
use crate::report::{PARTIAL, quoted};

/// Header line of the CSV table. Reports of several machines have one more column, `machine`.
const HEAD: &str = "scene,triangles,width,height,threads,reference,method,scale,anchor,light,label,drawn,rounds,frame_ms,\
    frame_ms_p10,frame_ms_p90,frame_ms_max,geometry_ms,pixels_ms,upscale_ms,transfer_ms,mse,psnr_db,ssim,flip,max_abs,differing_pixels,\
    turn_degrees,motion_frames,motion_mse,motion_psnr_db,motion_ssim,motion_flip,worst_psnr_db,worst_flip,metric,metric_at_rest,metric_in_motion,dominated_by,within_noise_of,\
    native_within_noise,noise,noise_pairs,native_ms";

/// Formats the upscaling report as CSV with a header line. Text is quoted; values that do not apply are left empty.
pub fn csv(report: &UpscalingReport) -> String {
    let rows = report.scenes.iter().flat_map(|scene| scene.rows.iter().map(move |row| (scene, row)));
    let lines = rows.map(|(scene, row)| line(report, scene, row));
    let mark = report.partial.then(|| PARTIAL.to_owned());
    let machine = if report.machines.are_several() { ",machine" } else { "" };
    std::iter::once(format!("{HEAD}{machine}")).chain(lines).chain(mark).map(|line| line + "\n").collect()
}

fn line(report: &UpscalingReport, scene: &SceneReport, row: &UpscalingRow) -> String {
    let [width, height] = report.size;
    let (codes, parts, ms) = (row.error.codes, row.parts_ms, row.frame_ms);
    let (mean, worst) = (row.motion.mean, row.motion.worst);
    let fields = [
        quoted(&scene.scene),
        scene.triangles.to_string(),
        width.to_string(),
        height.to_string(),
        row.threads.to_string(),
        quoted(report.reference),
        row.recipe.upscaler.method().to_owned(),
        row.recipe.upscaler.scale().to_string(),
        row.recipe.upscaler.anchor().id().to_owned(),
        row.recipe.upscaler.light().id().to_owned(),
        quoted(&row.label),
        row.drawn.to_string(),
        ms.n.to_string(),
        ms.median.to_string(),
        ms.p10.to_string(),
        ms.p90.to_string(),
        ms.max.to_string(),
        parts.geometry.to_string(),
        parts.pixels.to_string(),
        parts.upscale.to_string(),
        parts.transfer.to_string(),
        codes.mse.to_string(),
        codes.psnr_db.to_string(),
        codes.ssim.to_string(),
        row.error.flip.to_string(),
        codes.max_abs.to_string(),
        codes.differing_pixels.to_string(),
        report.turn.degrees.to_string(),
        report.turn.frames.to_string(),
        mean.codes.mse.to_string(),
        mean.codes.psnr_db.to_string(),
        mean.codes.ssim.to_string(),
        mean.flip.to_string(),
        worst.codes.psnr_db.to_string(),
        worst.flip.to_string(),
        report.metric.id().to_owned(),
        row.error.value(report.metric).to_string(),
        mean.value(report.metric).to_string(),
        row.dominated_by.as_deref().map(quoted).unwrap_or_default(),
        row.within_noise_of.as_deref().map(quoted).unwrap_or_default(),
        row.native_within_noise.to_string(),
        scene.noise.p90.to_string(),
        scene.noise.pairs.to_string(),
        row.native_ms.map(|native| native.frame.to_string()).unwrap_or_default(),
    ];
    fields.into_iter().chain(row.machine.as_deref().map(quoted)).collect::<Vec<_>>().join(",")
}
