"""What tests of the converter share: the tools on the path, and Rayflock's view of a file."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

ObjFrame = tuple[np.ndarray, np.ndarray]
"""Vertices and triangles."""


def _run(*words: object) -> str:
    program = os.environ.get("RAYFLOCK")
    if not program:
        pytest.skip("RAYFLOCK does not say where the program rayflock is")
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def rayflock_info() -> Callable[[Path], dict]:
    """What `rayflock info` says of a file."""
    return lambda path: json.loads(_run("info", "--json", path))


@pytest.fixture
def rayflock_frames(tmp_path: Path) -> Callable[[Path, int], list[ObjFrame]]:
    """The first frames of a file as Rayflock shows them."""

    def frames(path: Path, count: int) -> list[ObjFrame]:
        _run("convert", path, "--frames", f"0..{count - 1}", "-o", tmp_path / "seen/%d.obj")
        return [_obj(tmp_path / f"seen/{idx}.obj") for idx in range(count)]

    return frames


def _obj(path: Path) -> ObjFrame:
    rows = [line.split() for line in path.read_text().splitlines()]
    vertices = [[float(word) for word in row[1:]] for row in rows if row[0] == "v"]
    triangles = [[int(word) - 1 for word in row[1:]] for row in rows if row[0] == "f"]
    return np.array(vertices).reshape(-1, 3), np.array(triangles).reshape(-1, 3)
