"""Geometry of USD stages, by the package usd-core.

Read are meshes, points and spheres that are visible and made for rendering, instances included,
with skinned meshes as their joints place them. Subdivision is not carried out: surfaces are as
their control meshes are. What has another shape is counted.
"""

from __future__ import annotations

import gzip
import tempfile
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, UsdSkel

from frame_set import Frame, check_corners, triangulate

_RENDERED = (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


class UsdFile:
    """A stage, to be asked for its geometry at a time."""

    def __init__(self, path: Path) -> None:
        self.stage = _open(path)
        self.left_out: Counter[str] = Counter()
        roots = [prim for prim in self.stage.Traverse() if prim.IsA(UsdSkel.Root)]
        if roots:
            # In the layer of this session: the file stays as it is.
            self.stage.SetEditTarget(self.stage.GetSessionLayer())
            UsdSkel.BakeSkinning(self.stage.Traverse())

    @property
    def times_per_second(self) -> float:
        """Time codes a second."""
        return self.stage.GetTimeCodesPerSecond()

    def times(self, step: float | None) -> list[float]:
        """The time codes of frames: as many a second as the stage states, or `step` apart.

        A stage without a range has the times at which its points are given, or one frame.
        """
        if self.stage.HasAuthoredTimeCodeRange():
            first, last = self.stage.GetStartTimeCode(), self.stage.GetEndTimeCode()
        else:
            samples = sorted(self._sample_times())
            first, last = (samples[0], samples[-1]) if samples else (0.0, 0.0)
        if step is None:
            step = self.times_per_second / self.stage.GetFramesPerSecond()
        count = int((last - first) / step + 1e-6) + 1
        return [first + step * idx for idx in range(max(count, 1))]

    def frame(self, time: float) -> Frame:
        """The geometry at a time code."""
        frame, places = Frame(), UsdGeom.XformCache(Usd.TimeCode(time))
        self.left_out.clear()
        for prim in self._shown(time):
            world = np.array(places.GetLocalToWorldTransform(prim)) @ self._upright()
            try:
                self._add(prim, time, world, frame)
            except ValueError as error:
                raise ValueError(f"{prim.GetPath()} at {time:g}: {error}") from None
        return frame

    def _shown(self, time: float) -> Iterator[Usd.Prim]:
        root = self.stage.GetPseudoRoot()
        for prim in Usd.PrimRange(root, Usd.TraverseInstanceProxies()):
            shape = UsdGeom.Gprim(prim) or UsdGeom.PointInstancer(prim)
            if not shape or shape.ComputePurpose() not in _RENDERED:
                continue
            if shape.ComputeVisibility(time) != UsdGeom.Tokens.invisible:
                yield prim

    def _upright(self) -> np.ndarray:
        """What makes +Y of the stage's "up", for rows of points."""
        if UsdGeom.GetStageUpAxis(self.stage) == UsdGeom.Tokens.z:
            return np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
        return np.eye(4)

    def _add(self, prim: Usd.Prim, time: float, world: np.ndarray, frame: Frame) -> None:
        if prim.IsA(UsdGeom.Mesh):
            _add_mesh(UsdGeom.Mesh(prim), time, world, frame)
        elif prim.IsA(UsdGeom.Points):
            _add_points(UsdGeom.Points(prim), time, world, frame)
        elif prim.IsA(UsdGeom.Sphere):
            radius = UsdGeom.Sphere(prim).GetRadiusAttr().Get(time)
            frame.add_spheres(world[3, :3], np.array([radius * _scale(world)]))
        else:
            self.left_out[prim.GetTypeName()] += 1

    def _sample_times(self) -> set[float]:
        based = (UsdGeom.PointBased(prim) for prim in self.stage.Traverse())
        points = (shape.GetPointsAttr() for shape in based if shape)
        return {time for attribute in points for time in attribute.GetTimeSamples()}


def _open(path: Path) -> Usd.Stage:
    if path.suffix.lower() != ".gz":
        return Usd.Stage.Open(str(path))
    # USD reads no compressed text.
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        plain.write_bytes(_unpacked(path))
        return Usd.Stage.Open(str(plain))


def _unpacked(path: Path) -> bytes:
    try:
        return gzip.decompress(path.read_bytes())
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise ValueError(f"damaged gzip: {error}") from None


def _scale(world: np.ndarray) -> float:
    """How much larger a transform makes lengths, in the mean of all directions."""
    return float(abs(np.linalg.det(world[:3, :3])) ** (1 / 3))


def _placed(points: object, world: np.ndarray) -> np.ndarray:
    points = np.asarray(points if points is not None else [], np.float64).reshape(-1, 3)
    return points @ world[:3, :3] + world[3, :3]


def _add_mesh(mesh: UsdGeom.Mesh, time: float, world: np.ndarray, frame: Frame) -> None:
    points = _placed(mesh.GetPointsAttr().Get(time), world)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(time) or [], np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(time) or [], np.int64)
    check_corners(corners, len(points))
    holes = mesh.GetHoleIndicesAttr().Get(time)
    if holes:
        keep = np.ones(len(counts), bool)
        keep[np.array(holes)] = False
        corners, counts = corners[np.repeat(keep, counts)], counts[keep]
    triangles = triangulate(counts, corners)
    is_left_handed = mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    is_mirrored = np.linalg.det(world[:3, :3]) < 0
    frame.add_mesh(points, triangles[:, ::-1] if is_left_handed != is_mirrored else triangles)


def _add_points(points: UsdGeom.Points, time: float, world: np.ndarray, frame: Frame) -> None:
    centers = _placed(points.GetPointsAttr().Get(time), world)
    widths = points.GetWidthsAttr().Get(time)
    radii = None
    if widths:
        radii = 0.5 * _scale(world) * np.array(widths, np.float64)
        radii = np.repeat(radii, len(centers)) if len(radii) == 1 else radii
        if len(radii) != len(centers):
            raise ValueError(f"found {len(radii)} widths, expected {len(centers)} or one")
    frame.add_spheres(centers, radii)
