import threading
import time

from apd_viewer.session.processes.mailbox import Mailbox


def test_put_tells_whether_the_slot_was_empty():
    mailbox = Mailbox()
    assert [mailbox.put(1), mailbox.put(2)] == [True, False]
    assert mailbox.take() == 2
    assert mailbox.put(3)


def test_mailbox_lets_the_newest_value_win_and_gives_it_once():
    mailbox = Mailbox()
    for value in range(1, 100):
        mailbox.put(value)
    assert [mailbox.take(), mailbox.take()] == [99, None]


def test_is_ready_tells_of_a_value_and_of_the_end():
    mailbox = Mailbox()
    assert not mailbox.is_ready
    mailbox.put("value")
    assert mailbox.is_ready
    mailbox.take()
    assert not mailbox.is_ready
    mailbox.close()
    assert mailbox.is_ready


def _waiter(mailbox: Mailbox, got: list) -> threading.Thread:
    thread = threading.Thread(target=lambda: got.append(mailbox.wait()))
    thread.start()
    return thread


def test_wait_wakes_for_a_value():
    mailbox, got = Mailbox(), []
    thread = _waiter(mailbox, got)
    time.sleep(0.02)
    assert got == []
    mailbox.put("value")
    thread.join(5.0)
    assert got == ["value"]
    assert mailbox.take() is None


def test_wait_ends_when_the_slot_is_closed():
    mailbox, got = Mailbox(), []
    thread = _waiter(mailbox, got)
    time.sleep(0.02)
    mailbox.close()
    thread.join(5.0)
    assert got == [None]


def test_wait_gets_nothing_more_from_a_closed_slot():
    mailbox = Mailbox()
    mailbox.put("unread")
    mailbox.close()
    assert mailbox.wait() is None


def test_mailbox_shows_the_last_value_with_one_wake_a_batch():
    """Who is woken only when put says so, and then takes, never misses the last value."""
    mailbox, woken, seen = Mailbox(), threading.Semaphore(0), []

    def taker() -> None:
        while True:
            woken.acquire()
            seen.append(mailbox.take())
            if seen[-1] == 20_000:
                return

    thread = threading.Thread(target=taker)
    thread.start()
    for value in range(1, 20_001):
        if mailbox.put(value):
            woken.release()
    thread.join(10.0)
    assert not thread.is_alive()
    assert None not in seen
    assert seen == sorted(seen)
