# SPDX-License-Identifier: Apache-2.0
"""``ros2 run sim_node disturb``: lets something go wrong in the simulated world."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from typing import Final

import rclpy
from geometry_msgs.msg import Point, Vector3
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args
from tamp_interfaces.srv import Disturb
from tamp_runtime.node_process import prepare_process

from ..disturbance.request import EVENTS, MOMENTS, NOW, Vector
from .client import DisturbClient, SimulatorUnavailableError

#: The kinds that the interface names. The simulator may know more, and is asked for any; to import
#: them from there would bring the physics engine along.
KINDS: Final = tuple(
    str(getattr(Disturb.Request, name))
    for name in dir(Disturb.Request)
    if name.isupper()
    and name != "SLOT_TYPES"
    and str(getattr(Disturb.Request, name)) not in MOMENTS
)
EXIT_REFUSED: Final = 1
EXIT_INTERRUPTED: Final = 130
#: As in the camera's picture.
DIRECTIONS: Final[Mapping[str, Vector]] = {
    "left": (0.0, -1.0, 0.0),
    "right": (0.0, 1.0, 0.0),
    "front": (1.0, 0.0, 0.0),
    "back": (-1.0, 0.0, 0.0),
    "up": (0.0, 0.0, 1.0),
    "down": (0.0, 0.0, -1.0),
}
_EXAMPLES: Final = """\
examples:
  disturb push red_box                      slides it some 5 cm away from the arm
  disturb push --force 60 --direction down --when in_air
                                            pulls out of the hand what is lifted next
  disturb slip --when in_air --count 2      the second block that is lifted slips
  disturb jam --seconds 5 --when grasp      the fingers keep the next block for 5 s
  disturb swap red_box blue_box
  disturb add pink_box --on stack1
  disturb cover --what sheet --delay 3
  disturb calm                              drops and ends all of them
  disturb shove --acceleration 8 --direction left

exit code: 0 it happens, or waits for its moment; 1 it was refused, or no sim_node answers;
2 an argument makes no sense. A reset of the scene drops what is pending or under way.
"""


def disturb(arguments: Sequence[str] | None = None) -> int:
    """Asks for a disturbance and prints what comes of it."""
    arguments = sys.argv if arguments is None else arguments
    parser = _parser()
    options = parser.parse_intermixed_args(remove_ros_args(arguments)[1:])
    if not options.timeout > 0.0:
        parser.error(f"--timeout {options.timeout:g}: must be positive")
    if not 0 <= options.count < 2**32:
        parser.error(f"--count {options.count}: must not be negative")
    request = _request(options)
    prepare_process()
    try:
        rclpy.init(args=list(arguments), signal_handler_options=SignalHandlerOptions.NO)
        with DisturbClient() as simulator:
            answer = simulator.disturb(request, options.timeout)
    except SimulatorUnavailableError as error:
        print(f"disturb: {error}", file=sys.stderr)
        return EXIT_REFUSED
    except KeyboardInterrupt:
        print("disturb: interrupted; what was asked for stays asked for", file=sys.stderr)
        return EXIT_INTERRUPTED
    finally:
        rclpy.try_shutdown()
    if not answer.success:
        print(f"disturb: {answer.message}", file=sys.stderr)
        return EXIT_REFUSED
    print(f"disturbance {answer.id}: {answer.message}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="disturb",
        description="Lets something go wrong in the simulated world, now or at an event.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("kind", metavar="KIND", help=", ".join(KINDS))
    add("blocks", nargs="*", metavar="BLOCK", help="such as red_box")
    add("--force", type=float, default=0.0, help="push, nudge [N]")
    add("--acceleration", type=float, default=0.0, help="shove [m/s^2]")
    add(
        "--direction",
        type=_direction,
        default=(0.0,) * 3,
        metavar="WORD|X,Y,Z",
        help=f"push, shove, nudge: {', '.join(DIRECTIONS)} as in the picture, or "
        "in world; with a minus in front as --direction=-1,0,0",
    )
    add("--seconds", type=float, default=0.0, help="for how long, in simulated time")
    add("--on", default="", help="add: a block, or a place such as stack0")
    add(
        "--position",
        type=_triple,
        default=(0.0,) * 3,
        metavar="X,Y,Z",
        help="add: centre of its bottom, in world [m]",
    )
    add("--what", default="", help="cover: hand or sheet")
    add("--when", choices=[NOW, *EVENTS], default=NOW, help="default %(default)s")
    add("--count", type=int, default=0, metavar="N", help="the n-th such event from now on")
    add("--of", default="", metavar="BLOCK", help="only events of this block")
    add("--height", type=float, default=0.0, help="in_air: lifted by more than this [m]")
    add("--delay", type=float, default=0.0, help="after that moment, in simulated time [s]")
    add("--timeout", type=float, default=10.0, help="for the answer [s], default %(default)s")
    return parser  # fmt: skip


def _triple(text: str) -> Vector:
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y,Z, such as 0.5,0,0.1") from None
    return x, y, z


def _direction(text: str) -> Vector:
    if text in DIRECTIONS:
        return DIRECTIONS[text]
    try:
        vector = _triple(text)
    except argparse.ArgumentTypeError:
        vector = (0.0,) * 3
    if not any(vector):
        raise argparse.ArgumentTypeError(
            f"{text!r} is no direction; there are {', '.join(DIRECTIONS)}, or X,Y,Z such as 1,0.5,0"
        )
    return vector


def _request(options: argparse.Namespace) -> Disturb.Request:
    return Disturb.Request(
        kind=options.kind,
        blocks=options.blocks,
        force=options.force,
        acceleration=options.acceleration,
        direction=Vector3(**dict(zip("xyz", options.direction))),
        seconds=options.seconds,
        on=options.on,
        position=Point(**dict(zip("xyz", options.position))),
        what=options.what,
        when=options.when,
        count=options.count,
        of=options.of,
        height=options.height,
        delay=options.delay,
    )
