# SPDX-License-Identifier: Apache-2.0
"""The catalogue is what the issue asks for; outcomes are judged and told as they should be."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
import write_results_page
from eval_faults import FIRST_SEED, plan_tasks, seed_of
from faults.askers import Answer
from faults.catalogue import CATALOGUE, UnknownFaultError, faults_named
from faults.fault import Ending, Fault, Phase, names_the_cause
from faults.injections import Cancelled
from faults.judge import arm_untruth, ending_of, holds, untidy
from faults.numbered import NUMBERED, numbered_table
from faults.numbered import tests_that_name as by_number
from faults.report import command_of, dictionary, make_rows, problems
from faults.setting import parameters_by_node
from faults.small_tasks import (
    first_layout,
    other_layout,
    some_moves_away,
    two_blocks_swapped,
    without_top,
)
from faults.topics import LABELS

from perception_node.segment import SEGMENTATION_TOPIC
from scene_graph import Place, SceneGraph, SceneObject, Stacks, up_relations

RED_ON_BLUE: Stacks = (("blue_box", "red_box"), (), ())
APART: Stacks = (("blue_box",), ("red_box",), ())
FAULT = Fault(
    "depth-lost", "no depth", Cancelled(), (Phase.PERCEIVE,), (("depth",), ("lost", "no"))
)


def truth(stacks: Stacks) -> SceneGraph:
    objects = tuple(SceneObject(name, "red", "box") for stack in stacks for name in stack)
    places = tuple(Place(index, (0.0, 0.0, 0.0)) for index in range(len(stacks)))
    return SceneGraph(objects, up_relations(stacks), places)


def trial(ending: Ending = Ending.REACHED, **changes: Any) -> dict[str, Any]:
    values = {
        "fault": "depth-lost", "phase": "perceive", "trial": 0, "seed": 1000, "goal": "red on blue",
        "injected": True, "ending": ending.value, "status": "SUCCESS", "message": "all is well",
        "causes": [], "replans": 0, "untrue": "", "stuck": "", "poisoned": "",
    }  # fmt: skip
    return values | changes


# The catalogue


def test_there_are_at_least_sixty_kinds_with_names_of_their_own() -> None:
    assert len({fault.name for fault in CATALOGUE}) == len(CATALOGUE) >= 60


@pytest.mark.parametrize("fault", CATALOGUE, ids=lambda fault: fault.name)
def test_declaration_is_complete(fault: Fault) -> None:
    assert fault.what and fault.phases and fault.words
    assert fault.name == fault.name.lower() and " " not in fault.name and "_" not in fault.name
    assert fault.seconds is None or 0.0 < fault.seconds <= 5.0


def test_every_phase_and_every_relayed_stream_is_hit() -> None:
    assert {phase for fault in CATALOGUE for phase in fault.phases} == set(Phase)
    relayed = {topic for fault in CATALOGUE for topic in fault.topics}
    for topic in ("camera/image_raw", "joint_trajectory", "joint_states", "motion_status"):
        assert topic in relayed
    assert {"symbolic_plan", "clock"} <= relayed


def test_a_name_finds_its_fault_and_a_part_finds_all() -> None:
    assert [fault.name for fault in faults_named("cancelled")] == ["cancelled"]
    assert len(faults_named("stands-still")) == 8
    assert faults_named("") == CATALOGUE
    assert [fault.name for fault in faults_named("crowd,cancelled")] == ["cancelled", "crowd"]
    with pytest.raises(UnknownFaultError, match="cancelled"):
        faults_named("no such fault")


def test_trials_are_spread_over_the_phases_with_seeds_that_stay() -> None:
    (fault,) = faults_named("cancelled")
    tasks = plan_tasks([fault], 5, None, None)
    assert {task.phase for task in tasks} == set(Phase)
    assert len({task.path for task in tasks}) == len({task.seed for task in tasks}) == 5
    assert all(task.seed >= FIRST_SEED for task in tasks)


def test_the_command_that_is_printed_runs_the_same_trial() -> None:
    (fault,) = faults_named("cancelled")
    (printed,) = plan_tasks([fault], 5, Phase.CONFIRM, 1234)
    assert (printed.phase, printed.seed) == (Phase.CONFIRM, 1234)
    assert printed.path not in [task.path for task in plan_tasks([fault], 5, None, None)]
    command = command_of(trial(fault="cancelled", phase="confirm", seed=1234))
    assert command == "make eval-faults ONLY=cancelled PHASE=confirm SEED=1234"
    assert seed_of(fault, 1) == seed_of(fault, 0) + 1


def test_a_detector_is_damaged_where_its_labels_are_heard() -> None:
    for fault in CATALOGUE:
        mask_source = parameters_by_node(fault.parameters).get("perception_node", {})
        if fault.topics == {LABELS}:
            assert mask_source == {"mask_source": SEGMENTATION_TOPIC}, fault.name
        else:
            assert not mask_source, fault.name


def test_trials_with_the_same_parameters_share_a_graph() -> None:
    tasks = plan_tasks(
        faults_named("labels-merged,image-black,labels-none,depth-nan"), 2, None, None
    )
    kinds = [graph for graph, _ in groupby(tasks, key=lambda task: task.graph)]
    assert len(kinds) == 2
    assert {parameters for _, parameters in kinds} == {
        (),
        (("perception_node", "mask_source", SEGMENTATION_TOPIC),),
    }


# Small tasks


@pytest.mark.parametrize("seed", range(1000, 1040))
def test_goals_are_reachable_and_not_reached(seed: int) -> None:
    start = first_layout(seed)
    for moves in (1, 2):
        goal = some_moves_away(start, moves, seed)
        assert goal != start
        assert sorted(sum(goal, ())) == sorted(sum(start, ()))


@pytest.mark.parametrize("seed", range(1000, 1010))
def test_worlds_change_as_they_say(seed: int) -> None:
    start = first_layout(seed)
    for change in (other_layout, two_blocks_swapped):
        assert sorted(sum(change(start, seed), ())) == sorted(sum(start, ()))
        assert change(start, seed) != start
    assert len(sum(without_top(start, seed), ())) == len(sum(start, ())) - 1


# The judge


def test_goal_is_judged_by_the_truth() -> None:
    assert holds("red on blue", truth(RED_ON_BLUE))
    assert not holds("red on blue", truth(APART))
    assert not holds("red on blue", None)
    assert not holds("red on green", truth(RED_ON_BLUE))


@pytest.mark.parametrize(("fallen", "reached"), [("green_box", True), ("red_box", False)])
def test_a_block_that_stands_nowhere_counts_only_if_the_goal_is_of_it(
    fallen: str, reached: bool
) -> None:
    stacks = tuple(tuple(name for name in stack if name != fallen) for stack in RED_ON_BLUE)
    standing = truth(stacks)
    lies = SceneObject(fallen, "red", "box", (0.5, -0.4, 0.02))
    assert holds("red on blue", replace(standing, objects=(*standing.objects, lies))) is reached


def test_a_claim_that_is_not_so_is_a_false_success() -> None:
    claim = Answer("SUCCESS", "the camera confirms it")
    assert ending_of(FAULT, "red on blue", claim, truth(APART), None)[0] is Ending.FALSE_SUCCESS
    assert ending_of(FAULT, "red on blue", claim, truth(RED_ON_BLUE), None)[0] is Ending.REACHED


def test_a_world_that_changes_after_the_picture_makes_no_claim_wrong() -> None:
    claim = Answer("SUCCESS", "the camera confirms it")
    ending, _ = ending_of(FAULT, "red on blue", claim, truth(APART), truth(RED_ON_BLUE))
    assert ending is Ending.REACHED


def test_a_refusal_must_name_the_cause_in_message_or_causes() -> None:
    def ending(answer: Answer) -> Ending:
        return ending_of(FAULT, "red on blue", answer, truth(APART), None)[0]

    assert ending(Answer("NOT_CONFIDENT", "No depth image")) is Ending.REFUSED
    assert ending(Answer("TOO_MANY_REPLANS", "gave up", ("depth was lost",))) is Ending.REFUSED
    assert ending(Answer("NOT_CONFIDENT", "brown_box is in the air")) is Ending.WRONG_SENTENCE
    assert ending(Answer("INTERNAL_ERROR", "no depth: KeyError")) is Ending.WRONG_SENTENCE
    assert ending_of(FAULT, "red on blue", None, None, None)[0] is Ending.HUNG


def test_each_group_of_words_must_be_said() -> None:
    assert names_the_cause("The Depth image is LOST", FAULT.words)
    assert not names_the_cause("depth", FAULT.words)


def test_an_arm_that_rests_does_not_move_and_a_held_block_stands_nowhere() -> None:
    resting = Answer("MOTION_FAILED", "…", arm="resting", held="red_box")
    assert "it moves" in arm_untruth(resting, None, moves=True)
    assert "blue_box" in arm_untruth(resting, truth(RED_ON_BLUE), moves=False)
    assert not arm_untruth(resting, truth((("blue_box",), (), ())), moves=False)
    assert not arm_untruth(Answer("X", "…", arm="moving"), None, moves=True)


def test_a_scene_is_tidy_while_blocks_stand_in_the_middle_of_what_is_beneath_them() -> None:
    def scene(red: tuple[float, float, float], blue: tuple[float, float, float]) -> SceneGraph:
        objects = (
            SceneObject("red_box", "red", "box", red),
            SceneObject("blue_box", "blue", "box", blue),
        )
        return SceneGraph(objects, up_relations(RED_ON_BLUE), (Place(0, (0.5, 0.0, 0.0)),))

    assert untidy(scene((0.5, 0.01, 0.07), (0.51, 0.01, 0.02))) == ""
    assert (
        untidy(scene((0.54, 0.03, 0.07), (0.54, 0.03, 0.02)))
        == "blue_box stands 50 mm beside stack0"
    )
    assert (
        untidy(scene((0.52, 0.0, 0.07), (0.5, 0.0, 0.02))) == "red_box stands 20 mm beside blue_box"
    )


# The report


def test_a_transient_fault_must_be_reached() -> None:
    refused = trial(Ending.REFUSED, fault="camera-lost-3s")
    assert problems(refused) == ["not reached"]
    assert problems(trial(Ending.REFUSED)) == []
    assert problems(trial(Ending.HUNG, stuck="…")) == ["hung", "stuck"]


def test_what_no_camera_can_tell_is_counted_apart() -> None:
    wrong = trial(Ending.FALSE_SUCCESS, fault="colours-exchanged")
    assert problems(wrong) == []
    rows = {(row.set, row.metric): row for row in make_rows([wrong, trial()])}
    assert rows["what a camera can tell", "false success"].value == 0
    assert rows["what no camera can tell", "false success"].value == 1


def test_rows_hold_the_bounds_of_the_issue() -> None:
    trials = [trial(), trial(Ending.REFUSED, stuck="x"), trial(Ending.HUNG, poisoned="y")]
    rows = {row.metric: row for row in make_rows(trials)}
    assert rows["reached, or refused with the cause named"].value == pytest.approx(2 / 3)
    assert not rows["hung: no answer in 60 s, none to a cancel in 10 s"].holds
    assert not rows["stuck: a plain task fails until the world is reset"].holds
    assert not rows["poisoned: a plain task fails even then"].holds


def test_dictionary_joins_what_is_alike_and_says_how_to_run_what_is_bad_again() -> None:
    entries = dictionary([trial(trial=0), trial(trial=1), trial(Ending.HUNG, trial=2, seed=1002)])
    assert [(entry["ending"], entry["n"]) for entry in entries] == [("reached", 2), ("hung", 1)]
    assert entries[1]["again"].endswith("SEED=1002")
    table = "\n".join(write_results_page.dictionary_table(entries))
    assert "| **depth-lost**: no depth image arrives | perceive | reached | 2 |" in table
    assert "SEED=1002" in table


# The numbered faults


def test_every_numbered_fault_says_what_it_was_and_is_and_knows_its_kinds() -> None:
    assert [item.number for item in NUMBERED] == list(range(1, 18))
    for item in NUMBERED:
        assert item.was and item.now
        assert all(faults_named(kind) for kind in item.kinds)


def test_numbered_faults_have_the_tests_that_name_them(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(
        "def test_fault_1_a(): pass\n"
        "def test_b():\n    'holds fault_12 and fault_1'\n"
        "def helper_fault_3(): pass\n"
    )
    assert by_number(tmp_path) == {1: ["test_b", "test_fault_1_a"], 12: ["test_b"]}


def test_numbered_table_counts_the_trials_of_its_kinds() -> None:
    entries = dictionary([trial(fault="fingers-stay-open"), trial(fault="crowd")])
    table = numbered_table(entries, {4: ["test_fault_4"]})
    (fingers,) = [item for item in table if item["number"] == 4]
    assert fingers["trials"] == "1 reached" and fingers["tests"] == ["test_fault_4"]
    page = "\n".join(write_results_page.numbered_table(table))
    assert "| 1 reached | 1 |" in page
