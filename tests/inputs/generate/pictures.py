"""Encodes small pictures of many formats, bit by bit, so that each file has exactly the property that it is made for."""

import struct
import zlib


def chunk(name, data, crc=None):
    """Returns a PNG chunk."""
    body = name + data
    return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body) if crc is None else crc)


SIGNATURE = b"\x89PNG\r\n\x1a\n"
END = chunk(b"IEND", b"")

# Samples per pixel of each PNG colour type.
CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}


def header(width, height, depth=8, colour=2, interlace=0):
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlace))


def packed(samples, depth):
    """Returns a row of samples as bytes."""
    if depth == 16:
        return struct.pack(f">{len(samples)}H", *samples)
    bits = "".join(f"{sample:0{depth}b}" for sample in samples)
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[i : i + 8], 2) for i in range(0, len(bits), 8))


# First column, first row, column step and row step of the passes of an interlaced PNG.
PASSES = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]


def png_rows(width, height, depth, pixel, interlace=0):
    """Returns the rows of a PNG, each preceded by the number of its filter; `pixel` returns the samples of a pixel."""
    data = b""
    for left, top, right, down in PASSES if interlace else [(0, 0, 1, 1)]:
        columns = range(left, width, right)
        for y in range(top, height, down) if columns else []:
            data += b"\0" + packed([s for x in columns for s in pixel(x, y)], depth)
    return data


def png(width, height, pixel, depth=8, colour=2, interlace=0, before=b"", level=9):
    """Returns a PNG; `before` holds chunks before the pixels."""
    data = zlib.compress(png_rows(width, height, depth, pixel, interlace), level)
    return SIGNATURE + header(width, height, depth, colour, interlace) + before + chunk(b"IDAT", data) + END


class Bits:
    """Bits from the most significant of each byte; 0xFF is followed by 0x00, as in JPEG."""

    def __init__(self):
        self.text = ""

    def add(self, value, count):
        if count:
            self.text += f"{value:0{count}b}"

    def to_bytes(self):
        text = self.text + "1" * (-len(self.text) % 8)
        return b"".join(
            bytes([byte]) + (b"\0" if byte == 0xFF else b"")
            for byte in (int(text[i : i + 8], 2) for i in range(0, len(text), 8))
        )


def segment(marker, data):
    return struct.pack(">BBH", 0xFF, marker, len(data) + 2) + data


# Number of Huffman codes of each length for the 12 sizes of a DC coefficient (JPEG, table K.3).
DC_LENGTHS = (0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0)


def dc_codes():
    codes, code, size = {}, 0, 0
    for length, count in enumerate(DC_LENGTHS, 1):
        for _ in range(count):
            codes[size] = (code, length)
            code, size = code + 1, size + 1
        code <<= 1
    return codes


def jpeg(columns, rows, colour, progressive=False, adobe=None):
    """Returns a JPEG of 8 × 8 px squares of one colour each: all coefficients except the first are zero.

    `colour` returns the components of a square, and `adobe` is the colour transform of an Adobe marker.
    """
    components = len(colour(0, 0))
    codes = dc_codes()
    data = b"\xff\xd8"
    if adobe is not None:
        data += segment(0xEE, b"Adobe" + struct.pack(">HHHB", 100, 0, 0, adobe))
    # The first coefficient is eight times the mean; a quantiser of 8 stores the mean.
    data += segment(0xDB, b"\0" + bytes([8] * 64))
    frame = b"".join(struct.pack("BBB", number, 0x11, 0) for number in range(1, components + 1))
    sides = struct.pack(">BHHB", 8, rows * 8, columns * 8, components)
    data += segment(0xC2 if progressive else 0xC0, sides + frame)
    data += segment(0xC4, b"\x00" + bytes(DC_LENGTHS) + bytes(range(12)))
    # The only other code: end of block.
    data += segment(0xC4, b"\x10" + bytes([1] + [0] * 15) + b"\0")

    def scan(selected, first, last):
        parts = b"".join(struct.pack("BB", number, 0) for number in selected)
        return segment(0xDA, bytes([len(selected)]) + parts + bytes([first, last, 0]))

    bits, before = Bits(), [0] * components
    for y in range(rows):
        for x in range(columns):
            for number, value in enumerate(colour(x, y)):
                difference = value - 128 - before[number]
                before[number] = value - 128
                size = abs(difference).bit_length()
                bits.add(*codes[size])
                bits.add(difference if difference >= 0 else difference + 2**size - 1, size)
                if not progressive:
                    bits.add(0, 1)
    data += scan(range(1, components + 1), 0, 0 if progressive else 63) + bits.to_bytes()
    for number in range(1, components + 1) if progressive else []:
        ends = Bits()
        ends.add(0, columns * rows)
        data += scan([number], 1, 63) + ends.to_bytes()
    return data + b"\xff\xd9"


def cmyk(rgb):
    """Returns the components of a colour as Adobe stores them: cyan, magenta, yellow and black, inverted."""
    black = max(rgb)
    return [round(255 * channel / max(black, 1)) for channel in rgb] + [black]


def bmp(width, height, pixel):
    """Returns a BMP of 24 bits per pixel."""
    padding = b"\0" * (-3 * width % 4)
    rows = [b"".join(bytes(pixel(x, y)[::-1]) for x in range(width)) + padding for y in reversed(range(height))]
    data = b"".join(rows)
    info = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(data), 2835, 2835, 0, 0)
    return b"BM" + struct.pack("<IHHI", 54 + len(data), 0, 0, 54) + info + data


def tga(width, height, pixels, kind=2, bits=24):
    """Returns a TGA whose pixel data is `pixels`; kind 2 is raw, and kind 10 has run lengths."""
    return struct.pack("<BBBHHBHHHHBB", 0, 0, kind, 0, 0, 0, 0, 0, width, height, bits, 0x20) + pixels


def gif(width, height, palette, index):
    """Returns a GIF of eight colours; the dictionary is cleared before codes grow."""
    bits = ""
    for number in range(width * height):
        if number % 5 == 0:
            bits = f"{8:04b}" + bits
        bits = f"{index(number % width, number // width):04b}" + bits
    bits = f"{9:04b}" + bits
    data = int(bits, 2).to_bytes((len(bits) + 7) // 8, "little")
    blocks = b"".join(bytes([len(data[i : i + 255])]) + data[i : i + 255] for i in range(0, len(data), 255))
    screen = struct.pack("<HHBBB", width, height, 0xF2, 0, 0) + b"".join(map(bytes, palette))
    return b"GIF89a" + screen + b"," + struct.pack("<HHHHBB", 0, 0, width, height, 0, 3) + blocks + b"\0;"


def tiff(width, height, pixel):
    """Returns an uncompressed RGB TIFF."""
    data = b"".join(bytes(pixel(x, y)) for y in range(height) for x in range(width))
    entries = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 3, 8 + len(data)), (259, 3, 1, 1), (262, 3, 1, 2),
               (273, 4, 1, 8), (277, 3, 1, 3), (278, 3, 1, height), (279, 4, 1, len(data)), (284, 3, 1, 1)]
    depths = struct.pack("<HHH", 8, 8, 8)
    directory = struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *entry) for entry in entries) + bytes(4)
    return b"II*\0" + struct.pack("<I", 8 + len(data) + len(depths)) + data + depths + directory


def webp():
    """Returns a lossless WebP of one pixel."""
    bits = ""

    def add(value, count):
        nonlocal bits
        bits = f"{value:0{count}b}" + bits

    add(0, 14), add(0, 14), add(0, 1), add(0, 3)
    # Neither transforms nor a colour cache nor several codes.
    add(0, 1), add(0, 1), add(0, 1)
    for symbol in (60, 200, 120, 255, 0):
        # A code of one symbol, given in 8 bits.
        add(1, 1), add(0, 1), add(1, 1), add(symbol, 8)
    data = b"\x2f" + int(bits, 2).to_bytes((len(bits) + 7) // 8, "little")
    data += b"\0" * (len(data) % 2)
    return b"RIFF" + struct.pack("<I", 12 + len(data)) + b"WEBPVP8L" + struct.pack("<I", len(data)) + data
