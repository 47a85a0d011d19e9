# SPDX-License-Identifier: Apache-2.0
"""What every executable does first: it listens to Ctrl-C and imports its program, which is slow.

Imports nothing heavy itself, so that Ctrl-C while the imports run ends the process in order, too.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import sys
from collections.abc import Mapping
from types import FrameType
from typing import Final, NoReturn

#: The exit code of a node that cannot start, as with parameters that make no sense.
EXIT_CANNOT_START: Final = 2

#: What pip calls what no package of ROS or Ubuntu brings along, by the name it is imported by.
PIP_NAMES: Final[Mapping[str, str]] = {
    "casadi": "casadi",
    "pybullet": "pybullet",
    "pybullet_data": "pybullet",
    "safetensors": "safetensors",
    "torch": "torch",
    "torchvision": "torchvision",
    "vector_quantize_pytorch": "vector-quantize-pytorch",
}


def run_module(name: str, function: str = "run", stopped: int = 0) -> int:
    """Calls a function of a module that is imported now, and returns its exit code.

    Where a Python module is missing, that is one sentence on stderr and ``EXIT_CANNOT_START``.

    Args:
        stopped: the exit code if SIGINT arrives before the function handles it.
    """

    def end(_number: int, _frame: FrameType | None) -> None:
        os._exit(stopped)

    # At once, since there is nothing to tidy up yet: a KeyboardInterrupt in the middle of an import
    # is swallowed by some library, one in fifty, or leaves a module behind that is half there.
    signal.signal(signal.SIGINT, end)
    try:
        module = importlib.import_module(name)
        listen_to_interrupts()
        code: int = getattr(module, function)()
    except KeyboardInterrupt:  # stopped before there was anything to stop
        return stopped
    except ModuleNotFoundError as error:
        if error.name is None:
            raise
        print(f"cannot start: {_what_is_missing(error.name.split('.')[0])}", file=sys.stderr)
        return EXIT_CANNOT_START
    return code


def _what_is_missing(name: str) -> str:
    """A sentence that says how to get a module that cannot be imported."""
    missing = f"{sys.executable} has no Python module {name}"
    if name in PIP_NAMES:
        return (
            f"{missing}; install it with '{sys.executable} -m pip install {PIP_NAMES[name]}', "
            "in a virtual environment as README.md says under 'On a full ROS 2'"
        )
    return (
        f"{missing}; source the workspace's setup, and install what its packages depend on with "
        "'rosdep install --from-paths ros_ws/src --ignore-src' as README.md says under "
        "'On a full ROS 2'"
    )


def listen_to_interrupts() -> None:
    """Has SIGINT raise KeyboardInterrupt, even where the parent had it ignored.

    A script starts what it puts into the background so, and Python leaves it at that; but a robot
    has to stop whoever started it.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)


def end_process(code: int) -> NoReturn:
    """Ends a process whose node is destroyed, without taking the interpreter apart.

    torch's and casadi's modules take a second for that, and eight on a busy machine, which would
    pass for a node that hangs. DDS and the logs are closed with the node.
    """
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):  # whoever read it is gone
            stream.flush()
    os._exit(code)
