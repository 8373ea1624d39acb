"""Classes with the names, arguments and answers of other libraries, traced by Rayflock.

Change one import and keep the rest:

- :mod:`rayflock.compat.trimesh`: ``RayMeshIntersector`` of ``trimesh.ray``;
- :mod:`rayflock.compat.open3d`: ``RaycastingScene`` of ``open3d.t.geometry``;
- :mod:`rayflock.compat.embreex`: ``rtcore_scene`` and ``mesh_construction`` of ``embreex``.

None of the other libraries has to be installed, but for trimesh's ``contains_points``, which is
its own. What differs is listed in each module, and compared by the tests.
"""
