# SPDX-License-Identifier: Apache-2.0
"""A pybullet world with an arm, a table of blocks, a camera and an arm controller.

What a notebook needs stands here; none of it knows ROS::

    from sim_node import World, random_layout

    with World() as world:
        world.reset(random_layout(seed=3, blocks=6))
        frame = world.render()
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from tamp_runtime.public_face import exported_by

if TYPE_CHECKING:
    from .public import *  # noqa: F403

__getattr__ = exported_by(__name__)
