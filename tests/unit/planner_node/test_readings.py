# SPDX-License-Identifier: Apache-2.0
"""A block in doubt keeps its name over pictures, and what was answered about it."""

from __future__ import annotations

from loop_bench import LoopBench, in_doubt, sighting_of

from planner_node.loop import Sighting, Status
from planner_node.loop.readings import Doubt, Readings, doubts_in, readings_of
from scene_graph import GraphStatus, Stacks

NAMES = ("blue_box", "red_box", "unknown_box")


def seen(name: str, *alternatives: str, stamp: int = 1, beside: str = "blue_box") -> Sighting:
    """One block on another one, with the other colours that it may have."""
    stacks: Stacks = ((beside, name), (), ())
    others = {name: " ".join(alternatives)} if alternatives else {}
    return in_doubt(sighting_of(stacks, stamp), **others)


def names(sighting: Sighting) -> tuple[str, ...]:
    return sighting.graph.names


def test_a_picture_without_doubt_is_left_as_it_is() -> None:
    sighting = seen("red_box")
    assert Readings().named(sighting) is sighting


def test_a_doubtful_graph_can_be_planned_on() -> None:
    named = Readings().named(seen("orange_box", "red"))
    assert named.status is GraphStatus.CONFIDENT
    assert doubts_in(named.graph) == (Doubt("orange_box", ("orange", "red"), "box"),)


def test_a_block_keeps_its_name_when_another_colour_becomes_likelier_or_certain() -> None:
    readings = Readings()
    for sighting in (seen("orange_box", "red"), seen("red_box", "orange"), seen("red_box"),
                     seen("orange_box", "red")):  # fmt: skip
        assert names(readings.named(sighting)) == ("blue_box", "orange_box")


def test_another_block_does_not_get_its_name() -> None:
    readings = Readings()
    readings.named(seen("orange_box", "red"))
    assert names(readings.named(seen("pink_box"))) == ("blue_box", "pink_box")
    # It is gone since: who comes now comes by his own name.
    assert names(readings.named(seen("red_box", "orange"))) == ("blue_box", "red_box")


def test_a_block_that_was_there_before_is_not_taken_for_it() -> None:
    readings = Readings()
    readings.named(seen("orange_box", "red", beside="red_box"))
    gone = sighting_of((("red_box",), (), ()), 2)
    assert names(readings.named(gone)) == ("red_box",)


def test_an_answer_holds_while_the_block_may_be_that() -> None:
    readings = Readings()
    (doubt,) = doubts_in(readings.named(seen("orange_box", "red")).graph)
    readings.answer(doubt, "red", ["blue_box", "orange_box"])
    for sighting in (seen("orange_box", "red"), seen("red_box", "orange")):
        named = readings.named(sighting)
        assert names(named) == ("blue_box", "red_box")
        assert doubts_in(named.graph) == ()
    # Seen to be orange for certain, it is not what was answered.
    assert names(readings.named(seen("orange_box"))) == ("blue_box", "orange_box")


def test_a_clock_that_goes_back_shows_another_scene() -> None:
    readings = Readings()
    (doubt,) = doubts_in(readings.named(seen("orange_box", "red", stamp=9)).graph)
    readings.answer(doubt, "red", ["blue_box", "orange_box"])
    assert names(readings.named(seen("orange_box", "red", stamp=1))) == ("blue_box", "orange_box")


def test_readings_number_blocks_of_one_name() -> None:
    doubts = [Doubt("unknown_box", ("red", "orange"), "box")]
    assert list(readings_of(doubts, NAMES)) == [
        {"unknown_box": "red_box_2"},
        {"unknown_box": "orange_box"},
    ]


def test_the_loop_asks_once_and_goes_on_by_the_answer() -> None:
    bench = LoopBench()
    bench.stacks = (("orange_box",), ("green_box",), ("blue_box",))
    bench.alternatives = {"orange_box": "red"}
    outcome = bench.achieve("red on green")
    assert (outcome.status, outcome.module) == (Status.NEEDS_ANSWER, "perception")
    assert outcome.answers == ("orange", "red")
    assert not bench.plans
    outcome = bench.achieve("red on green", answer="red")
    assert outcome.status == Status.SUCCESS, outcome.message
    assert bench.stacks == ((), ("green_box", "orange_box"), ("blue_box",))


def test_the_loop_moves_a_block_in_doubt_by_whatever_name() -> None:
    bench = LoopBench()
    bench.stacks = (("blue_box", "orange_box"), ("green_box",), ())
    bench.alternatives = {"orange_box": "red"}
    outcome = bench.achieve("green on blue")
    assert outcome.status == Status.SUCCESS, outcome.message
    assert (outcome.moves_planned, outcome.replans) == (2, 0)
