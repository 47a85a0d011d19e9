# SPDX-License-Identifier: Apache-2.0
"""Plans for many blocks: right, with a proven bound, and the same every time."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable

import pytest
from planner_states import NAMES, distance, random_state, relation_holds

from planner_node.errors import SearchCancelledError
from planner_node.goals import Goal, complete_goal
from planner_node.search import Problem, bounded, make_plan, part_bounds, reinsertion, search
from planner_node.search.construct import constructed
from planner_node.search.limits import Limits
from planner_node.search.patterns import pattern_count
from planner_node.search.reinsertion import Reinsertion, shortened, shortened_in_python, steps_of
from planner_node.validator import validate_plan
from scene_graph import Move, Relation, Stacks, apply_move


def many(count: int) -> tuple[str, ...]:
    return tuple(f"block{index:02}" for index in range(count))


def problem(blocks: int, places: int, seed: int) -> tuple[Stacks, Stacks]:
    rng = random.Random(seed)
    return random_state(many(blocks), places, rng), random_state(many(blocks), places, rng)


@pytest.mark.parametrize(("blocks", "places"), [(14, 3), (20, 3), (20, 4)])
def test_many_blocks_are_arranged_and_the_bound_is_told(blocks: int, places: int) -> None:
    initial, target = problem(blocks, places, 3)
    found = make_plan(initial, complete_goal(target), algorithm="bounded", max_expansions=10**7)
    assert found.states[-1] == target
    assert 1.0 <= found.bound < 2.0


@pytest.mark.parametrize("in_c", [True, False])
@pytest.mark.parametrize("size", [1, 2, 4])
@pytest.mark.parametrize("seed", range(2))
def test_the_bound_is_true(
    monkeypatch: pytest.MonkeyPatch, in_c: bool, size: int, seed: int
) -> None:
    patterns = pattern_count(3, size, 0)
    monkeypatch.setattr(bounded, "TABLE", 9 * patterns)
    monkeypatch.setattr(part_bounds, "TABLE", 6 * patterns)
    if not in_c:
        for module in (part_bounds, reinsertion):
            monkeypatch.setattr(module, "written", lambda _file: None)
    initial, target = problem(11, 3, seed)
    goal = complete_goal(target)
    shortest = make_plan(initial, goal, algorithm="patterns")
    assert shortest.bound == 1.0
    limits = Limits(initial, goal)
    found = len(bounded.bounded(Problem(initial, goal), limits)) - 1
    assert limits.at_least is not None
    assert limits.at_least <= len(shortest.moves) <= found


def test_few_blocks_get_a_shortest_plan() -> None:
    rng = random.Random(4)
    initial, target = random_state(NAMES[:5], 3, rng), random_state(NAMES[:5], 3, rng)
    found = make_plan(initial, complete_goal(target), algorithm="bounded")
    assert (len(found.moves), found.bound) == (
        distance(initial, lambda state: state == target),
        1.0,
    )


def test_it_is_deterministic() -> None:
    initial, target = problem(16, 3, 5)
    one, other = (search(initial, complete_goal(target), algorithm="bounded") for _ in range(2))
    assert (one.moves, one.expanded, one.bound) == (other.moves, other.expanded, other.bound)


def test_limits_hold_for_its_parts_too() -> None:
    initial, target = problem(16, 3, 1)
    goal = complete_goal(target)
    # There is a plan by then, and a bound, which is not raised any more.
    found = search(initial, goal, algorithm="bounded", max_expansions=20)
    assert found.expanded == 20
    assert found.bound > search(initial, goal, algorithm="bounded").bound
    polls = 0

    def cancelled() -> bool:
        nonlocal polls
        polls += 1
        return polls > 20

    with pytest.raises(SearchCancelledError):
        search(initial, goal, algorithm="bounded", cancelled=cancelled)
    assert polls == 21


@pytest.mark.parametrize("places", [3, 4, 6])
@pytest.mark.parametrize("seed", range(20))
def test_a_constructed_plan_leads_to_the_target(places: int, seed: int) -> None:
    initial, target = problem(9, places, seed)
    moves = constructed(initial, target, random.Random(seed))
    validate_plan(initial, complete_goal(target), moves)


@pytest.mark.parametrize("way", [shortened, shortened_in_python])
@pytest.mark.parametrize("places", [3, 4, 6])
@pytest.mark.parametrize("seed", range(10))
def test_reinsertion_leads_to_the_target_with_no_more_moves(
    way: Callable[..., list[Move]], places: int, seed: int
) -> None:
    initial, target = problem(9, places, seed)
    moves = constructed(initial, target, random.Random(seed))
    shorter = way(initial, target, moves, 0, 2_000, Limits(initial, complete_goal(target)))
    validate_plan(initial, complete_goal(target), shorter)
    assert len(shorter) <= len(moves)


@pytest.mark.parametrize("seed", range(8))
def test_putting_all_blocks_back_again_and_again_leads_to_a_shortest_plan(seed: int) -> None:
    initial, target = problem(5, 3, seed)
    moves = constructed(initial, target, random.Random(seed))
    limits = Limits(initial, complete_goal(target))
    shorter = shortened(initial, target, moves, 0, 200_000, limits)
    assert len(shorter) == distance(initial, lambda state: state == target)


@pytest.mark.parametrize("seed", range(20))
def test_one_block_is_put_back_with_the_fewest_moves(seed: int) -> None:
    """Among the moves of all others, which stay: breadth-first search says how few there can be."""
    initial, target = problem(5, 3, seed)
    moves = constructed(initial, target, random.Random(seed))
    steps = steps_of(initial, moves)
    putting = Reinsertion(initial, target)
    for name in {step.block for step in steps}:
        again = putting.again(steps, [name])
        assert again is not None
        others = [(step.source, step.target) for step in steps if step.block != name]
        assert [(s.source, s.target) for s in again if s.block != name] == others
        validate_plan(initial, complete_goal(target), [Move(s.source, s.target) for s in again])
        assert len(again) - len(others) == fewest_among(initial, target, name, others)


def fewest_among(initial: Stacks, target: Stacks, name: str, others: list[tuple[int, int]]) -> int:
    """Moves of one block that let the others' moves happen in their order."""
    queue = deque([(initial, 0, 0)])
    best: dict[tuple[Stacks, int], int] = {(initial, 0): 0}
    while queue:
        stacks, done, own = queue.popleft()
        if best[stacks, done] < own:
            continue
        following = []
        if done < len(others):
            source, to = others[done]
            if stacks[source] and stacks[source][-1] != name:
                following.append((apply_move(stacks, Move(source, to)), done + 1, own))
        for source, stack in enumerate(stacks):
            if stack and stack[-1] == name:
                following += [
                    (apply_move(stacks, Move(source, to)), done, own + 1)
                    for to in range(len(stacks))
                    if to != source
                ]
        for after, count, cost in following:
            if cost < best.get((after, count), 99):
                best[after, count] = cost
                queue.append((after, count, cost))
    return best[target, len(others)]


def test_two_blocks_among_thirty_are_planned_for_with_the_fewest_moves() -> None:
    rng = random.Random(6)
    initial = random_state(many(30), 5, rng)
    goal = Goal((Relation(initial[0][-1], "up", initial[1][-1]),))
    found = make_plan(initial, goal)
    assert len(found.moves) == 1
    assert relation_holds(found.states[-1], goal.relations[0])
