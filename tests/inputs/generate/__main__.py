"""Writes the inputs of the tests anew: `python3 tests/inputs/generate`. Needs nothing but Python 3.11."""

import shutil
import sys
from pathlib import Path

sys.dont_write_bytecode = True

import cases
import damaged
import gltf
import models

inputs = Path(__file__).resolve().parent.parent
for name, writer in (("bad", damaged), ("cases", cases), ("gltf", gltf), ("models", models)):
    shutil.rmtree(inputs / name, ignore_errors=True)
    writer.write(inputs / name)
