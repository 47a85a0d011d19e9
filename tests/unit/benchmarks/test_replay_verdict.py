# SPDX-License-Identifier: Apache-2.0
"""The second judge reads graphs off poses by the ground truth's rule, and says where they part."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from replay.arm_links import bodies_in
from replay.compare import PUSHED, SLIPPED, SLIPPED_BEFORE, TOPPLED, TOUCHED, compare, relations_of
from replay.grasps import Grasp, grasps, hand_poses, slip
from replay.report import differences_table, make_rows, verdict_details
from replay_scenes import (
    CLOSE,
    EDGE,
    LIFT,
    OPEN,
    TIMES,
    block,
    carried_red,
    recording,
    standing_blue,
    trace,
)
from write_results_page import section

from scene_graph import up_relations
from sim_node.layouts import random_layout
from sim_node.world import World


@pytest.mark.parametrize("seed", [1, 2])
def test_blocks_that_stand_in_pybullet_are_read_as_the_layout(seed: int) -> None:
    layout = random_layout(seed, 6)
    with World() as world:
        world.reset(layout, seed)
        bodies = bodies_in(world)
        assert all(body.size == (0.045,) * 3 for body in bodies if body.mass > 0.0)
        whole = recording(bodies=bodies, places=world.config.stack_positions)
        poses = np.array([[*body.position, *body.quaternion] for body in whole.blocks])
    wanted = sorted((item.subject, item.predicate, item.object) for item in up_relations(layout))
    assert list(relations_of(whole, poses)) == wanted


@given(
    aside=st.floats(-0.08, 0.08),
    gap=st.floats(-0.02, 0.02),
)
@settings(max_examples=60)
def test_a_block_is_on_another_when_it_touches_it_and_its_centre_is_above_it(
    aside: float, gap: float
) -> None:
    lower, upper = (0.5, 0.0, EDGE / 2), (0.5, aside, 1.5 * EDGE + gap)
    whole = recording(bodies=(block("red_box", upper), block("blue_box", lower)))
    poses = np.array([[*upper, 0, 0, 0, 1], [*lower, 0, 0, 0, 1]], dtype=float)
    on = ("red_box", "up", "blue_box") in relations_of(whole, poses)
    if abs(abs(aside) - EDGE / 2) > 1e-6 and abs(abs(gap) - 0.006) > 1e-6:
        assert on == (abs(aside) < EDGE / 2 and abs(gap) < 0.006)


def test_a_grasp_lasts_from_closing_to_opening_and_knows_its_block() -> None:
    (grasp,) = grasps(recording())
    assert grasp.start == pytest.approx(CLOSE + 0.2)
    assert (grasp.end, grasp.block) == (OPEN, "red_box")


def test_fingers_that_close_on_nothing_carry_nothing() -> None:
    still = np.tile(carried_red()[0], (len(TIMES), 1))
    (grasp,) = grasps(recording(trace=trace(red=still)))
    assert grasp.block == ""
    assert np.isnan(slip(grasp, trace(red=still), lambda _joints: np.eye(4)))


def test_slip_is_measured_in_the_hand() -> None:
    # The hand itself moves and turns; the block slides by 3 mm along its x axis.
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shift = 0.003 * np.clip((TIMES - 2.0) / 1.0, 0.0, 1.0)
    positions = TIMES[:, None] * [0.1, 0.0, 0.02] + shift[:, None] * turn[:, 0]
    seen = trace(red=positions)
    seen.joints[:, 0] = TIMES

    def hand(joints: np.ndarray) -> np.ndarray:
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn, joints[0] * np.array([0.1, 0.0, 0.02])
        return pose

    assert slip(Grasp(1.0, 4.0, "red_box"), seen, hand) == pytest.approx(0.003)


def test_the_hand_at_home_points_down_at_the_table() -> None:
    pose = hand_poses(recording())(recording().start)
    assert pose[:3, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-2)


def test_the_same_traces_are_the_same() -> None:
    verdict = compare(recording(), trace())
    assert verdict.same
    assert verdict.moved
    assert verdict.cause == verdict.sentence == ""
    assert verdict.final_deviation == verdict.largest_deviation == 0.0
    assert verdict.parted_at is None


def falls(positions: np.ndarray, at: float, to: tuple[float, float, float]) -> np.ndarray:
    """The same, but from a time on the block lies elsewhere."""
    return np.where((at <= TIMES)[:, None], to, positions)


AWAY = (0.35, 0.3, EDGE / 2)


@pytest.mark.parametrize(
    ("red", "blue", "cause"),
    [
        (falls(carried_red(), LIFT + 0.5, AWAY), None, SLIPPED),
        (falls(carried_red(), OPEN + 0.3, AWAY), None, TOPPLED),
        (None, falls(standing_blue(), LIFT + 0.5, AWAY), PUSHED),
        (None, falls(standing_blue(), 0.5, AWAY), TOUCHED),
    ],
)
def test_where_the_engines_part_is_said(
    red: np.ndarray | None, blue: np.ndarray | None, cause: str
) -> None:
    verdict = compare(recording(), trace(red, blue))
    assert not verdict.same
    assert verdict.cause == cause
    assert verdict.parted_block == ("red_box" if blue is None else "blue_box")
    assert verdict.parted_block in verdict.sentence
    assert ("red_box", "up", "blue_box") in verdict.missing
    assert verdict.final_deviation > 0.2


def test_a_block_that_slipped_in_the_first_engine_only_is_told_from_one_in_the_second() -> None:
    dropped = recording(
        success=False,
        trace=trace(red=falls(carried_red(), LIFT + 0.5, AWAY)),
        relations=(("blue_box", "up", "stack1"),),
    )
    verdict = compare(dropped, trace())
    assert verdict.cause == SLIPPED_BEFORE
    assert verdict.extra == (("red_box", "up", "blue_box"),)


def results_of(*sames: bool) -> dict[str, list[dict[str, Any]]]:
    def verdict(same: bool) -> dict[str, Any]:
        gone = falls(carried_red(), LIFT + 0.5, AWAY)
        content = compare(recording(), trace() if same else trace(red=gone)).to_json()
        return dict(json.loads(json.dumps(content)))

    tasks = [verdict(same) for same in sames]
    return {"tasks": tasks, "still": [{"unrest": 1e-5}], "weak": [verdict(False)]}


def test_the_rows_count_what_is_the_same_and_every_cause() -> None:
    rows = {row.metric: row for row in make_rows(results_of(True, True, False, True), 6, "process")}
    share = rows["same scene graph in MuJoCo"]
    assert (share.value, share.n, share.holds) == (0.75, 4, False)
    assert rows["same scene graph, trivial baseline: the arm does not move"].value == 0.0
    assert rows[f"differs: {SLIPPED}"].value == 0.25
    assert rows["slip in the hand, pybullet"].n == 4


def test_tasks_in_which_nothing_was_executed_do_not_count_as_the_same() -> None:
    results = results_of(True, False)
    results["tasks"].append({**results["tasks"][0], "trajectories": 0})
    rows = {row.metric: row for row in make_rows(results, 6, "process")}
    assert rows["same scene graph in MuJoCo"].value == 0.5
    assert rows["nothing was executed; left out above"].value == pytest.approx(1 / 3)


def test_each_difference_is_on_the_page_with_the_command_that_repeats_it() -> None:
    details = verdict_details(results_of(True, False)["tasks"], "make eval-replay SEED={seed}")
    machine = {"cpu": "Some CPU", "cores": 2, "memory_gib": 24}
    result: dict[str, Any] = {"name": "replay", "command": "make eval-replay", "commit": "abc1234"}
    result |= {"date": "2026-01-31", "machine": machine, "rows": [], "details": details}
    page = section(result, [])
    (line,) = differences_table(details["differences"])[4:]
    assert line in page
    assert SLIPPED in line
    assert "`make eval-replay SEED=7`" in line
    assert "red_box up blue_box" in line
