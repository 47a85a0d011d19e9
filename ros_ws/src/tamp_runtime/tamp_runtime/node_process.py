# SPDX-License-Identifier: Apache-2.0
"""Starting and stopping a node process: its settings, executor, signals, exit code."""

from __future__ import annotations

import faulthandler
import gc
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Final

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from .domain import leave_in_turn
from .orderly_executor import OrderlyExecutor
from .stream_thread import StreamThread

#: After how long a thread that computes passes the interpreter on to one that waits for it [s].
SWITCH_INTERVAL: Final = 1e-4

#: How long the shutdown of a node may take before its process is ended [s].
STOP_SECONDS: Final = 5.0

#: The exit code of a process that was ended because its shutdown hung (sysexits.h: EX_SOFTWARE).
EXIT_STUCK: Final = 70

#: The same, where a library keeps the interpreter, so that not even a thread that looks after that
#: gets it: after how long [s], and faulthandler's exit code.
_HELD_SECONDS: Final = 4 * STOP_SECONDS
EXIT_HELD: Final = 1

_POLL_SECONDS: Final = 0.1


def prepare_process() -> None:
    """Settings of every process that has a node; must run before ``rclpy.init``.

    DDS discovery stays on this host unless the environment asks for more:
    ``ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET`` opens it.

    Threads take turns fifty times more often than Python's 5 ms. A thread that computes in a
    library gives the interpreter up at each call, and waits that long to get it back from one that
    hears joint states: a motion of 0.1 s took 3 s.
    """
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    sys.setswitchinterval(SWITCH_INTERVAL)


def run_node(make_node: Callable[[], Node], args: list[str] | None = None, threads: int = 4) -> int:
    """Runs a node until SIGINT, SIGTERM or shutdown, and returns the process's exit code.

    Both signals stop it even where the parent had them ignored, as a script has SIGINT for what it
    puts into the background.

    Returns:
        0 after a regular stop; 2, with one sentence on stderr, if the node cannot start with its
        parameters (ValueError or OSError from its constructor). A process that does not get through
        its shutdown within ``STOP_SECONDS`` is ended with ``EXIT_STUCK`` (70), or later with
        ``EXIT_HELD`` (1) where a library keeps the interpreter, and stderr shows where each of its
        threads was; SIGABRT shows that, too.
    """
    prepare_process()
    faulthandler.enable()
    interrupts = _Interrupts()
    signal.signal(signal.SIGINT, interrupts)
    # rclpy's own handlers of SIGINT and SIGTERM wake the executor; Python's wait for a message.
    # They replace an inherited SIG_IGN, and call what was installed for SIGINT before.
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.ALL)
    context = rclpy.get_default_context()
    threading.Thread(target=_end_in_time, args=[context], daemon=True).start()
    executor = OrderlyExecutor(threads)
    node: Node | None = None
    clock: StreamThread | None = None
    try:
        node = make_node()
        clock = StreamThread.of_clock(node)
        executor.add_node(node)
        # What a node has once it has started it keeps: a collector that looks through it all again
        # and again stops every thread for a tenth of a second.
        gc.freeze()
        interrupts.awaited = False
        if not interrupts.arrived:  # some library may have swallowed the exception
            _spin(executor, node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception as error:
        if not context.ok():  # stopped while it started: nothing of ROS works any more then
            return 0
        if node is not None or not isinstance(error, ValueError | OSError):
            raise
        print(f"cannot start: {error}", file=sys.stderr)
        return 2
    finally:
        # Needs no interpreter, which rclpy keeps while DDS deletes its own.
        faulthandler.dump_traceback_later(_HELD_SECONDS, exit=True)
        # It looks first whether there is anything to shut down, but rclpy's thread for signals can
        # come in between: an RCLError, which is a RuntimeError.
        with suppress(RuntimeError):
            rclpy.try_shutdown()
        # Callbacks that run see the shutdown, and every wait in them has a timeout. It waits for
        # them: a node must not be destroyed under one.
        executor.shutdown()
        if clock is not None:
            clock.stop()
        if node is not None:
            with leave_in_turn(STOP_SECONDS / 2):
                node.destroy_node()
        faulthandler.cancel_dump_traceback_later()
    return 0


class _Interrupts:
    """What SIGINT does besides rclpy's shutdown: it interrupts a node that starts, and no other.

    Raised in the middle of the executor, KeyboardInterrupt leaves half-made tasks behind.
    """

    def __init__(self) -> None:
        self.awaited = True
        self.arrived = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        self.arrived = True
        if self.awaited:
            raise KeyboardInterrupt


def _end_in_time(context: Context) -> None:
    """Ends a process that does not get through its own shutdown, and shows where it hangs."""
    while context.ok():
        time.sleep(_POLL_SECONDS)
    # Turns are counted, not time: a machine that stood still meanwhile is not the node's fault.
    for _ in range(round(STOP_SECONDS / _POLL_SECONDS)):
        time.sleep(_POLL_SECONDS)
    print(f"not stopped after {STOP_SECONDS:g} s, ended; please report:", file=sys.stderr)
    faulthandler.dump_traceback(all_threads=True)
    os._exit(EXIT_STUCK)


def _spin(executor: OrderlyExecutor, node: Node) -> None:
    """Spins until shutdown. An exception of a callback is logged, and the node lives on."""
    while node.context.ok():
        try:
            # With a time limit, since a signal that arrives between the executor's look at the
            # context and its wait wakes nobody: without one, about one stop in fifty hangs.
            executor.spin_once(timeout_sec=0.5)
        except (KeyboardInterrupt, ExternalShutdownException):
            return
        except Exception:
            if node.context.ok():
                node.get_logger().error(f"a callback failed:\n{traceback.format_exc()}")
