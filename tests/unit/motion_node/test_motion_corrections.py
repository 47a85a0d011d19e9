# SPDX-License-Identifier: Apache-2.0
"""A motion under way goes over to a corrected one for a block that was moved, without standing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from executive_bench import Bench, rest_of
from simulated_arm import BLOCKS, OPEN, PLAN, two_moves
from tamp_runtime.motion_report import MotionReason, MotionState

from motion_node.errors import PATH, InfeasibleError
from motion_node.execution.corrections import AHEAD
from motion_node.execution.last_look import PlanSighting
from motion_node.phases import PICK, PLACE
from motion_node.planner import Motion
from scene_graph import Place, SceneGraph, SceneObject, up_relations

Point = tuple[float, float, float]
GRAPH = SceneGraph(
    tuple(SceneObject(name, "blue", "box", (0.5, 0.1 * i, 0.02)) for i, name in enumerate(BLOCKS)),
    up_relations(((BLOCKS[0],), (BLOCKS[1],), ())),
    tuple(Place(i, (0.5, 0.1 * i, 0.0)) for i in range(3)),
)
WATCHED = replace(PLAN, graph=GRAPH, watched=True)


class Corrected(Bench):
    """Everything is seen all the time; some blocks are seen elsewhere.

    Attributes:
        moved: where.
        asked: at which times of which motions a correction was asked for, and where the blocks
            were then.
    """

    def __init__(self) -> None:
        super().__init__()
        self.moved: dict[str, Point] = {}
        self.asked: list[tuple[float, dict[str, Point]]] = []
        self.correct = self.solve
        self.arm.when(lambda: True, self.tell)

    def tell(self) -> None:
        self.arm.when(lambda: True, self.tell)
        if (state := self.arm.newest()) is not None:
            moved = tuple(
                replace(GRAPH.object(name), position_world=at) for name, at in self.moved.items()
            )
            move = self.executive.report.move
            self.sightings.put(PlanSighting("a", state.stamp - 0.1, move, moved=moved))

    def solve(self, now: Motion, at: float, graph: SceneGraph) -> Motion:
        self.asked.append((at, {item.name: item.position_world for item in graph.objects}))
        return rest_of(now, at)

    def jumps(self) -> list[float]:
        """By how much the joints and the beginnings of trajectories differ that replace others."""
        return [float(np.abs(sent.positions.arm[0] - joints.arm).max())
                for sent, joints in self.arm.sent[1:]]  # fmt: skip


@pytest.fixture
def bench() -> Corrected:
    return Corrected()


@pytest.mark.parametrize(("phase", "move"), [(PICK, 0), (PLACE, 0), (PICK, 1)])
def test_what_was_moved_is_corrected_once_and_without_standing(
    bench: Corrected, phase: str, move: int
) -> None:
    """From the next switch on, or on the way to the block."""
    there = (0.53, 0.1, 0.02)
    bench.when(phase, move, lambda: bench.moved.update(blue_box=there))
    end = bench.carry_out(WATCHED)
    assert (end.state, end.moves_done) == (MotionState.SUCCEEDED, 2)
    assert [where for _, where in bench.asked] == [
        {"green_box": (0.5, 0.0, 0.02), "blue_box": there}
    ]
    assert len(bench.arm.sent) == 2
    assert max(bench.jumps()) < 0.05
    speed = np.abs(bench.arm.sent[1][0].velocities.arm[0]).max()
    assert (speed > 0.1) == ((phase, move) == (PICK, 1))
    progress = [
        report.progress for report in bench.reports if report.state is MotionState.EXECUTING
    ]
    assert progress == sorted(progress)


def test_a_correction_that_comes_late_is_joined_where_it_should_be(bench: Corrected) -> None:
    """On a busy machine; begun at its first point the arm would jump, and its driver refuse it."""

    def busy() -> None:
        bench.moved.update(blue_box=(0.53, 0.1, 0.02))
        bench.arm.travels = 0.16

    bench.when(PICK, 1, busy)
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    (_, _), (corrected, joints) = bench.arm.sent
    speed = np.abs(corrected.velocities.arm[0]).max()
    assert speed * bench.arm.travels > 0.1
    assert np.abs(corrected.positions.arm[0] - joints.arm).max() < 0.05
    assert not bench.arm.refused


def test_of_several_moves_each_is_corrected(bench: Corrected) -> None:
    bench.when(PICK, 0, lambda: bench.moved.update(blue_box=(0.53, 0.1, 0.02)))
    bench.when(PLACE, 0, lambda: bench.moved.update(blue_box=(0.53, 0.13, 0.02)))
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert [where["blue_box"][1] for _, where in bench.asked] == [0.1, 0.13]


@pytest.mark.parametrize(("before", "at"), [(2, 3), (0, 1)])
def test_a_correction_begins_where_the_arm_rests_if_it_is_not_on_its_way_to_the_block(
    bench: Corrected, before: int, at: int
) -> None:
    intervals = two_moves().intervals
    bench.arm.when(
        lambda: bench.follower.time > intervals[before].start + 0.01,
        lambda: bench.moved.update(blue_box=(0.53, 0.1, 0.02)),
    )
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert [begins for begins, _ in bench.asked] == [pytest.approx(intervals[at].end)]


def test_what_takes_longer_than_there_was_time_is_tried_further_ahead(bench: Corrected) -> None:
    took = iter([1.1 * AHEAD])

    def slowly(now: Motion, at: float, graph: SceneGraph) -> Motion:
        bench.arm.pass_time(next(took, 0.0))
        return bench.solve(now, at, graph)

    bench.correct = slowly
    bench.when(PICK, 0, lambda: bench.moved.update(green_box=(0.53, 0.0, 0.02)))
    assert bench.carry_out(WATCHED).state is MotionState.SUCCEEDED
    assert len(bench.asked) == 2
    assert len(bench.arm.sent) == 2


def test_what_cannot_be_corrected_under_way_stops_the_arm(bench: Corrected) -> None:
    def never(now: Motion, at: float, graph: SceneGraph) -> Motion:
        raise InfeasibleError(PATH, f"{at:g} {now} {graph}")

    bench.correct = never
    bench.when(PICK, 1, lambda: bench.moved.update(blue_box=(0.53, 0.1, 0.02)))
    end = bench.carry_out(WATCHED)
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.UNSEEN)
    assert end.message.startswith(
        "blue_box was moved, and the way there cannot be corrected without a stop: "
    )
    assert (end.moves_done, end.held) == (1, "")
    assert bench.arm.at_home()


def test_what_is_moved_when_the_hand_is_there_is_not_taken(bench: Corrected) -> None:
    arrives = two_moves().intervals[4].end
    bench.arm.when(
        lambda: bench.follower.time > arrives - 0.1,
        lambda: bench.moved.update(blue_box=(0.53, 0.1, 0.02)),
    )
    end = bench.carry_out(WATCHED)
    assert (end.state, end.reason, end.held) == (MotionState.FAILED, MotionReason.UNSEEN, "")
    assert not bench.asked
    assert bench.arm.at_home()
    np.testing.assert_allclose(bench.arm.joints.fingers, OPEN, atol=1e-3)
