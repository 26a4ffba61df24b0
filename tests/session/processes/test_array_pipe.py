"""What is the same object on one side is the same object on the other."""

import gc
import io
import weakref

import numpy as np
import pytest
from meshes import box, sphere

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import array_pipe, shared_memory


class Line:
    """A packer and an unpacker."""

    def __init__(self) -> None:
        self.packer, self.unpacker = array_pipe.ArrayPacker(), array_pipe.ArrayUnpacker()
        self.bytes = 0

    def sent(self, value):
        message = self.packer.packed_message(value)
        self.bytes = len(message)
        arrived = self.unpacker.unpacked_value(message)
        if self.packer.shared_arrays:
            self.packer.shared_arrays.discard()
        return arrived


@pytest.fixture(params=["shared memory", "no shared memory"])
def line(request, monkeypatch):
    if request.param == "no shared memory":

        def full(*_, **__):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(shared_memory, "SharedMemory", full)
    return Line()


MESHES = {"small": box(), "large": sphere(4)}


@pytest.mark.parametrize("size", MESHES)
def test_array_pipe_brings_a_document_with_all_its_arrays_once(line, size):
    document = initial_state(Mesh(*MESHES[size])).document.with_label(np.arange(5), BASE)
    there = line.sent((document, document.labels))
    assert np.array_equal(there[0].labels, document.labels)
    assert there[0].labels is there[1]
    assert there[0].initial_positions is there[0].mesh.V, "as here"
    assert np.array_equal(there[0].mesh.V, document.mesh.V)
    assert np.array_equal(there[0].mesh.F, document.mesh.F)
    assert np.array_equal(there[0].mesh.weld.inverse, document.mesh.weld.inverse)
    first = line.bytes
    again = line.sent((document.with_settings(area=101.0), document.labels))
    assert again[0].settings.area == 101.0
    assert again[0].mesh is there[0].mesh
    assert again[0].labels is again[1] is there[1]
    assert line.bytes < first / 2


def test_array_pipe_brings_arrays_read_only_whole_and_their_own(line):
    arrays = [
        np.arange(100_000.0).reshape(-1, 4)[::2, ::-1],
        np.asfortranarray(np.arange(60_000).reshape(300, 200)),
        np.zeros((0, 3)),
        np.array(3.5),
        np.arange(20_000, dtype=np.uint8),
    ]
    there = line.sent(arrays)
    for a, b in zip(arrays, there, strict=True):
        assert a.dtype == b.dtype
        assert a.shape == b.shape
        assert np.array_equal(a, b)
        assert not b.flags.writeable
    first = arrays[0].copy()
    arrays[0][:] = 0.0
    assert np.array_equal(there[0], first)


def test_array_pipe_keeps_equal_arrays_that_are_two_as_two(line):
    a, b = line.sent((np.zeros(5000), np.zeros(5000)))
    assert a is not b


def test_array_pipe_lets_go_on_both_sides_what_is_no_longer_mentioned(line):
    kept, dropped = np.zeros(5000), np.ones(5000)
    here = weakref.ref(dropped)
    there = [weakref.ref(array) for array in line.sent((kept, dropped))]
    del dropped
    again = line.sent(kept)
    gc.collect()
    assert again is there[0]()
    assert there[1]() is None
    assert here() is None


def test_array_pipe_takes_no_array_for_one_that_is_gone_from_its_place(line):
    for k in range(50):
        assert line.sent(np.full(3000, float(k)))[0] == k


def test_pickled_value_of_a_handle_may_be_read_by_another_thread_meanwhile():
    """The first reading of its rotation is kept in it, while the solver's thread goes through its fields."""
    handle = Handle("Handle 1", np.eye(4))

    def number_of(thing):
        if isinstance(thing, np.ndarray):
            assert not handle.rotation.any()

    again = array_pipe.unpickled_value(array_pipe.pickled_value(handle, number_of), {})
    assert again.name == handle.name
    assert np.array_equal(again.pose, handle.pose)
    assert np.array_equal(again.rotation, handle.rotation)


def test_array_pipe_read_gives_message_after_message_and_ends():
    file = io.BytesIO()
    for message in (b"one", b"", b"three" * 10_000):
        array_pipe.write_message(file, message)
    whole = file.getvalue()
    file.seek(0)
    assert [array_pipe.read_message(file) for _ in range(4)] == [b"one", b"", b"three" * 10_000, None]
    for cut in (0, 3, 9, len(whole) - 1):
        file = io.BytesIO(whole[:cut])
        while array_pipe.read_message(file) is not None:
            pass


def test_shared_shape_buffer_tells_each_side_what_the_other_has_done():
    ours = shared_memory.SharedShapeBuffer(4)
    theirs = shared_memory.SharedShapeBuffer(4, ours.name)
    assert theirs.is_free
    assert theirs.is_displayed
    U = np.arange(12.0).reshape(4, 3)
    number = theirs.write_shape(U)
    assert not theirs.is_free
    assert not theirs.is_displayed
    assert np.array_equal(ours.take_shape(number), U)
    assert theirs.is_free
    assert not theirs.is_displayed
    ours.mark_displayed(number)
    assert theirs.is_displayed
    name = ours.name
    del ours, theirs
    with pytest.raises(FileNotFoundError):
        shared_memory.SharedShapeBuffer(4, name)


def test_shared_shape_buffer_leaves_nothing_of_a_block_that_cannot_be_had(monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    if not hasattr(shared_memory.os, "posix_fallocate"):
        pytest.skip("this system has no posix_fallocate, whose failure is tested")
    made = []
    real = shared_memory.SharedMemory
    monkeypatch.setattr(
        shared_memory, "SharedMemory", lambda *given, **how: made.append(real(*given, **how)) or made[-1]
    )
    monkeypatch.setattr(shared_memory.os, "posix_fallocate", full)
    with pytest.raises(OSError, match="No space"):
        shared_memory.SharedShapeBuffer(4)
    with pytest.raises(FileNotFoundError):
        real(name=made[0].name)
