"""The same calls on both sides: the real library, and what stands in for it."""

import copy
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import random_rays, soup, sphere_mesh
from rayflock.compat import embreex as our_embreex
from rayflock.compat import open3d as our_open3d
from rayflock.compat import trimesh as our_trimesh

RAYS = 3000


@pytest.fixture(params=["ball", "soup"])
def mesh(request, rng):
    return sphere_mesh() if request.param == "ball" else soup(rng, 300, size=0.3)


@pytest.fixture
def rays(rng):
    return random_rays(rng, RAYS)


def assert_ids_agree(ours, theirs):
    """All but a few in a thousand: rays that hit an edge, or two surfaces at one distance."""
    assert ours.dtype == theirs.dtype and ours.shape == theirs.shape
    assert np.mean(ours != theirs) < 3e-3


class TestOpen3D:
    @pytest.fixture(autouse=True)
    def library(self):
        self.real = pytest.importorskip("open3d").t.geometry.RaycastingScene

    def both(self, mesh, call):
        """What both sides answer, as NumPy arrays."""
        answers = []
        for kind in (our_open3d.RaycastingScene, self.real):
            scene = kind()
            assert scene.add_triangles(*mesh) == 0
            assert scene.add_triangles(mesh[0] + np.float32(0.1), mesh[1]) == 1
            answer = call(scene)
            if isinstance(answer, dict):
                answer = {
                    name: np.asarray(getattr(a, "numpy", lambda a=a: a)())
                    for name, a in answer.items()
                }
            else:
                answer = np.asarray(answer.numpy() if hasattr(answer, "numpy") else answer)
            answers.append(answer)
        return answers

    @pytest.mark.parametrize("shape", [(RAYS,), (50, 60)])
    def test_cast_rays(self, mesh, rays, shape):
        ours, theirs = self.both(mesh, lambda scene: scene.cast_rays(rays.reshape(*shape, 6)))
        assert set(ours) == set(theirs)
        for name in theirs:
            assert (ours[name].shape, ours[name].dtype) == (theirs[name].shape, theirs[name].dtype)
        for name in ("geometry_ids", "primitive_ids"):
            assert_ids_agree(ours[name], theirs[name])
        same = (ours["geometry_ids"] == theirs["geometry_ids"]) & (
            ours["primitive_ids"] == theirs["primitive_ids"]
        )
        assert np.isfinite(ours["t_hit"]).any() and np.isinf(ours["t_hit"]).any()
        np.testing.assert_allclose(ours["t_hit"][same], theirs["t_hit"][same], rtol=1e-4)
        np.testing.assert_allclose(
            ours["primitive_uvs"][same], theirs["primitive_uvs"][same], atol=2e-3
        )
        np.testing.assert_allclose(
            ours["primitive_normals"][same], theirs["primitive_normals"][same], atol=2e-3
        )

    def test_occlusions(self, mesh, rays):
        for near, far in ((0.0, np.inf), (0.5, 0.9)):
            ours, theirs = self.both(
                mesh, lambda scene: scene.test_occlusions(rays, tnear=near, tfar=far)
            )
            assert_ids_agree(ours, theirs)
            assert ours.any()

    def test_counts_and_lists(self, mesh, rays):
        ours, theirs = self.both(mesh, lambda scene: scene.count_intersections(rays))
        assert_ids_agree(ours, theirs)
        assert ours.max() >= 3
        ours, theirs = self.both(mesh, lambda scene: scene.list_intersections(rays))
        assert {name: a.dtype for name, a in ours.items()} == {
            name: a.dtype for name, a in theirs.items()
        }
        wrong = 0
        for ray in range(RAYS):
            found = []
            for hits in (ours, theirs):
                rows = slice(hits["ray_splits"][ray], hits["ray_splits"][ray + 1])
                assert (hits["ray_ids"][rows] == ray).all()
                ids = zip(hits["geometry_ids"][rows], hits["primitive_ids"][rows], strict=True)
                found.append(sorted(map(tuple, ids)))
            wrong += found[0] != found[1]
        assert wrong < 3e-3 * RAYS

    def test_nothing_and_no_rays(self):
        for kind in (our_open3d.RaycastingScene, self.real):
            scene = kind()
            t_hit = scene.cast_rays(np.zeros((2, 6), np.float32))["t_hit"]
            assert np.isinf(np.asarray(getattr(t_hit, "numpy", lambda: t_hit)())).all()
            assert kind.INVALID_ID == 0xFFFFFFFF

    def test_cameras(self):
        intrinsic = np.array([[40, 0.5, 16.5], [0, 50, 11.5], [0, 0, 1.0]])
        extrinsic = np.eye(4)
        extrinsic[:3, :3] = [[0, 1, 0], [0, 0, -1], [-1, 0, 0]]
        extrinsic[:3, 3] = [1, 2, 3]
        views = [
            (60, [0.5, 0.5, 0.5], [-1, -1, -1], [0, 0, 1], 32, 24),
            (95.5, [0, 0, 0], [3, 1, 2], [0, 2, 0.5], 7, 31),
            (intrinsic, extrinsic, 33, 22),
        ]
        for view in views:
            theirs = self.real.create_rays_pinhole(*view).numpy()
            ours = our_open3d.RaycastingScene.create_rays_pinhole(*view)
            assert (ours.shape, ours.dtype) == (theirs.shape, theirs.dtype)
            np.testing.assert_allclose(ours, theirs, atol=2e-6)

    def test_a_mesh_of_open3d_is_taken(self, rays):
        open3d = pytest.importorskip("open3d")
        box = open3d.t.geometry.TriangleMesh.from_legacy(open3d.geometry.TriangleMesh.create_box())
        ours, theirs = our_open3d.RaycastingScene(), self.real()
        assert ours.add_triangles(box) == theirs.add_triangles(box)
        expected = theirs.cast_rays(rays)["geometry_ids"].numpy()
        assert_ids_agree(ours.cast_rays(rays)["geometry_ids"], expected)


class TestEmbreex:
    @pytest.fixture(autouse=True)
    def library(self):
        scenes = pytest.importorskip("embreex.rtcore_scene")
        meshes = pytest.importorskip("embreex.mesh_construction")
        self.sides = [
            (our_embreex.EmbreeScene, our_embreex.TriangleMesh),
            (scenes.EmbreeScene, meshes.TriangleMesh),
        ]

    def both(self, mesh, call):
        answers = []
        for scene_kind, mesh_kind in self.sides:
            scene = scene_kind()
            mesh_kind(scene, mesh[0], mesh[1].astype(np.int32))
            mesh_kind(scene, (mesh[0] + np.float32(0.1))[mesh[1]])
            answers.append(call(scene))
        return answers

    @pytest.mark.parametrize("query", ["INTERSECT", "OCCLUDED", "DISTANCE"])
    @pytest.mark.parametrize("limit", ["none", "all", "each"])
    def test_run(self, mesh, rays, query, limit):
        def call(scene):
            dists = {"none": None, "all": 0.7, "each": np.linspace(0, 1, RAYS, dtype=np.float32)}
            return scene.run(rays[:, :3].copy(), rays[:, 3:].copy(), dists[limit], query)

        ours, theirs = self.both(mesh, call)
        if query == "DISTANCE":
            assert ours.dtype == theirs.dtype
            assert np.mean(~np.isclose(ours, theirs, rtol=1e-4)) < 3e-3
        else:
            assert_ids_agree(ours, theirs)
            assert len(set(ours.tolist())) > 1

    @pytest.mark.parametrize(
        "options", [{"query": "INTERSECT"}, {"query": "DISTANCE"}, {"output": True}]
    )
    def test_distances_are_told_in_place_where_they_are_asked_for(self, mesh, rays, options):
        def call(scene):
            dists = np.full(2 * RAYS, 9, np.float32)[::2]
            answer = scene.run(rays[:, :3].copy(), rays[:, 3:].copy(), dists, **options)
            if options != {"query": "INTERSECT"}:
                assert (answer["tfar"] if "output" in options else answer) is dists
            return dists

        ours, theirs = self.both(mesh, call)
        assert np.mean(~np.isclose(ours, theirs, rtol=1e-4)) < 3e-3
        assert (ours == 9).all() == (options == {"query": "INTERSECT"})

    def test_output(self, mesh, rays):
        call = lambda scene: scene.run(rays[:, :3].copy(), rays[:, 3:].copy(), output=True)
        ours, theirs = self.both(mesh, call)
        assert list(ours) == list(theirs)
        for name in theirs:
            assert (ours[name].dtype, ours[name].shape) == (theirs[name].dtype, theirs[name].shape)
        for name in ("primID", "geomID"):
            assert_ids_agree(ours[name], theirs[name])
        same = (ours["primID"] == theirs["primID"]) & (ours["geomID"] == theirs["geomID"])
        for name, tolerance in (("u", 2e-3), ("v", 2e-3), ("Ng", 1e-6), ("tfar", 1e-4)):
            np.testing.assert_allclose(
                ours[name][same], theirs[name][same], rtol=1e-4, atol=tolerance
            )

    def test_one_direction_for_all_and_mistakes(self, mesh, rays):
        origins, direction = rays[:, :3].copy(), np.float32([[0, 0, 1]])
        with pytest.raises(ValueError, match="not recognized"):
            self.both(mesh, lambda scene: scene.run(origins, rays[:, 3:].copy(), query="NEAREST"))
        for (scene_kind, mesh_kind), kinds in zip(self.sides, (ValueError, Exception), strict=True):
            scene = scene_kind()
            mesh_kind(scene, mesh[0], mesh[1].astype(np.int32))
            with pytest.raises(kinds):
                scene.run(origins, direction[0])
            with pytest.raises(TypeError):
                scene.run(origins.tolist(), direction)

    def test_an_update_moves_a_mesh(self, mesh, rays):
        scene = our_embreex.EmbreeScene()
        ours = our_embreex.TriangleMesh(scene, mesh[0] + np.float32(50), mesh[1])
        origins, directions = rays[:, :3].copy(), rays[:, 3:].copy()
        assert (scene.run(origins, directions) == -1).all()
        ours.update(mesh[0], mesh[1])
        assert (scene.run(origins, directions) != -1).any()


class TestTrimesh:
    @pytest.fixture(autouse=True)
    def library(self, mesh):
        trimesh = pytest.importorskip("trimesh")
        pytest.importorskip("embreex")
        from trimesh.ray.ray_pyembree import RayMeshIntersector

        self.mesh = trimesh.Trimesh(*mesh, process=False)
        self.ours = our_trimesh.RayMeshIntersector(self.mesh)
        self.theirs = RayMeshIntersector(self.mesh)

    def both(self, call):
        return call(self.ours), call(self.theirs)

    def test_first_and_any(self, rays):
        for name in ("intersects_first", "intersects_any"):
            ours, theirs = self.both(lambda side: getattr(side, name)(rays[:, :3], rays[:, 3:]))
            assert_ids_agree(ours, theirs)
            assert ours.any()

    @pytest.mark.parametrize("multiple_hits", [False, True])
    def test_ids_and_locations(self, rays, multiple_hits):
        call = lambda side: side.intersects_location(
            rays[:, :3], rays[:, 3:], multiple_hits=multiple_hits
        )
        found = []
        for locations, index_ray, index_tri in self.both(call):
            order = np.lexsort((index_tri, index_ray))
            found.append((locations[order], index_ray[order], index_tri[order]))
        (locations, index_ray, index_tri), theirs = found
        for ours, other in zip(found[0], theirs, strict=True):
            assert ours.dtype == other.dtype and ours.ndim == other.ndim
        pairs, their_pairs = (set(zip(*side[1:], strict=True)) for side in found)
        assert len(pairs ^ their_pairs) < 3e-3 * len(their_pairs)
        places = {key: place for place, key in enumerate(zip(*theirs[1:], strict=True))}
        rows = [
            (row, places[key])
            for row, key in enumerate(zip(index_ray, index_tri, strict=True))
            if key in places
        ]
        mine, other = np.array(rows).T
        np.testing.assert_allclose(locations[mine], theirs[0][other], atol=1e-5)

        index_tri, index_ray = self.ours.intersects_id(
            rays[:, :3], rays[:, 3:], multiple_hits, max_hits=1
        )
        assert len(index_ray) == len(set(index_ray))

    def test_a_vertex_that_is_not_finite_costs_its_own_triangles_alone(self, rays):
        origins, directions = rays[:, :3], rays[:, 3:]
        before = self.ours.intersects_first(origins, directions)
        vertices, faces = np.array(self.mesh.vertices), np.array(self.mesh.faces)
        broken = faces[before.max(), 0]
        vertices[broken] = [np.nan, np.inf, 0]
        is_whole = ~(faces == broken).any(axis=1)
        ours = our_trimesh.RayMeshIntersector(SimpleNamespace(vertices=vertices, faces=faces))
        after = ours.intersects_first(origins, directions)
        is_kept = (before >= 0) & is_whole[before]
        assert is_kept.any()
        assert_ids_agree(after[is_kept], before[is_kept])
        assert is_whole[after[after >= 0]].all()
        ours.mesh.vertices[:] = np.nan
        assert not ours.intersects_any(origins, directions).any()

    def test_hits_of_a_ray_go_from_near_to_far(self, rays):
        locations, index_ray, _ = self.ours.intersects_location(rays[:, :3], rays[:, 3:])
        assert (np.diff(index_ray) >= 0).all()
        distance = np.linalg.norm(locations - rays[index_ray, :3], axis=1)
        assert (np.diff(distance)[np.diff(index_ray) == 0] > -1e-6).all()

    def test_contains(self, rng):
        points = rng.uniform(-1.2, 1.2, (500, 3))
        if not self.mesh.is_watertight:
            pytest.skip("a soup contains nothing")
        ours, theirs = self.both(lambda side: side.contains_points(points))
        np.testing.assert_array_equal(ours, theirs)
        assert ours.any()

    def test_changes_copies_and_places_far_away(self, rays):
        origins, directions = rays[:, :3].astype(np.float64), rays[:, 3:].astype(np.float64)
        before = self.ours.intersects_first(origins, directions)
        self.mesh.vertices += [5e6, -4e6, 0]
        moved = origins + [5e6, -4e6, 0]
        for side in (self.ours, copy.deepcopy(self.ours)):
            assert_ids_agree(side.intersects_first(moved, directions), before)
        with pytest.raises(ValueError, match="don't match"):
            self.ours.intersects_first(origins, directions[:2])
