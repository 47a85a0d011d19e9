# SPDX-License-Identifier: Apache-2.0
"""Somebody exchanges two blocks."""

from __future__ import annotations

import pybullet

from scene_graph import SPHERE, UP

from ..ground_truth import true_scene_graph
from ..world import World
from .disturbance import Disturbance, Stage, check_there, named_blocks
from .free_space import in_the_way, reach
from .hand import touched_block
from .request import DisturbanceError, Request, Vector


class Swap(Disturbance):
    """Each of two blocks stands where the other one stood, as it was turned; both at rest."""

    uses = frozenset({"blocks"})

    def __init__(self, request: Request) -> None:
        self._names = named_blocks(request, 2, 2)
        self.sentence = f"{self._names[0]} and {self._names[1]} change places"

    def check(self, stage: Stage) -> None:
        """Both are there."""
        check_there(stage, *self._names)

    def begin(self, stage: Stage) -> None:
        """Exchanges them if they fit."""
        world = stage.world
        check_there(stage, *self._names)
        if (held := touched_block(world)) in self._names:
            raise DisturbanceError(f"{held} is in the hand, so it cannot change places")
        first, second = self._names
        moves = ((first, second), (second, first))
        centres = [self._place(stage, name, other) for name, other in moves]
        for (name, _), centre in zip(moves, centres):
            _, quaternion = world.block_pose(name)
            body = world.body(name)
            pybullet.resetBasePositionAndOrientation(
                body, centre, quaternion, physicsClientId=world.client
            )
            pybullet.resetBaseVelocity(body, (0.0,) * 3, (0.0,) * 3, physicsClientId=world.client)

    def _place(self, stage: Stage, name: str, other: str) -> Vector:
        """The centre of a block that takes another one's place [m]; checks that it fits there."""
        world = stage.world
        graph = true_scene_graph(world)
        above = [item.subject for item in sorted(graph.relations)
                 if item.predicate == UP and item.object == other]  # fmt: skip
        if above and name.endswith(SPHERE):
            raise DisturbanceError(f"{above[0]} cannot stand on {name}: it would roll off")
        (x, y, _), (_, _, z) = _origin(world, other), _origin(world, name)
        bottom, _ = reach(world, name)
        centre = (x, y, reach(world, other)[0] + z - bottom)
        if graph.object(name).size != graph.object(other).size and (
            thing := in_the_way(world, graph.object(name).size, centre, self._names)
        ):
            raise DisturbanceError(f"{name} does not fit where {other} is: {thing} is in the way")
        return centre


def _origin(world: World, name: str) -> Vector:
    """Where pybullet has the body of a block, which need not be its middle [m]."""
    x, y, z = pybullet.getBasePositionAndOrientation(
        world.body(name), physicsClientId=world.client
    )[0]
    return x, y, z
