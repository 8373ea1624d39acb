"""Frames of triangles and spheres, and the .npz file that Rayflock reads (docs/formats.md)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass
class Frame:
    """The geometry of one frame, in world space, +Y up."""

    vertices: list[np.ndarray] = field(default_factory=list)
    """Positions, (n, 3) each."""
    triangles: list[np.ndarray] = field(default_factory=list)
    """Positions in `vertices` as if these were one array, (m, 3) each."""
    centers: list[np.ndarray] = field(default_factory=list)
    """Middles of spheres, (k, 3) each."""
    radii: list[np.ndarray] = field(default_factory=list)
    """Radii of spheres, (k,) each; NaN where the file has none."""

    def add_mesh(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Adds a mesh, whose triangles count its own vertices."""
        first = sum(len(array) for array in self.vertices)
        self.vertices.append(np.asarray(vertices, np.float32).reshape(-1, 3))
        self.triangles.append(np.asarray(triangles, np.int64).reshape(-1, 3) + first)

    def add_spheres(self, centers: np.ndarray, radii: np.ndarray | None) -> None:
        """Adds spheres, whose radii may be unknown."""
        centers = np.asarray(centers, np.float32).reshape(-1, 3)
        if radii is None:
            radii = np.full(len(centers), np.nan)
        self.centers.append(centers)
        self.radii.append(np.asarray(radii, np.float32))


def triangulate(counts: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The triangles of polygons, as fans around their first corners: right where they are convex.

    `counts` holds the number of corners of each polygon, `corners` their vertices one polygon
    after the other. Polygons of fewer than three corners are left out.
    """
    counts, corners = np.asarray(counts, np.int64), np.asarray(corners, np.int64)
    if counts.min(initial=0) < 0 or counts.sum() != len(corners):
        raise ValueError(f"found {len(corners)} corners of faces, expected {counts.sum()}")
    fan_sizes = np.maximum(counts - 2, 0)
    first = np.repeat(np.cumsum(counts) - counts, fan_sizes)
    step = np.arange(fan_sizes.sum()) - np.repeat(np.cumsum(fan_sizes) - fan_sizes, fan_sizes)
    return np.stack([corners[first], corners[first + step + 1], corners[first + step + 2]], axis=1)


def check_corners(corners: np.ndarray, vertex_count: int) -> None:
    """Refuses faces at vertices that are not there."""
    wrong = corners[(corners < 0) | (corners >= vertex_count)]
    if len(wrong):
        raise ValueError(
            f"found a face at vertex {wrong[0]}, expected at least 0 and less than {vertex_count}"
        )


def write(path: Path, frames: list[Frame], frame_rate: float) -> None:
    """Writes frames in the arrays that Rayflock reads, each with offsets."""
    arrays: dict[str, np.ndarray] = {"frame_rate": np.float64(frame_rate)}
    if any(frame.vertices for frame in frames) or not any(frame.centers for frame in frames):
        vertices, offsets = _joined([frame.vertices for frame in frames], (3,), np.float32)
        arrays |= {"vertices": vertices, "vertex_offsets": offsets}
        triangles = [_rows(frame.triangles, (3,), np.uint32) for frame in frames]
        if all(np.array_equal(triangles[0], later) for later in triangles[1:]):
            arrays["triangles"] = triangles[0]
        else:
            arrays["triangles"], arrays["triangle_offsets"] = _joined(
                [[rows] for rows in triangles], (3,), np.uint32
            )
    if any(frame.centers for frame in frames):
        centers, offsets = _joined([frame.centers for frame in frames], (3,), np.float32)
        arrays |= {"centers": centers, "center_offsets": offsets}
        radii, _ = _joined([frame.radii for frame in frames], (), np.float32)
        known = radii[np.isfinite(radii)]
        # Without any, Rayflock takes the distances between points.
        if len(known) > 0:
            arrays["radii"] = np.where(np.isfinite(radii), radii, np.median(known))
    np.savez_compressed(path, **arrays)


def _rows(parts: list[np.ndarray], row: tuple[int, ...], kind: type) -> np.ndarray:
    return np.concatenate([np.empty((0, *row), kind), *(part.astype(kind) for part in parts)])


def _joined(
    frames: list[list[np.ndarray]], row: tuple[int, ...], kind: type
) -> tuple[np.ndarray, np.ndarray]:
    """The rows of all frames, and where each begins and the last ends."""
    arrays = [_rows(parts, row, kind) for parts in frames]
    offsets = np.cumsum([0, *(len(array) for array in arrays)], dtype=np.int64)
    return _rows(arrays, row, kind), offsets
