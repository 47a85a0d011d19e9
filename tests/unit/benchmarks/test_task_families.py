# SPDX-License-Identifier: Apache-2.0
"""Tasks are drawn by their seed alone, within what their family declares, and can be done."""

from __future__ import annotations

import itertools
import json
import math
from collections import deque
from dataclasses import replace

import numpy as np
import pytest
from tasks.draw import Task, draw_task, reachable_goal, unknown_parameters
from tasks.family import FAMILIES, Family, Row, UnknownFamilyError, family_named, family_of

from perception_node.segment import SEGMENTERS
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import Stacks
from sim_node.layouts import all_layouts, random_layout
from sim_node.scene import CameraConfig
from tamp_bringup.task import goal_text, random_goal

VARIED, VARIED_MASKS = family_named("varied"), family_named("varied_masks")
SEEDS = range(60)

every_family = pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
every_seed = pytest.mark.parametrize("seed", SEEDS)


def names_of(layout: Stacks) -> list[str]:
    return sorted(name for stack in layout for name in stack)


def states_reached_from(start: Stacks) -> set[Stacks]:
    """Breadth first, move by move."""
    seen, waiting = {start}, deque([start])
    while waiting:
        state = waiting.popleft()
        for source, stack in enumerate(state):
            for target in range(len(state)):
                if not stack or source == target:
                    continue
                moved = [list(blocks) for blocks in state]
                moved[target].append(moved[source].pop())
                after = tuple(tuple(blocks) for blocks in moved)
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
    return seen


def scene_of(task: Task) -> dict:
    assert task.scene is not None
    return dict(task.scene)


# All families


@every_family
def test_a_seed_means_the_same_task_whenever_it_is_drawn(family: Family) -> None:
    tasks = [draw_task(family, seed) for seed in SEEDS]
    assert tasks == [draw_task(family, seed) for seed in SEEDS]
    assert len({json.dumps(task.to_json()) for task in tasks}) > len(SEEDS) // 2


@every_family
def test_a_task_that_was_written_down_is_the_same_task(family: Family) -> None:
    for seed in SEEDS:
        task = draw_task(family, seed)
        assert Task.from_json(json.loads(json.dumps(task.to_json()))) == task


@every_family
def test_the_goal_names_blocks_of_the_start(family: Family) -> None:
    """All of them, but where half of the goals say only what is in front of what."""
    for seed in SEEDS:
        task = draw_task(family, seed)
        names = names_of(task.layout)
        assert family.blocks[0] <= len(names) <= family.blocks[1]
        assert len(set(names)) == len(names)
        named = {name for name in names if name in task.goal}
        assert named == set(names) or (family.rows is not None and named)


def test_plain_tasks_are_those_that_have_always_been_run() -> None:
    for blocks in (6, 7):
        for seed in (1000, 1001, 1019):
            task = draw_task(family_of(blocks), seed)
            layout = random_layout(seed, blocks)
            assert task.layout == layout
            assert task.goal == goal_text(random_goal(names_of(layout), seed))
            assert task.scene is None and not task.parameters and not task.disturbance


def test_plain_families_keep_the_names_of_their_files() -> None:
    assert family_named("six").result == family_of(6).result == "tasks_6"
    assert family_named("seven").result == "tasks_7"
    assert VARIED.result == "tasks_varied"


def test_an_unknown_family_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(UnknownFamilyError, match="varied"):
        family_named("sixty")
    with pytest.raises(UnknownFamilyError, match="3 to 7"):
        family_of(9)


# The varied family


@every_seed
def test_sizes_and_places_are_within_what_is_declared(seed: int) -> None:
    task, row = draw_task(VARIED, seed), VARIED.row
    assert row is not None and VARIED.sizes is not None
    scene = scene_of(task)
    for named in scene["blocks"]["named"].values():
        assert set(named["size"]) == {named["size"][0]}
        assert VARIED.sizes[0] <= named["size"][0] <= VARIED.sizes[1]
    assert sorted(scene["blocks"]["named"]) == names_of(task.layout)
    places = scene["places"]
    assert row.count[0] <= len(places) == len(task.layout) <= row.count[1]
    for x, y in places:
        assert row.reach[0] <= math.hypot(x, y) <= row.reach[1]
    gaps = [math.dist(one, other) for one, other in itertools.pairwise(places)]
    assert all(row.gap[0] - 2e-4 <= gap <= row.gap[1] + 2e-4 for gap in gaps)
    assert [y for _, y in places] == sorted(y for _, y in places)


@every_seed
def test_places_are_on_one_line(seed: int) -> None:
    places = np.array(scene_of(draw_task(VARIED, seed))["places"])
    deviation = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    assert deviation[1] < 1e-3


@every_seed
def test_the_camera_is_turned_as_far_as_is_declared_and_sees_every_possible_stack(
    seed: int,
) -> None:
    task = draw_task(VARIED, seed)
    scene = scene_of(task)
    entry, places = scene["cameras"][0], np.array(scene["places"])
    along = places[-1] - places[0]
    front = np.array([along[1], -along[0]])
    view = np.array(entry["position"][:2]) - entry["target"][:2]
    angle = math.degrees(math.atan2(front[0] * view[1] - front[1] * view[0], float(front @ view)))
    assert abs(angle) <= 15.1
    assert angle == pytest.approx(task.drawn["camera angle"], abs=0.1)
    camera = CameraConfig(
        entry["width"], entry["height"], tuple(entry["position"]), tuple(entry["target"]),
        entry["vertical_fov"],
    )  # fmt: skip
    highest = sum(named["size"][0] for named in scene["blocks"]["named"].values())
    for x, y in places:
        for height in (0.0, highest):
            point = np.linalg.inv(camera.world_from_optical) @ [x, y, height, 1.0]
            u, v, depth = camera.intrinsics @ point[:3]
            assert 0.0 < u / depth < entry["width"] and 0.0 < v / depth < entry["height"]
    columns = [
        (camera.intrinsics @ (np.linalg.inv(camera.world_from_optical) @ [x, y, 0.0, 1.0])[:3])
        for x, y in places
    ]
    across = [column[0] / column[2] for column in columns]
    assert across == sorted(across)  # numbered from the left of the image


@every_seed
def test_perception_is_told_where_the_places_are(seed: int) -> None:
    task = draw_task(VARIED, seed)
    told = task.parameters["perception_node"]["stack_positions"]
    assert [[x, y] for x, y in zip(told[0::3], told[1::3])] == scene_of(task)["places"]
    assert set(told[2::3]) == {0.0}


def test_every_number_of_places_and_of_blocks_and_both_sides_occur() -> None:
    tasks = [draw_task(VARIED, seed) for seed in range(200)]
    assert {task.drawn["places"] for task in tasks} == {2, 3, 4, 5}
    assert {task.drawn["blocks"] for task in tasks} == {4, 5, 6}
    angles = [float(task.drawn["camera angle"]) for task in tasks]
    assert min(angles) < -10.0 and max(angles) > 10.0
    sizes = [float(task.drawn["smallest block"]) for task in tasks]
    assert min(sizes) >= 3.0 and max(sizes) > 4.5


@every_seed
def test_no_goal_holds_from_the_start(seed: int) -> None:
    task = draw_task(VARIED, seed)
    goal = resolve_goal(parse_goal(task.goal), names_of(task.layout))
    assert not goal.holds(task.layout)


@pytest.mark.parametrize("start", [(("a", "b"), ("c",)), (("a", "b", "c", "d"), ())])
def test_goals_of_two_places_are_exactly_what_moves_can_reach(start: Stacks) -> None:
    rng = np.random.default_rng(0)
    assert {reachable_goal(start, rng) for _ in range(300)} == states_reached_from(start)


def test_with_three_places_every_state_can_be_reached_and_is_drawn() -> None:
    start: Stacks = (("a", "b", "c"), (), ())
    rng = np.random.default_rng(0)
    reached = states_reached_from(start)
    assert reached == set(all_layouts(["a", "b", "c"]))
    assert {reachable_goal(start, rng) for _ in range(2000)} == reached


@every_seed
def test_pictures_are_as_of_a_real_camera_with_the_seed_of_the_task(seed: int) -> None:
    task = draw_task(VARIED, seed)
    parameters = task.parameters["sim_node"]
    assert parameters["sensor.depth.noise"] == 0.0015
    assert parameters["sensor.segmentation.kind"] == task.drawn["masks"]
    assert parameters["sensor.segmentation.strength"] == 1
    assert parameters["sensor.seed"] == seed


def test_every_kind_of_mask_error_and_every_disturbance_occurs() -> None:
    kinds = {draw_task(VARIED, seed).drawn["masks"] for seed in range(100)}
    assert kinds == set(VARIED.masks)
    disturbed = family_named("disturbed")
    drawn = [draw_task(disturbed, seed) for seed in range(100)]
    assert len({task.drawn["disturbance"] for task in drawn}) == len(disturbed.disturbances)
    assert all(task.disturbance in disturbed.disturbances for task in drawn)


@every_seed
def test_the_varied_tasks_can_be_run_with_the_masks_of_a_detector_and_are_the_same_else(
    seed: int,
) -> None:
    found, given = draw_task(VARIED, seed), draw_task(VARIED_MASKS, seed)
    told = dict(given.parameters["perception_node"])
    assert told.pop("mask_source") == "segmentation_topic"
    expected = {**found.parameters, "perception_node": told}
    assert replace(given, family="varied", parameters=expected) == found
    assert "mask_source" not in found.parameters["perception_node"]


def test_both_varied_families_have_the_same_bound_and_rows_and_files_of_their_own() -> None:
    assert VARIED.success == VARIED_MASKS.success == 0.95
    assert VARIED_MASKS.result == "tasks_varied_masks"
    assert len({family.what.split(",")[0] for family in (VARIED, VARIED_MASKS)}) == 2
    assert VARIED_MASKS.mask_source in SEGMENTERS


def test_a_disturbed_task_is_a_plain_one_in_which_something_goes_wrong() -> None:
    plain, disturbed = draw_task(family_of(6), 5), draw_task(family_named("disturbed"), 5)
    assert (plain.layout, plain.goal) == (disturbed.layout, disturbed.goal)
    assert not plain.disturbance and disturbed.disturbance


def test_a_row_that_cannot_be_in_reach_is_refused() -> None:
    far = replace(VARIED, row=Row(reach=(2.0, 2.1), bearing=0.01, count=(5, 5)))
    with pytest.raises(RuntimeError, match="in reach"):
        draw_task(far, 0)


def test_parameters_that_a_node_would_pass_over_are_found() -> None:
    task = draw_task(VARIED, 0)
    known = {"sim_node": ["real_time_factor"], "perception_node": ["stack_positions"]}
    assert "sim_node.scene" in unknown_parameters(task, known)
    known["sim_node"] += ["scene", *task.parameters.get("sim_node", {})]
    assert unknown_parameters(task, known) == []
