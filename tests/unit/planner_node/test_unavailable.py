# SPDX-License-Identifier: Apache-2.0
"""What is said of a planner that does not know a goal."""

from __future__ import annotations

from planner_node.cli.unavailable import unknown_goal


def test_fault_6_two_planners_are_named_where_one_does_not_know_the_goal() -> None:
    assert "two of planner_node in this domain" in str(unknown_goal(servers=2))
    alone = str(unknown_goal(servers=1))
    assert "two of" not in alone
    assert "it was started anew. What became of its plan is not known" in alone
