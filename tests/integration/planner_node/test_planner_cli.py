# SPDX-License-Identifier: Apache-2.0
"""What the commands print and return, with a client that needs no planner."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from PIL import Image
from planner_neighbours import scene_message
from sensor_msgs.msg import Image as ImageMsg
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, Move, SymbolicPlan
from tamp_interfaces.srv import PlanToGoal

from planner_node.cli import commands
from planner_node.cli.arm_text import describe_arm
from planner_node.cli.goal_image import ImageFileError, read_goal_image
from planner_node.cli.plan_text import describe_scene
from planner_node.cli.write_pddl import write_pddl

Result = AchieveGoal.Result
Feedback = AchieveGoal.Feedback

PLAN = SymbolicPlan(
    plan_id="abc",
    initial=scene_message((("red_box",), ()), Time()),
    moves=[Move(source=0, target=1, object_name="red_box")],
)
STATES = [scene_message(((), ("red_box",)), Time())]


class FakePlanner:
    """A client whose goal ends with ``result`` as soon as it is cancelled, or at once.

    Attributes:
        seconds: how long each look at the goal takes.
        interrupt: Ctrl-C comes while the goal is worked on.
        interrupt_at: what is called when another one comes: start, cancel or wait.
    """

    def __init__(self) -> None:
        self.answer = PlanToGoal.Response()
        self.final = Result()
        self.ends_by_itself = True
        self.interrupt = False
        self.interrupt_at: set[str] = set()
        self.cancels = 0
        self.withdrawals = 0
        self.asked: dict[str, Any] = {}
        self.now = 0.0

    def __enter__(self) -> FakePlanner:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def plan(self, goal: str, **arguments: Any) -> PlanToGoal.Response:
        self.asked = {"goal": goal, **arguments}
        return self.answer

    def start(self, goal: str, **arguments: Any) -> None:
        self.asked = {"goal": goal, **arguments}
        self.interrupted("start")

    def interrupted(self, call: str) -> None:
        if call in self.interrupt_at:
            raise KeyboardInterrupt

    def next_feedback(self, timeout: float) -> None:
        self.now += timeout
        if self.cancels:
            self.interrupted("wait")
        if self.interrupt:
            self.interrupt = False
            raise KeyboardInterrupt

    def is_done(self) -> bool:
        return self.ends_by_itself or self.cancels > 0

    def cancel(self) -> None:
        self.interrupted("cancel")
        self.cancels += 1

    def withdraw(self, timeout: float = 1.0) -> bool:
        del timeout
        self.withdrawals += 1
        return True

    def result(self, timeout: float) -> AchieveGoal.Result:
        del timeout
        return self.final


@pytest.fixture
def planner(monkeypatch: pytest.MonkeyPatch) -> FakePlanner:
    fake = FakePlanner()
    monkeypatch.setattr(commands, "PlannerClient", lambda: fake)
    monkeypatch.setattr(commands, "prepare", lambda _arguments: None)
    monkeypatch.setattr(commands.time, "monotonic", lambda: fake.now)
    return fake


def test_a_plan_is_asked_for_as_it_was_typed(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str]
) -> None:
    planner.answer = PlanToGoal.Response(
        message="1 move", plan=PLAN, states=STATES, expanded=7, planning_seconds=0.25
    )
    assert commands.plan_to_goal(["plan_to_goal", "red on stack1", "--execute"]) == 0
    assert (planner.asked["goal"], planner.asked["execute"]) == ("red on stack1", True)
    assert capsys.readouterr().out.splitlines() == [
        "1 move",
        "       start    [red_box | -]",
        "(0, 1) red_box  [- | red_box]",
        "7 states expanded in 0.250 s",
    ]


@pytest.mark.parametrize("command", [commands.plan_to_goal, commands.achieve_goal])
def test_another_planners_plan_is_read_from_its_file(
    planner: FakePlanner, command: Callable[[list[str]], int], tmp_path: Path
) -> None:
    (tmp_path / "plan").write_text("(0, 1)\n")
    assert command(["command", "--plan", str(tmp_path / "plan")]) == 0
    assert (planner.asked["goal"], planner.asked["plan"]) == ("", "(0, 1)\n")


def test_problems_are_written_for_other_planners(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    state = ("--state", "[red_box green_box | - | blue_box]", "--out", str(tmp_path / "pddl"))
    assert write_pddl(["write_pddl", "red on blue", *state]) == 0
    assert "'red_box on blue_box'" in capsys.readouterr().out
    problem = (tmp_path / "pddl" / "problem.pddl").read_text()
    assert "(on green_box red_box)" in problem
    assert "(:goal (and (on red_box blue_box)))" in problem
    assert "(:action move" in (tmp_path / "pddl" / "domain.pddl").read_text()
    assert write_pddl(["write_pddl", "red on pink", *state]) == 1
    assert "pink" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        write_pddl(["write_pddl", "red on blue", "--state", "red_box | red_box"])


def test_a_refused_goal_is_explained(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str]
) -> None:
    planner.answer = PlanToGoal.Response(status=Result.UNKNOWN_OBJECT, message="there is blue_box")
    assert commands.plan_to_goal(["plan_to_goal", "red on purple"]) == 1
    assert capsys.readouterr() == ("", "plan_to_goal: there is blue_box\n")


@pytest.mark.parametrize("status", [Result.SUCCESS, Result.ALREADY_TRUE])
def test_an_achieved_goal_is_told_with_its_times(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str], status: int
) -> None:
    planner.final = Result(status=status, message="confirmed", moves_executed=3, plan_seconds=0.5)
    assert commands.achieve_goal(["achieve_goal", "red on blue"]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first == "confirmed"
    assert second.startswith("3 moves, 0 replans;")
    assert "plan 0.500 s" in second


def test_a_failed_goal_names_the_module(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str]
) -> None:
    planner.final = Result(status=Result.UNREACHABLE, message="no way", module="planner")
    assert commands.achieve_goal(["achieve_goal", "red on blue"]) == 1
    assert capsys.readouterr().err == "achieve_goal [planner]: no way\n"


@pytest.mark.parametrize(
    ("interrupt", "code", "sentence"),
    [(False, 1, "not done after 12 s"), (True, 130, "waiting until the arm rests")],
)
def test_a_goal_that_is_given_up_is_cancelled(
    planner: FakePlanner,
    capsys: pytest.CaptureFixture[str],
    interrupt: bool,
    code: int,
    sentence: str,
) -> None:
    planner.ends_by_itself, planner.interrupt = False, interrupt
    planner.final = Result(status=Result.CANCELLED, message="cancelled; all is down")
    assert commands.achieve_goal(["achieve_goal", "red on blue", "--timeout", "12"]) == code
    assert planner.cancels == 1
    error = capsys.readouterr().err
    assert sentence in error
    assert "all is down" in error


def test_fault_1_a_client_that_is_interrupted_while_it_asks_withdraws_the_goal(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str]
) -> None:
    planner.interrupt_at = {"start"}
    assert commands.achieve_goal(["achieve_goal", "red on blue"]) == 130
    assert (planner.cancels, planner.withdrawals) == (0, 1)
    assert "the goal is cancelled" in capsys.readouterr().err


@pytest.mark.parametrize(("when", "withdrawals"), [("cancel", 1), ("wait", 0)])
def test_fault_1_the_second_ctrl_c_leaves_at_once_and_the_goal_is_cancelled_all_the_same(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str], when: str, withdrawals: int
) -> None:
    planner.ends_by_itself, planner.interrupt, planner.interrupt_at = False, True, {when}
    assert commands.achieve_goal(["achieve_goal", "red on blue"]) == 130
    assert planner.withdrawals == withdrawals
    assert planner.cancels + planner.withdrawals == 1
    error = capsys.readouterr().err
    assert "the arm puts down what it holds" in error
    assert "ros2 run planner_node stop" in error


def test_fault_4_a_failure_is_told_with_its_first_cause_and_what_the_arm_holds(
    planner: FakePlanner, capsys: pytest.CaptureFixture[str]
) -> None:
    motion = MotionStatus(arm=MotionStatus.ARM_RESTING, held="red_box")
    motion.hand.x = 0.512
    planner.final = Result(
        status=Result.TOO_MANY_REPLANS,
        message="given up",
        module="motion",
        causes=["the fingers closed on nothing", "the arm fell behind"],
        motion=motion,
    )
    assert commands.achieve_goal(["achieve_goal", "red on blue"]) == 1
    assert capsys.readouterr().err.splitlines() == [
        "achieve_goal [motion]: given up",
        "  the first cause: the fingers closed on nothing",
        "  the arm rests away from home, its hand at (0.51, 0.00, 0.00) m, and holds red_box",
    ]


@pytest.mark.parametrize(
    ("arm", "held", "sentence"),
    [
        (MotionStatus.ARM_HOME, "", "the arm is at home with an empty hand"),
        (MotionStatus.ARM_MOVING, "?", "the arm still moves and holds something"),
        (MotionStatus.ARM_UNKNOWN, "", "it may still move"),
    ],
)
def test_the_arm_is_described_as_the_motion_node_reports_it(
    arm: int, held: str, sentence: str
) -> None:
    assert sentence in describe_arm(MotionStatus(arm=arm, held=held))


def save(path: Path, pixels: Any) -> Path:
    Image.fromarray(pixels).save(path)
    return path


def test_goal_images_are_read_from_files(planner: FakePlanner, tmp_path: Path) -> None:
    colors = save(tmp_path / "goal.png", np.full((4, 6, 3), 7, np.uint8))
    labels = save(tmp_path / "labels.png", np.full((4, 6), 300, np.uint16))
    images = ("--goal-image", str(colors), "--goal-segmentation", str(labels))
    assert commands.plan_to_goal(["plan_to_goal", *images]) == 0
    image: ImageMsg = planner.asked["goal_image"]
    segmentation: ImageMsg = planner.asked["goal_segmentation"]
    assert (image.encoding, image.width, image.height) == ("rgb8", 6, 4)
    assert set(image.data) == {7}
    assert segmentation.encoding == "16UC1"
    assert segmentation.data[:2].tobytes() == (300).to_bytes(2, "little")


def test_labels_in_colour_are_no_labels(tmp_path: Path) -> None:
    picture = save(tmp_path / "goal.png", np.zeros((4, 6, 3), np.uint8))
    with pytest.raises(ImageFileError, match="not an image of labels"):
        read_goal_image(picture, picture)


@pytest.mark.parametrize("command", [commands.plan_to_goal, commands.achieve_goal])
@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--goal-image", "x.png"), "belong together"),
        (("--goal-image", "x.png", "--goal-segmentation", "y.png"), "cannot read"),
        ((), "give a goal"),
        (("red on blue", "--timeout", "soon"), "--timeout"),
        (("--plan", "x.plan"), "cannot read it"),
    ],
)
def test_bad_arguments_are_refused(
    capsys: pytest.CaptureFixture[str],
    command: Callable[[list[str]], int],
    arguments: tuple[str, ...],
    sentence: str,
) -> None:
    with pytest.raises(SystemExit) as caught:
        command(["command", *arguments])
    assert caught.value.code == 2
    assert sentence in capsys.readouterr().err


def test_a_scene_without_stacks_is_told_by_its_relations() -> None:
    message = scene_message((("red_box",), ("blue_box",)), Time())
    message.relations = message.relations[:1]
    message.relations[0].object = "red_box"
    assert describe_scene(message) == "blue_box up red_box"
