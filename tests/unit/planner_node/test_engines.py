# SPDX-License-Identifier: Apache-2.0
"""Engines of Unified Planning as a search algorithm, where they are installed (make peers)."""

from __future__ import annotations

import random

import pytest
from planner_states import NAMES, distance, random_state

from planner_node import EngineError, Goal, Limits, Problem, make_plan
from planner_node.errors import SearchCancelledError, SearchLimitError
from planner_node.goals import complete_goal
from planner_node.parameters import PARAMETERS
from planner_node.search.peers import engine as engines
from planner_node.search.peers.engine import Engine, is_installed
from scene_graph import Relation, Stacks

START: Stacks = (("red_box", "blue_box"), (), ("green_box",))
GOAL = Goal((Relation("red_box", "up", "green_box"),))
#: On a machine that is busy [s].
LONG = 280.0

needs_engines = pytest.mark.skipif(not is_installed(), reason="make peers installs the engines")


def solved(name: str, initial: Stacks, goal: Goal) -> tuple[list[tuple[str, ...]], Limits]:
    limits = Limits(initial, goal)
    return Engine(name, LONG)(Problem(initial, goal), limits), limits


@needs_engines
def test_an_engine_for_shortest_plans_gives_one() -> None:
    rng = random.Random(5)
    initial, target = random_state(NAMES[:4], 3, rng), random_state(NAMES[:4], 3, rng)
    path, limits = solved("fast-downward-opt", initial, complete_goal(target))
    assert len(path) - 1 == distance(initial, lambda state: state == target)
    assert limits.at_least is None


@needs_engines
def test_the_plan_of_another_engine_comes_with_a_bound() -> None:
    goal = Goal(
        (Relation("red_box", "left", "green_box"), Relation("green_box", "above", "stack1"))
    )
    path, limits = solved("fast-downward", START, goal)
    assert limits.at_least is not None
    assert limits.at_least <= 1 <= len(path) - 1


@needs_engines
def test_an_unknown_engine_comes_with_the_known_ones() -> None:
    with pytest.raises(EngineError, match="fast-downward-opt"):
        solved("magic", START, GOAL)


def test_without_the_package_the_sentence_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(engines, "is_installed", lambda: False)
    with pytest.raises(ValueError, match="unified-planning, which is not installed; make peers"):
        make_plan(START, GOAL, algorithm="up:fast-downward")
    spec = next(item for item in PARAMETERS if item.name == "search_algorithm")
    assert "is not installed; make peers" in spec.problem("up:fast-downward")
    assert "such as up:fast-downward" in spec.problem("up:")


def test_an_engine_is_ended_when_it_is_too_slow_or_not_wanted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(engines, "is_installed", lambda: True)
    with pytest.raises(SearchLimitError, match="no plan within 0 s; ask for less"):
        Engine("fast-downward", seconds=0.0)(Problem(START, GOAL), Limits(START, GOAL))
    limits = Limits(START, GOAL, cancelled=lambda: True)
    with pytest.raises(SearchCancelledError):
        Engine("fast-downward", LONG)(Problem(START, GOAL), limits)


@pytest.mark.skipif(is_installed(), reason="there are engines")
def test_what_a_process_says_that_fails_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "is_installed", lambda: True)
    with pytest.raises(EngineError, match="No module named 'unified_planning'") as caught:
        solved("fast-downward", START, GOAL)
    assert caught.value.status == "ENGINE_FAILED"
