import threading
import time

from apd_viewer.session.slot import Slot


def test_put_tells_whether_the_slot_was_empty():
    slot = Slot()
    assert [slot.put(1), slot.put(2)] == [True, False]
    assert slot.take() == 2
    assert slot.put(3)


def test_the_newest_value_wins_and_is_given_once():
    slot = Slot()
    for value in range(1, 100):
        slot.put(value)
    assert [slot.take(), slot.take()] == [99, None]


def test_waiting_tells_of_a_value_and_of_the_end():
    slot = Slot()
    assert not slot.waiting
    slot.put("value")
    assert slot.waiting
    slot.take()
    assert not slot.waiting
    slot.close()
    assert slot.waiting


def _waiter(slot: Slot, got: list) -> threading.Thread:
    thread = threading.Thread(target=lambda: got.append(slot.wait()))
    thread.start()
    return thread


def test_wait_wakes_for_a_value():
    slot, got = Slot(), []
    thread = _waiter(slot, got)
    time.sleep(0.02)
    assert got == []
    slot.put("value")
    thread.join(5.0)
    assert got == ["value"]
    assert slot.take() is None


def test_wait_ends_when_the_slot_is_closed():
    slot, got = Slot(), []
    thread = _waiter(slot, got)
    time.sleep(0.02)
    slot.close()
    thread.join(5.0)
    assert got == [None]


def test_a_closed_slot_gives_nothing_more_to_who_waits():
    slot = Slot()
    slot.put("unread")
    slot.close()
    assert slot.wait() is None


def test_one_wake_a_batch_is_enough_to_see_the_last_value():
    """Who is woken only when put says so, and then takes, never misses the last value."""
    slot, woken, seen = Slot(), threading.Semaphore(0), []

    def taker() -> None:
        while True:
            woken.acquire()
            seen.append(slot.take())
            if seen[-1] == 20_000:
                return

    thread = threading.Thread(target=taker)
    thread.start()
    for value in range(1, 20_001):
        if slot.put(value):
            woken.release()
    thread.join(10.0)
    assert not thread.is_alive()
    assert None not in seen
    assert seen == sorted(seen)
