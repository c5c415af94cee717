"""Writes numerical cases with their exact answers: `cases/cases/ID.json` and `cases/expected/ID.json`."""

import json
import math
import random
import struct
from fractions import Fraction
from pathlib import Path

from exact import answer, covered, inside_edges

RULES = ("top_left", "top_right", "bottom_left", "bottom_right", "inclusive", "exclusive")


def f32(value):
    """Returns the nearest binary32 value."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def stepped(value, steps):
    """Returns the binary32 value that many steps away from a positive one."""
    bits = struct.unpack("<I", struct.pack("<f", value))[0]
    return struct.unpack("<f", struct.pack("<I", bits + steps))[0]


def uniform(rng, low, high):
    return f32(low + (high - low) * rng.random())


def triangles(rng, count, point):
    return [[point(rng) for _ in range(3)] for _ in range(count)]


def coverage(case_id, case_class, note, size, rule, shapes, exactly_once=False):
    case = {"id": case_id, "class": case_class, "note": note, "kind": "tri_coverage"}
    case |= {"width": size[0], "height": size[1], "rule": rule}
    case["triangles"] = [[[f32(x), f32(y)] for x, y in shape] for shape in shapes]
    return case | ({"exactly_once": True} if exactly_once else {})


def single_triangles():
    rng = random.Random(1)
    anywhere = lambda r: [uniform(r, -6, 30), uniform(r, -6, 24)]
    for rule in RULES:
        on_centres = lambda r: [math.floor(r.random() * 24) + 0.5, math.floor(r.random() * 18) + 0.5]
        shapes = triangles(rng, 5, on_centres)
        # Edges along rows, columns and diagonals of samples, in both windings.
        shapes += [[[2.5, 3.5], [14.5, 3.5], [2.5, 15.5]], [[20.5, 3.5], [8.5, 15.5], [20.5, 15.5]]]
        note = "corners at pixel centres: many samples lie on edges"
        yield coverage(f"cov-on-centres-{rule.replace('_', '-')}", "cov_on_centres", note, (24, 18), rule, shapes)
    for number, rule in enumerate(("top_left", "bottom_right")):
        shapes = triangles(rng, 4, anywhere)
        yield coverage(f"cov-random-{number}", "cov_random", "corners anywhere, also outside", (24, 18), rule, shapes)
    thin = []
    for _ in range(6):
        x, y = uniform(rng, 0, 8), uniform(rng, 0, 18)
        far = [uniform(rng, 14, 24), uniform(rng, 0, 18)]
        thin.append([[x, y], far, [x + 0.05 * rng.random(), y + 0.3]])
    yield coverage("cov-needle", "cov_needle", "thinner than a pixel", (24, 18), "top_left", thin)
    # The third corner lies a few steps of a float beside the diagonal through pixel centres.
    slivers = [[[0.5, 0.5], [16.5, 16.5], [stepped(8.5, k), 8.5]] for k in (-2, -1, 0, 1, 2)]
    yield coverage("cov-sliver", "cov_sliver", "as wide as a step of a float", (18, 18), "top_left", slivers)
    big = [[[-1e6, -1e6], [1e6, 9.3], [-1e6, 1e6]], [[7.25, 1e7], [-1e7, -1e7], [3e7, -5e6]], [[-4e3, 8], [4e3, 8.1], [0, 9e3]]]
    yield coverage("cov-huge", "cov_huge", "far beyond the picture", (20, 16), "top_left", big)
    close = [[[0.5, 0.5], [12.5, stepped(4.5, k)], [0.5, 12.5]] for k in (-1, 0, 1)]
    yield coverage("cov-step", "cov_sub_f64", "an edge one step of a float beside samples", (14, 14), "top_left", close)
    least = 2.0**-149
    subnormal = [[[0, 0], [8, least], [least, 8]], [[least, least], [2 * least, 0], [0, 3 * least]], [[-least, 0.5], [8, 0.5], [0, 9]]]
    yield coverage("cov-subnormal", "cov_subnormal", "subnormal coordinates", (8, 8), "inclusive", subnormal)
    corner = lambda x, y: [x / 256, y / 256]
    tiny = [[corner(127, 127), corner(130, 127), corner(127, 130)], [corner(128, 128), corner(129, 128), corner(128, 129)]]
    tiny += [[corner(384.4, 380), corner(388, 384.6), corner(380, 388)], [corner(640, 640), corner(640.4, 640), corner(640, 640.4)]]
    yield coverage("cov-tiny", "cov_tiny", "a few steps of the grid of 1/256 px", (4, 4), "top_left", tiny)
    flat = [[[5, 5]] * 3, [[1.5, 1.5], [6.5, 6.5], [1.5, 1.5]], [[0.5, 3.5], [4.5, 3.5], [7.5, 3.5]], [[0, 0], [3.25, 3.25], [8, 8]]]
    for rule in ("top_left", "inclusive"):
        name = f"cov-degenerate-{rule.replace('_', '-')}"
        yield coverage(name, "cov_degenerate", "no area: a point or a line", (8, 8), rule, flat)
    wide = [[[-0.5, 0.5], [1023.5, 2.5], [3, 2.75]], [[0.25, 0], [1024, 0.51], [1024, 2.49]]]
    yield coverage("cov-wide", "cov_wide", "a wide picture", (1024, 3), "top_left", wide)


def meshes():
    rng = random.Random(2)
    size = (20, 16)
    for number, middle in enumerate(([8.5, 7.5], [9.171875, 6.3])):
        around = []
        for step in range(11):
            turn = 2 * math.pi * step / 11
            around.append([f32(10 + 40 * math.cos(turn)), f32(8 + 40 * math.sin(turn))])
        fan = [[middle, a, b] for a, b in zip(around, around[1:] + around[:1])]
        yield coverage(f"mesh-fan-{number}", "mesh_fan", "a fan around one corner", size, "top_left", fan, True)

    def grid(columns, rows, move):
        def at(x, y):
            is_inner = 0 < x < columns and 0 < y < rows
            dx, dy = (move(rng), move(rng)) if is_inner else (0, 0)
            return [f32(-1 + 22 * x / columns + dx), f32(-1 + 18 * y / rows + dy)]

        corners = [[at(x, y) for x in range(columns + 1)] for y in range(rows + 1)]
        for y in range(rows):
            for x in range(columns):
                a, b, c, d = corners[y][x], corners[y][x + 1], corners[y + 1][x + 1], corners[y + 1][x]
                yield from ([a, b, c], [a, d, c]) if (x + y) % 2 else ([a, b, d], [b, d, c])

    shaken = list(grid(4, 3, lambda r: 1.5 * (r.random() - 0.5)))
    yield coverage("mesh-grid-0", "mesh_grid", "a grid with moved corners", size, "top_left", shaken, True)
    aligned = list(grid(11, 3, lambda r: math.floor(3 * r.random()) / 2 - 0.5))
    yield coverage("mesh-grid-1", "mesh_grid", "corners at pixel centres and edges", size, "bottom_right", aligned, True)
    top = [[f32(-2 + 24 * k / 40), -1] for k in range(41)]
    bottom = [[f32(22 - 24 * k / 40), 17] for k in range(41)]
    # Strips that turn over in the middle would overlap, so both borders run in one direction.
    bottom.reverse()
    strips = [t for k in range(40) for t in ([top[k], top[k + 1], bottom[k]], [top[k + 1], bottom[k + 1], bottom[k]])]
    yield coverage("mesh-strips", "mesh_strips", "strips narrower than a pixel", size, "top_left", strips, True)


def clip_space():
    def case(number, note, *shapes, size=(24, 18)):
        triangles_ = [[[f32(c) for c in corner] for corner in shape] for shape in shapes]
        head = {"id": f"clip-{number}", "class": "clip", "note": note, "kind": "clip_tri"}
        return head | {"width": size[0], "height": size[1], "triangles": triangles_}

    yield case("inside", "not clipped", [[-0.7, -0.6, 0.2, 1], [0.9, -0.4, 0.5, 1.25], [0.1, 1.4, 1.2, 2]])
    yield case("near", "one and two corners before the near plane",
               [[-0.8, -0.9, -0.3, 0.5], [0.9, -0.7, 0.6, 1], [0, 0.8, 0.4, 1]],
               [[-0.8, -0.9, -0.3, 0.5], [0.9, -0.7, -0.2, 1], [0, 0.8, 0.4, 1]])
    yield case("far", "one corner beyond the far plane", [[-0.8, -0.8, 0.7, 1], [0.9, -0.6, 0.9, 1], [0.2, 2.4, 3.9, 3]])
    yield case("behind", "one and two corners behind the eye",
               [[-1, -1, 0.5, 1], [1, -1, 0.5, 1], [0.3, 2, -1.5, -1]],
               [[0.1, -0.8, 0.5, 1], [2, 1, -1.2, -1], [-2, 1.5, -1.4, -0.75]])
    yield case("all-behind", "completely behind the eye", [[-1, -1, -0.5, -1], [1, -1, -0.5, -1], [0, 1, -0.5, -1]])
    yield case("zero", "a corner at the eye; edge-on", [[0, 0, 0, 0], [1, 0, 0.5, 1], [0, 1, 0.5, 1]],
               [[-1, 0.25, 0.5, 1], [1, 0.25, 0.25, 1], [3, 0.25, 0.125, 1]])
    yield case("outside", "beside the picture", [[2, -1, 0.5, 1], [3, -1, 0.5, 1], [2.5, 1, 0.5, 1]])
    yield case("large", "hundreds of pictures wide", [[-300, -200, 0.25, 1], [310, -190, 0.5, 1.5], [12, 400, 0.5, 2]])
    yield case("floor", "a floor from below the eye to the horizon",
               [[-4, -1, -0.1, 0.05], [4, -1, -0.1, 0.05], [4, -1, 9.8, 10]],
               [[-4, -1, -0.1, 0.05], [4, -1, 9.8, 10], [-4, -1, 9.8, 10]])


def attributes():
    def case(number, case_class, note, corners, count=14, size=(64, 48)):
        vertices = [dict(zip("xyzwuv", map(f32, corner))) for corner in corners]
        rng = random.Random(number)
        lines = inside_edges([tuple(map(Fraction, (vertex["x"], vertex["y"]))) for vertex in vertices])
        inside = sorted(covered(lines, "exclusive", *size))
        chosen = sorted(list(inside[math.floor(rng.random() * len(inside))]) for _ in range(count))
        unique = [pixel for k, pixel in enumerate(chosen) if k == 0 or pixel != chosen[k - 1]]
        head = {"id": f"attr-{number}", "class": case_class, "note": note, "kind": "tri_attr"}
        return head | {"width": size[0], "height": size[1], "vertices": vertices, "eval": unique}

    yield case("affine", "attr_affine", "equal w", [[2, 3, 0.25, 1, 0, 0], [60, 7.5, 0.5, 1, 1, 0], [9, 45, 0.75, 1, 0, 1]])
    yield case("perspective", "attr_persp", "w from 1 to 9", [[1, 2, 0.1, 1, 0, 0], [62, 10, 0.8, 4.5, 1, 0], [20, 47, 0.9, 9, 0.25, 1]])
    yield case("extreme", "attr_w_extreme", "w from 1/1000 to 1000", [[1, 1, 0.5, 0.001, 0, 0], [62, 3, 0.5, 1, 1, 0], [5, 46, 0.5, 1000, 0, 1]])
    yield case("clockwise", "attr_persp", "the other winding", [[1, 47, 0.9, 2, 0, 1], [62, 30.25, 0.3, 1, 1, 1], [10.5, 1, 0.2, 3, 0, 0]])
    yield case("plane", "attr_zplane", "depths one step of a float apart", [[0, 0, 0.5, 1, 0, 0], [64, 0, stepped(0.5, 1), 1, 1, 0], [0, 48, 0.5, 1, 0, 1]])
    yield case("sliver", "attr_sliver", "half a pixel thin", [[1, 2.25, 0.1, 1, 0, 0], [62, 40.5, 0.9, 2, 1, 0], [62, 41, 0.8, 2, 1, 1]])
    yield case("uv", "attr_huge_uv", "texture coordinates up to a million", [[2, 2, 0.5, 1, -1e6, 3e5], [60, 4, 0.5, 2, 1e6, 7], [8, 44, 0.5, 4, 0.5, -2e5]])
    yield case("large", "attr_guardband", "far beyond the picture", [[-4000, -3000, 0.25, 1, 0, 0], [4100, -2000, 0.5, 2, 1, 0], [30, 6000, 0.75, 3, 0, 1]])


def polygons():
    rng = random.Random(5)

    def case(number, note, rule, contours, centre=0.5, size=(24, 18)):
        head = {"id": f"poly-{number}", "class": "poly", "note": note, "kind": "poly_fill"}
        head |= {"width": size[0], "height": size[1], "rule": rule, "center": centre}
        return head | {"contours": [[[f32(x), f32(y)] for x, y in contour] for contour in contours]}

    star = [[f32(12 + 9 * math.sin(2.4 * math.pi * k / 3)), f32(9 - 8.5 * math.cos(2.4 * math.pi * k / 3))] for k in range(5)]
    for rule in ("even_odd", "nonzero"):
        name = rule.replace("_", "-")
        yield case(f"star-{name}", "crosses itself", rule, [star])
        hole = [[[1.5, 1.5], [22.5, 1.5], [22.5, 16.5], [1.5, 16.5]], [[6.5, 4.5], [17.5, 4.5], [17.5, 12.5], [6.5, 12.5]]]
        yield case(f"nested-{name}", "one contour in another, both of one winding", rule, hole)
        yield case(f"lattice-{name}", "samples at whole coordinates", rule, [[[2, 2], [20, 2], [20, 9], [11, 16], [2, 9]]], 0.0)
    wild = [[uniform(rng, -3, 27), uniform(rng, -3, 21)] for _ in range(9)]
    yield case("random", "random corners", "even_odd", [wild])
    comb = [[1, 1]] + [[1 + k * 0.75, 15 if k % 2 else 3] for k in range(28)] + [[22, 1]]
    yield case("comb", "teeth narrower than a pixel", "nonzero", [comb])
    yield case("thin", "as thin as a step of a float", "nonzero", [[[3, 3], [21, stepped(3, 4)], [3, stepped(3, 8)]]])
    yield case("empty", "no corners, one corner, and a line", "even_odd", [[], [[4, 4]], [[1, 1], [20, 15]]])
    yield case("large", "far beyond the picture", "nonzero", [[[-1e7, 4.25], [1e7, 5.75], [0, 3e6]]])


def areas():
    def case(number, note, triangle, size=(12, 10)):
        head = {"id": f"area-{number}", "class": "area", "note": note, "kind": "tri_area"}
        return head | {"width": size[0], "height": size[1], "triangle": [[f32(x), f32(y)] for x, y in triangle]}

    yield case("plain", "corners anywhere", [[1.2, 0.7], [10.9, 3.3], [4.1, 9.6]])
    yield case("clockwise", "the other winding", [[4.1, 9.6], [10.9, 3.3], [1.2, 0.7]])
    yield case("grid", "corners at pixel corners", [[1, 1], [9, 1], [1, 9]])
    yield case("small", "within one pixel", [[3.25, 4.125], [3.75, 4.25], [3.5, 4.875]])
    yield case("needle", "thinner than a pixel", [[0.1, 0.2], [11.7, 8.9], [11.6, 9.0]])
    yield case("half", "half of the plane", [[-1e6, 5], [1e6, 5], [5, 1e6]])
    yield case("flat", "no area", [[1, 1], [5, 5], [9, 9]])
    yield case("outside", "beside the picture", [[20, 1], [30, 2], [25, 9]])


def lines():
    # Lines twice as long as high pass exactly between two pixels.
    ends = [(9, 4), (4, 8), (-4, 8), (-8, 4), (-9, -4), (-4, -9), (4, -8), (8, -4), (9, 0), (0, -9), (9, 9)]
    for number, (x, y) in enumerate(ends):
        head = {"id": f"line-{number:02}", "class": "line", "note": "every octant, ties included", "kind": "line"}
        yield head | {"p0": [3, -2], "p1": [3 + x, -2 + y], "last_pixel": number % 3 > 0}
    for last in (False, True):
        head = {"id": f"line-point-{str(last).lower()}", "class": "line", "note": "a single pixel", "kind": "line"}
        yield head | {"p0": [5, 7], "p1": [5, 7], "last_pixel": last}
    head = {"id": "line-long", "class": "line", "note": "long enough for sums of floats to drift", "kind": "line"}
    yield head | {"p0": [-7, 4], "p1": [493, 171], "last_pixel": True}


def real_lines():
    ends = [([20.5, 5.25], [4, -5.5]), ([0.5, 0.5], [9.5, 5.0]), ([3, 12.75], [7.25, -1]), ([-2.4, 3.5], [8.3, 3.5]),
            ([4.2, 8], [4.9, -3]), ([2.3, 1.1], [2.6, 1.4]), ([1, 1], [1, 1]), ([0, 0], [8, 4])]
    for number, (p0, p1) in enumerate(ends):
        head = {"id": f"real-line-{number}", "class": "real_line", "note": "either pixel at an exact tie", "kind": "real_line"}
        yield head | {"p0": list(map(f32, p0)), "p1": list(map(f32, p1))}


def distance_lines():
    ends = [([2, 3], [20, 3]), ([2.5, 1], [2.5, 14]), ([1, 1], [17, 13]), ([0, 0.5], [20, 7]), ([15, 2.25], [3.5, 12]), ([5, 5], [5.25, 5.25])]
    for number, (p0, p1) in enumerate(ends):
        head = {"id": f"distance-line-{number}", "class": "distance_line", "note": "pixels at whole coordinates", "kind": "distance_line"}
        yield head | {"width": 22, "height": 15, "p0": list(map(f32, p0)), "p1": list(map(f32, p1))}


def circles():
    for number, (x, y, radius) in enumerate([(0, 0, 0), (2, -3, 1), (0, 0, 2), (5, 5, 7), (-4, 9, 11), (100, -50, 40)]):
        yield {"id": f"circle-{number}", "class": "circle", "note": "pixels as a set", "kind": "circle", "c": [x, y], "r": radius}


def regions():
    picture = ["##########", "#...#....#", "#...#....#", "#....#...#", "#.....#..#", "##########", "..o....o..", "..oo..oo.."]
    grid = [[{"#": 1, ".": 0, "o": 4}[mark] for mark in row] for row in picture]
    seeds = [("left", [1, 1]), ("right", [8, 3]), ("border", [0, 0]), ("spot", [2, 7])]
    ways = [("flood", 4), ("boundary", 8), ("flood", 8), ("boundary", 4)]
    for number, (name, seed) in enumerate(seeds):
        for mode, connectivity in (ways[number], ways[(number + 1) % 4]):
            head = {"id": f"fill-{name}-{mode}-{connectivity}", "class": "fill", "note": "a room with a slanted wall", "kind": "region_fill"}
            head |= {"grid": grid, "seed": seed, "mode": mode, "connectivity": connectivity, "new": 7}
            yield head | {"boundary": 1 if mode == "boundary" else None}
    same = {"id": "fill-same", "class": "fill", "note": "the colour that is there already", "kind": "region_fill"}
    yield same | {"grid": grid, "seed": [1, 1], "mode": "flood", "connectivity": 4, "new": 0, "boundary": None}


def depths():
    rng = random.Random(9)
    ranges = ((1.0, 1000.0), (0.0625, 65536.0))
    for mapping in ("standard", "reversed", "reversed_inf", "linear"):
        for number, encoding in enumerate(("f32", "unorm24", "unorm16")):
            # Both ranges with the standard mapping, and one of them with the others.
            for near, far in ranges if mapping == "standard" else ranges[number % 2 :][:1]:
                z = {near, f32(0.999 * far)} if mapping == "reversed_inf" else {near, far}
                for _ in range(12):
                    distance = near * (0.99 * far / near) ** rng.random()
                    gap = 2.0 ** -(8 + math.floor(14 * rng.random()))
                    z |= {f32(distance), f32(distance * (1 + gap))}
                name = f"depth-{mapping.replace('_', '-')}-{encoding}-{'short' if near == 1 else 'long'}"
                head = {"id": name, "class": "depth", "note": "pairs of close distances", "kind": "depth", "mapping": mapping}
                far_plane = None if mapping == "reversed_inf" else far
                yield head | {"format": encoding, "near": near, "far": far_plane, "z": sorted(z)}


def textures():
    texels = [[12, 80, 7, 255], [200, 3, 99, 41], [0, 255, 128, 60]]
    near = [[0, 0], [0.5, 0.5], [1, 1], [0.125, 0.9], [0.26, 0.34], [0.75, 2 / 3], [0.99, 0.01]]
    beyond = [[1.3, -0.4], [-2.6, 3.7], [17.25, -9.5], [-1e3, 1e3], [65537.375, -4095.625]]
    uv = [[f32(u), f32(v)] for u, v in near + beyond]
    for filter_ in ("point", "bilinear"):
        for address in ("clamp", "wrap"):
            head = {"id": f"texture-{filter_}-{address}", "class": "texture", "note": "inside and outside of the unit square", "kind": "texture"}
            yield head | {"texels": texels, "filter": filter_, "address": address, "uv": uv}
    head = {"id": "texture-single", "class": "texture", "note": "a single texel", "kind": "texture"}
    yield head | {"texels": [[77]], "filter": "bilinear", "address": "wrap", "uv": uv}
    huge = [[1e9, -1e9], [-1e20, 1e20], [3e38, -3e38]]
    head = {"id": "texture-huge", "class": "texture", "note": "coordinates beyond every integer type", "kind": "texture"}
    yield head | {"texels": texels, "filter": "point", "address": "wrap", "uv": [[f32(u), f32(v)] for u, v in huge]}


def enlargements():
    image = [[0, 255, 17, 90], [200, 3, 128, 64], [31, 31, 255, 0]]
    kernels = [("nearest_floor", "corner"), ("nearest", "corner"), ("nearest", "center")]
    kernels += [(kernel, phase) for kernel in ("bilinear", "lagrange", "catmull_rom", "mitchell") for phase in ("corner", "center")]
    for kernel, phase in kernels:
        for scale in (2, 3, 4):
            # Every method and phase at one scale, and each scale by some.
            if scale == 2 or (kernel in ("bilinear", "lagrange") and (scale == 4) == (phase == "corner")):
                name = f"upscale-{kernel.replace('_', '-')}-{phase}-{scale}"
                head = {"id": name, "class": "upscale", "note": "a small picture of strong contrast", "kind": "upscale"}
                yield head | {"image": image, "scale": scale, "kernel": kernel, "phase": phase}
    for name, kernel, scale, small in (("half", "bilinear", 1.5, image), ("single", "mitchell", 3, [[99]]), ("pair", "catmull_rom", 4, [[10, 240]])):
        head = {"id": f"upscale-{name}", "class": "upscale", "note": "small, or by one and a half", "kind": "upscale"}
        yield head | {"image": small, "scale": scale, "kernel": kernel, "phase": "center"}


def write(folder: Path):
    makers = (single_triangles, meshes, clip_space, attributes, polygons, areas, lines, real_lines, distance_lines,
              circles, regions, depths, textures, enlargements)
    for name in ("cases", "expected"):
        (folder / name).mkdir(parents=True)
    count = 0
    for case in (case for make in makers for case in make()):
        name = case["id"] + ".json"
        for kind, content in (("cases", case), ("expected", answer(case))):
            with open(folder / kind / name, "x", newline="\n") as file:
                file.write(json.dumps(content) + "\n")
        count += 1
    print(f"{count} cases")
