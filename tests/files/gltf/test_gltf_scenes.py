"""Scenes of glTF as they are meant: mirrored, instanced, morphed, skinned and sparse.

Every shape is a box of volume 4, so volumes are sums of determinants. Scenes are written as GLB and as text.
"""

import numpy as np
import pytest
from gltf_scenes import GltfScene
from meshes import box, rotation

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh, suffix_for
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.operators import volume

V, F = box(1, 2, 2)
VOLUME = 4.0
QUARTER = [0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)]  # about z


def instanced(**attributes):
    return {"EXT_mesh_gpu_instancing": {"attributes": attributes}}


def mirrored_in(axis):
    def build(scene, V):
        scale = np.where(np.arange(3) == axis, -1, 1).tolist()
        mesh = scene.mesh(V, F)
        scene.node(mesh=mesh, translation=[9, 0, 0])
        scene.node(mesh=mesh, scale=scale)

    return build


def mirrored_thrice(scene, V):
    scene.node(mesh=scene.mesh(V, F), scale=[-1, -2, -3])


def mirrored_by_a_matrix(scene, V):
    swap = np.eye(4)[[1, 0, 2, 3]]
    scene.node(mesh=scene.mesh(V, F), matrix=swap.T.ravel().tolist())


def mirrored_above(scene, V):
    below = scene.node(root=False, mesh=scene.mesh(V, F), rotation=QUARTER, translation=[1, 2, 3])
    scene.node(children=[below], scale=[1, -2, 1])


def mirrored_twice(scene, V):
    below = scene.node(root=False, mesh=scene.mesh(V, F), scale=[-1, 1, 1])
    scene.node(children=[below], scale=[1, 1, -1], translation=[0, 0, 5])


def three_instances(scene, V):
    at = scene.accessor([[0, 0, 0], [5, 0, 0], [0, 5, 0]])
    scene.node(mesh=scene.mesh(V, F), extensions=instanced(TRANSLATION=at))


def mirrored_instances(scene, V):
    at = scene.accessor([[0, 0, 0], [9, 0, 0]])
    scale = scene.accessor([[-1, 1, 1], [1, 2, 1]])
    scene.node(mesh=scene.mesh(V, F), extensions=instanced(TRANSLATION=at, SCALE=scale))


def instances_turned_by_small_numbers(scene, V):
    at = scene.accessor([[0, 0, 0], [9, 0, 0]])
    turn = scene.accessor(np.rint(32767 * np.array([QUARTER, [0, 0, 0, 1]])), "i2", normalized=True)
    scene.node(mesh=scene.mesh(V, F), extensions=instanced(TRANSLATION=at, ROTATION=turn))


def instances_below_a_mirror(scene, V):
    scale = scene.accessor([[1, 1, 1], [-1, 1, 1], [2, 2, 2]])
    below = scene.node(root=False, mesh=scene.mesh(V, F), extensions=instanced(SCALE=scale))
    scene.node(children=[below], scale=[-1, 1, 1], translation=[0, 7, 0])


def morphed_by_its_mesh(scene, V):
    more = scene.accessor(V * [1, 0, 0])
    scene.node(mesh=scene.mesh(V, F, weights=[1.0], targets=[{"POSITION": more}]))


def morphed_by_its_node(scene, V):
    targets = [{"POSITION": scene.accessor(V * np.eye(3)[axis])} for axis in range(2)]
    mesh = scene.mesh(V, F, weights=[0.0, 9.0], targets=targets)
    below = scene.node(root=False, mesh=mesh, weights=[1.0, 0.5], translation=[1, 0, 0])
    scene.node(children=[below], scale=[-1, 1, 1])


def morphed_sparsely(scene, V):
    rows = np.flatnonzero(V[:, 2] == V[:, 2].max())
    targets = [{"POSITION": scene.sparse(len(V), rows, V[rows] * [0, 0, 1], index="u1")}]
    targets += [{"POSITION": scene.told(len(V), 3)}, {"NORMAL": scene.accessor(V)}]
    scene.node(mesh=scene.mesh(V, F, weights=[0.5, 1.0, 1.0], targets=targets))


def skinned(scene, V, joints, weights=None, bound=None, node=None, small=False):
    """A skin with a joint for each of ``joints``, bound at the matrices ``bound``; nodes that move it."""
    weights = np.eye(len(joints), 4)[np.zeros(len(V), dtype=int)] if weights is None else weights
    attributes = {
        "JOINTS_0": scene.accessor(np.tile(np.arange(4) % len(joints), (len(V), 1)), "u1"),
        "WEIGHTS_0": scene.accessor(np.rint(255 * weights), "u1", normalized=True)
        if small
        else scene.accessor(weights),
    }
    skin = {"joints": [scene.node(**joint) for joint in joints]}
    if bound is not None:
        columns = np.linalg.inv(bound).transpose(0, 2, 1).reshape(-1, 16)
        skin["inverseBindMatrices"] = scene.accessor(columns)
    skins = scene.document.setdefault("skins", [])
    skins.append(skin)
    mesh = scene.mesh(V, F, attributes=attributes)
    scene.node(mesh=mesh, skin=len(skins) - 1, **(node or {"translation": [100, 0, 0], "scale": [-3, 1, 1]}))


def skinned_at_rest(scene, V):
    skinned(scene, V, [{}])


def skinned_by_a_moved_joint(scene, V):
    bound = np.eye(4)
    bound[:3, 3] = 1, 2, 3
    skinned(scene, V, [{"translation": [1, 2, 3], "scale": [1, 1, 2]}], bound=bound[None])


def skinned_by_a_mirror(scene, V):
    skinned(scene, V, [{"scale": [-1, 1, 1]}])


def skinned_by_two(scene, V):
    """The upper half follows a joint that lifts, and between them it is half and half."""
    up = V[:, 2:] / V[:, 2].max()
    skinned(scene, V, [{}, {"translation": [0, 0, 2]}], np.hstack([1 - up, up, 0 * V[:, :2]]), small=True)


def skinned_twice(scene, V):
    skinned(scene, V, [{"translation": [5, 0, 0]}])
    skinned(scene, V, [{"translation": [-5, 0, 0]}])


def sparse_over_a_base(scene, V):
    rows = [2, 3, 5]
    base = V.copy()
    base[rows] = 77.0
    scene.node(mesh=scene.mesh(scene.sparse(len(V), rows, V[rows], base=base), F))


def sparse_alone(scene, V):
    rows = np.arange(len(V))
    scene.node(mesh=scene.mesh(scene.sparse(len(V), rows, V, index="u4"), F), scale=[-1, 1, 1])


def sparse_triangles(scene, V):
    flat = F.ravel()
    indices = scene.sparse(len(flat), [0, 1], flat[:2], 1, "u2", "u1", np.r_[[9, 9], flat[2:]])
    mesh = scene.mesh(V, F)
    scene.document["meshes"][mesh]["primitives"][0]["indices"] = indices
    scene.node(mesh=mesh)


# What builds a scene, the volume it encloses in boxes, and its places
SCENES = {
    "mirrored in x": (mirrored_in(0), 2, 2),
    "mirrored in y": (mirrored_in(1), 2, 2),
    "mirrored in z": (mirrored_in(2), 2, 2),
    "mirrored thrice": (mirrored_thrice, 6, 1),
    "mirrored by a matrix": (mirrored_by_a_matrix, 1, 1),
    "mirrored above": (mirrored_above, 2, 1),
    "mirrored twice": (mirrored_twice, 1, 1),
    "three instances": (three_instances, 3, 3),
    "mirrored instances": (mirrored_instances, 3, 2),
    "instances turned by small numbers": (instances_turned_by_small_numbers, 2, 2),
    "instances below a mirror": (instances_below_a_mirror, 10, 3),
    "morphed by its mesh": (morphed_by_its_mesh, 2, 1),
    "morphed by its node": (morphed_by_its_node, 3, 1),
    "morphed sparsely": (morphed_sparsely, 1.5, 1),
    "skinned at rest": (skinned_at_rest, 1, 1),
    "skinned by a moved joint": (skinned_by_a_moved_joint, 2, 1),
    "skinned by a mirror": (skinned_by_a_mirror, 1, 1),
    "skinned by two": (skinned_by_two, 2, 1),
    "skinned twice": (skinned_twice, 2, 1),
    "sparse over a base": (sparse_over_a_base, 1, 1),
    "sparse alone": (sparse_alone, 1, 1),
    "sparse triangles": (sparse_triangles, 1, 1),
}


@pytest.fixture(params=[".glb", ".gltf"])
def suffix(request):
    return request.param


@pytest.fixture(params=SCENES)
def scene_of(request):
    """The name of a scene, and a function that builds it of a shape."""

    def build(shape):
        scene = GltfScene()
        SCENES[request.param][0](scene, shape)
        return scene

    return request.param, build


def test_read_gltf_encloses_the_volume_of_the_scene(scene_of, suffix, tmp_path):
    name, build = scene_of
    mesh = open_mesh(build(V).write(tmp_path / f"a{suffix}"))
    assert volume(mesh.V, mesh.F) == pytest.approx(
        SCENES[name][1] * VOLUME, rel=3e-3 if "two" in name else 1e-4
    )


def test_gltf_file_leaves_what_is_not_moved_as_it_stood(scene_of, suffix, tmp_path):
    path = scene_of[1](V).write(tmp_path / f"a{suffix}")
    mesh = open_mesh(path)
    save_mesh(mesh, mesh.V, tmp_path / f"b{suffix}")
    assert (tmp_path / f"b{suffix}").read_bytes() == path.read_bytes()


def test_gltf_file_writes_another_shape_of_the_scene_into_it(scene_of, suffix, tmp_path):
    """The shape is that of the same scene with a bent box: so all its places agree."""
    name, build = scene_of
    bent = V @ rotation((1, 2, 3), 0.2).T * [1.1, 0.9, 1.2] + [0.1, 0.2, 0.3]
    mesh = open_mesh(build(V).write(tmp_path / f"a{suffix}"))
    if "morphed" in name or "skinned" in name:  # targets and weights of the other scene differ
        U = mesh.V @ rotation((1, 2, 3), 0.2).T * 1.1
    else:
        U = open_mesh(build(bent).write(tmp_path / f"other{suffix}")).V
    if name == "skinned twice" or name == "morphed sparsely":
        U[0] += 0.1
    save_mesh(mesh, U, tmp_path / f"b{suffix}")
    again = open_mesh(tmp_path / f"b{suffix}")
    np.testing.assert_array_equal(again.F, mesh.F)
    assert np.abs(again.V - U).max() <= 1e-5 * np.abs(U).max()
    save_mesh(mesh, U, tmp_path / "b.obj")
    assert np.abs(open_mesh(tmp_path / "b.obj").V - U).max() < 1e-9


def test_gltf_file_says_the_places_of_one_mesh_which_cannot_differ(scene_of, suffix, tmp_path):
    name, build = scene_of
    places = SCENES[name][2]
    mesh = open_mesh(build(V).write(tmp_path / f"a{suffix}"))
    assert len(mesh.remarks) == (places > 1)
    assert all(f"one mesh in {places} places" in line for line in mesh.remarks)
    assert ("instances" in mesh.origin.extras) == (places > 1)
    U = mesh.V.copy()
    U[0] += 0.1
    if places > 1:
        with pytest.raises(InputError, match="several places that now differ"):
            save_mesh(mesh, U, tmp_path / f"b{suffix}")
    save_mesh(mesh, U, tmp_path / "b.ply")
    assert np.abs(open_mesh(tmp_path / "b.ply").V - U).max() < 1e-5


def test_read_gltf_places_a_mesh_by_its_skin_and_not_by_the_node(suffix, tmp_path):
    scene = GltfScene()
    skinned_at_rest(scene, V)
    np.testing.assert_array_equal(open_mesh(scene.write(tmp_path / f"a{suffix}")).V, V)


def test_read_gltf_takes_weights_of_a_node_before_those_of_its_mesh(suffix, tmp_path):
    scene = GltfScene()
    morphed_by_its_node(scene, V)
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    np.testing.assert_allclose(mesh.V, (V * [2, 1.5, 1] + [1, 0, 0]) * [-1, 1, 1])


def test_gltf_file_normals_face_outwards_in_a_mirror_and_turn_with_morph_targets(suffix, tmp_path):
    scene = GltfScene()
    N = V - V.mean(axis=0)
    normals = {"NORMAL": scene.accessor(N)}
    target = {"POSITION": scene.accessor(V * [1, 0, 0]), "NORMAL": scene.accessor(N * [-0.5, 0, 0])}
    mesh = scene.mesh(V, F, weights=[1.0], attributes=normals, targets=[target])
    scene.node(mesh=mesh, scale=[-1, 1, 1])
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    (read, _), middle = mesh.origin.normals(mesh), mesh.V.mean(axis=0)
    assert (np.einsum("ij,ij->i", read, mesh.V - middle) > 0).all()
    np.testing.assert_allclose(read, N * [-0.5, 1, 1], atol=1e-6)
    turn = rotation((1, 2, 3), 0.4)
    save_mesh(mesh, mesh.V @ turn.T, tmp_path / f"b{suffix}")
    again = open_mesh(tmp_path / f"b{suffix}")
    turned, _ = again.origin.normals(again)
    size = np.linalg.norm(turned, axis=1, keepdims=True) * np.linalg.norm(read, axis=1, keepdims=True)
    assert (np.sum(turned * (read @ turn.T), axis=1) / size[:, 0]).min() > 0.99


@pytest.mark.parametrize("told", [{"scene": 1}, {"scene": 0}])
def test_read_gltf_reads_the_scene_that_the_file_opens_with_and_says_others(told, suffix, tmp_path):
    scene = GltfScene()
    scene.node(mesh=scene.mesh(V, F))
    scene.node(root=False, mesh=scene.mesh(2 * V, F))
    scene.document["scenes"].append({"nodes": [1]})
    scene.document |= told
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    assert volume(mesh.V, mesh.F) == pytest.approx(VOLUME * 8 ** told["scene"])
    assert "several scenes" in mesh.remarks[0]
    scene.document["scenes"][1]["nodes"] = [0]
    scene.document["scene"] = 0
    assert not open_mesh(scene.write(tmp_path / f"b{suffix}")).remarks


MAY_PASS = ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform", "EXT_texture_webp"]
REFUSED = [
    "VENDOR_displaced",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_gaussian_splatting",
    "CESIUM_RTC",
    "khr_materials_unlit",
]


@pytest.mark.parametrize("name", MAY_PASS)
def test_check_supported_lets_an_extension_that_changes_no_geometry_be_required(name, suffix, tmp_path):
    scene = GltfScene(extensionsUsed=[name], extensionsRequired=[name])
    scene.node(mesh=scene.mesh(V, F))
    assert len(open_mesh(scene.write(tmp_path / f"a{suffix}")).F) == len(F)


@pytest.mark.parametrize("name", REFUSED)
def test_check_supported_refuses_any_other_required_extension_by_its_name(name, suffix, tmp_path):
    scene = GltfScene(extensionsUsed=[name], extensionsRequired=["KHR_materials_unlit", name])
    scene.node(mesh=scene.mesh(V, F))
    with pytest.raises(InputError, match=name):
        open_mesh(scene.write(tmp_path / f"a{suffix}"))
    del scene.document["extensionsRequired"]
    assert len(open_mesh(scene.write(tmp_path / f"b{suffix}")).F) == len(F)


def test_read_gltf_does_not_take_compressed_positions_for_zeros(suffix, tmp_path):
    scene = GltfScene(extensionsUsed=["KHR_draco_mesh_compression"])
    extensions = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    scene.node(mesh=scene.mesh(scene.told(len(V), 3), F, extensions=extensions))
    with pytest.raises(InputError, match=r"compressed \(KHR_draco_mesh_compression\)"):
        open_mesh(scene.write(tmp_path / f"a{suffix}"))


@pytest.mark.parametrize(
    "asset", [{"version": "1.0"}, {"version": "3.0"}, {"version": "2.1", "minVersion": "2.1"}]
)
def test_check_supported_names_other_versions(asset, suffix, tmp_path):
    scene = GltfScene(asset=asset, buffers={}, nodes={})
    scene.document["nodes"] = []
    with pytest.raises(InputError, match=f"it is version {asset['version']}"):
        open_mesh(scene.write(tmp_path / f"a{suffix}"))


def test_check_supported_lets_a_later_version_that_asks_for_no_more_be_read(suffix, tmp_path):
    scene = GltfScene(asset={"version": "2.1", "minVersion": "2.0"})
    scene.node(mesh=scene.mesh(V, F))
    assert len(open_mesh(scene.write(tmp_path / f"a{suffix}")).F) == len(F)


def test_read_gltf_names_version_1_of_a_glb(tmp_path):
    (tmp_path / "a.glb").write_bytes(b"glTF" + bytes([1, 0, 0, 0]) + bytes(12) + b"{}")
    with pytest.raises(InputError, match="it is version 1"):
        open_mesh(tmp_path / "a.glb")


def wrong_joint(scene):
    scene.document["skins"][0]["joints"] = [7]


def too_few_matrices(scene):
    scene.document["skins"][0]["inverseBindMatrices"] = scene.told(0, 16, bufferView=0)


def joint_of_no_skin(scene):
    scene.document["accessors"][0]["bufferView"] = scene.view(np.full((len(V), 4), 9, dtype="u1"))


def row_beyond(scene):
    view = scene.view(np.full(3, 999, dtype="<u2"))
    scene.document["accessors"][0]["sparse"]["indices"]["bufferView"] = view


def sparse_in_words(scene):
    scene.document["accessors"][0]["sparse"] = "some"


def unequal_instances(scene):
    instances = scene.document["nodes"][-1]["extensions"]["EXT_mesh_gpu_instancing"]
    instances["attributes"]["SCALE"] = scene.accessor([[1, 1, 1]])


def no_instances(scene):
    scene.document["nodes"][-1]["extensions"]["EXT_mesh_gpu_instancing"] = {}


def short_target(scene):
    scene.document["accessors"][0]["count"] -= 1


def weight_in_words(scene):
    scene.document["meshes"][0]["weights"] = ["1"]


DAMAGED = {
    wrong_joint: (skinned_at_rest, "a joint of its skin is not in the scene"),
    too_few_matrices: (skinned_at_rest, "fewer matrices than joints"),
    joint_of_no_skin: (skinned_at_rest, "a joint that is missing from its skin"),
    row_beyond: (sparse_over_a_base, "refers to row 999 of"),
    sparse_in_words: (sparse_over_a_base, "has no indices or no values"),
    unequal_instances: (three_instances, "differ in number"),
    no_instances: (three_instances, "are missing"),
    short_target: (morphed_by_its_mesh, "another number of vertices"),
    weight_in_words: (morphed_by_its_mesh, "not a number"),
}


@pytest.mark.parametrize("damage", DAMAGED, ids=lambda damage: damage.__name__)
def test_read_gltf_says_what_is_damaged(damage, suffix, tmp_path):
    build, words = DAMAGED[damage]
    scene = GltfScene()
    build(scene, V)
    damage(scene)
    with pytest.raises(InputError, match=words):
        open_mesh(scene.write(tmp_path / f"a{suffix}"))


def test_read_gltf_refuses_instances_without_end(tmp_path, monkeypatch):
    monkeypatch.setattr("apd_viewer.files.gltf.gltf_reader.MOST_VERTICES", 2 * len(V))
    scene = GltfScene()
    three_instances(scene, V)
    with pytest.raises(InputError, match="all its instances"):
        open_mesh(scene.write(tmp_path / "a.glb"))


def test_gltf_file_cannot_move_rows_that_are_not_stored(suffix, tmp_path):
    flat = V * [1, 1, 0] + [0, 0, 1]
    rows = np.flatnonzero(np.abs(flat).sum(axis=1) > 1.0)  # not the corner at zero
    scene = GltfScene()
    scene.node(mesh=scene.mesh(scene.sparse(len(V), rows, V[rows]), F))
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    U = mesh.V.copy()
    U[rows] += 0.1
    save_mesh(mesh, U, tmp_path / f"b{suffix}")
    with pytest.raises(InputError, match="only some of its positions"):
        save_mesh(mesh, U + 0.1, tmp_path / f"b{suffix}")


def test_read_gltf_takes_lengths_for_metres(suffix, tmp_path):
    scene = GltfScene()
    scene.node(mesh=scene.mesh(V, F))
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    assert (mesh.unit, mesh.baked(2 * mesh.V).unit) == ("m", "m")


def test_suffix_for_names_another_format_where_shapes_do_not_fit(scene_of, tmp_path):
    name, build = scene_of
    mesh = open_mesh(build(V).write(tmp_path / "a.glb"))
    assert suffix_for(mesh) == (".obj" if SCENES[name][2] > 1 else ".glb")


def with_normals(scene, X, normal):
    return scene.mesh(X, F, attributes={"NORMAL": normal})


def test_gltf_file_refuses_normals_that_two_places_share_and_one_changes(suffix, tmp_path):
    """As of two equal meshes whose equal accessors a tool has merged."""
    scene, N = GltfScene(), V - V.mean(axis=0)
    normal = scene.accessor(N)
    for shift in (0.0, 9.0):
        scene.node(mesh=with_normals(scene, V + [shift, 0, 0], normal))
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    assert len(mesh.V) == 2 * len(V)
    turn = rotation((1, 2, 3), 0.4)
    both = np.where(mesh.V[:, :1] < 5, mesh.V @ turn.T, (mesh.V - [9, 0, 0]) @ turn.T + [9, 0, 0])
    save_mesh(mesh, both, tmp_path / f"b{suffix}")
    read, _ = open_mesh(tmp_path / f"b{suffix}").origin.normals(mesh)
    np.testing.assert_allclose(read, np.vstack([N, N]) @ turn.T, atol=0.1)
    one = np.where(mesh.V[:, :1] < 5, mesh.V @ turn.T, mesh.V)
    with pytest.raises(InputError, match="shares its normals"):
        save_mesh(mesh, one, tmp_path / f"c{suffix}")


@pytest.mark.parametrize("kind", ["i1", "i2"])
def test_gltf_file_rotates_rounded_normals_and_their_bounds(kind, suffix, tmp_path):
    scene, N = GltfScene(), V - V.mean(axis=0)
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    most = np.iinfo(kind).max
    stored = np.rint(most * N)
    normal = scene.accessor(stored, kind, normalized=True)
    bounds = {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()}
    scene.document["accessors"][normal] |= bounds
    scene.node(mesh=with_normals(scene, V, normal))
    mesh = open_mesh(scene.write(tmp_path / f"a{suffix}"))
    turn = rotation((1, 2, 3), 0.4)
    save_mesh(mesh, mesh.V @ turn.T, tmp_path / f"b{suffix}")
    origin = open_mesh(tmp_path / f"b{suffix}").origin
    read, _ = origin.normals(mesh)
    np.testing.assert_allclose(read, N @ turn.T, atol=2.0 / most)
    told = origin.document["accessors"][normal]
    np.testing.assert_allclose(told["min"], np.rint(most * read.min(axis=0)), atol=0.5)
    np.testing.assert_allclose(told["max"], np.rint(most * read.max(axis=0)), atol=0.5)


def test_gltf_file_keeps_rounded_positions_that_stay(suffix, tmp_path):
    scene = GltfScene(extensionsUsed=["KHR_mesh_quantization"])
    mesh = scene.mesh(V, F)
    attributes = scene.document["meshes"][mesh]["primitives"][0]["attributes"]
    attributes["POSITION"] = scene.accessor(V, "i2")
    scene.node(mesh=mesh)
    path = scene.write(tmp_path / f"a{suffix}")
    found = open_mesh(path)
    save_mesh(found, found.V, tmp_path / f"b{suffix}")
    assert (tmp_path / f"b{suffix}").read_bytes() == path.read_bytes()
    with pytest.raises(InputError, match="rounded positions"):
        save_mesh(found, 1.1 * found.V, tmp_path / f"c{suffix}")


def test_read_gltf_refuses_a_weight_beyond_all_numbers(suffix, tmp_path):
    scene = GltfScene()
    targets = [{"POSITION": scene.accessor(V)}]
    scene.node(mesh=scene.mesh(V, F, weights=[10**400], targets=targets))
    with pytest.raises(InputError, match="weight of a morph target"):
        open_mesh(scene.write(tmp_path / f"a{suffix}"))
