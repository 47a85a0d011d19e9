# SPDX-License-Identifier: Apache-2.0
"""Whoever waits for the physics gets an answer, also when it dies or stands still."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from sim_node import physics_thread
from sim_node.physics_thread import PhysicsError, PhysicsThread

PATIENCE = 60.0


class Bench:
    """A physics that does what it is told; ``turn`` may be replaced at any time."""

    def __init__(self) -> None:
        self.turns = 0
        self.turn: Callable[[], None] = lambda: None
        self.errors: list[str] = []
        self.dead = threading.Event()
        self.traceback = ""
        self.physics = PhysicsThread(self._turn, lambda: 0.001, self.errors.append, self._died)

    def _turn(self) -> None:
        self.turn()
        self.turns += 1

    def _died(self, traceback: str) -> None:
        self.traceback = traceback
        self.dead.set()


@pytest.fixture
def bench() -> Iterator[Bench]:
    bench = Bench()
    yield bench
    bench.turn = lambda: None
    bench.physics.stop()


def breaks() -> None:
    raise ArithmeticError("the blocks explode")


def test_calls_happen_between_turns_and_answer(bench: Bench) -> None:
    bench.physics.start()
    assert bench.physics.call(lambda: threading.current_thread().name) == "physics"
    turns = [bench.physics.call(lambda: bench.turns) for _ in range(20)]
    assert turns == sorted(turns) and turns[-1] > 0


def test_what_a_call_raises_reaches_the_caller_and_turns_go_on(bench: Bench) -> None:
    bench.physics.start()
    for error in (ValueError("no"), TimeoutError("its own")):

        def fail(error: Exception = error) -> None:
            raise error

        with pytest.raises(type(error), match=str(error)):
            bench.physics.call(fail)
    assert bench.physics.call(lambda: 7) == 7


def test_what_is_posted_and_fails_is_reported_and_turns_go_on(bench: Bench) -> None:
    bench.physics.start()
    bench.physics.post(breaks)
    assert bench.physics.call(lambda: 7) == 7
    assert "the blocks explode" in bench.errors[0]
    assert bench.physics.failure == ""


def test_a_long_pause_does_not_keep_callers_waiting() -> None:
    physics = PhysicsThread(lambda: None, lambda: 1000.0, print, print)
    physics.start()
    assert physics.call(lambda: 7) == 7
    physics.stop()


def test_fault_11_a_turn_that_fails_is_told_with_its_traceback(bench: Bench) -> None:
    bench.turn = breaks
    bench.physics.start()
    assert bench.dead.wait(PATIENCE)
    assert "in breaks" in bench.traceback
    assert bench.physics.failure == "ArithmeticError: the blocks explode"


def test_fault_11_callers_who_wait_while_the_physics_dies_are_answered(bench: Bench) -> None:
    waiting = threading.Event()

    def breaks_when_all_wait() -> None:
        assert waiting.wait(PATIENCE)
        breaks()

    bench.turn = breaks_when_all_wait
    bench.physics.start()
    with ThreadPoolExecutor(3) as pool:
        answers = [pool.submit(bench.physics.call, lambda: 7) for _ in range(3)]
        waiting.set()
        for answer in answers:
            with pytest.raises(PhysicsError, match=r"stopped \(ArithmeticError: the blocks expl"):
                answer.result(PATIENCE)
    with pytest.raises(PhysicsError, match="start sim_node anew"):
        bench.physics.call(lambda: 7)


def test_fault_11_a_physics_that_hangs_answers_and_does_not_do_later_what_it_refused(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(physics_thread, "POLL_SECONDS", 0.001)
    released, done = threading.Event(), []
    bench.turn = lambda: assert_true(released.wait(PATIENCE))
    bench.physics.start()
    with pytest.raises(PhysicsError, match="the physics has not moved"):
        bench.physics.call(lambda: done.append("the refused call"))
    with pytest.raises(PhysicsError, match="the physics has not moved"):  # at the first look
        bench.physics.call(lambda: done.append("another one"))
    released.set()
    monkeypatch.setattr(physics_thread, "POLL_SECONDS", PATIENCE)
    bench.physics.call(lambda: done.append("a later call"))
    assert done == ["a later call"]


def test_fault_11_a_call_that_hangs_itself_is_given_up(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(physics_thread, "POLL_SECONDS", 0.001)
    released = threading.Event()
    bench.physics.start()
    with pytest.raises(PhysicsError, match="it may still take effect"):
        bench.physics.call(lambda: released.wait(PATIENCE))
    released.set()


def test_a_stop_while_callers_wait_answers_them(bench: Bench) -> None:
    in_turn, released = threading.Event(), threading.Event()

    def stands() -> None:
        in_turn.set()
        assert released.wait(PATIENCE)

    bench.turn = stands
    bench.physics.start()
    with ThreadPoolExecutor(1) as pool:
        assert in_turn.wait(PATIENCE)
        answer = pool.submit(bench.physics.call, lambda: 7)
        bench.physics.stop(timeout=0.0)
        with pytest.raises(PhysicsError, match="being stopped"):
            answer.result(PATIENCE)
        released.set()


def assert_true(value: bool) -> None:
    assert value
