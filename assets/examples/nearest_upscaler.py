# An upscaler process: repeats the nearest sample, like the built-in upscaler `nearest` at x2. Needs no packages. Try it:
# rasterscope render chess --upscaler-process 'py-nearest=python3 nearest_upscaler.py' --set upscaler.method=py-nearest
import struct, sys

read, write = sys.stdin.buffer.read, sys.stdout.buffer.write
magic, version, pixel_format, has_depth = struct.unpack("<8s3I", read(20))
if (magic, version) != (b"RSUPSCAL", 1):
    sys.exit("this program speaks version 1 of the upscaler protocol")
write(struct.pack("<8sI", b"RSUPSCAL", 1))
sys.stdout.buffer.flush()
pixel = 16 if pixel_format else 4  # bytes per pixel

while header := read(36):
    number, columns, rows, width, height, scale, first, size = struct.unpack("<5I2fQ", header)
    data = read(size)  # colours, then depths
    x_offsets = [int(x / scale) * pixel for x in range(width)]
    picture = bytearray()
    for y in range(height):
        start = int(y / scale) * columns * pixel
        row = data[start : start + columns * pixel]
        picture += b"".join(row[x : x + pixel] for x in x_offsets)
    write(struct.pack("<3I", number, width, height) + picture)
    sys.stdout.buffer.flush()
