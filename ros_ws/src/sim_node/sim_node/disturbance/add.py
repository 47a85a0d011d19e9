# SPDX-License-Identifier: Apache-2.0
"""Somebody puts another block down."""

from __future__ import annotations

import numpy as np

from scene_graph import FLAT_TOPPED, base_index, split_object_name

from .disturbance import Disturbance, Stage, check_there, named_blocks
from .free_space import in_the_way, reach, support
from .request import DisturbanceError, Request, Vector


class Add(Disturbance):
    """Another block stands on a place, on a block, or anywhere on the table."""

    uses = frozenset({"blocks", "on", "position"})

    def __init__(self, request: Request) -> None:
        (self._name,) = named_blocks(request, 1, 1)
        try:
            split_object_name(self._name)
        except ValueError as error:
            raise DisturbanceError(str(error)) from error
        if request.on and any(request.position):
            raise DisturbanceError("a block is added on something or at a position, not both")
        if not request.on and not any(request.position):
            raise DisturbanceError("say on what, such as stack0, or at which position it is added")
        self._on, self._position = request.on, request.position
        x, y, z = self._position
        where = f"on {self._on}" if self._on else f"at ({x:g}, {y:g}, {z:g})"
        self.sentence = f"{self._name} is added {where}"

    def check(self, stage: Stage) -> None:
        """Its name is free, and what it is put on is there."""
        self._check_name(stage)
        if self._on:
            self._bottom(stage)

    def begin(self, stage: Stage) -> None:
        """Puts it down where it fits and stands."""
        self._check_name(stage)
        world = stage.world
        x, y, z = self._bottom(stage) if self._on else self._position
        beneath = support(world, (x, y, z))
        block = world.config.blocks.block(self._name, world.seed)
        centre = (x, y, z + 0.5 * block.size[2])
        if thing := in_the_way(world, block.size, centre):
            raise DisturbanceError(f"{self._name} cannot stand there: {thing} is there")
        if not beneath or beneath == "the arm":
            raise DisturbanceError(f"{self._name} would be in the air: nothing is beneath it")
        if beneath in world.names and not beneath.endswith(FLAT_TOPPED):
            raise DisturbanceError(f"{self._name} cannot stand on {beneath}: it would come off")
        world.add_block(block, np.array(centre))

    def _check_name(self, stage: Stage) -> None:
        names = stage.world.names
        if self._name in names:
            raise DisturbanceError(f"there is a {self._name} already")
        if len(names) >= stage.world.config.blocks.most:
            raise DisturbanceError(f"the table has {len(names)} blocks already; more are too many")

    def _bottom(self, stage: Stage) -> Vector:
        """Where the middle of its bottom comes to be on what it is put on [m]."""
        places = stage.world.config.stack_positions
        index = base_index(self._on)
        if index is None:
            check_there(stage, self._on)
            (x, y, _), _ = stage.world.block_pose(self._on)
            return x, y, reach(stage.world, self._on)[1]
        if index >= len(places):
            raise DisturbanceError(
                f"there is no place {self._on}; there are stack0 to stack{len(places) - 1}"
            )
        return places[index]
