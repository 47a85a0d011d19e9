# SPDX-License-Identifier: Apache-2.0
"""What may stand on what: as physics says, as blocks are seen, and as the validator reads it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import pybullet
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stable_states import random_problem, rules

from planner_node import Figure, SearchResult, Stability, Unstable, make_stable_plan, stability_of
from planner_node.errors import PlannerError
from planner_node.search.stability import figure_of
from planner_node.validator import InvalidPlanError, validate_stability
from scene_graph import Move, SceneObject, Stacks, quaternion_from_yaw

EDGE = 0.04
#: How far beside the middle of what it stands on the motion node puts a block, in its width.
OVERHANG = 0.2
RIDGE = 2**-0.5


@pytest.fixture
def world() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
    pybullet.setPhysicsEngineParameter(numSolverIterations=200, physicsClientId=client)
    ground = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    pybullet.createMultiBody(0, ground, physicsClientId=client)
    yield client
    pybullet.disconnect(client)


def put(world: int, shape: str, width: float, x: float, bottom: float, mass: float = 0.08) -> int:
    """A block of height EDGE, or a ball, with its lowest point at ``bottom``; its body."""
    half = 0.5 * EDGE
    if shape == "sphere":
        form = {"shapeType": pybullet.GEOM_SPHERE, "radius": half}
    elif shape == "prism":
        corners = [(-half, -half), (half, -half), (0.0, half)]
        points = [[a, y, z] for a, z in corners for y in (-half, half)]
        form = {"shapeType": pybullet.GEOM_MESH, "vertices": points}
    else:
        extents = [0.5 * width, 0.5 * width, half]
        form = {"shapeType": pybullet.GEOM_BOX, "halfExtents": extents}
    body = pybullet.createCollisionShape(**form, physicsClientId=world)
    where = [x, 0.0, bottom + half]
    return int(pybullet.createMultiBody(mass, body, -1, where, physicsClientId=world))


def stays(world: int, body: int) -> bool:
    """Whether a body is as high after two seconds as it was."""
    height = pybullet.getBasePositionAndOrientation(body, physicsClientId=world)[0][2]
    for _ in range(480):
        pybullet.stepSimulation(physicsClientId=world)
    after = pybullet.getBasePositionAndOrientation(body, physicsClientId=world)[0][2]
    return bool(abs(after - height) < 0.25 * EDGE)


@pytest.mark.parametrize("shape", ["sphere", "prism", "box"])
def test_from_round_and_sharp_tops_a_block_falls(world: int, shape: str) -> None:
    put(world, shape, EDGE, 0.0, 0.0)
    upper = put(world, "box", EDGE, 0.002, EDGE)
    stability = Stability({"upper": Figure("box"), "lower": Figure(shape)})
    objection = stability.objection("upper", "lower")
    assert stays(world, upper) == (objection is None)
    assert objection is None or objection.falls


@pytest.mark.parametrize("ratio", [1.0, 1.3, 2.0, 2.3])
def test_what_stands_on_a_much_wider_block_tips_it(world: int, ratio: float) -> None:
    width = ratio * EDGE
    put(world, "box", EDGE, 0.0, 0.0)
    middle = put(world, "box", width, OVERHANG * EDGE, EDGE)
    assert stays(world, middle), "by itself it stands"
    upper = put(world, "box", EDGE, OVERHANG * (EDGE + width), 2 * EDGE, mass=0.5)
    figures = {"middle": Figure("box", width, width), "lower": Figure("box", EDGE, EDGE)}
    objection = Stability(figures).objection("middle", "lower")
    assert stays(world, upper) == (objection is None)
    assert objection is None or not objection.falls


def seen(shape: str, size: tuple[float, float, float], quaternion: object = None) -> SceneObject:
    turn = quaternion or quaternion_from_yaw(0.4)
    return SceneObject(f"red_{shape}", "red", shape, (0.5, 0.0, 0.03), turn, size)  # type: ignore[arg-type]


def test_the_width_of_a_block_is_that_of_its_horizontal_edges() -> None:
    size = (0.03, 0.05, 0.07)
    assert figure_of(seen("box", size)) == Figure("box", 0.05, 0.03)
    lying = figure_of(seen("box", size, (RIDGE, 0.0, 0.0, RIDGE)))
    assert lying == Figure("box", 0.07, 0.03), "its second axis is vertical"


@pytest.mark.parametrize(
    "item",
    [
        SceneObject("red_box", "red", "box"),
        seen("box", (0.05, math.nan, 0.05)),
        seen("box", (0.05, 0.05, 0.05), (0.0, 0.0, 0.0, 0.0)),
    ],
)
def test_of_blocks_that_were_not_measured_nothing_is_said_but_of_their_shape(
    item: SceneObject,
) -> None:
    assert figure_of(item) == Figure("box")
    stability = stability_of([item, seen("sphere", (0.04, 0.04, 0.04))])
    assert stability.objection("red_sphere", "red_box") is None
    assert stability.objection("red_box", "red_sphere") is not None


def test_what_a_block_looks_like_decides_and_not_what_it_is_called() -> None:
    stability = stability_of([replace(seen("sphere", (0.04,) * 3), name="ball_2")])
    assert str(stability.objection("x", "ball_2")) == "x on ball_2 (it would roll off)"
    assert stability.objection("x", "never_seen") is None


START: Stacks = (("red_box",), ("green_sphere",), ("blue_box",))
FIGURES = {
    "red_box": Figure("box", 0.06, 0.06),
    "green_sphere": Figure("sphere", 0.03, 0.03),
    "blue_box": Figure("box", 0.03, 0.03),
}
WIDE = Unstable("red_box", "blue_box", "", falls=False)


@pytest.mark.parametrize(
    ("move", "told", "require", "right"),
    [
        (Move(0, 1), (), False, False),
        (Move(0, 1), (Unstable("red_box", "green_sphere", "", True),), False, False),
        (Move(0, 2), (), False, False),
        (Move(0, 2), (WIDE,), False, True),
        (Move(0, 2), (WIDE,), True, False),
        (Move(2, 0), (), True, True),
        (Move(2, 0), (WIDE,), False, False),
        (Move(1, 2), (), True, True),
    ],
)
def test_the_validator_finds_what_a_plan_should_not_put_or_does_not_tell(
    move: Move, told: tuple[Unstable, ...], require: bool, right: bool
) -> None:
    stability = Stability(FIGURES, require)
    if right:
        validate_stability(START, (move,), stability, told)
    else:
        with pytest.raises(InvalidPlanError):
            validate_stability(START, (move,), stability, told)


@given(seed=st.integers(0, 10**6))
def test_the_validator_and_the_search_agree_on_every_placement(seed: int) -> None:
    figures, initial, goal = random_problem(seed, (3, 4))
    found: SearchResult | None
    try:
        found = make_stable_plan(initial, goal, None)
    except PlannerError:
        return
    stability = rules(figures)
    placed = stability.unstable(initial, found.moves)
    if any(item.falls for item in placed):
        with pytest.raises(InvalidPlanError):
            validate_stability(initial, found.moves, stability, placed)
    else:
        validate_stability(initial, found.moves, stability, placed)
        for item in placed:
            left = [other for other in placed if other != item]
            with pytest.raises(InvalidPlanError):
                validate_stability(initial, found.moves, stability, left)
