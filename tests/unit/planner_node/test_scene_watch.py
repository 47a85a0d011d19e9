# SPDX-License-Identifier: Apache-2.0
"""Which scene graphs are planned on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from loop_bench import START, FakeClock, sighting_of

from planner_node.errors import (
    CancelledError,
    NoSceneGraphError,
    NotConfidentError,
    ObjectLostError,
)
from planner_node.loop import SceneWatch, Sighting
from planner_node.settings import Settings
from scene_graph import GraphStatus, Relation, SceneObject


class Watched:
    """A watch, its clock and its settings."""

    def __init__(self, **settings: Any) -> None:
        self.clock = FakeClock()
        self.settings = Settings(**settings)
        self.watch = SceneWatch(self.settings, self.clock.ros_now, self.clock)

    def see(self, ago: float = 0.0, **fields: Any) -> None:
        stamp = self.clock.ros_now() - round(ago * 1e9)
        self.watch.receive(sighting_of(START, stamp, **fields))


def never() -> bool:
    return False


def test_the_newest_scene_is_given_with_its_time_and_frame() -> None:
    watched = Watched()
    watched.see()
    scene = watched.watch.latest()
    assert scene.stacks == START
    assert scene.names == ("blue_box", "green_box", "red_box")
    assert (scene.stamp, scene.frame_id) == (watched.clock.ros_now(), "world")


def test_none_has_arrived() -> None:
    with pytest.raises(NoSceneGraphError, match="perception_node"):
        Watched().watch.latest()


def test_an_older_confident_scene_does_not_count() -> None:
    watched = Watched()
    watched.see()
    watched.see(status=GraphStatus.OCCLUDED, message="a hand hides stack0")
    with pytest.raises(NotConfidentError, match="a hand hides stack0"):
        watched.watch.latest()


@pytest.mark.parametrize(
    ("ago", "sentence"), [(60.0, "60.0 s old"), (-60.0, "60.0 s in the future")]
)
def test_a_scene_of_another_time_is_refused(ago: float, sentence: str) -> None:
    watched = Watched()
    watched.see(ago)
    with pytest.raises(NotConfidentError, match=f"{sentence}.*use_sim_time"):
        watched.watch.latest()


def test_simulated_time_that_does_not_arrive_is_said() -> None:
    watched = Watched()
    watched.see()
    watched.clock.seconds = 0.0
    with pytest.raises(NoSceneGraphError, match="nothing arrives on clock"):
        watched.watch.latest()


def test_a_scene_from_before_is_refused_unless_before_lies_in_the_future() -> None:
    watched = Watched()
    watched.see(ago=1.0)
    with pytest.raises(NotConfidentError, match="before the last motion"):
        watched.watch.latest(after=watched.clock.ros_now())
    watched.watch.latest(after=watched.clock.ros_now() + 1)  # the simulation was restarted


def test_a_needed_object_is_missed() -> None:
    watched = Watched()
    watched.see()
    with pytest.raises(ObjectLostError, match="pink_box cannot be seen any more"):
        watched.watch.latest(needed=frozenset({"pink_box", "red_box"}))


def test_fault_10_a_clock_that_stopped_with_its_simulator_makes_no_scene_young() -> None:
    clock = FakeClock()
    watch = SceneWatch(Settings(graph_max_age=5.0), lambda: 10**9, clock)
    watch.receive(sighting_of(START, 10**9))
    clock.seconds += 4.9
    watch.latest()
    clock.seconds += 2.1
    with pytest.raises(
        NoSceneGraphError, match=r"nothing has arrived from perception for 7 s.*clock"
    ):
        watch.latest()


def test_fault_10_a_slow_simulation_that_lives_is_not_refused() -> None:
    clock = FakeClock()
    watch = SceneWatch(Settings(graph_max_age=5.0), lambda: 10**9 + 2, clock)
    for stamp in (1, 2):
        watch.receive(sighting_of(START, 10**9 + stamp))
        clock.seconds += 4.0
        watch.latest()


def test_fault_3_a_perception_that_stands_still_for_five_seconds_is_waited_for() -> None:
    watched = Watched()
    watched.see()
    watched.clock.seconds += 1.0
    asked = watched.clock.ros_now()
    back = watched.clock.seconds + 5.0

    def come_back() -> None:
        if watched.clock.seconds > back:
            watched.see()

    watched.clock.on_wait = come_back
    assert watched.watch.wait(never, after=asked).stacks == START


def without_bottom(sighting: Sighting) -> Sighting:
    relations = sighting.graph.relations - {Relation("red_box", "up", "stack0")}
    return replace(sighting, graph=replace(sighting.graph, relations=relations))


def two_on_one(sighting: Sighting) -> Sighting:
    relations = sighting.graph.relations | {Relation("green_box", "up", "red_box")}
    return replace(sighting, graph=replace(sighting.graph, relations=relations))


def test_a_block_that_lies_before_the_places_is_none_of_the_scene_and_is_told_where_it_is() -> None:
    watched = Watched()
    sighting = sighting_of(START, watched.clock.ros_now())
    lying = SceneObject("pink_box", "pink", "box", (0.66, 0.02, 0.02))
    graph = replace(sighting.graph, objects=(*sighting.graph.objects, lying))
    watched.watch.receive(replace(sighting, graph=graph))
    scene = watched.watch.latest()
    assert (scene.stacks, scene.names) == (START, ("blue_box", "green_box", "red_box"))
    with pytest.raises(ObjectLostError) as told:
        watched.watch.latest(needed=frozenset({"pink_box", "cyan_box"}))
    assert "cyan_box cannot be seen any more" in str(told.value)
    assert "pink_box lies before the places, at (0.66, 0.02) m" in str(told.value)


def unmentioned(sighting: Sighting) -> Sighting:
    relations = sighting.graph.relations - {Relation("green_box", "up", "stack1")}
    objects = tuple(replace(item, size=(0.045,) * 3) for item in sighting.graph.objects)
    graph = replace(sighting.graph, objects=objects, relations=relations)
    return replace(sighting, graph=graph)


def no_places(sighting: Sighting) -> Sighting:
    return replace(sighting, graph=replace(sighting.graph, places=(), relations=frozenset()))


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (without_bottom, "do not stand on any base"),
        (two_on_one, "contradicts itself"),
        (unmentioned, "incomplete: objects and relations differ: green_box"),
        (no_places, "no bases"),
        (lambda sighting: replace(sighting, defect="no such thing"), "no such thing"),
        (lambda sighting: replace(sighting, status=GraphStatus.UNSTABLE), "reports UNSTABLE"),
    ],
)
def test_a_scene_graph_that_makes_no_sense_is_refused(
    damage: Callable[[Sighting], Sighting], sentence: str
) -> None:
    watched = Watched()
    watched.watch.receive(damage(sighting_of(START, watched.clock.ros_now())))
    with pytest.raises(NotConfidentError, match=sentence):
        watched.watch.latest()


def test_the_least_confidence_can_be_changed_while_it_runs() -> None:
    watched = Watched()
    watched.see(confidence=0.2)
    watched.watch.latest()
    watched.settings.update({"min_confidence": 0.5})
    with pytest.raises(NotConfidentError, match=r"0\.20 is below min_confidence 0\.50"):
        watched.watch.latest()


def test_a_scene_is_waited_for() -> None:
    watched = Watched()

    def appear() -> None:
        if watched.clock.seconds > 1003.0:
            watched.see()

    watched.clock.on_wait = appear
    assert watched.watch.wait(never).stacks == START
    assert 1003.0 < watched.clock.seconds < 1003.2


def test_waiting_ends_with_what_was_wrong_last() -> None:
    watched = Watched(perceive_timeout=2.0)
    watched.clock.on_wait = lambda: watched.see(status=GraphStatus.OCCLUDED)
    with pytest.raises(NotConfidentError, match="OCCLUDED"):
        watched.watch.wait(never)
    assert watched.clock.seconds == pytest.approx(1002.0, abs=0.06)


def test_waiting_can_be_cancelled() -> None:
    watched = Watched()
    with pytest.raises(CancelledError):
        watched.watch.wait(lambda: watched.clock.seconds > 1001.0)
    assert watched.clock.seconds < 1001.2


def test_fault_13_what_perception_refuses_is_told_however_rarely_it_says_so() -> None:
    """A simulation at four times real time: 2 s between two refusals are 8 s of its time."""
    watched = Watched()
    watched.see(8.0, status=GraphStatus.BAD_IMAGE, message="no camera/segmentation arrives")
    with pytest.raises(NotConfidentError, match="no camera/segmentation arrives"):
        watched.watch.latest()


BEHIND = (("red_box", "blue_box"), ("hidden_stack1",), ())


class Asked(Watched):
    """Something is hidden, and a camera was asked to look from elsewhere."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.clock.on_wait = self.see_less
        self.see_less()

    def see_less(self) -> None:
        stamp = self.clock.ros_now()
        fields = {"status": GraphStatus.HIDDEN, "view_requested": True}
        self.watch.receive(sighting_of(BEHIND, stamp, **fields))

    def waited(self) -> float:
        """How long it waits for a scene [s]."""
        start = self.clock.seconds
        self.watch.wait(never)
        return self.clock.seconds - start


def test_a_camera_that_was_asked_to_look_from_elsewhere_is_waited_for() -> None:
    asked = Asked(view_timeout=3.0)
    there = asked.clock.seconds + 1.0
    asked.clock.on_wait = lambda: asked.see() if asked.clock.seconds > there else asked.see_less()
    assert asked.watch.wait(never).stacks == START


def test_one_that_does_not_go_there_is_waited_for_once() -> None:
    asked = Asked(view_timeout=3.0)
    assert 3.0 <= asked.waited() < 4.0
    assert asked.watch.wait(never).hidden == (1,)
    assert asked.waited() == 0.0
    asked.see(status=GraphStatus.OCCLUDED)  # by the arm, which moves something aside
    asked.see_less()
    assert asked.waited() == 0.0
    asked.see()
    assert asked.waited() == 0.0
    asked.see_less()  # what it was asked before is over
    assert asked.waited() >= 3.0


def test_what_is_hidden_but_remembered_needs_no_other_view() -> None:
    asked = Asked(view_timeout=3.0)
    remembered = asked.watch.wait(never, recall=lambda scene: replace(scene, stacks=START))
    assert remembered.stacks == START
    assert asked.clock.seconds == Asked().clock.seconds
