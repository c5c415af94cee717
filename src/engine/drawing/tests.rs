//! Tests that write drawings, decode them, and compare them with known areas.

use super::file::{DrawingFormat, EXTENSIONS, encode_animation, format_of, save, write};
use super::*;

const RED: Rgb = [200, 30, 30];

fn example() -> Drawing {
    let stroke = Stroke { color: [20, 40, 60], width: 0.5 };
    let corners = [(1.0, 1.0), (9.0, 1.0), (5.0, 7.0)].map(DVec2::from).to_vec();
    let shapes = vec![
        Shape::Polygon { corners, fill: Some(RED), stroke: None },
        Shape::Line { from: DVec2::new(0.0, 8.0), to: DVec2::new(10.0, 8.0), stroke },
        Shape::Ellipse {
            center: DVec2::new(5.0, 3.0),
            radii: DVec2::new(2.0, 1.0),
            fill: Some([0, 0, 255]),
            stroke: None,
        },
        Shape::Text { at: DVec2::new(5.0, 5.0), text: "a < b & −1".to_owned(), color: [0; 3], size: 1.0 },
    ];
    Drawing { size: DVec2::new(10.0, 9.0), background: [255; 3], shapes }
}

/// Returns the area of a black shape on white, measured from its bitmap, in square units of the drawing.
fn area(shape: Shape) -> f64 {
    const SCALE: f64 = 20.0;
    let drawing = Drawing { size: DVec2::new(10.0, 9.0), background: [255; 3], shapes: vec![shape] };
    let image = bitmap::bitmap(&drawing, SCALE);
    assert_eq!(image.size(), (200, 180));
    image.pixels().iter().map(|pixel| 1.0 - f64::from(pixel[0]) / 255.0).sum::<f64>() / (SCALE * SCALE)
}

#[test]
fn a_bitmap_has_the_areas_of_its_shapes() {
    let [polygon, line, ellipse, text] = example().shapes.try_into().unwrap();
    let black = |shape| match shape {
        Shape::Polygon { corners, .. } => Shape::Polygon { corners, fill: Some([0; 3]), stroke: None },
        Shape::Line { from, to, .. } => Shape::Line { from, to, stroke: Stroke { color: [0; 3], width: 0.5 } },
        Shape::Ellipse { center, radii, .. } => Shape::Ellipse { center, radii, fill: Some([0; 3]), stroke: None },
        text => text,
    };
    for (shape, expected) in [(polygon, 24.0), (line, 5.0), (ellipse, 2.0 * std::f64::consts::PI), (text, 0.0)] {
        let found = area(black(shape.clone()));
        assert!((found - expected).abs() <= 0.005 * expected, "{shape:?}: {found}");
    }
}

/// Returns the bytes of a PDF with its streams decompressed.
fn readable_pdf(drawing: &Drawing, scale: f64) -> Vec<u8> {
    const START: &[u8] = b"stream\n";
    let page = pdf::bytes(drawing, scale);
    let mut readable = Vec::new();
    let mut rest = &page[..];
    while let Some(at) = rest.windows(START.len()).position(|window| window == START) {
        let (before, data) = rest.split_at(at + START.len());
        readable.extend_from_slice(before);
        let mut decoder = flate2::read::ZlibDecoder::new(data);
        std::io::Read::read_to_end(&mut decoder, &mut readable).expect("a zlib stream");
        rest = &data[decoder.total_in() as usize..];
        let end = b"\nendstream\n";
        assert!(rest.starts_with(end), "the length of the stream");
        readable.extend_from_slice(end);
        rest = &rest[end.len()..];
    }
    readable.extend_from_slice(rest);
    readable
}

#[test]
fn lines_have_round_ends_in_every_format() {
    let stroke = Stroke { color: [0; 3], width: 2.0 };
    let line = Shape::Line { from: DVec2::new(3.0, 4.0), to: DVec2::new(6.0, 4.0), stroke };
    let found = area(line.clone());
    assert!((found - (6.0 + std::f64::consts::PI)).abs() < 0.1, "{found}");
    let drawing = Drawing { size: DVec2::new(10.0, 9.0), background: [255; 3], shapes: vec![line] };
    assert!(svg::text(&drawing, 1.0).contains("stroke-linecap=\"round\""));
    let page = readable_pdf(&drawing, 1.0);
    assert!(page.windows(4).any(|window| window == b"1 J\n"));
}

#[test]
fn pixel_formats_read_back_as_the_bitmap() {
    let folder = tempfile::tempdir().unwrap();
    let drawing = example();
    let expected = bitmap::bitmap(&drawing, 8.0);
    for (end, format) in EXTENSIONS {
        let path = folder.path().join(format!("drawing.{end}"));
        assert_eq!(format_of(&path).unwrap(), format);
        write(&path, &drawing, 8.0).unwrap();
        if !matches!(format, DrawingFormat::Pixels(_)) {
            continue;
        }
        let decoded = ::image::open(&path).unwrap().into_rgb8();
        assert_eq!(decoded.dimensions(), expected.size(), "{end}");
        let off = |(found, expected): (&::image::Rgb<u8>, &[u8; 4])| {
            found.0.iter().zip(expected).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>()
        };
        let mean = decoded.pixels().zip(expected.pixels()).map(off).sum::<f64>() / expected.pixels().len() as f64;
        let bound = if end.starts_with("jp") { 12.0 } else { 0.0 };
        assert!(mean <= bound, "{end}: {mean}");
    }
}

#[test]
fn an_animation_holds_all_its_frames() {
    use ::image::AnimationDecoder as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("steps.gif");
    let frames = (0..5).map(|count| {
        let mut drawing = example();
        drawing.shapes.truncate(count);
        drawing
    });
    save(&path, &encode_animation(&path, frames, 4.0, std::time::Duration::from_millis(100)).unwrap()).unwrap();
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let frames = ::image::codecs::gif::GifDecoder::new(file).unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 5);
    assert_eq!(frames[0].delay().numer_denom_ms().0 / frames[0].delay().numer_denom_ms().1, 100);
}

#[test]
fn vector_formats_hold_shapes_and_no_pixels() {
    let text = svg::text(&example(), 10.0);
    for part in ["<polygon", "1,1 9,1 5,7", "<ellipse", "<line", "#c81e1e", "a &lt; b &amp; −1", "viewBox=\"0 0 10 9\""]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    let page = readable_pdf(&example(), 10.0);
    assert!(page.starts_with(b"%PDF-"));
    let has = |part: &[u8]| page.windows(part.len()).any(|window| window == part);
    assert!(has(b"/MediaBox [0 0 100 90]") && has(b"1 1 m") && has(b"(a < b & -1)"));
}

#[test]
fn unknown_extensions_are_refused() {
    for name in ["drawing", "drawing.webp", "svg"] {
        let message = write(name.as_ref(), &example(), 1.0).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains("svg, pdf, png"), "{message}");
    }
}

/// Returns a fan of white triangles around a common point, which together fill the page of the example.
fn fan() -> Vec<PartitionRegion> {
    const COUNT: u32 = 14;
    // The page's perimeter is 38 units, and the length of each side is a whole number of units.
    let border = |place: u32| match place % 38 {
        at @ 0..10 => DVec2::new(at.into(), 0.0),
        at @ 10..19 => DVec2::new(10.0, f64::from(at - 10)),
        at @ 19..29 => DVec2::new(f64::from(29 - at), 9.0),
        at => DVec2::new(0.0, f64::from(38 - at)),
    };
    let corners = [0, 10, 19, 29];
    let mut ends: Vec<u32> = (0..COUNT).map(|end| end * 38 / COUNT).chain(corners).collect();
    ends.sort_unstable();
    ends.dedup();
    let next = ends.iter().cycle().skip(1);
    let triangle = |(from, to): (&u32, &u32)| vec![DVec2::new(5.3, 4.1), border(*from), border(*to)];
    ends.iter()
        .zip(next)
        .map(triangle)
        .map(|contour| PartitionRegion { contours: vec![contour], fill: [255; 3] })
        .collect()
}

#[test]
fn bitmaps_of_partitions_hide_the_background() {
    let on_black = |shapes| Drawing { size: DVec2::new(10.0, 9.0), background: [0; 3], shapes };
    for scale in [0.9, 3.0, 7.7] {
        let image = bitmap::bitmap(&on_black(vec![Shape::Partition(fan())]), scale);
        assert!(image.pixels().iter().all(|pixel| *pixel == [255; 4]), "at {scale}");
    }
    // A pixel that is half white and half background shows the mean.
    let half = [(0.0, 0.0), (4.5, 0.0), (4.5, 9.0), (0.0, 9.0)].map(DVec2::from).to_vec();
    let half = PartitionRegion { contours: vec![half], fill: [255; 3] };
    let image = bitmap::bitmap(&on_black(vec![Shape::Partition(vec![half])]), 1.0);
    assert_eq!([3, 4, 5].map(|x| image.at(x, 2)[0]), [255, 128, 0]);
}

#[test]
fn viewers_that_smooth_one_polygon_after_the_other_show_no_seams_in_partitions() {
    // Draws all regions once per line width, as the vector formats do.
    let darkest = |widths: &[f64], scale: f64| {
        let mut drawing = Drawing { size: DVec2::new(10.0, 9.0), background: [0; 3], shapes: Vec::new() };
        for width in widths {
            drawing.shapes.extend(fan().into_iter().map(|PartitionRegion { contours, fill }| Shape::Polygon {
                corners: contours.concat(),
                fill: Some(fill),
                stroke: (*width > 0.0).then_some(Stroke { color: fill, width: *width }),
            }));
        }
        bitmap::bitmap(&drawing, scale).pixels().iter().map(|pixel| pixel[0]).min().unwrap()
    };
    for scale in [0.5, 1.0, 3.0, 20.0] {
        assert!(darkest(&[0.0], scale) < 210, "at {scale} the fan has seams");
        assert_eq!(darkest(&SEAM_WIDTHS, scale), 255, "at {scale}");
    }
}

#[test]
fn vector_formats_hold_partitions_once_for_each_width_of_lines() {
    let shapes = vec![Shape::Partition(fan()), Shape::Partition(fan())];
    let drawing = Drawing { size: DVec2::new(10.0, 9.0), background: [0; 3], shapes };
    let text = svg::text(&drawing, 1.0);
    assert_eq!(text.matches("<path").count(), drawing.shape_count(), "written once, used several times");
    for number in 0..2 {
        let used = SEAM_WIDTHS.map(|width| format!("stroke-width=\"{width}\" xlink:href=\"#regions-{number}\""));
        let places: Vec<_> =
            used.iter().map(|using| text.find(using).unwrap_or_else(|| panic!("{using} in {text}"))).collect();
        assert!(places.is_sorted());
    }
    let page = String::from_utf8_lossy(&readable_pdf(&drawing, 1.0)).into_owned();
    let uses: Vec<_> = page.lines().filter(|line| line.ends_with(" Do")).collect();
    assert_eq!(uses, ["/X0 Do", "/X0 Do", "/X1 Do", "/X1 Do", "/X2 Do", "/X2 Do", "/X3 Do", "/X3 Do"]);
    assert_eq!([page.matches("\nf*").count(), page.matches("\nB*").count()], [drawing.shape_count(); 2]);
}
