"""Reads a clip of `rasterscope clip`: python load_clip.py FOLDER (needs: pip install OpenEXR numpy)"""
import hashlib, json, pathlib, sys
import OpenEXR

def frames(folder):
    """Yields number, jitter, channels of the input and channels of the reference of each frame."""
    folder = pathlib.Path(folder)
    for frame in json.loads((folder / "clip.json").read_text())["frames"]:
        for entry in (frame["input"], frame["reference"]):
            if hashlib.sha256((folder / entry["file"]).read_bytes()).hexdigest() != entry["sha256"]:
                sys.exit(f"{folder / entry['file']}: its SHA-256 is not the one in clip.json")
        read = lambda kind: {n: c.pixels for n, c in OpenEXR.File(str(folder / frame[kind]["file"]), separate_channels=True).channels().items()}
        yield frame["number"], frame["jitter_px"], read("input"), read("reference")

for number, jitter, given, wanted in frames(sys.argv[1]):
    print(number, jitter, {name: plane.shape for name, plane in given.items()}, wanted["R"].mean())
