# SPDX-License-Identifier: Apache-2.0
"""What a client says of a planner that does not answer, or not any more."""

from __future__ import annotations

from typing import Final

#: What a person can do when nobody is there any more who follows the plan.
WHAT_TO_DO: Final = (
    "What became of its plan is not known, and the arm may go on with it: stop it with "
    "'ros2 run planner_node stop', or look at the scene and ask again"
)


class PlannerUnavailableError(RuntimeError):
    """planner_node does not answer; the message says what to do about it."""


def unknown_goal(servers: int) -> PlannerUnavailableError:
    """The error of a planner that does not know what it was asked for.

    Args:
        servers: of the action; one that was killed is still there for some seconds.
    """
    two = ", or there are two of planner_node in this domain" if servers > 1 else ""
    return PlannerUnavailableError(
        f"planner_node does not know the goal; it was started anew{two}. {WHAT_TO_DO}"
    )


def no_answer(seconds: float) -> PlannerUnavailableError:
    """The error of a request that was answered by nobody for so long [s]."""
    return PlannerUnavailableError(
        f"planner_node does not answer (waited {seconds:g} s); start it with: "
        "ros2 run planner_node planner_node"
    )
