//! Writing of OpenEXR files: one layer of named channels with the standard attributes of a rendered picture.

use std::io::{self, Cursor};

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::Text;
use exr::meta::header::LayerAttributes;
use exr::prelude::{SmallVec, WritableImage as _};

use crate::image::picture::{Channel, Picture, Samples};

/// Standard attributes of a rendered picture. Matrices multiply row vectors from the right, and are stored row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RenderAttributes {
    /// Description of the content. It is omitted if it has characters outside Latin-1.
    pub(crate) comments: String,
    /// Matrix from world space to camera space: left-handed, with x to the right, y up, and z along the line of sight.
    pub(crate) world_to_camera: [f32; 16],
    /// Matrix from world space to the picture, whose top left corner is (0, 0) and whose bottom right corner is (1, 1).
    pub(crate) world_to_picture: [f32; 16],
    /// Distances of the near and the far plane, in world units.
    pub(crate) clip_planes: [f32; 2],
}

/// Name of the program in the attribute `software`.
const SOFTWARE: &str = concat!("Rasterscope ", env!("CARGO_PKG_VERSION"));

/// Encodes a picture as an OpenEXR file with lossless compression. Equal pictures give equal bytes.
///
/// # Errors
/// Returns an error if a channel has samples of 8 or 16 bits that are integers, or does not cover the picture.
pub(crate) fn encode(picture: Picture, attributes: &RenderAttributes) -> io::Result<Vec<u8>> {
    let (width, height) = picture.size();
    let channels: io::Result<SmallVec<[_; 4]>> =
        picture.channels.into_iter().map(|channel| encodable(channel, (width, height))).collect();
    let attributes = LayerAttributes {
        software_name: Text::new_or_none(SOFTWARE),
        comments: Text::new_or_none(&attributes.comments),
        world_to_camera: Some(attributes.world_to_camera),
        world_to_normalized_device: Some(attributes.world_to_picture),
        near_clip_plane: Some(attributes.clip_planes[0]),
        far_clip_plane: Some(attributes.clip_planes[1]),
        ..LayerAttributes::default()
    };
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels?));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.into_inner())
}

fn encodable(channel: Channel, size: (u32, u32)) -> io::Result<AnyChannel<FlatSamples>> {
    let unsupported = |reason: &str| io::Error::other(format!("channel {}: {reason}", channel.name));
    if !channel.is_data_window_whole(size) {
        return Err(unsupported("its data window is not the picture"));
    }
    let samples = match channel.samples {
        Samples::F16(values) => FlatSamples::F16(values),
        Samples::F32(values) => FlatSamples::F32(values),
        Samples::U32(values) => FlatSamples::U32(values),
        Samples::U8(_) | Samples::U16(_) => return Err(unsupported("OpenEXR has no such integers")),
    };
    Ok(AnyChannel::new(channel.name.as_str(), samples))
}
