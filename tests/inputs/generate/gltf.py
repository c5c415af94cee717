"""Writes small glTF files in `gltf`: one with files beside it, one binary, one with many features, and one in motion."""

import base64
import json
import struct
from pathlib import Path

from pictures import png

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
UVS = [(0, 1), (1, 1), (1, 0), (0, 0)]
FLAG = [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)]


class Builder:
    """Collects accessors in one buffer."""

    def __init__(self):
        self.data = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "accessors": [], "bufferViews": []}

    def view(self, data):
        self.data += b"\0" * (-len(self.data) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, vectors, kind, **further):
        """Adds vectors of floats ("f"), or of bytes ("B") or shorts ("H")."""
        count = len(vectors[0])
        data = b"".join(struct.pack(f"<{count}{kind}", *vector) for vector in vectors)
        name = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[count]
        component = {"f": 5126, "B": 5121, "H": 5123}[kind]
        accessor = {"bufferView": self.view(data), "componentType": component, "count": len(vectors), "type": name}
        if kind == "f" and count == 3:
            accessor["min"], accessor["max"] = ([pick(axis) for axis in zip(*vectors)] for pick in (min, max))
        self.json["accessors"].append(accessor | further)
        return len(self.json["accessors"]) - 1

    def square(self, **further):
        attributes = {"POSITION": self.accessor(SQUARE, "f"), "TEXCOORD_0": self.accessor(UVS, "f")}
        indices = self.accessor([(index,) for index in (0, 1, 2, 0, 2, 3)], "H")
        return {"attributes": attributes, "indices": indices, "material": 0} | further

    def text(self, uri):
        return json.dumps(self.json | {"buffers": [{"byteLength": len(self.data), "uri": uri}]}, indent=1) + "\n"

    def embedded(self):
        return self.text("data:application/octet-stream;base64," + base64.b64encode(self.data).decode())

    def binary(self):
        text = json.dumps(self.json | {"buffers": [{"byteLength": len(self.data)}]}).encode()
        chunks = b""
        for kind, data, padding in ((b"JSON", text, b" "), (b"BIN\0", self.data, b"\0")):
            data += padding * (-len(data) % 4)
            chunks += struct.pack("<I", len(data)) + kind + data
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def textured(builder, image):
    builder.json |= {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "flag"}],
        "meshes": [{"primitives": [builder.square()]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        "textures": [{"source": 0}],
        "images": [image],
    }
    return builder


def features():
    builder = Builder()
    primitive = builder.square()
    colors = builder.accessor([(0, 128, 255, 255)] * 4, "B", normalized=True)
    strip = builder.accessor([(index,) for index in (0, 1, 3, 2)], "B")
    moved = builder.accessor(SQUARE, "f")
    places, values = builder.view(struct.pack("<B", 2)), builder.view(struct.pack("<3f", 2, 2, 0))
    builder.json["accessors"][moved]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": places, "componentType": 5121},
        "values": {"bufferView": values},
    }
    attributes = primitive["attributes"]
    transform = {"KHR_texture_transform": {"offset": [0, 1], "rotation": 1.5707964, "scale": [0.5, 0.5]}}
    builder.json |= {
        "extensionsUsed": ["KHR_texture_transform", "KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional"}, {"type": "point"}]}},
        "scenes": [{"nodes": [0, 3, 4, 5]}],
        "nodes": [
            {"children": [1, 2], "rotation": [0, 0.70710677, 0, 0.70710677]},
            {"mesh": 0, "name": "square", "translation": [0, 0, 1]},
            {"mesh": 0, "scale": [-1, 2, 1]},
            {"camera": 0, "translation": [0, 0, 5], "name": "front"},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": [0.1, 0, 0, 0.99498744]},
            {"camera": 1, "mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]},
        ],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}},
            {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0, "zfar": 10}},
        ],
        "meshes": [
            {
                "primitives": [
                    primitive,
                    primitive | {"mode": 5, "indices": strip, "material": 1},
                    primitive | {"mode": 6, "indices": strip, "attributes": attributes | {"COLOR_0": colors}},
                    primitive | {"mode": 0},
                ]
            },
            {"primitives": [{"attributes": {"POSITION": moved}, "indices": primitive["indices"]}]},
        ],
        "materials": [
            {
                "name": "mask",
                "alphaMode": "MASK",
                "alphaCutoff": 0.25,
                "doubleSided": True,
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": transform}},
            },
            {
                "alphaMode": "BLEND",
                "emissiveFactor": [0.1, 0, 0],
                "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.2, 0.5], "baseColorTexture": {"index": 0}},
                "normalTexture": {"index": 0, "scale": 0.5},
            },
        ],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 33071, "wrapT": 33071}],
    }
    alphas = [255, 100, 40, 0]
    picture = png(2, 2, lambda x, y: (*FLAG[2 * y + x], alphas[2 * y + x]), colour=6)
    builder.json["images"] = [{"uri": "data:image/png;base64," + base64.b64encode(picture).decode()}]
    return builder


def moving():
    """A skinned square of two joints with a morph target, and a square that a node carries along a spline."""
    builder = Builder()
    primitive = builder.square()
    joints = builder.accessor([(0, 1, 0, 0)] * 4, "B")
    weights = builder.accessor([(1, 0, 0, 0), (1, 0, 0, 0), (0.25, 0.75, 0, 0), (0.25, 0.75, 0, 0)], "f")
    raised = builder.accessor([(0, 0, 0), (0, 0, 0.5), (0, 0, 0), (0, 0, 0.5)], "f")
    skinned = primitive | {
        "attributes": primitive["attributes"] | {"JOINTS_0": joints, "WEIGHTS_0": weights},
        "targets": [{"POSITION": raised}],
    }
    inverse_binds = builder.accessor([(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5 * joint, 0, 1) for joint in (0, 1)], "f")
    times = builder.accessor([(0,), (1,), (2,)], "f")
    turns = builder.accessor([(0, 0, 0, 1), (0.6, 0, 0, 0.8), (0, 0, 0, 1)], "f")
    shapes = builder.accessor([(0,), (1,), (0,)], "f")
    scales = builder.accessor([(1, 1, 1), (1, 2, 1), (1, 1, 1)], "f")
    spline = builder.accessor([(1, 0, 0), (1.5, 0, 0), (1, 0, 0)] * 3, "f")
    tracks = [
        (2, "rotation", "LINEAR", turns),
        (0, "weights", "LINEAR", shapes),
        (3, "translation", "CUBICSPLINE", spline),
        (3, "scale", "STEP", scales),
    ]
    builder.json |= {
        "scenes": [{"nodes": [0, 1, 3]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [0, 0.5, 0]}, {"mesh": 1}],
        "meshes": [{"primitives": [skinned]}, {"primitives": [primitive]}],
        "materials": [{}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": inverse_binds}],
        "animations": [
            {
                "samplers": [{"input": times, "interpolation": kind, "output": values} for _, _, kind, values in tracks],
                "channels": [
                    {"sampler": index, "target": {"node": node, "path": path}}
                    for index, (node, path, _, _) in enumerate(tracks)
                ],
            }
        ],
    }
    return builder


def write(folder: Path):
    folder.mkdir(parents=True)
    flag = png(2, 2, lambda x, y: FLAG[2 * y + x])
    (folder / "flag.png").write_bytes(flag)
    apart = textured(Builder(), {"uri": "flag.png"})
    (folder / "square.gltf").write_text(apart.text("square.bin"))
    (folder / "square.bin").write_bytes(apart.data)
    builder = Builder()
    view = builder.view(flag)
    (folder / "square.glb").write_bytes(textured(builder, {"bufferView": view, "mimeType": "image/png"}).binary())
    (folder / "features.gltf").write_text(features().embedded())
    (folder / "features.glb").write_bytes(features().binary())
    (folder / "moving.gltf").write_text(moving().embedded())
