"""Geometry of Alembic archives, by the package alembic3d, which is Alembic's own PyAlembic.

Read are polygon meshes, subdivision meshes (as their control meshes are) and points that are
visible. What has another shape is counted.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
from alembic3d import Abc, AbcGeom

from frame_set import Frame, check_corners, triangulate


class AbcFile:
    """An archive, to be asked for its geometry at a time in seconds."""

    def __init__(self, path: Path) -> None:
        try:
            self.archive = Abc.IArchive(str(path))
        except RuntimeError as error:
            raise ValueError(str(error).strip()) from None
        self.left_out: Counter[str] = Counter()

    @property
    def times_per_second(self) -> float:
        """Times are seconds."""
        return 1.0

    def times(self, step: float | None) -> list[float]:
        """The times of frames: those of the time sampling with the most, or `step` apart."""
        samplings = range(self.archive.getNumTimeSamplings())
        counts = [self.archive.getMaxNumSamplesForTimeSamplingIndex(idx) for idx in samplings]
        # Sampling 0 is that of whatever has one sample.
        if not counts or max(counts) <= 1:
            return [0.0]
        sampling = self.archive.getTimeSampling(counts.index(max(counts)))
        times = [sampling.getSampleTime(idx) for idx in range(max(counts))]
        if step is None:
            return times
        count = int((times[-1] - times[0]) / step + 1e-6) + 1
        return [times[0] + step * idx for idx in range(count)]

    def frame(self, time: float) -> Frame:
        """The geometry at a time."""
        frame = Frame()
        self.left_out.clear()
        self._add_children(self.archive.getTop(), np.eye(4), time, frame)
        return frame

    def _add_children(
        self, parent: Abc.IObject, world: np.ndarray, time: float, frame: Frame
    ) -> None:
        selector = Abc.ISampleSelector(time)
        for idx in range(parent.getNumChildren()):
            child = parent.getChild(idx)
            if AbcGeom.GetVisibility(child, selector) == AbcGeom.ObjectVisibility.kVisibilityHidden:
                continue
            place = world
            if AbcGeom.IXform.matches(child.getHeader()):
                schema = AbcGeom.IXform(child, Abc.WrapExistingFlag.kWrapExisting).getSchema()
                place = _matrix(schema, selector)
                place = place @ world if schema.getInheritsXforms(selector) else place
            else:
                self._add(child, place, selector, frame)
            self._add_children(child, place, time, frame)

    def _add(
        self, shape: Abc.IObject, world: np.ndarray, selector: Abc.ISampleSelector, frame: Frame
    ) -> None:
        header, wrap = shape.getHeader(), Abc.WrapExistingFlag.kWrapExisting
        meshes = [kind for kind in (AbcGeom.IPolyMesh, AbcGeom.ISubD) if kind.matches(header)]
        try:
            if meshes:
                _add_mesh(meshes[0](shape, wrap).getSchema().getValue(selector), world, frame)
            elif AbcGeom.IPoints.matches(header):
                _add_points(AbcGeom.IPoints(shape, wrap).getSchema(), selector, world, frame)
            elif not AbcGeom.IFaceSet.matches(header):
                self.left_out[header.getMetaData().get("schema") or "object"] += 1
        except (ValueError, RuntimeError) as error:
            raise ValueError(f"{shape.getFullName()}: {error}") from None


def _matrix(schema: AbcGeom.IXformSchema, selector: Abc.ISampleSelector) -> np.ndarray:
    matrix = schema.getValue(selector).getMatrix()
    return np.array([[matrix[row][column] for column in range(4)] for row in range(4)])


def _placed(points: object, world: np.ndarray) -> np.ndarray:
    points = np.array([(p.x, p.y, p.z) for p in points], np.float64).reshape(-1, 3)
    return points @ world[:3, :3] + world[3, :3]


def _add_mesh(sample: AbcGeom.IPolyMeshSchemaSample, world: np.ndarray, frame: Frame) -> None:
    points = _placed(sample.getPositions(), world)
    corners = np.array(list(sample.getFaceIndices()), np.int64)
    check_corners(corners, len(points))
    triangles = triangulate(np.array(list(sample.getFaceCounts()), np.int64), corners)
    # Faces of Alembic are clockwise as seen from outside.
    is_mirrored = np.linalg.det(world[:3, :3]) < 0
    frame.add_mesh(points, triangles if is_mirrored else triangles[:, ::-1])


def _add_points(
    schema: AbcGeom.IPointsSchema,
    selector: Abc.ISampleSelector,
    world: np.ndarray,
    frame: Frame,
) -> None:
    centers = _placed(schema.getValue(selector).getPositions(), world)
    radii, widths = None, schema.getWidthsParam()
    if widths.valid():
        scale = abs(np.linalg.det(world[:3, :3])) ** (1 / 3)
        radii = 0.5 * scale * np.array(list(widths.getExpandedValue(selector).getVals()))
        radii = np.repeat(radii, len(centers)) if len(radii) == 1 else radii
        if len(radii) != len(centers):
            raise ValueError(f"found {len(radii)} widths, expected {len(centers)} or one")
    frame.add_spheres(centers, radii)
