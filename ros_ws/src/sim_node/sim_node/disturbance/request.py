# SPDX-License-Identifier: Apache-2.0
"""What is asked of the world: a kind of disturbance, its amounts, and when."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import isfinite
from typing import Final

Vector = tuple[float, float, float]

NOW: Final = "now"
AT: Final = "at"
GRASP: Final = "grasp"
RELEASE: Final = "release"
IN_AIR: Final = "in_air"
#: The moments at which something can happen; the last three are events of the hand.
MOMENTS: Final = (NOW, AT, GRASP, RELEASE, IN_AIR)
EVENTS: Final = (GRASP, RELEASE, IN_AIR)

#: The most that can be asked for: further off it is a slip of the pen.
MOST_SECONDS: Final = 60.0
MOST_DELAY: Final = 3600.0
MOST_FORCE: Final = 1000.0
MOST_ACCELERATION: Final = 100.0
MOST_HEIGHT: Final = 0.5
MOST_COUNT: Final = 1000

#: A lift counts from this height on, if nothing else is said [m].
DEFAULT_HEIGHT: Final = 0.015


class DisturbanceError(ValueError):
    """A disturbance that cannot happen; the sentence says why. The world is as it was."""


@dataclass(frozen=True)
class Request:
    """A disturbance that is asked for; 0 and what is empty stand for defaults.

    Attributes:
        kind: a key of :data:`~sim_node.disturbance.kinds.KINDS`.
        blocks: names; what their number means depends on the kind.
        force: [N].
        acceleration: [m/s²].
        direction: in world, of any length.
        seconds: for how long [s].
        on: the block or the place that a block is put on; empty: at ``position``.
        position: centre of the bottom of a block that is added, in world [m].
        what: which thing is held before the camera.
        when: one of :data:`MOMENTS`; empty: now.
        count: of the events from now on; 0 or 1: the next.
        of: only the events of this block; empty: of any.
        height: of a lift [m].
        step: of the physics, for ``at``.
        delay: after that moment [s].
    """

    kind: str
    blocks: tuple[str, ...] = ()
    force: float = 0.0
    acceleration: float = 0.0
    direction: Vector = (0.0, 0.0, 0.0)
    seconds: float = 0.0
    on: str = ""
    position: Vector = (0.0, 0.0, 0.0)
    what: str = ""
    when: str = NOW
    count: int = 0
    of: str = ""
    height: float = 0.0
    step: int | None = None
    delay: float = 0.0


#: What only some kinds understand, with what it is if nobody says anything.
_AMOUNTS: Final = ("blocks", "force", "acceleration", "direction", "seconds", "on", "position",
                   "what")  # fmt: skip
_LIMITS: Final = {
    "force": (MOST_FORCE, "N"),
    "acceleration": (MOST_ACCELERATION, "m/s²"),
    "seconds": (MOST_SECONDS, "s"),
    "delay": (MOST_DELAY, "s"),
    "height": (MOST_HEIGHT, "m"),
}


def check_request(request: Request, uses: Collection[str], kind: str) -> None:
    """What can be said of a request without a look at the world.

    Args:
        uses: the amounts that its kind understands.

    Raises:
        DisturbanceError: for numbers that are none, are too large or below 0, and for what means
            nothing to the kind or to the moment.
    """
    default = Request(kind)
    for name in ("direction", "position"):
        if not all(map(isfinite, getattr(request, name))):
            raise DisturbanceError(f"{name} {getattr(request, name)} is not finite")
    for name, (most, unit) in _LIMITS.items():
        value = getattr(request, name)
        if not 0.0 <= value <= most:
            raise DisturbanceError(f"{name} is {value:g} {unit}; 0 to {most:g} is possible")
    for name in _AMOUNTS:
        if name not in uses and getattr(request, name) != getattr(default, name):
            raise DisturbanceError(f"{name} means nothing to {kind}; leave it out")
    _check_moment(request)


def _check_moment(request: Request) -> None:
    when = request.when or NOW
    if when not in MOMENTS:
        raise DisturbanceError(f"when is {when!r}; there are {', '.join(MOMENTS)}")
    if when not in EVENTS and (request.count or request.of):
        raise DisturbanceError(
            f"count and of belong to an event ({', '.join(EVENTS)}), not to {when}"
        )
    if not 0 <= request.count <= MOST_COUNT:
        raise DisturbanceError(f"count is {request.count}; 1 to {MOST_COUNT} is possible")
    if when != IN_AIR and request.height:
        raise DisturbanceError(f"height belongs to {IN_AIR}, not to {when}")
    if (when == AT) != (request.step is not None):
        raise DisturbanceError(f"a stamp is given with when {AT!r}, and only with it")
