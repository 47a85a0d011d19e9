# SPDX-License-Identifier: Apache-2.0
"""Where the messages of ``sim/disturb`` meet the types of this room."""

from __future__ import annotations

from collections.abc import Callable

from builtin_interfaces.msg import Time
from tamp_interfaces.srv import Disturb

from .request import NOW, Request


def request_from_message(
    message: Disturb.Request, step_at: Callable[[Time], int | None]
) -> Request:
    """A request; ``step_at`` gives the physics' step that a stamp means, None for no stamp."""
    direction, position = message.direction, message.position
    return Request(
        kind=message.kind,
        blocks=tuple(message.blocks),
        force=message.force,
        acceleration=message.acceleration,
        direction=(direction.x, direction.y, direction.z),
        seconds=message.seconds,
        on=message.on,
        position=(position.x, position.y, position.z),
        what=message.what,
        when=message.when or NOW,
        count=message.count,
        of=message.of,
        height=message.height,
        step=step_at(message.stamp),
        delay=message.delay,
    )
