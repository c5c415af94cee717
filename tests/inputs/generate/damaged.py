"""Writes damaged and odd files, one for each class of faults, and `INDEX.md` with the outcomes that are allowed."""

import math
import random
import struct
import zlib
from pathlib import Path

from pictures import END, SIGNATURE, bmp, chunk, cmyk, gif, header, jpeg, png, png_rows, tga, tiff, webp

INTRODUCTION = """\
# Damaged and odd files

Written by `generate`. Outcomes: ERR = the model is refused with a message that names the file and, where this table
states a line, the line; WARN = what is sound is loaded, with a warning that names the place; LOAD = loaded silently.
Pictures are loaded as texture of a square. Where two outcomes are given, both are allowed.

| file | bytes | outcome | fault |
|---|---:|---|---|
"""

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
FACE = "f 1 2 3\n"
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"


def polygon(count):
    """Returns a regular polygon of radius 1 as a single face."""
    around = (2 * math.pi * k / count for k in range(count))
    points = "".join(f"v {math.cos(t):.5f} {math.sin(t):.5f} 0\n" for t in around)
    return points + "f " + " ".join(map(str, range(1, count + 1))) + "\n"


def with_library(name, material="m", body=TRIANGLE + FACE):
    return f"mtllib {name}\nusemtl {material}\n{body}"


def models():
    """Yields name, content, allowed outcomes, and fault. A content of None is a folder."""
    rng = random.Random(30)
    yield "index-out-of-range", TRIANGLE + "f 1 2 9\n", "ERR", "index 9 of 3 positions, line 4"
    yield "index-zero", TRIANGLE + "f 0 1 2\n", "ERR", "indices start at 1, line 4"
    yield "index-before-start", TRIANGLE + "f -1 -2 -4\n", "ERR", "a relative index before the first position, line 4"
    yield "index-too-early", "f -3 -2 -1\n" + TRIANGLE, "ERR", "relative indices before any position, line 1"
    yield "index-over-u32", TRIANGLE + f"f 1 2 {2**32 + 3}\n", "ERR", "an index that is 3 modulo 2^32, line 4"
    yield "index-over-u64", TRIANGLE + f"f 1 2 {2**64 + 3}\n", "ERR", "an index that is 3 modulo 2^64, line 4"
    yield "index-fraction", TRIANGLE + "f 1 2 2.5\n", "ERR", "an index with a fraction, line 4"
    yield "uv-out-of-range", TRIANGLE + "vt 0 0\nf 1/1 2/1 3/2\n", "ERR", "texture coordinate 2 of 1, line 5"
    yield "normal-out-of-range", TRIANGLE + "vn 0 0 1\nf 1//1 2//1 3//7\n", "ERR", "normal 7 of 1, line 5"
    yield "four-parts", TRIANGLE + "vt 0 0\nvn 0 0 1\nf 1/1/1/1 2/1/1/1 3/1/1/1\n", "ERR", "four indices for a corner, line 6"
    yield "nan", "v nan 0 0\nv 1 0 0\nv 0 1 0\n" + FACE, "ERR", "a position that is not a number, line 1"
    yield "nan-of-printf", TRIANGLE + "v -1.#IND 0 0\nf 1 2 4\n", "ERR", "not a number as some runtimes print it, line 4"
    yield "infinity", "v 0 0 0\nv inf 0 0\nv 0 1 0\n" + FACE, "ERR", "an infinite position, line 2"
    yield "overflow", "v 0 0 0\nv 1 0 0\nv 0 1e300 0\n" + FACE, "ERR", "a position beyond 32-bit floats, line 3"
    yield "nan-beside-others", "v 0 0 0\nv nan 1 1\nv 1 0 0\nv 0 1 0\nf 1 3 4\nf 1 2 3\n", "WARN", "one of two faces has a corner that is not a number, line 2"
    yield "nan-colour", "v 0 0 0 1 1 1\nv 1 0 0 nan 0 0\nv 0 1 0 0 0 1\n" + FACE, "WARN", "a colour that is not a number, line 2"
    yield "largest", "v 3e38 0 0\nv -3e38 0 0\nv 0 3e38 0\n" + FACE, "WARN", "an extent beyond 32-bit floats"
    yield "decimal-commas", "v 0,5 0,0 0,0\nv 1,0 0,0 0,0\nv 0,0 1,0 0,0\n" + FACE, "ERR", "decimal commas, line 1"
    yield "letters", "v 0 0 0\nv one 0 0\nv 0 1 0\n" + FACE, "ERR", "letters for a number, line 2"
    yield "exponent", "v 0 0 0\nv 3.1+e2 0 0\nv 0 1 0\n" + FACE, "ERR", "a sign before the exponent, line 2"
    yield "two-coordinates", "v 0 0 0\nv 1 0 0\nv 0 1\n" + FACE, "ERR", "a position of two coordinates, line 3"
    yield "cut-in-face", TRIANGLE + "f 1 2", "ERR", "the file ends within a face, line 4"
    yield "cut-in-vertex", "v 0 0 0\nv 1 0 0\nv 0 1", "ERR", "the file ends within a position, line 3"
    yield "face-of-one", TRIANGLE + "f 1\n" + FACE, "WARN", "a face of one corner, line 4"
    yield "face-of-two", TRIANGLE + "f 1// 2//\nf 1// 2// 3//\n", "WARN", "a face of two corners, line 4"
    yield "face-of-none", TRIANGLE + "f\n" + FACE, "WARN", "a face without corners, line 4"
    yield "continued-at-end", TRIANGLE + "f 1 2 \\", "ERR", "a continuation that never comes, line 4"
    yield "degenerate", TRIANGLE + "f 1 1 1\nf 1 2 2\nv 2 0 0\nf 1 2 4\n" + FACE, "WARN", "three faces without area, line 4"
    yield "zero-normals", TRIANGLE + "vn 0 0 0\nf 1//1 2//1 3//1\n", "LOAD/WARN", "normals of length zero"
    yield "mixed-corners", SQUARE + "vn 0 0 1\nf 1/1/1 2/2 3//1 4\n", "WARN", "corners of different forms in one face, line 10"
    yield "uv-starts-late", SQUARE + "f 1 2 3\nf 1/1 2/2 3/3\nf 1 3 4\n", "LOAD/WARN", "only some faces have texture coordinates"
    yield "lines-are-no-faces", SQUARE + "f 1 2 3\nl 1 2 3 4\n", "WARN", "an `l` statement besides a triangle, line 10"
    yield "concave", "v 0 0 0\nv 6 0 0\nv 6 3 0\nv 3 1 0\nv 0 3 0\nf 1 2 3 4 5\n", "LOAD", "a concave polygon of area 12"
    yield "large-polygon", polygon(720), "LOAD", "a polygon of 720 corners"
    yield "long-comment", f"# {'x' * 5000}\n{TRIANGLE}{FACE}", "LOAD", "a line of 5000 characters"
    yield "cr-only", (TRIANGLE + FACE).replace("\n", "\r"), "LOAD", "lines end with CR"
    yield "faces-first", FACE + TRIANGLE, "LOAD", "a face before its positions"
    yield "free-form", "vp 0 0\nvp 1 0\ncstype bezier\ndeg 2 2\n" + TRIANGLE + "curv 0 1 1 2 3\nparm u 0 1\nend\n" + FACE, "WARN", "free-form statements besides a triangle"
    yield "empty", "", "ERR", "no bytes"
    yield "comments-only", "# nothing\n# here\n", "ERR", "no geometry"
    yield "points-only", TRIANGLE + "p 1 2 3\n", "ERR", "points only, line 4"
    yield "random-bytes", bytes(math.floor(rng.random() * 256) for _ in range(600)), "ERR", "random bytes"
    yield "picture", png(2, 2, lambda x, y: [x, y, 0]), "ERR", "a picture"
    yield "nul-bytes", (TRIANGLE + FACE).encode() + bytes(200), "WARN", "zeros after the last line, line 5"
    yield "nul-inside", b"v 0 0 0\nv 1\0 0 0\nv 0 1 0\nf 1 2 3\n", "ERR", "a zero within a number"
    yield "utf16", b"\xfe\xff" + (TRIANGLE + FACE).encode("utf-16-be"), "LOAD/ERR", "UTF-16"
    yield "latin1-comment", f"# Würfel\n{TRIANGLE}{FACE}".encode("latin-1"), "LOAD", "Latin-1 in a comment"
    yield "latin1-names", f"mtllib latin1-names.mtl\no Fläche\nusemtl grün\n{TRIANGLE}{FACE}".encode("latin-1"), "LOAD", "Latin-1 in names"
    yield "web-page", "<!DOCTYPE html>\n<html><body>404 Not Found</body></html>\n", "ERR", "a web page instead of the model"
    yield "git-lfs", f"version https://git-lfs.github.com/spec/v1\noid sha256:{'0' * 64}\nsize 12345\n", "ERR", "a pointer instead of the model"
    yield "folder", None, "ERR", "a folder"
    yield "missing-library", with_library("nowhere.mtl"), "WARN", "a material library that does not exist, line 1"
    yield "library-is-folder", with_library("folder.obj"), "WARN", "a folder as material library, line 1"
    yield "library-outside", with_library("../../../../../../../../etc/os-release"), "WARN", "a material library outside the folder of the model, line 1"
    yield "library-is-model", with_library("library-is-model.obj"), "WARN", "the model as its own material library"
    yield "undefined-material", with_library("undefined-material.mtl", "other"), "WARN", "a material that no library defines, line 2"
    yield "missing-texture", with_library("missing-texture.mtl"), "WARN", "a texture that does not exist"
    yield "texture-is-library", with_library("texture-is-library.mtl"), "WARN", "the material library as texture"
    yield "library-numbers", with_library("library-numbers.mtl"), "WARN", "numbers that cannot be read in a material library"
    yield "library-starts-early", with_library("library-starts-early.mtl"), "WARN", "a statement before the first material"
    yield "library-short-colours", with_library("library-short-colours.mtl"), "LOAD", "colours of one number"


LIBRARIES = {
    "latin1-names": "newmtl grün\nKd 0.2 0.8 0.2\n".encode("latin-1"),
    "undefined-material": b"newmtl m\nKd 1 1 1\n",
    "missing-texture": b"newmtl m\nKd 0.5 0.5 0.5\nmap_Kd nowhere.png\n",
    "texture-is-library": b"newmtl m\nmap_Kd texture-is-library.mtl\n",
    "library-numbers": b"newmtl m\nKd red green blue\nNs nan\nd 7\n",
    "library-starts-early": b"Kd 1 0 0\nnewmtl m\nKd 0 1 0\n",
    "library-short-colours": b"newmtl m\nKd 0.5\nKs 0\n",
}


def colour(x, y):
    return [(40 + 37 * x + 11 * y) % 256, (90 + 5 * x + 71 * y) % 256, (200 + 13 * x * y) % 256]


def square(x, y):
    """Returns the colour of a square of a JPEG."""
    return [250 - 50 * x, 20 + 60 * y, (70 * x + 30 * y) % 256]


def valid_pictures():
    """Yields pictures that every reader must accept."""
    alpha = lambda x, y: colour(x, y) + [255 * (x % 2)]
    wide = lambda pixel: lambda x, y: [257 * sample for sample in pixel(x, y)]
    palette = chunk(b"PLTE", bytes(c for k in range(256) for c in colour(k % 16, k // 16)))
    yield "grey-1.png", png(9, 7, lambda x, y: [(x + y) % 2], 1, 0), "1 bit of grey"
    yield "grey-2.png", png(9, 7, lambda x, y: [(x + y) % 4], 2, 0), "2 bits of grey"
    yield "grey-4.png", png(9, 7, lambda x, y: [(x + y) % 16], 4, 0), "4 bits of grey"
    yield "grey-16.png", png(5, 4, wide(lambda x, y: [20 * x + 7 * y]), 16, 0), "16 bits of grey"
    yield "rgb-8.png", png(9, 7, colour), "RGB of 8 bits"
    yield "rgb-16.png", png(5, 4, wide(colour), 16), "RGB of 16 bits"
    yield "palette-2.png", png(9, 7, lambda x, y: [(x * y) % 4], 2, 3, before=chunk(b"PLTE", palette[8:20])), "a palette of 4 colours"
    yield "palette-8.png", png(9, 7, lambda x, y: [(16 * y + x) % 256], 8, 3, before=palette), "a palette of 256 colours"
    clear = chunk(b"tRNS", bytes([0, 128, 255]))
    yield "palette-alpha.png", png(9, 7, lambda x, y: [(x * y) % 5], 8, 3, before=palette + clear), "a palette with alpha"
    yield "grey-alpha-8.png", png(9, 7, lambda x, y: [20 * x, 30 * y], 8, 4), "grey and alpha"
    yield "rgba-8.png", png(9, 7, alpha, 8, 6), "RGBA of 8 bits"
    yield "rgba-16.png", png(5, 4, wide(alpha), 16, 6), "RGBA of 16 bits"
    yield "interlaced-rgb.png", png(9, 7, colour, interlace=1), "interlaced RGB"
    yield "interlaced-rgba-16.png", png(9, 7, wide(alpha), 16, 6, 1), "interlaced RGBA of 16 bits"
    yield "interlaced-1x1.png", png(1, 1, colour, interlace=1), "one interlaced pixel: six passes are empty"
    yield "gamma.png", png(9, 7, colour, before=chunk(b"gAMA", struct.pack(">I", 250000))), "a gamma that textures ignore"
    yield "stored.png", png(9, 7, colour, level=0), "stored without compression"
    yield "1x1.png", png(1, 1, colour), "one pixel"
    yield "4096x1.png", png(4096, 1, lambda x, y: [255 * (x % 2), 0, 128]), "one long row"
    yield "37x53.png", png(37, 53, lambda x, y: colour(x % 5, y % 3)), "sides that are no powers of two"
    yield "grey.jpg", jpeg(4, 3, lambda x, y: [60 * x + 20 * y]), "a grey JPEG"
    yield "colour.jpg", jpeg(4, 3, lambda x, y: [60 * x + 20 * y, 100 + 10 * x, 150 - 10 * y]), "a JPEG"
    yield "progressive.jpg", jpeg(4, 3, lambda x, y: [60 * x + 20 * y, 100 + 10 * x, 150 - 10 * y], True), "a progressive JPEG"
    yield "cmyk.jpg", jpeg(4, 3, lambda x, y: cmyk(square(x, y)), adobe=0), "cyan, magenta, yellow and black"
    yield "cmyk-as-rgb.png", png(32, 24, lambda x, y: square(x // 8, y // 8)), "the colours of `cmyk.jpg`"
    yield "jpeg-named.png", jpeg(2, 2, lambda x, y: [60 * x + 90 * y]), "a JPEG with the suffix of a PNG"
    yield "rgb.bmp", bmp(5, 4, colour), "a BMP"
    raw = b"".join(bytes(colour(x, y)[::-1]) for y in range(4) for x in range(5))
    yield "rgb.tga", tga(5, 4, raw), "a TGA"
    runs = b"".join(bytes([0x84, *colour(0, y)[::-1]]) for y in range(4))
    yield "runs.tga", tga(5, 4, runs, 10), "a TGA with run lengths"
    yield "rgb.gif", gif(6, 5, [colour(k, k) for k in range(8)], lambda x, y: (x + y) % 8), "a GIF"
    yield "rgb.tiff", tiff(5, 4, colour), "a TIFF"


def damaged_pictures():
    """Yields pictures that no reader must accept, except where two outcomes are allowed."""
    whole = png(9, 7, colour)
    data = zlib.compress(png_rows(9, 7, 8, colour), 9)
    pixels = chunk(b"IDAT", data)
    start = SIGNATURE + header(9, 7)
    noise = random.Random(4)
    rough = lambda x, y: [math.floor(256 * noise.random()) for _ in range(3)]
    yield "signature-bit.png", bytes([whole[0] & 0x7F]) + whole[1:], "WARN", "the top bit of the first byte is lost"
    yield "signature-short.png", whole[:3] + whole[4:], "WARN", "a byte of the signature is lost"
    yield "line-ends.png", whole.replace(b"\n", b"\r\n"), "WARN", "line ends converted as in text"
    wrong = chunk(b"IHDR", struct.pack(">IIBBBBB", 9, 7, 8, 2, 0, 0, 0), 0x12345678)
    yield "header-checksum.png", SIGNATURE + wrong + pixels + END, "WARN", "a wrong checksum of the header"
    yield "colour-type.png", SIGNATURE + header(9, 7, 8, 1) + pixels + END, "WARN", "colour type 1 does not exist"
    yield "bit-depth.png", SIGNATURE + header(9, 7, 0) + pixels + END, "WARN", "bit depth 0"
    yield "depth-of-colour.png", SIGNATURE + header(9, 7, 4) + pixels + END, "WARN", "RGB cannot have 4 bits"
    yield "no-header.png", SIGNATURE + pixels + END, "WARN", "no header"
    yield "no-pixels.png", start + END, "WARN", "no pixels"
    yield "no-palette.png", SIGNATURE + header(9, 7, 8, 3) + pixels + END, "WARN", "palette indices without a palette"
    yield "no-end.png", start + pixels, "LOAD/WARN", "no end marker"
    rough_png = png(24, 24, rough)
    yield "cut.png", rough_png[: len(rough_png) // 2], "WARN", "cut within the pixels"
    yield "cut-in-chunk.png", whole[:50], "WARN", "cut soon after the header"
    yield "cut-in-header.png", whole[:20], "WARN", "cut within the header"
    yield "few-rows.png", start + chunk(b"IDAT", zlib.compress(png_rows(9, 3, 8, colour), 9)) + END, "WARN", "fewer rows than the header states"
    broken = data[:2] + bytes([data[2] ^ 0x06]) + data[3:]
    yield "deflate.png", start + chunk(b"IDAT", broken) + END, "WARN", "pixels that cannot be decompressed"
    filtered = b"".join(b"\x09" + bytes(27) for _ in range(7))
    yield "row-filter.png", start + chunk(b"IDAT", zlib.compress(filtered, 9)) + END, "WARN", "filter 9 does not exist"
    long = struct.pack(">I", 2**31 - 1) + pixels[4:]
    yield "chunk-length.png", start + long + END, "WARN", "a chunk of 2 GB in a small file"
    yield "zero-bytes.png", b"", "WARN", "no bytes"
    yield "zero-width.png", SIGNATURE + header(0, 7) + pixels + END, "WARN", "width 0"
    yield "largest-header.png", SIGNATURE + header(2**31 - 1, 2**31 - 1) + pixels + END, "WARN", "the largest sides that a header can state"
    side = 16400
    packer = zlib.compressobj(9)
    rows = b"".join(packer.compress(bytes(1 + side // 8)) for _ in range(side)) + packer.flush()
    bomb = SIGNATURE + header(side, side, 1, 0) + chunk(b"IDAT", rows) + END
    yield "bomb-16400x16400.png", bomb, "WARN", "269 million pixels in a small file"
    yield "text.png", b"this is no picture\n", "WARN", "text"
    yield "webp.png", webp(), "WARN", "a WebP"
    photo = jpeg(8, 8, rough)
    yield "cut.jpg", photo[: len(photo) * 2 // 3], "LOAD/WARN", "cut within the squares"
    yield "cut-in-tables.jpg", photo[:60], "WARN", "cut within the tables"
    yield "no-frame.jpg", photo[: photo.index(b"\xff\xc0")] + photo[photo.index(b"\xff\xc4") :], "WARN", "no frame header"
    picture = bmp(5, 4, colour)
    yield "large.bmp", picture[:18] + struct.pack("<ii", 2**31 - 1, 2**31 - 1) + picture[26:], "WARN", "sides of 2 billion pixels"
    yield "cut.bmp", picture[: len(picture) // 2], "WARN", "cut within the pixels"
    yield "bits.bmp", picture[:28] + struct.pack("<H", 5) + picture[30:], "WARN", "5 bits per pixel"
    yield "zero-height.tga", tga(5, 0, b""), "WARN", "height 0"
    yield "run-beyond-end.tga", tga(2, 2, bytes([0xFF, 1, 2, 3]), 10), "LOAD/WARN", "a run longer than the picture"
    yield "cut.tga", tga(5, 4, bytes(20)), "WARN", "cut within the pixels"
    animation = gif(6, 5, [colour(k, k) for k in range(8)], lambda x, y: (x + y) % 8)
    yield "cut.gif", animation[: len(animation) // 2], "WARN", "cut within the pixels"
    yield "cut.tiff", tiff(5, 4, colour)[:50], "WARN", "the directory is lost"


def write(folder: Path):
    for name in ("obj", "images", "images-valid"):
        (folder / name).mkdir(parents=True)
    rows = []

    def add(name, content, outcome, fault):
        content = content.encode() if isinstance(content, str) else content
        (folder / name).write_bytes(content)
        rows.append(f"| {name} | {len(content)} | {outcome} | {fault} |\n")

    for name, content, outcome, fault in models():
        if content is None:
            (folder / "obj" / f"{name}.obj").mkdir()
            # An empty folder cannot be versioned.
            (folder / "obj" / f"{name}.obj" / "placeholder").write_bytes(b"")
            rows.append(f"| obj/{name}.obj | - | {outcome} | {fault} |\n")
        else:
            add(f"obj/{name}.obj", content, outcome, fault)
    for name, content in LIBRARIES.items():
        (folder / "obj" / f"{name}.mtl").write_bytes(content)
    for name, content, outcome, fault in damaged_pictures():
        add(f"images/{name}", content, outcome, fault)
    for name, content, fault in valid_pictures():
        add(f"images-valid/{name}", content, "LOAD", fault)
    (folder / "INDEX.md").write_text(INTRODUCTION + "".join(rows))
    print(f"{len(rows)} damaged and odd files")
