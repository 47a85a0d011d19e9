# SPDX-License-Identifier: Apache-2.0
"""A pybullet world with an arm, a table of blocks, a camera and an arm controller.

What a notebook needs stands here; none of it knows ROS::

    from sim_node import World, random_layout

    with World() as world:
        world.reset(random_layout(seed=3, blocks=6))
        frame = world.render()
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .public import *  # noqa: F403


def __getattr__(name: str) -> Any:
    # Imported when it is first asked for: an executable listens to Ctrl-C before such imports.
    if name.startswith("_") and name != "__all__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(".public", __name__), name)
