# SPDX-License-Identifier: Apache-2.0
"""The clients that people type: ``plan_to_goal`` and ``achieve_goal``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import rclpy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import Image
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.node_process import prepare_process

from .arm_text import describe_failure
from .client import PlannerClient
from .goal_image import ImageFileError, read_goal_image
from .interrupts import exit_code, listen_to_signals, mute, say, terminal_may_close
from .plan_text import describe_plan
from .progress import ProgressPrinter
from .unavailable import PlannerUnavailableError

SUCCEEDED: Final = (PlanToGoal.Response.SUCCESS, PlanToGoal.Response.ALREADY_TRUE)
EXIT_FAILED: Final = 1
#: How long the planner may take to answer [s].
ANSWER_TIMEOUT: Final = 10.0
#: How long a cancelled motion may take until it rests [s].
CANCEL_TIMEOUT: Final = 60.0
STOP_HINT: Final = "'ros2 run planner_node stop' stops the arm and says how it ended"


def plan_to_goal(arguments: Sequence[str] | None = None) -> int:
    """Prints a plan; the exit code is 0 if there is one, or nothing needs to be done."""
    arguments = sys.argv if arguments is None else arguments
    parser = _parser("plan_to_goal", "Plans from what the camera sees to a goal.", ANSWER_TIMEOUT)
    parser.add_argument("--execute", action="store_true", help="also have the plan carried out")
    options = parser.parse_args(remove_ros_args(arguments)[1:])
    image, segmentation = _read_images(parser, options)
    plan = _read_plan(parser, options)
    prepare(arguments)
    try:
        with PlannerClient() as planner:
            answer = planner.plan(
                options.goal or "",
                goal_image=image,
                goal_segmentation=segmentation,
                execute=options.execute,
                plan=plan,
                answer=options.answer,
                timeout=options.timeout,
            )
    except PlannerUnavailableError as error:
        say(f"plan_to_goal: {error}")
        return EXIT_FAILED
    except KeyboardInterrupt as interrupt:
        if options.execute:
            say(f"plan_to_goal: interrupted, the plan may be carried out; {STOP_HINT}")
        return exit_code(interrupt)
    finally:
        rclpy.try_shutdown()
    if answer.status not in SUCCEEDED:
        say(f"plan_to_goal: {answer.message}")
        return EXIT_FAILED
    effort = f"{answer.expanded} states expanded in {answer.planning_seconds:.3f} s"
    for line in (answer.message, *describe_plan(answer.plan, answer.states), effort):
        say(line, sys.stdout)
    return 0


def achieve_goal(arguments: Sequence[str] | None = None) -> int:
    """Has a goal achieved and shows how.

    Ctrl-C, SIGTERM and a closed terminal cancel it and wait until the arm rests; the second of them
    leaves at once.
    """
    arguments = sys.argv if arguments is None else arguments
    parser = _parser("achieve_goal", "Achieves a goal, until the camera confirms it.", 600.0)
    options = parser.parse_args(remove_ros_args(arguments)[1:])
    image, segmentation = _read_images(parser, options)
    plan = _read_plan(parser, options)
    prepare(arguments)
    try:
        with PlannerClient() as planner:
            try:
                planner.start(
                    options.goal or "",
                    goal_image=image,
                    goal_segmentation=segmentation,
                    plan=plan,
                    answer=options.answer,
                    timeout=min(ANSWER_TIMEOUT, options.timeout),
                )
            except KeyboardInterrupt as interrupt:
                return _withdraw(planner, exit_code(interrupt))
            try:
                if _follow(planner, options.timeout):
                    return _report(planner.result(timeout=1.0))
                say(f"achieve_goal: not done after {options.timeout:g} s")
                code = EXIT_FAILED
            except KeyboardInterrupt as interrupt:
                code = exit_code(interrupt)
            except OSError:  # nobody reads any more what is printed
                mute(sys.stdout)
                code = EXIT_FAILED
            with terminal_may_close():
                return _cancel(planner, code)
    except PlannerUnavailableError as error:
        say(f"achieve_goal: {error}")
        return EXIT_FAILED
    except KeyboardInterrupt as interrupt:
        say("achieve_goal: left at once")
        return exit_code(interrupt)
    finally:
        rclpy.try_shutdown()


def _parser(name: str, description: str, timeout: float) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=name,
        description=description,
        epilog="Give a goal text, or a goal image with its segmentation; with a plan of another "
        "planner none is needed.",
    )
    parser.add_argument("goal", nargs="?", help="such as 'red on blue'")
    parser.add_argument("--timeout", type=float, default=timeout, help="[s], default %(default)s")
    parser.add_argument("--goal-image", type=Path, metavar="PNG", help="an RGB image")
    parser.add_argument(
        "--goal-segmentation", type=Path, metavar="PNG", help="its instance labels, 8 or 16 bits"
    )
    parser.add_argument(
        "--plan",
        type=Path,
        metavar="FILE",
        help="another planner's plan, in PDDL or as moves such as '(0, 2)', in place of a search",
    )
    parser.add_argument(
        "--answer", default="", metavar="COLOR", help="to what was asked back; several with commas"
    )
    return parser


def _read_plan(parser: argparse.ArgumentParser, options: argparse.Namespace) -> str:
    """The text of another planner's plan, or nothing; ends the program if there is none in it."""
    if options.plan is None:
        return ""
    try:
        text = str(options.plan.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        parser.error(f"--plan {options.plan}: cannot read it: {error}")
    if not text.strip():
        parser.error(f"--plan {options.plan}: there is nothing in it")
    return text


def _read_images(
    parser: argparse.ArgumentParser, options: argparse.Namespace
) -> tuple[Image | None, Image | None]:
    """The goal image and its segmentation, or nothing; ends the program if they do not fit."""
    image, labels = options.goal_image, options.goal_segmentation
    if (image is None) != (labels is None):
        parser.error("--goal-image and --goal-segmentation belong together")
    if image is None:
        if options.goal is None and options.plan is None:
            parser.error("give a goal, such as 'red on blue'")
        return None, None
    try:
        return read_goal_image(image, labels)
    except ImageFileError as error:
        parser.error(str(error))


def prepare(arguments: Sequence[str]) -> None:
    """What every client does before it makes a node."""
    prepare_process()
    # Signals must reach this program as KeyboardInterrupt: it still has a goal to cancel.
    listen_to_signals()
    rclpy.init(args=list(arguments), signal_handler_options=SignalHandlerOptions.NO)


def _follow(planner: PlannerClient, timeout: float) -> bool:
    """Prints feedback until the goal is done; False if that takes longer than ``timeout`` [s]."""
    printer = ProgressPrinter()
    deadline = time.monotonic() + timeout
    try:
        while time.monotonic() < deadline:
            feedback = planner.next_feedback(timeout=0.1)
            if feedback is not None:
                printer.show(feedback)
            elif planner.is_done():
                return True
        return False
    finally:
        printer.finish()


def _withdraw(planner: PlannerClient, code: int) -> int:
    """Ends a client that was interrupted before the planner answered."""
    try:
        known = planner.withdraw()
    except PlannerUnavailableError:
        say(f"achieve_goal: interrupted, and planner_node does not answer; {STOP_HINT}")
    else:
        what = "the goal is cancelled" if known else "nothing was asked for yet"
        say(f"achieve_goal: interrupted, {what}")
    return code


def _cancel(planner: PlannerClient, code: int) -> int:
    say("achieve_goal: cancelling, waiting until the arm rests; Ctrl-C leaves at once")
    told = False
    try:
        planner.cancel()
        told = True
        ended = _follow_to_the_end(planner)
    except KeyboardInterrupt as interrupt:
        if not told and not planner.withdraw(timeout=1.0):
            raise
        say(
            "achieve_goal: left at once; the goal is cancelled, so the arm puts down what it holds "
            f"and goes home. {STOP_HINT}"
        )
        return exit_code(interrupt)
    if not ended:
        say(f"achieve_goal: no end after {CANCEL_TIMEOUT:g} s; {STOP_HINT}")
        return EXIT_FAILED
    result = planner.result(timeout=1.0)
    for line in (result.message, *describe_failure(result)):
        say(f"achieve_goal: {line}")
    return code


def _follow_to_the_end(planner: PlannerClient) -> bool:
    """As :func:`_follow`, until a cancelled motion rests, also where nobody reads what is told."""
    try:
        return _follow(planner, CANCEL_TIMEOUT)
    except OSError:
        mute(sys.stdout)
        return _follow(planner, CANCEL_TIMEOUT)


def _report(result: AchieveGoal.Result) -> int:
    where = f" [{result.module}]" if result.module else ""
    if result.status not in SUCCEEDED:
        say(f"achieve_goal{where}: {result.message}")
        for line in describe_failure(result):
            say(f"  {line}")
        return EXIT_FAILED
    say(result.message, sys.stdout)
    say(
        f"{result.moves_executed} moves, {result.replans} replans; "
        f"perceive {result.perceive_seconds:.2f} s, plan {result.plan_seconds:.3f} s, "
        f"motion {result.motion_seconds:.2f} s, execute {result.execute_seconds:.2f} s",
        sys.stdout,
    )
    return 0
