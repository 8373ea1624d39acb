"""Geometry and rays that tests share; all of them are seeded."""

import os
from pathlib import Path

import numpy as np
import pytest
import rayflock

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
TRIANGLES = np.array([[0, 1, 2]], np.uint32)


@pytest.fixture
def rng():
    return np.random.default_rng(7)


@pytest.fixture
def one_triangle():
    """A scene with one triangle, and its id."""
    scene = rayflock.Scene()
    return scene, scene.add(VERTICES, TRIANGLES)


def real_file(name):
    """A file among the real scenes; without it, the test is skipped and says so."""
    data = Path(os.environ.get("RAYFLOCK_DATA", Path(__file__).parents[3] / "shared/data"))
    files = sorted(data.rglob(name)) if data.is_dir() else []
    if not files:
        pytest.skip(f"there is no {name} in {data}; RAYFLOCK_DATA says where real scenes are")
    return files[0]


def sphere_mesh(rows=24, columns=48, radius=1.0):
    """A closed sphere of triangles: vertices and triangles."""
    theta = np.linspace(0, np.pi, rows + 1)[1:-1]
    phi = np.arange(columns) * (2 * np.pi / columns)
    ring = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), np.ones(columns)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = np.concatenate([[[0, 0, 1]], ring, [[0, 0, -1]]]) * radius
    at = lambda row, column: 1 + row * columns + column % columns
    triangles = []
    for column in range(columns):
        triangles.append([0, at(0, column), at(0, column + 1)])
        for row in range(rows - 2):
            a, b = at(row, column), at(row, column + 1)
            c, d = at(row + 1, column), at(row + 1, column + 1)
            triangles += [[a, c, d], [a, d, b]]
        triangles.append([len(vertices) - 1, at(rows - 2, column + 1), at(rows - 2, column)])
    return vertices.astype(np.float32), np.array(triangles, np.uint32)


def soup(rng, count, size=0.2):
    """Triangles that have nothing to do with each other."""
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.uniform(-size, size, (count, 3, 3))
    triangles = np.arange(3 * count, dtype=np.uint32).reshape(-1, 3)
    return corners.reshape(-1, 3).astype(np.float32), triangles


def random_rays(rng, count):
    """Rays from around the cube of edge 2 into it."""
    origins = rng.normal(size=(count, 3))
    origins *= 4 / np.linalg.norm(origins, axis=1, keepdims=True)
    targets = rng.uniform(-1, 1, (count, 3))
    return np.concatenate([origins, targets - origins], axis=1).astype(np.float32)
