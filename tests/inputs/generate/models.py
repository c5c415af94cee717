"""Writes small models in `models`, and `INDEX.md` with their triangles, counted from the text of their faces."""

import math
from pathlib import Path

from pictures import png

INTRODUCTION = """\
# Models

Written by `generate`. The last column counts faces and their triangles, corners − 2 each, in the text; it does not
know which faces have no area.

| model | shows | v / vt / vn | faces -> triangles |
|---|---|---|---|
"""


def number(value):
    """Returns a number with at most five decimals."""
    text = f"{value:.5f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def vertices(points, keyword="v"):
    return "".join(f"{keyword} {' '.join(map(number, point))}\n" for point in points)


CUBE = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
# Sides of the cube as quads, counter-clockwise from outside, by indices from 1.
SIDES = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def faces(lists):
    return "".join(f"f {' '.join(map(str, corners))}\n" for corners in lists)


def ball(columns, rows):
    """Returns positions and faces of a sphere: quads, and triangles at the poles."""
    points = [(0, 1, 0)]
    for row in range(1, rows):
        latitude = math.pi * row / rows
        for column in range(columns):
            longitude = 2 * math.pi * column / columns
            points.append((math.sin(latitude) * math.cos(longitude), math.cos(latitude), -math.sin(latitude) * math.sin(longitude)))
    points.append((0, -1, 0))
    at = lambda row, column: 2 + (row - 1) * columns + column % columns
    lists = [(1, at(1, c), at(1, c + 1)) for c in range(columns)]
    lists += [(at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)) for r in range(1, rows - 1) for c in range(columns)]
    lists += [(at(rows - 1, c), len(points), at(rows - 1, c + 1)) for c in range(columns)]
    return points, lists


def vase():
    """Returns a body of revolution with texture coordinates and normals, about twice as high as wide."""
    profile = [(0.35, -1), (0.6, -0.7), (0.72, -0.25), (0.5, 0.3), (0.3, 0.7), (0.42, 1)]
    columns = 14
    points, normals, uvs, lists = [], [], [], []
    for index, (radius, y) in enumerate(profile):
        (below, low), (above, high) = profile[max(index - 1, 0)], profile[min(index + 1, 5)]
        length = math.hypot(above - below, high - low)
        slope = ((high - low) / length, (below - above) / length)
        for column in range(columns + 1):
            turn = 2 * math.pi * column / columns
            points.append((radius * math.cos(turn), y, radius * math.sin(turn)))
            normals.append((slope[0] * math.cos(turn), slope[1], slope[0] * math.sin(turn)))
            uvs.append((column / columns, index / 5))
    for row in range(5):
        for column in range(columns):
            a = row * (columns + 1) + column + 1
            lists.append([f"{i}/{i}/{i}" for i in (a, a + columns + 1, a + columns + 2, a + 1)])
    return vertices(points) + vertices(uvs, "vt") + vertices(normals, "vn") + faces(lists)


def corridor():
    """Returns a long room with pillars, seen from inside in every near view."""
    points, lists = [], []

    def box(low, high, inward):
        first = len(points)
        points.extend(tuple(b if c > 0 else a for a, b, c in zip(low, high, corner)) for corner in CUBE)
        for side in SIDES:
            lists.append([first + i for i in (reversed(side) if inward else side)])

    box((-2, -1, -12), (2, 2, 12), True)
    for k in range(8):
        for x in (-1.5, 1.5):
            z = -10 + k * 20 / 7
            box((x - 0.15, -1, z - 0.15), (x + 0.15, 2, z + 0.15), False)
    return vertices(points) + faces(lists)


CRATES = ["wood", "leaf", "checker"]


def crates():
    """Returns three crates in five materials, two of which share a picture."""
    text = "mtllib crates.mtl\n" + vertices(SQUARE, "vt")
    materials = ["wood", "dark-wood", "leaf", "checker", "plain"]
    first = 0
    for crate in range(3):
        text += f"o crate-{crate}\n" + vertices([(x + 2.5 * crate - 2.5, y, z) for x, y, z in CUBE])
        for index, side in enumerate(SIDES):
            text += f"usemtl {materials[(crate * 2 + index) % 5]}\n"
            text += f"f {' '.join(f'{first + i}/{k}' for k, i in enumerate(side, 1))}\n"
        first += 8
    library = ""
    for material, picture, shade in (("wood", "wood", 1), ("dark-wood", "wood", 0.4), ("leaf", "leaf", 1), ("checker", "checker", 1)):
        library += f"newmtl {material}\nKd {shade} {shade} {shade}\nmap_Kd {picture}.png\n\n"
    return text, library + "newmtl plain\nKd 0.2 0.6 0.3\n"


def wood(x, y):
    grain = (x * 7 + (y // 3) * 5) % 11
    return [150 + 6 * grain, 95 + 5 * grain, 50 + 3 * grain]


def leaf(x, y):
    is_leaf = (x - 7.5) ** 2 / 60 + (y - 7.5) ** 2 / 20 < 1 and abs(x - 7.5) + abs(y - 7.5) < 9
    return [40 + 8 * y, 160 - 3 * x, 30, 255 if is_leaf else 0]


def checker(x, y):
    return [240, 240, 230] if (x // 2 + y // 2) % 2 else [60, 70, 120]


def star(points):
    """Returns the corners of a star, which is concave at every second one."""
    around = [math.pi * k / points for k in range(2 * points)]
    return [(r * math.sin(t), r * math.cos(t), 0) for t, r in zip(around, [1, 0.4] * points)]


def smoothing():
    """Returns a roof of four slopes in smoothing groups: one group, another, and none."""
    points = [(-2, 0, -1), (2, 0, -1), (2, 0, 1), (-2, 0, 1), (-1, 1, 0), (1, 1, 0)]
    return vertices(points) + "s 1\nf 4 3 6 5\nf 2 1 5 6\ns 2\nf 3 2 6\ns off\nf 1 4 5\n"


def all_models():
    """Yields name, description and text of every model, and the text of its material library."""
    box = vertices(CUBE) + faces(SIDES)
    yield "box", "quads without normals", box, None
    yield "ball", "a smooth surface without normals", vertices(ball(24, 14)[0]) + faces(ball(24, 14)[1]), None
    yield "vase", "texture coordinates and normals", vase(), None
    yield "vase_crlf", "the same with other line ends", vase().replace("\n", "\r\n"), None
    yield "corridor", "large triangles around the eye", corridor(), None
    yield "crates", "materials, three pictures, one of them with alpha", *crates()
    colours = [(0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.5 + 0.5 * z) for x, y, z in ball(8, 5)[0]]
    coloured = vertices([p + c for p, c in zip(ball(8, 5)[0], colours)]) + faces(ball(8, 5)[1])
    yield "vertex-colours", "colours after positions", coloured, None
    opacity = "mtllib opacity.mtl\n" + vertices(CUBE) + "".join(
        f"usemtl {'before' if k % 2 else 'after'}\n{faces([side])}" for k, side in enumerate(SIDES))
    yield "opacity", "Tr before and after d", opacity, "newmtl before\nTr 0.6\nd 0.75\n\nnewmtl after\nd 0.75\nTr 0.6\n"
    relative = "".join(
        vertices([CUBE[i - 1] for i in side]) + vertices(SQUARE, "vt") + vertices([normal], "vn") + "f -4/-4/-1 -3/-3/-1 -2/-2/-1 -1/-1/-1\n"
        for side, normal in zip(SIDES, [(0, 0, -1), (0, 0, 1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]))
    yield "relative", "relative indices of positions, texture coordinates and normals", relative, None
    yield "star", "a concave polygon of 14 corners", vertices(star(7)) + faces([range(1, 15)]), None
    yield "smoothing", "smoothing groups", smoothing(), None
    grouped = vertices(CUBE + [(x, y + 3, z) for x, y, z in CUBE]) + "".join(
        f"{'og'[k % 2]} part {k}\n{faces([[i + 8 * (k // 6) for i in SIDES[k % 6]]])}" for k in range(12))
    yield "groups", "objects and groups, names with spaces", grouped, None
    formats = "v 1. .5 -0\nv +1 -.25 1e0\nv 1E+0 0.1e+1 -1.5E-1\nv -1.0000000000000000001 000.5 1e-30\nf 1 2 3 4\n"
    yield "numbers", "numbers in every valid form", formats, None
    yield "homogeneous", "positions with w", "".join(f"v {x} {y} {z} 1.0\n" for x, y, z in CUBE) + faces(SIDES), None
    mixed = vertices(CUBE) + "p 1 2 3\nl 1 2 4 3 1\n" + faces(SIDES[:3]) + "l 5 6\np 8\n" + faces(SIDES[3:])
    yield "mixed", "points and lines between faces", mixed, None
    yield "points", "points only", vertices(CUBE) + "p 1 2 3 4\np 5 6 7 8\n", None
    yield "lines", "lines only", vertices(CUBE) + "l 1 2 4 3\nl 5 6 8 7\n", None
    yield "unfinished", "no line end at the end", box.rstrip("\n"), None
    continued = vertices(CUBE) + "".join(f"f {a} {b} \\\n  {c} {d}\n" for a, b, c, d in SIDES)
    yield "continued", "faces over two lines", continued, None
    yield "around", "a face that runs around its corners five times", vertices(CUBE) + faces([SIDES[0] * 5] + SIDES[1:]), None
    slit = vertices(CUBE + [(-1, -1, -1)]) + faces(SIDES) + faces([(1, 9, 2), (3, 4, 4)])
    yield "slit", "two faces with two corners in one place", slit, None
    libraries = "mtllib nowhere.mtl libraries.mtl\nusemtl red\n" + vertices(CUBE[:3]) + faces([(1, 2, 3)])
    yield "libraries", "two libraries on one line, the first one missing", libraries, "newmtl red\nKd 0.9 0.1 0.1\n"
    options = "mtllib options.mtl\n" + vertices(SQUARE, "vt") + vertices([(x, y, 0) for x, y in SQUARE]) + "usemtl m\nf 1/1 2/2 3/3 4/4\n"
    yield "options", "options before the name of a picture", options, "newmtl m\nmap_Kd -blendu on -o 0 0 0 -s 1 1 1 -mm 0 1 checker.png\n"


def counted(text):
    """Returns counts of v, vt, vn, faces and triangles."""
    lines = [line.split() for line in text.replace("\\\n", " ").splitlines()]
    counts = [sum(line[:1] == [keyword] for line in lines) for keyword in ("v", "vt", "vn", "f")]
    return counts + [sum(len(line) - 3 for line in lines if line[:1] == ["f"])]


def write(folder: Path):
    folder.mkdir(parents=True)
    table = INTRODUCTION
    for name, shows, text, library in all_models():
        (folder / f"{name}.obj").write_bytes(text.encode())
        if library is not None:
            (folder / f"{name}.mtl").write_bytes(library.encode())
        v, vt, vn, count, triangles = counted(text.replace("\r\n", "\n"))
        table += f"| {name}.obj | {shows} | {v} / {vt} / {vn} | {count} -> {triangles} |\n"
    (folder / "INDEX.md").write_bytes(table.encode())
    for name, pixel, colour in (("wood", wood, 2), ("leaf", leaf, 6), ("checker", checker, 2)):
        (folder / f"{name}.png").write_bytes(png(16, 16, pixel, colour=colour))
    print(f"{table.count('.obj |')} models")
