# SPDX-License-Identifier: Apache-2.0
"""The faults that trials by hand found before there was a campaign: what they were, and are."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final


@dataclass(frozen=True)
class Numbered:
    """One of them.

    Attributes:
        number: tests of it have ``fault_NUMBER`` in their name or docstring.
        was: what happened at 96bf19d.
        now: what happens instead.
        kinds: the kinds of the catalogue that bring it about, or parts of their names.
    """

    number: int
    was: str
    now: str
    kinds: tuple[str, ...] = ()


NUMBERED: Final = (
    Numbered(
        1,
        "clients of a killed and restarted planner waited for ever; the new planner answered BUSY "
        "for a plan that it did not follow",
        "a client notices within 10 s; a new planner stops or waits out the plan under way; a "
        "client that ends cancels what it asked for, and everybody can type `planner_node stop`",
        (
            "planner-killed", "planner-restarted", "planner-stopped-again", "command-",
            "client-killed",
        ),
    ),
    Numbered(
        2,
        "the arm stayed before the camera with a block, and every later request was refused as "
        "OCCLUDED",
        "an arm that is not home puts down or holds what it has and goes home before the next look",
        ("trajectory-ends-early", "trajectory-slow", "joints-frozen"),
    ),
    Numbered(
        3,
        "a node that stood still for 5 s ended the task with 'no joint_states for 3 s'",
        "what passes is waited out, or looked at again and planned anew",
        ("stands-still", "all-stand-still", "joints-lost-", "status-lost-5s", "clock-stopped-3s"),
    ),
    Numbered(
        4,
        "fingers that never close were not noticed; reasons were dropped on the way to the answer",
        "fingers are watched as they close and open; every answer carries its causes, the first "
        "one first",
        ("fingers-",),
    ),
    Numbered(
        5,
        "a plan published while motion_node started was ignored; motion_status fell silent after "
        "the first plan",
        "such a plan is published again; motion_status beats as long as the node lives and tells "
        "late listeners",
        ("motion-restarted", "plan-lost-3s", "plan-late", "plan-again"),
    ),
    Numbered(
        6,
        "two graphs in one domain were mixed up: a goal was called reached that was not",
        "nodes tell that they live and notice a second one of their kind; CONFLICT",
        ("second-planner", "second-motion", "second-simulator", "second-graph"),
    ),
    Numbered(
        7,
        "launch's real_time_factor was without effect; rviz:=true without rviz2 left four orphans; "
        "nothing happened when a node died",
        "arguments are described, checked and heeded; launch ends when a node ends",
    ),
    Numbered(
        8,
        "best-effort cameras and volatile extrinsics delivered nothing; no camera_info of depth",
        "perception hears them as well; camera/depth/camera_info is there",
    ),
    Numbered(
        9,
        "sim/reset accepted 1 and 2 blocks, and answered a refusal without the layout",
        "random scenes have 3 to 7 blocks; every answer has the layout as it is",
    ),
    Numbered(
        10,
        "plan_to_goal planned on the scene of a dead simulator",
        "the age of a scene is also measured by this machine's clock",
        ("sim-killed", "clock-stopped", "graph-lost"),
    ),
    Numbered(
        11,
        "a physics thread that died left sim_node alive and silent; perception took 5 s to end",
        "the process says why and ends; stopping is heeded at once",
    ),
    Numbered(
        12,
        "frames, feedback, mesh files and several sentences about goals were wrong",
        "each is as its interface says",
        ("nonsense",),
    ),
    Numbered(
        13,
        "sentences that sent a person to the wrong place",
        "each names what is wrong",
        (
            "image-black", "stamps-constant", "depth-millimetres", "joints-nan", "status-lost",
            "labels-merged",
        ),
    ),
    Numbered(
        14,
        "a full installation built and then failed at import; README promised what is not so",
        "package.xml files name what is needed; README says what is so today",
    ),
    Numbered(
        15,
        "the check deleted every process's shared memory; graph_seconds grew without bound; "
        "rclpy's private executor was reached into",
        "own files only; a bounded number; a public executor",
    ),
    Numbered(
        16,
        "the environment took 6.5 GB, 4 of them never used",
        "triton and unused CUDA packages are left out; TORCH_BACKEND=cpu asks for the CPU build",
    ),
    Numbered(
        17,
        "make demo ended in a traceback where the scene lacked a goal's block or OUT could not be "
        "written",
        "the scene has the blocks that the goal names; every bad argument is one sentence",
    ),
)  # fmt: skip


def numbered_table(
    entries: Sequence[Mapping[str, Any]], tests: Mapping[int, Sequence[str]]
) -> list[dict[str, Any]]:
    """For each fault what it was and is, how its kinds ended in a campaign, and its tests.

    Args:
        entries: the dictionary of :func:`faults.report.dictionary`.
        tests: names by number, see :func:`tests_that_name`.
    """
    table = []
    for item in NUMBERED:
        mine = [entry for entry in entries if any(kind in entry["fault"] for kind in item.kinds)]
        endings: dict[str, int] = {}
        for entry in mine:
            endings[entry["ending"]] = endings.get(entry["ending"], 0) + entry["n"]
        table.append(
            {
                "number": item.number,
                "was": item.was,
                "now": item.now,
                "trials": ", ".join(f"{count} {ending}" for ending, count in endings.items()),
                "tests": list(tests.get(item.number, ())),
            }
        )
    return table


def tests_that_name(folder: Path) -> dict[int, list[str]]:
    """The tests that have ``fault_N`` in name or docstring, by N, sorted."""
    found: dict[int, set[str]] = {}
    for path in folder.rglob("test_*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.FunctionDef) or not node.name.startswith("test_"):
                continue
            for number in _numbers([node.name, ast.get_docstring(node) or ""]):
                found.setdefault(number, set()).add(node.name)
    return {number: sorted(names) for number, names in sorted(found.items())}


def _numbers(texts: Iterable[str]) -> set[int]:
    return {int(number) for text in texts for number in re.findall(r"fault_(\d+)(?!\d)", text)}
