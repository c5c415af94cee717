"""Exact answers to numerical cases: every decision is made with `fractions.Fraction`.

Pixel (i, j) spans [i, i + 1) × [j, j + 1) with y down, and its sample lies at its centre. Numbers of a case are exact
binary32 values. Answers are rounded to binary64 once, at the end.
"""

import math
from collections import deque
from fractions import Fraction

HALF = Fraction(1, 2)

# Distance in pixels within which a sample counts as close to an edge.
BORDER = Fraction(1, 128)


def answer(case):
    """Returns the answer to a case as a JSON object."""
    return {"id": case["id"], **globals()["answer_" + case["kind"]](case)}


def snapped(value, bits):
    """Returns the nearest multiple of 2^-bits, ties to even; the value itself if `bits` is None."""
    return Fraction(value) if bits is None else Fraction(round(Fraction(value) * 2**bits), 2**bits)


def spans_of(pixels):
    """Returns runs [row, first column, one past the last column] of a set of (column, row)."""
    runs = []
    for x, y in sorted(pixels, key=lambda pixel: (pixel[1], pixel[0])):
        if runs and runs[-1][0] == y and runs[-1][2] == x:
            runs[-1][2] = x + 1
        else:
            runs.append([y, x, x + 1])
    return runs


class Line:
    """The form a·x + b·y + c in pixels, positive inside."""

    def __init__(self, a, b, c):
        self.a, self.b, self.c = a, b, c

    def at(self, x, y):
        return self.a * x + self.b * y + self.c

    def is_near(self, value):
        """Whether a point where the form has this value lies within BORDER of the line."""
        return value**2 <= BORDER**2 * (self.a**2 + self.b**2)

    def owns(self, rule):
        """Whether samples on the line belong to the inside."""
        sideways, down = self.a, self.b
        if rule in ("top_right", "bottom_right"):
            sideways = -sideways
        if rule in ("bottom_left", "bottom_right"):
            down = -down
        return rule == "inclusive" or (rule != "exclusive" and (sideways > 0 or (sideways == 0 and down > 0)))


def edges(corners):
    """Returns the three edges of a triangle, each opposite to its corner, and twice its signed area."""
    forms = []
    for i in range(3):
        (ax, ay), (bx, by) = corners[(i + 1) % 3], corners[(i + 2) % 3]
        forms.append(Line(ay - by, bx - ax, (by - ay) * ax - (bx - ax) * ay))
    return forms, forms[0].at(*corners[0])


def inside_edges(corners):
    """Returns the edges of a triangle with the inside positive; nothing for a triangle without area."""
    forms, area = edges(corners)
    if area == 0:
        return []
    sign = 1 if area > 0 else -1
    return [Line(sign * form.a, sign * form.b, sign * form.c) for form in forms]


def covered(lines, rule, width, height, closed=()):
    """Returns the pixels whose samples satisfy all edges `lines` under a fill rule and all forms `closed` with equality."""
    if not lines:
        return set()
    conditions = [(line, line.owns(rule)) for line in lines] + [(line, True) for line in closed]
    found = set()
    for j in range(height):
        for i in range(width):
            values = ((line.at(i + HALF, j + HALF), owned) for line, owned in conditions)
            if all(value > 0 or (owned and value == 0) for value, owned in values):
                found.add((i, j))
    return found


def borderline(lines, width, height):
    """Returns the pixels whose samples lie close to an edge and not clearly outside of another."""
    found = set()
    for j in range(height):
        for i in range(width):
            values = [(line, line.at(i + HALF, j + HALF)) for line in lines]
            near = [line.is_near(value) for line, value in values]
            if any(near) and all(is_near or value >= 0 for is_near, (_, value) in zip(near, values)):
                found.add((i, j))
    return found


def answer_tri_coverage(case):
    width, height = case["width"], case["height"]
    result = {"spans": {}}
    once = {}
    for key, bits in (("none", None), ("8", 8)):
        pixels = []
        for triangle in case["triangles"]:
            corners = [tuple(snapped(c, bits) for c in corner) for corner in triangle]
            pixels.append(covered(inside_edges(corners), case["rule"], width, height))
        result["spans"][key] = [spans_of(p) for p in pixels]
        hits = [sum((i, j) in p for p in pixels) for j in range(height) for i in range(width)]
        once[key] = {"cracks": hits.count(0), "double": sum(count > 1 for count in hits)}
    if case.get("exactly_once"):
        result["exactly_once"] = once
    close = set()
    for triangle in case["triangles"]:
        lines = inside_edges([tuple(map(Fraction, corner)) for corner in triangle])
        if lines:
            close |= borderline(lines, width, height)
    result["borderline"] = spans_of(close)
    return result


def clip_space_forms(triangle, width, height):
    """Returns, as forms over the picture, the weights of the corners of a clip-space triangle and its depth z / w.

    The weights solve Σ weight · (x, y, w) = (x, y, 1) at a point in normalised device coordinates. They are positive
    where the triangle lies in front of the eye; nothing is divided by w. Returns None if the triangle is seen edge-on.
    """
    rows = [[Fraction(corner[k]) for k in (0, 1, 3)] for corner in triangle]

    def cross(p, q):
        return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])

    normals = [cross(rows[(i + 1) % 3], rows[(i + 2) % 3]) for i in range(3)]
    volume = sum(rows[0][k] * normals[0][k] for k in range(3))
    if volume == 0:
        return None
    weights = []
    for normal in normals:
        a, b, c = (component / volume for component in normal)
        # x = 2 px / width − 1 and y = 1 − 2 py / height.
        weights.append(Line(2 * a / width, -2 * b / height, c - a + b))
    depths = [Fraction(corner[2]) for corner in triangle]
    depth = Line(*(sum(z * getattr(w, k) for z, w in zip(depths, weights)) for k in "abc"))
    return weights, depth


def answer_clip_tri(case):
    width, height = case["width"], case["height"]
    spans, close, rows = [], set(), []
    for number, triangle in enumerate(case["triangles"]):
        forms = clip_space_forms(triangle, width, height)
        if forms is None:
            spans.append([])
            continue
        weights, depth = forms
        planes = [depth, Line(-depth.a, -depth.b, 1 - depth.c)]
        pixels = covered(weights, "top_left", width, height, planes)
        spans.append(spans_of(pixels))
        close |= borderline([line for line in weights + planes if line.a or line.b], width, height)
        ordered = sorted(pixels, key=lambda pixel: (pixel[1], pixel[0]))
        for i, j in ordered[:: max(1, len(ordered) // 10)]:
            at = (i + HALF, j + HALF)
            values = [weight.at(*at) for weight in weights]
            rows.append([number, i, j, *(float(v / sum(values)) for v in values), float(depth.at(*at))])
    return {"spans": spans, "borderline": spans_of(close), "attr": rows}


def answer_tri_attr(case):
    vertices = [{key: Fraction(number) for key, number in vertex.items()} for vertex in case["vertices"]]
    forms, area = edges([(vertex["x"], vertex["y"]) for vertex in vertices])
    rows = []
    for i, j in case["eval"]:
        affine = [form.at(i + HALF, j + HALF) / area for form in forms]
        shares = [weight / vertex["w"] for weight, vertex in zip(affine, vertices)]
        perspective = [share / sum(shares) for share in shares]
        depth = sum(weight * vertex["z"] for weight, vertex in zip(affine, vertices))
        uv = [sum(weight * vertex[key] for weight, vertex in zip(perspective, vertices)) for key in "uv"]
        rows.append([i, j, *map(float, (*affine, *perspective, depth, *uv))])
    return {"pixels": rows}


def answer_poly_fill(case):
    centre = Fraction(case["center"])
    result = {}
    for key, bits in (("none", None), ("8", 8)):
        sides = []
        for contour in case["contours"]:
            corners = [tuple(snapped(c, bits) for c in corner) for corner in contour]
            sides += zip(corners, corners[1:] + corners[:1])
        pixels = set()
        for j in range(case["height"]):
            y = j + centre
            crossings = []
            for (ax, ay), (bx, by) in sides:
                if (ay <= y) != (by <= y):
                    crossings.append((ax + (y - ay) * (bx - ax) / (by - ay), 1 if by > ay else -1))
            for i in range(case["width"]):
                passed = [turn for x, turn in crossings if x <= i + centre]
                if len(passed) % 2 if case["rule"] == "even_odd" else sum(passed):
                    pixels.add((i, j))
        result[key] = spans_of(pixels)
    return {"spans": result}


def clipped(polygon, inside):
    """Returns the part of a convex polygon where the function `inside` is not negative."""
    kept = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1]):
        at_p, at_q = inside(p), inside(q)
        if at_p >= 0:
            kept.append(p)
        if at_p * at_q < 0:
            share = at_p / (at_p - at_q)
            kept.append(tuple(a + share * (b - a) for a, b in zip(p, q)))
    return kept


def answer_tri_area(case):
    triangle = [tuple(map(Fraction, corner)) for corner in case["triangle"]]
    areas = []
    for i in range(case["width"]):
        column = clipped(clipped(triangle, lambda p: p[0] - i), lambda p: i + 1 - p[0])
        for j in range(case["height"]):
            part = clipped(clipped(column, lambda p: p[1] - j), lambda p: j + 1 - p[1])
            twice = sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(part, part[1:] + part[:1]))
            if twice:
                areas.append([i, j, float(abs(twice) / 2)])
    return {"area": areas}


def answer_line(case):
    (x, y), (end_x, end_y) = case["p0"], case["p1"]
    right, down = (1 if end_x >= x else -1), (1 if end_y >= y else -1)
    across, along = sorted((abs(end_x - x), abs(end_y - y)))
    is_flat = abs(end_x - x) >= abs(end_y - y)
    pixels = []
    decision = 2 * across - along
    for _ in range(along + 1):
        pixels.append([x, y])
        # A tie stays on the row or column.
        steps_aside = decision > 0
        decision += 2 * across - 2 * along * steps_aside
        x += right * (is_flat or steps_aside)
        y += down * (steps_aside or not is_flat)
    return {"pixels": pixels if case["last_pixel"] else pixels[:-1]}


def answer_real_line(case):
    ends = [tuple(map(Fraction, case[key])) for key in ("p0", "p1")]
    is_steep = abs(ends[1][0] - ends[0][0]) < abs(ends[1][1] - ends[0][1])
    if is_steep:
        ends = [(y, x) for x, y in ends]
    (from_major, from_minor), (to_major, to_minor) = sorted(ends)
    nearest = []
    for major in range(math.ceil(from_major), math.floor(to_major) + 1):
        share = (major - from_major) / (to_major - from_major) if to_major != from_major else 0
        minor = from_minor + share * (to_minor - from_minor)
        rows = [math.floor(minor + HALF)]
        if minor + HALF == rows[0]:
            rows.append(rows[0] - 1)
        nearest.append([[row, major] if is_steep else [major, row] for row in rows])
    return {"pixels": nearest}


def answer_distance_line(case):
    (ax, ay), (bx, by) = (tuple(map(Fraction, case[key])) for key in ("p0", "p1"))
    dx, dy = bx - ax, by - ay
    square = dx**2 + dy**2
    must, tie = [], []
    for j in range(case["height"]):
        for i in range(case["width"]):
            along = (i - ax) * dx + (j - ay) * dy
            aside = 4 * ((i - ax) * dy - (j - ay) * dx) ** 2
            if 0 < along < square and aside < square:
                must.append([i, j])
            elif 0 <= along <= square and aside <= square:
                tie.append([i, j])
    return {"must": must, "tie": tie}


def answer_circle(case):
    (x, y), radius = case["c"], case["r"]
    pixels = set()
    for across in range(radius + 1):
        # The integer nearest to √(r² − x²), which is never halfway between two.
        square = radius**2 - across**2
        along = math.isqrt(square)
        along += (along + HALF) ** 2 < square
        if across > along:
            break
        for a, b in ((across, along), (along, across)):
            pixels |= {(x + a, y + b), (x + a, y - b), (x - a, y + b), (x - a, y - b)}
    return {"pixels": sorted(map(list, pixels))}


def answer_region_fill(case):
    grid = [row[:] for row in case["grid"]]
    x, y = case["seed"]
    old, new = grid[y][x], case["new"]
    if case["mode"] == "flood":
        belongs = lambda colour: colour == old and colour != new
    else:
        belongs = lambda colour: colour not in (case["boundary"], new)
    around = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)]
    if case["connectivity"] == 4:
        around = [(a, b) for a, b in around if a == 0 or b == 0]
    queue = deque([(x, y)])
    while queue:
        x, y = queue.popleft()
        if 0 <= y < len(grid) and 0 <= x < len(grid[0]) and belongs(grid[y][x]):
            grid[y][x] = new
            queue.extend((x + a, y + b) for a, b in around)
    return {"grid": grid}


def answer_depth(case):
    near = Fraction(case["near"])
    far = None if case["far"] is None else Fraction(case["far"])
    at = {
        "standard": lambda z: far * (z - near) / (z * (far - near)),
        "reversed": lambda z: near * (far - z) / (z * (far - near)),
        "reversed_inf": lambda z: near / z,
        "linear": lambda z: (z - near) / (far - near),
    }[case["mapping"]]
    depths = [at(Fraction(z)) for z in case["z"]]
    stored = [as_stored(depth, case["format"]) for depth in depths]
    steps = [b - a for a, b in zip(stored, stored[1:])]
    sign = -1 if case["mapping"].startswith("reversed") else 1
    ideal = {"ties": steps.count(0), "inversions": sum(step * sign < 0 for step in steps)}
    return {"depth": list(map(float, depths)), "ideal": ideal}


def as_stored(depth, encoding):
    """Returns the value of a depth buffer closest to an exact depth from 0 to 1, as integer or fraction."""
    if encoding == "f32":
        if depth == 0:
            return depth
        exponent = math.floor(math.log2(depth))
        exponent += (Fraction(2) ** (exponent + 1) <= depth) - (Fraction(2) ** exponent > depth)
        step = Fraction(2) ** (max(exponent, -126) - 23)
        return round(depth / step) * step
    return math.floor(depth * (2 ** int(encoding.removeprefix("unorm")) - 1) + HALF)


def answer_texture(case):
    texels = case["texels"]
    width, height = len(texels[0]), len(texels)

    def texel(i, j):
        if case["address"] == "wrap":
            return Fraction(texels[j % height][i % width])
        return Fraction(texels[min(max(j, 0), height - 1)][min(max(i, 0), width - 1)])

    values = []
    for u, v in case["uv"]:
        x, y = Fraction(u) * width, Fraction(v) * height
        if case["filter"] == "point":
            values.append(float(texel(math.floor(x), math.floor(y))))
            continue
        x, y = x - HALF, y - HALF
        i, j = math.floor(x), math.floor(y)
        s, t = x - i, y - j
        rows = [texel(i, j + k) * (1 - s) + texel(i + 1, j + k) * s for k in (0, 1)]
        values.append(float(rows[0] * (1 - t) + rows[1] * t))
    return {"values": values}


def cubic(b, c):
    """Returns the cubic filter of Mitchell and Netravali with these parameters."""

    def at(x):
        x = abs(x)
        if x < 1:
            return ((12 - 9 * b - 6 * c) * x**3 + (12 * b + 6 * c - 18) * x**2 + 6 - 2 * b) / 6
        if x < 2:
            return ((-b - 6 * c) * x**3 + (6 * b + 30 * c) * x**2 - (12 * b + 48 * c) * x + 8 * b + 24 * c) / 6
        return Fraction(0)

    return at


def lagrange(t):
    """Returns the weights of the cubic polynomial through the samples −1, 0, 1 and 2 at t."""
    places = (-1, 0, 1, 2)
    return [math.prod(Fraction(t - b, a - b) for b in places if b != a) for a in places]


def weights_at(kernel, t):
    """Returns the weights of the samples −1, 0, 1 and 2 at t in [0, 1)."""
    zero, one = Fraction(0), Fraction(1)
    if kernel == "nearest_floor":
        return [zero, one, zero, zero]
    if kernel == "nearest":
        return [zero, one, zero, zero] if t < HALF else [zero, zero, one, zero]
    if kernel == "bilinear":
        return [zero, 1 - t, t, zero]
    if kernel == "lagrange":
        return lagrange(t)
    at = {"catmull_rom": cubic(zero, HALF), "mitchell": cubic(Fraction(1, 3), Fraction(1, 3))}[kernel]
    return [at(t - place) for place in (-1, 0, 1, 2)]


def answer_upscale(case):
    image, scale, kernel = case["image"], Fraction(case["scale"]), case["kernel"]

    def enlarged(samples):
        """Enlarges a list of samples; samples beyond its ends equal the last ones."""
        result = []
        for pixel in range(math.floor(len(samples) * scale)):
            place = pixel / scale if case["phase"] == "corner" else (pixel + HALF) / scale - HALF
            first = math.floor(place)
            taps = (samples[min(max(first + k, 0), len(samples) - 1)] for k in (-1, 0, 1, 2))
            result.append(sum(weight * tap for weight, tap in zip(weights_at(kernel, place - first), taps)))
        return result

    rows = [enlarged(row) for row in image]
    columns = [enlarged(column) for column in zip(*rows)]
    return {"values": [list(map(float, row)) for row in zip(*columns)]}
