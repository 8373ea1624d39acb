"""USD stages come through the converter with the geometry that they were made with."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom
from to_npz import main

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 2]], np.float32)
# A quad and a triangle.
COUNTS, CORNERS = [4, 3], [0, 1, 2, 3, 0, 1, 4]
TRIANGLES = [[0, 1, 2], [0, 2, 3], [0, 1, 4]]


def stage(path: Path, up: str = "Y") -> Usd.Stage:
    made = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(made, up)
    made.SetTimeCodesPerSecond(48)
    made.SetFramesPerSecond(12)
    made.SetStartTimeCode(4)
    made.SetEndTimeCode(12)
    return made


def moving_mesh(made: Usd.Stage) -> UsdGeom.Mesh:
    """A mesh whose points grow, on a node that moves; three frames, at 4, 8 and 12."""
    node = UsdGeom.Xform.Define(made, "/node")
    move = node.AddTranslateOp()
    mesh = UsdGeom.Mesh.Define(made, "/node/mesh")
    mesh.CreateFaceVertexCountsAttr(COUNTS)
    mesh.CreateFaceVertexIndicesAttr(CORNERS)
    for frame in range(3):
        time = 4 + 4 * frame
        move.Set(Gf.Vec3d(10 * frame, 0, 0), time)
        mesh.CreatePointsAttr().Set([Gf.Vec3f(*p) for p in POINTS.tolist()], 4)
        mesh.CreatePointsAttr().Set([Gf.Vec3f(*(3 * p).tolist()) for p in POINTS], 12)
    return mesh


def expected(frame: int) -> np.ndarray:
    return POINTS * (1 + frame) + np.array([10 * frame, 0, 0])


def test_a_mesh_moves_as_in_its_stage(tmp_path, rayflock_frames, rayflock_info):
    made = stage(tmp_path / "a.usda")
    moving_mesh(made)
    made.Save()
    assert main([str(tmp_path / "a.usda"), "-o", str(tmp_path / "a.npz")]) == 0
    assert rayflock_info(tmp_path / "a.npz")["frame_rate"] == 12
    for frame, (vertices, triangles) in enumerate(rayflock_frames(tmp_path / "a.npz", 3)):
        np.testing.assert_allclose(vertices, expected(frame), atol=1e-5)
        assert triangles.tolist() == TRIANGLES


def test_suffixes_may_be_capitals(tmp_path):
    made = stage(tmp_path / "a.usda")
    moving_mesh(made)
    made.Save()
    (tmp_path / "A.USDA.GZ").write_bytes(gzip.compress((tmp_path / "a.usda").read_bytes()))
    for name in ("a.usda", "A.USDA.GZ"):
        assert main([str(tmp_path / name), "-o", str(tmp_path / f"{name}.npz")]) == 0
    plain, packed = (np.load(tmp_path / f"{name}.npz") for name in ("a.usda", "A.USDA.GZ"))
    np.testing.assert_array_equal(packed["vertices"], plain["vertices"])


def test_up_hands_holes_and_what_is_hidden_are_heeded(tmp_path, rayflock_frames):
    made = stage(tmp_path / "a.usdc", up="Z")
    mesh = moving_mesh(made)
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    mesh.CreateHoleIndicesAttr([0])
    for name, hide in [
        ("hidden", lambda shape: shape.MakeInvisible()),
        ("guide", lambda shape: shape.CreatePurposeAttr(UsdGeom.Tokens.guide)),
    ]:
        twin = made.DefinePrim(f"/{name}")
        twin.GetReferences().AddInternalReference("/node/mesh")
        hide(UsdGeom.Imageable(twin))
    made.Save()
    assert main([str(tmp_path / "a.usdc"), "-o", str(tmp_path / "a.npz")]) == 0
    _, (vertices, triangles) = rayflock_frames(tmp_path / "a.npz", 2)
    x, y, z = expected(1).T
    np.testing.assert_allclose(vertices, np.stack([x, z, -y], axis=1), atol=1e-5)
    assert triangles.tolist() == [[4, 1, 0]]


def test_instances_are_unfolded_and_other_shapes_told(tmp_path, capsys):
    made = stage(tmp_path / "a.usda")
    moving_mesh(made)
    for idx in range(2):
        copy = UsdGeom.Xform.Define(made, f"/copy{idx}")
        copy.AddTranslateOp().Set(Gf.Vec3d(0, 0, 5 + idx))
        copy.GetPrim().GetReferences().AddInternalReference("/node")
        copy.GetPrim().SetInstanceable(True)
    UsdGeom.Cube.Define(made, "/cube")
    UsdGeom.Sphere.Define(made, "/ball").CreateRadiusAttr(0.25)
    made.Save()
    assert main([str(tmp_path / "a.usda"), "-o", str(tmp_path / "a.npz")]) == 0
    arrays = np.load(tmp_path / "a.npz")
    assert arrays["triangles"].tolist() == [
        [corner + first for corner in triangle] for first in (0, 5, 10) for triangle in TRIANGLES
    ]
    assert arrays["centers"].tolist() == [[0, 0, 0]] * 3
    assert arrays["radii"].tolist() == [0.25] * 3
    assert "1 of type Cube are left out" in capsys.readouterr().err


def test_points_of_several_files_are_spheres_frame_by_frame(tmp_path, rayflock_info):
    for idx in (9, 10):
        made = Usd.Stage.CreateNew(str(tmp_path / f"drops.{idx}.usda"))
        made.SetStartTimeCode(idx)
        made.SetEndTimeCode(idx)
        points = UsdGeom.Points.Define(made, "/drops")
        UsdGeom.XformCommonAPI(points).SetScale(Gf.Vec3f(2, 2, 2))
        points.CreatePointsAttr().Set([Gf.Vec3f(i, 0, 0) for i in range(idx)], idx)
        points.CreateWidthsAttr().Set([0.5] * idx, idx)
        made.Save()
    assert main([str(tmp_path / "drops.*.usda"), "-o", str(tmp_path / "drops.npz")]) == 0
    arrays = np.load(tmp_path / "drops.npz")
    assert arrays["center_offsets"].tolist() == [0, 9, 19]
    assert arrays["centers"][18].tolist() == [18, 0, 0]
    assert set(arrays["radii"].tolist()) == {0.5}
    info = rayflock_info(tmp_path / "drops.npz")
    assert (info["spheres"], info["frames"]) == (9, [0, 1])


def test_what_is_wrong_is_told_with_its_place(tmp_path, capsys):
    made = stage(tmp_path / "a.usda")
    moving_mesh(made).CreateFaceVertexIndicesAttr([0, 1, 2, 3, 0, -1, 9])
    made.Save()
    packed = gzip.compress((tmp_path / "a.usda").read_bytes())
    (tmp_path / "cut.usda.gz").write_bytes(packed[:-20])
    (tmp_path / "spoilt.usda.gz").write_bytes(packed[:10] + b"\xff" * 20 + packed[30:])
    (tmp_path / "plain.usda.gz").write_bytes(b"#usda 1.0")
    output = ["-o", str(tmp_path / "a.npz")]
    for words, message in [
        (
            ["a.usda"],
            "a.usda: /node/mesh at 4: found a face at vertex -1, "
            "expected at least 0 and less than 5",
        ),
        (["cut.usda.gz"], "cut.usda.gz: damaged gzip: "),
        (["spoilt.usda.gz"], "spoilt.usda.gz: damaged gzip: "),
        (["plain.usda.gz"], "plain.usda.gz: damaged gzip: "),
        (["b.usda"], "b.usda: there is no such file"),
        (["a.obj"], "a.obj: expected one of .usd, .usda, .usdc, .usdz (each also .gz) or .abc"),
    ]:
        (tmp_path / "a.obj").write_text("")
        assert main([str(tmp_path / words[0]), *output]) == 2
        assert message in capsys.readouterr().err
        assert not (tmp_path / "a.npz").exists()
    assert main([str(tmp_path / "a.usda"), "-o", "a.abc"]) == 2


def test_the_splash_has_its_points(tmp_path, rayflock_info):
    beside = Path(__file__).parents[4] / "shared/data"
    folder = Path(os.environ.get("RAYFLOCK_DATA") or beside) / "usd-particles-splash"
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there; RAYFLOCK_DATA says where real scenes are")
    assert main([str(folder / "*.usda.gz"), "-o", str(tmp_path / "splash.npz")]) == 0
    counts = np.diff(np.load(tmp_path / "splash.npz")["center_offsets"])
    assert counts.tolist() == [833, 1666, 2499, 3332, 4165, 4998, 5831, 6664, 7497]
    assert rayflock_info(tmp_path / "splash.npz")["frames"] == [0, 8]
