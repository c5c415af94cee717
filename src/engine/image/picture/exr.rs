//! OpenEXR files: layers of half, float and integer channels, with a data window of their own. Deep data and subsampled
//! channels are not supported.

pub(crate) mod write;

use std::io::Cursor;

use exr::block::chunk::{CompressedBlock, CompressedScanLineBlock, CompressedTileBlock};
use exr::compression::Compression;
use exr::image::{AnyChannels, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::attribute::IntegerBounds;
use exr::meta::attribute::LevelMode;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{ReadChannels as _, ReadLayers as _, read};

use super::{Channel, DataWindow, Picture, Samples};
use crate::image::decoder::{MAX_PIXELS, MAX_SIDE};

/// Maximum size of all decoded samples, in bytes. With the file itself, reading stays below a gigabyte.
const MAX_SAMPLE_BYTES: u64 = 512 << 20;

/// Places of the sizes of decompressed data among the counters at the start of a DWA block.
const DECOMPRESSED_SIZES: [usize; 5] = [1, 6, 7, 8, 9];

/// Returns the width and height of the display window in pixels.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| error.to_string())?;
    check(&meta.headers)?;
    let header = meta.headers.first().ok_or("it has no layer")?;
    let size = header.shared_attributes.display_window.size;
    let side = |length: usize| u32::try_from(length).map_err(|_| "its display window is too large".to_owned());
    Ok((side(size.width())?, side(size.height())?))
}

/// Decodes all layers at their largest resolution.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let size = size(bytes)?;
    check_blocks(bytes)?;
    let reader = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = reader.non_parallel().from_buffered(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let display = image.attributes.display_window;
    let has_several = image.layer_data.len() > 1;
    let channels: Result<Vec<_>, String> =
        image.layer_data.into_iter().map(|layer| channels(layer, display, has_several)).collect();
    let channels: Vec<_> = channels?.into_iter().flatten().collect();
    if channels.is_empty() {
        return Err("it has no channels".to_owned());
    }
    Ok(Picture::new("OpenEXR", size, channels))
}

/// Checks that the channels are supported and that their samples fit into memory, before any are allocated.
fn check(headers: &[Header]) -> Result<(), String> {
    let mut total = 0_u64;
    for header in headers {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        if header.deep {
            return Err("deep data are not supported".to_owned());
        }
        if width.max(height) > MAX_SIDE.into() || width * height > MAX_PIXELS {
            return Err(format!("its data window of {width} × {height} px is too large"));
        }
        for channel in &header.channels.list {
            if channel.sampling.x() != 1 || channel.sampling.y() != 1 {
                return Err(format!("its channel {} is subsampled, which is not supported", channel.name));
            }
            total = total.saturating_add(width * height * channel.sample_type.bytes_per_sample() as u64);
        }
    }
    if total > MAX_SAMPLE_BYTES {
        return Err(format!("its samples need more than {} MiB, the maximum", MAX_SAMPLE_BYTES >> 20));
    }
    Ok(())
}

/// Checks what the decoder does not: the sizes that DWA blocks state for their decompressed parts, which it allocates, and
/// that layers of one resolution have no blocks of others.
fn check_blocks(bytes: &[u8]) -> Result<(), String> {
    let words = |error: exr::error::Error| error.to_string();
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(words)?;
    let headers = reader.headers().to_vec();
    let is_dwa = |header: &Header| matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    let is_tiled_in_levels = |header: &Header| match header.blocks {
        BlockDescription::Tiles(tiles) => tiles.level_mode != LevelMode::Singular,
        BlockDescription::ScanLines => false,
    };
    for chunk in reader.all_chunks(false).map_err(words)? {
        let chunk = chunk.map_err(words)?;
        let header = headers.get(chunk.layer_index).ok_or("invalid: layer of a block")?;
        let block = &chunk.compressed_block;
        let indices = header.get_block_data_indices(block).map_err(words)?;
        if indices.level_index != Vec2(0, 0) && !is_tiled_in_levels(header) {
            return Err("invalid: resolution level of a block".to_owned());
        }
        if !is_dwa(header) {
            continue;
        }
        let pixels = header.get_absolute_block_pixel_coordinates(indices).map_err(words)?.size;
        let (CompressedBlock::ScanLine(CompressedScanLineBlock { compressed_pixels_le: data, .. })
        | CompressedBlock::Tile(CompressedTileBlock { compressed_pixels_le: data, .. })) = block
        else {
            continue;
        };
        let bytes_per_pixel = header.channels.bytes_per_pixel;
        if data.len() == pixels.width() * pixels.height() * bytes_per_pixel {
            // A block that compression would enlarge is stored as it is.
            continue;
        }
        // Squares of 8 × 8 px are complete even at the border, and run lengths may enlarge data a little.
        let largest = 2 * (pixels.width() + 8) * (pixels.height() + 8) * bytes_per_pixel;
        let (counters, _) = data.as_chunks::<8>();
        let stated = DECOMPRESSED_SIZES.iter().filter_map(|place| counters.get(*place));
        if stated.map(|counter| u64::from_le_bytes(*counter)).any(|size| size > largest as u64) {
            return Err("invalid: size of DWA data".to_owned());
        }
    }
    Ok(())
}

/// Returns the channels of a layer. `is_named` adds the name of the layer to theirs.
fn channels(
    layer: Layer<AnyChannels<FlatSamples>>,
    display: IntegerBounds,
    is_named: bool,
) -> Result<Vec<Channel>, String> {
    let place = layer.attributes.layer_position;
    let offset = |data: i32, display: i32| data.checked_sub(display).ok_or("its data window is out of range");
    let window = DataWindow {
        left: offset(place.x(), display.position.x())?,
        top: offset(place.y(), display.position.y())?,
        width: layer.size.width() as u32,
        height: layer.size.height() as u32,
    };
    let prefix = layer.attributes.layer_name.filter(|_| is_named).map_or_else(String::new, |name| format!("{name}."));
    let channel = |channel: exr::image::AnyChannel<FlatSamples>| {
        let samples = match channel.sample_data {
            FlatSamples::F16(values) => Samples::F16(values),
            FlatSamples::F32(values) => Samples::F32(values),
            FlatSamples::U32(values) => Samples::U32(values),
        };
        // Many programs write the name of the layer into that of the channel, too.
        let name = channel.name.to_string();
        let name = if name.starts_with(&prefix) { name } else { format!("{prefix}{name}") };
        Channel::new(name, samples, window)
    };
    Ok(layer.channel_data.list.into_iter().map(channel).collect())
}
