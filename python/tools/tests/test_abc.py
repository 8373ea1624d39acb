"""Alembic archives come through the converter with the geometry that they were made with."""

from __future__ import annotations

import imath
import numpy as np
from alembic3d import Abc, AbcCoreAbstract, AbcGeom
from to_npz import main

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)


def filled(array, values):
    """An array of Imath with these values."""
    for idx, value in enumerate(values):
        array[idx] = value
    return array


def vectors(points) -> imath.V3fArray:
    return filled(imath.V3fArray(len(points)), [imath.V3f(*map(float, p)) for p in points])


def numbers(values) -> imath.IntArray:
    return filled(imath.IntArray(len(values)), values)


def write_archive(path: str) -> None:
    """A quad that grows on a node that moves, and drops of which there are ever more; three
    frames, 12 a second."""
    archive = Abc.OArchive(path)
    sampling = AbcCoreAbstract.TimeSampling(1 / 12, 0.5)
    node = AbcGeom.OXform(archive.getTop(), "node")
    mesh = AbcGeom.OPolyMesh(node, "mesh")
    drops = AbcGeom.OPoints(archive.getTop(), "drops")
    for shape in (node, mesh, drops):
        shape.getSchema().setTimeSampling(sampling)
    AbcGeom.OCamera(node, "camera")
    for frame in range(3):
        move = AbcGeom.XformSample()
        move.setTranslation(imath.V3d(10 * frame, 0, 0))
        node.getSchema().set(move)
        # Clockwise, as Alembic wants it.
        corners, counts = numbers([3, 2, 1, 0]), numbers([4])
        grown = vectors(POINTS * (1 + frame))
        mesh.getSchema().set(AbcGeom.OPolyMeshSchemaSample(grown, corners, counts))
        centers = vectors([[i, 1, 0] for i in range(frame)])
        ids = filled(imath.IntArray(frame), range(frame))
        widths = filled(imath.FloatArray(frame), [0.5] * frame)
        widths = AbcGeom.OFloatGeomParamSample(widths, AbcGeom.GeometryScope.kVertexScope)
        sample = AbcGeom.OPointsSchemaSample(centers, ids, vectors([]), widths)
        drops.getSchema().set(sample)


def test_meshes_and_points_move_as_in_their_archive(tmp_path, capsys, rayflock_frames):
    write_archive(str(tmp_path / "a.abc"))
    assert main([str(tmp_path / "a.abc"), "-o", str(tmp_path / "a.npz")]) == 0
    assert "of type AbcGeom_Camera" in capsys.readouterr().err
    arrays = np.load(tmp_path / "a.npz")
    assert float(arrays["frame_rate"]) == 12
    assert np.diff(arrays["center_offsets"]).tolist() == [0, 1, 2]
    assert arrays["centers"].tolist() == [[0, 1, 0], [0, 1, 0], [1, 1, 0]]
    assert arrays["radii"].tolist() == [0.25] * 3
    for frame, (vertices, triangles) in enumerate(rayflock_frames(tmp_path / "a.npz", 3)):
        np.testing.assert_allclose(vertices, POINTS * (1 + frame) + [10 * frame, 0, 0], atol=1e-5)
        # Counter-clockwise as seen from +Z.
        edges = [vertices[triangles[:, i]] - vertices[triangles[:, 0]] for i in (1, 2)]
        assert (np.cross(*edges)[:, 2] > 0).all()


def test_a_file_that_is_no_archive_is_told(tmp_path, capsys):
    (tmp_path / "a.abc").write_bytes(b"Ogawa, but no more")
    assert main([str(tmp_path / "a.abc"), "-o", str(tmp_path / "a.npz")]) == 2
    assert "a.abc: " in capsys.readouterr().err
