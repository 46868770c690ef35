"""Other names of the queries: Open3D's methods, and trimesh's intersector."""

import copy
import pickle

import numpy as np
import pytest

import lookfrom
from lookfrom.trimesh import RayMeshIntersector
from meshes import box, icosphere

VERTICES, FACES = icosphere(3)
BVH = lookfrom.Bvh(VERTICES, FACES)
RNG = np.random.default_rng(1)
ORIGINS, DIRECTIONS = 2 * RNG.normal(size=(10, 30, 3)), RNG.normal(size=(10, 30, 3))


def test_open3d():
    rays = np.concatenate([ORIGINS, DIRECTIONS], axis=-1).astype(np.float32)
    hits = BVH.closest_hits(rays[..., :3], rays[..., 3:])
    cast = BVH.cast_rays(rays)
    assert (cast["t_hit"] == hits.t).all() and (
        cast["primitive_ids"][hits.hit] == hits.triangle[hits.hit]
    ).all()
    assert (cast["geometry_ids"][~hits.hit] == BVH.INVALID_ID).all() and cast["primitive_uvs"].shape == (
        10,
        30,
        2,
    )
    np.testing.assert_array_equal(cast["primitive_normals"], hits.normals)
    assert (BVH.test_occlusions(rays) == hits.hit).all()
    assert (BVH.count_intersections(rays) == BVH.count_hits(rays[..., :3], rays[..., 3:])).all()
    listed = BVH.list_intersections(rays)
    assert listed["ray_splits"][-1] == BVH.count_intersections(rays).sum() == len(listed["t_hit"])
    points = ORIGINS
    found = BVH.closest_points(points)
    closest = BVH.compute_closest_points(points)
    assert (closest["points"] == found.points).all() and closest["primitive_normals"].shape == points.shape
    assert (BVH.compute_distance(points) == found.distance).all()
    assert (BVH.compute_signed_distance(points) < 0).sum() == BVH.compute_occupancy(points).sum() > 0


class Mesh:
    """What the intersector needs of a mesh of trimesh."""

    def __init__(self, vertices, faces):
        self.vertices, self.faces = vertices, faces

    def __hash__(self):
        return hash((self.vertices.tobytes(), self.faces.tobytes()))


def test_the_intersector_without_trimesh():
    mesh = Mesh(VERTICES, FACES)
    ray = RayMeshIntersector(mesh, threads=1)
    origins, directions = ORIGINS.reshape(-1, 3), DIRECTIONS.reshape(-1, 3)
    first = ray.intersects_first(origins, directions)
    assert first.dtype == np.int64 and (ray.intersects_any(origins, directions) == (first >= 0)).all()
    index_tri, index_ray = ray.intersects_id(origins, directions, multiple_hits=False)
    assert (first[index_ray] == index_tri).all() and len(index_ray) == (first >= 0).sum()
    locations, index_ray, index_tri = ray.intersects_location(origins, directions)
    np.testing.assert_allclose(np.cross(locations - origins[index_ray], directions[index_ray]), 0, atol=1e-12)
    assert len(ray.intersects_id(origins, directions, max_hits=1)[0]) == (first >= 0).sum()
    assert ray.contains_points([(0, 0, 0), (2, 0, 0), (np.nan, 0, 0)]).tolist() == [True, False, False]
    assert ray.intersects_first([(0, 0, 0)], [(0, 0, 0)]).tolist() == [-1]
    with pytest.raises(ValueError, match="but ray_directions has shape"):
        ray.intersects_any(origins, directions[1:])
    for other in (copy.copy(ray), copy.deepcopy(ray), pickle.loads(pickle.dumps(ray))):
        assert (other.intersects_first(origins, directions) == first).all()
    # The mesh changes, and the tree with it.
    mesh.vertices = 3 * VERTICES
    assert ray.contains_points([(2, 0, 0)]).all()


@pytest.mark.slow
def test_the_intersector_agrees_with_those_of_trimesh():
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("rtree")
    mesh = trimesh.Trimesh(VERTICES, FACES, process=False)
    theirs = [trimesh.ray.ray_triangle.RayMeshIntersector(mesh)]
    if trimesh.ray.has_embree:
        theirs.append(trimesh.ray.ray_pyembree.RayMeshIntersector(mesh))
    ours = RayMeshIntersector(mesh)
    origins, directions = ORIGINS.reshape(-1, 3), DIRECTIONS.reshape(-1, 3)
    for other in theirs:
        assert (ours.intersects_any(origins, directions) == other.intersects_any(origins, directions)).all()
        assert (
            ours.intersects_first(origins, directions) == other.intersects_first(origins, directions)
        ).all()
        one, two = (r.intersects_location(origins, directions) for r in (ours, other))
        assert len(one[0]) == len(two[0])
        orders = [np.lexsort((*(np.round(r[0], 4).T), r[1])) for r in (one, two)]
        np.testing.assert_allclose(one[0][orders[0]], two[0][orders[1]], atol=1e-4)
        assert (one[2][orders[0]] == two[2][orders[1]]).all()
        points = RNG.uniform(-1, 1, (500, 3))
        assert (ours.contains_points(points) == other.contains_points(points)).all()


@pytest.mark.slow
def test_rays_agree_with_embree():
    pytest.importorskip("embreex")
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, VERTICES.astype(np.float32), FACES.astype(np.int32))
    origins = RNG.normal(size=(20_000, 3)).astype(np.float32)
    directions = RNG.normal(size=(20_000, 3)).astype(np.float32)
    hits = lookfrom.Bvh(VERTICES.astype(np.float32), FACES).closest_hits(origins, directions)
    theirs = scene.run(origins, directions, output=1)
    same = theirs["primID"] == hits.triangle
    # Rays near edges may differ.
    assert same.mean() > 0.9995
    np.testing.assert_allclose(theirs["tfar"][same & hits.hit], hits.t[same & hits.hit], rtol=1e-4, atol=1e-6)


def test_an_axis_through_a_box():
    vertices, faces = box()
    ray = RayMeshIntersector(Mesh(vertices, faces))
    # From the face itself, through its diagonal.
    _, index_ray, _ = ray.intersects_location([(0, 0, 0.5), (0.1, 0.1, 5)], [(0, 0, -1), (0, 0, -1)])
    assert index_ray.tolist() == [0, 0, 1, 1]
