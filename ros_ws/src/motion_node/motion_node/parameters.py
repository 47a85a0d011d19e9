# SPDX-License-Identifier: Apache-2.0
"""The parameters of motion_node, and the settings made of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from tamp_runtime.parameters import ParameterSpec

from .execution.monitor import MonitorSettings
from .execution.settings import ExecutionSettings, StepSettings
from .nlp import SOLVERS
from .obstacles import ObstacleError, read_obstacles
from .robots import ARMS, PANDA, Arm
from .settings import PathSettings, PhaseSettings, Settings
from .timing.time_paths import TimingSettings

_SETTINGS, _EXECUTION, _MONITOR = Settings(), ExecutionSettings(), MonitorSettings()
_STEP = StepSettings()
_PHASES, _PATH, _TIMING = _SETTINGS.phases, _SETTINGS.path, _SETTINGS.timing


def _spec(
    name: str, default: Any, description: str, low: float, high: float, read_only: bool = False
) -> ParameterSpec:
    return ParameterSpec(name, default, description, low, high, read_only)


def _robot_problem(name: str) -> str:
    """the name of an arm in motion_node.robots"""
    known = ", ".join(sorted(ARMS))
    return "" if name in ARMS else f"robot = {name!r} is not a known arm; known: {known}"


def _solver_problem(name: str) -> str:
    """the name of a solver in motion_node.nlp"""
    known = ", ".join(sorted(SOLVERS))
    return "" if name in SOLVERS else f"solver = {name!r} is not a known solver; known: {known}"


def _obstacles_problem(path: str) -> str:
    """a YAML file with a list `obstacles` as in sim_node's scenes, or empty"""
    try:
        read_obstacles(path)
    except ObstacleError as error:
        return f"obstacles: {error}"
    return ""


PARAMETERS = (
    ParameterSpec("robot", PANDA.name, "Which arm moves.", read_only=True, check=_robot_problem),
    ParameterSpec(
        "solver",
        _SETTINGS.solver,
        "What solves the motion problems.",
        read_only=True,
        check=_solver_problem,
    ),
    ParameterSpec(
        "joint",
        _SETTINGS.joint,
        "Whether all phases of a plan and the switches between them are optimised at once, from "
        "what phase by phase gives. It takes two to ten times as long.",
        read_only=True,
    ),
    ParameterSpec(
        "obstacles",
        "",
        "File that says what stands around besides blocks; the arm and what it holds keep away.",
        read_only=True,
        check=_obstacles_problem,
    ),
    ParameterSpec(
        "gripper_apart",
        False,
        "Arm and gripper have a controller each: the fingers' part of a trajectory goes to "
        "gripper_trajectory, the arm's, with the same stamp, to joint_trajectory. false: all "
        "joints in one message.",
        read_only=True,
    ),
    ParameterSpec(
        "world_frame",
        "world",
        "The frame besides the root of robot_description that plans may be in: the root stands in "
        "its origin.",
    ),
    _spec(
        "velocity_scale",
        _TIMING.velocity_scale,
        "Share of the joints' velocity limits that trajectories use.",
        0.01,
        1.0,
    ),
    _spec(
        "acceleration_scale",
        _TIMING.acceleration_scale,
        "Share of the joints' acceleration limits that trajectories use.",
        0.01,
        1.0,
    ),
    ParameterSpec(
        "acceleration_limits",
        [],
        "Acceleration limits of the arm's joints, one each; empty: the arm's own [rad/s^2].",
        0.1,
        100.0,
        True,
        element=float,
    ),
    _spec(
        "hand_clearance",
        _PATH.margin,
        "Distance of arm and held block to blocks and table, but where they are to touch [m].",
        0.0,
        0.05,
        True,
    ),
    _spec(
        "steps_per_phase",
        _PATH.steps,
        "Intervals into which the path of each pick or place is divided.",
        9,
        60,
        True,
    ),
    _spec(
        "vertical_steps",
        _PATH.vertical,
        "How many of them, at either end of a phase, the hand moves vertically.",
        2,
        4,
        True,
    ),
    _spec(
        "lift_height",
        _PATH.lift,
        "The hand moves vertically for at least this long at a pick or place [m].",
        0.02,
        0.2,
        True,
    ),
    _spec(
        "max_lean", _PATH.max_lean, "How far the hand may lean on its way [rad].", 0.0, 0.5, True
    ),
    _spec(
        "max_grasp_width",
        _PHASES.max_grasp_width,
        "Widest block that the open fingers go around [m].",
        0.01,
        0.08,
        True,
    ),
    _spec(
        "place_gap",
        _PHASES.place_gap,
        "Height above its support at which a block is let go [m].",
        0.0,
        0.01,
        True,
    ),
    _spec(
        "max_overhang",
        _PHASES.max_overhang,
        "A block is put at most this share of its support's width away from the support's centre.",
        0.0,
        0.45,
        True,
    ),
    _spec(
        "grasp_squeeze",
        _SETTINGS.squeeze,
        "How much farther than the block's half width each finger is sent [m].",
        0.002,
        0.02,
        True,
    ),
    _spec(
        "close_seconds",
        _TIMING.close_seconds,
        "Standing still at least, while the fingers close on a block [s].",
        0.1,
        5.0,
    ),
    _spec(
        "open_seconds",
        _TIMING.open_seconds,
        "Standing still at least, while the fingers let go of a block [s].",
        0.1,
        5.0,
    ),
    _spec(
        "tracking_tolerance",
        _MONITOR.tracking_tolerance,
        "Deviation of a joint from the path that ends the execution [rad].",
        0.01,
        1.0,
    ),
    _spec(
        "max_lag",
        _MONITOR.max_lag,
        "How far the arm may fall behind the trajectory [s].",
        0.1,
        60.0,
    ),
    _spec(
        "start_timeout",
        _MONITOR.start_seconds,
        "The arm has to start within this time [s].",
        0.5,
        60.0,
    ),
    _spec(
        "goal_tolerance",
        _MONITOR.goal_tolerance,
        "Deviation of a joint at the end that counts as arrived [rad].",
        0.001,
        0.2,
    ),
    _spec(
        "grasp_tolerance",
        _MONITOR.grasp_tolerance,
        "Fingers this near to where they were sent hold nothing [m].",
        0.0005,
        0.02,
    ),
    _spec(
        "joint_state_timeout",
        _EXECUTION.joint_state_timeout,
        "Silence of joint_states, or of their clock, that ends the execution [s, wall time].",
        0.1,
        600.0,
    ),
    _spec(
        "description_timeout",
        _EXECUTION.description_timeout,
        "How long a plan waits for robot_description [s, wall time].",
        0.1,
        600.0,
    ),
    _spec(
        "rest_timeout",
        _EXECUTION.rest_timeout,
        "How long a plan waits for the arm to stand still [s, wall time].",
        0.1,
        600.0,
    ),
    _spec(
        "execution_timeout_factor",
        _EXECUTION.execution_factor,
        "An execution ends after this many times its duration and 30 s [wall time].",
        1.0,
        10000.0,
    ),
    _spec(
        "brake_seconds",
        _EXECUTION.brake_seconds,
        "In which a moving arm comes to rest when asked to stop [s].",
        0.1,
        2.0,
    ),
    _spec(
        "start_lead",
        _STEP.lead,
        "With gripper_apart: how far ahead trajectories are stamped, so that both controllers have "
        "them in time [s, wall time].",
        0.0,
        10.0,
    ),
    _spec(
        "max_apart",
        _STEP.apart,
        "With gripper_apart: how far arm and gripper may each be from their trajectory's time [s].",
        0.05,
        10.0,
    ),
)


def chosen_arm(values: Mapping[str, Any]) -> Arm:
    """The arm that is named, with the limits that are given.

    Raises:
        ValueError: if there is not one acceleration limit a joint; the sentence says so.
    """
    named, limits = ARMS[values["robot"]], tuple(values["acceleration_limits"])
    if not limits:
        return named
    if len(limits) != len(named.arm_joints):
        raise ValueError(
            f"parameter acceleration_limits has {len(limits)} numbers; {named.name} has "
            f"{len(named.arm_joints)} joints"
        )
    return replace(named, acceleration=limits)


def planner_settings(values: Mapping[str, Any]) -> Settings:
    """What :class:`motion_node.planner.MotionPlanner` is made with."""
    return Settings(
        phases=PhaseSettings(
            max_grasp_width=values["max_grasp_width"],
            place_gap=values["place_gap"],
            max_overhang=values["max_overhang"],
        ),
        path=PathSettings(
            steps=values["steps_per_phase"],
            vertical=values["vertical_steps"],
            lift=values["lift_height"],
            margin=values["hand_clearance"],
            max_lean=values["max_lean"],
        ),
        timing=timing_settings(values),
        squeeze=values["grasp_squeeze"],
        solver=values["solver"],
        joint=values["joint"],
    )


def timing_settings(values: Mapping[str, Any]) -> TimingSettings:
    """Those settings of the planner that may change from plan to plan."""
    return TimingSettings(
        velocity_scale=values["velocity_scale"],
        acceleration_scale=values["acceleration_scale"],
        close_seconds=values["close_seconds"],
        open_seconds=values["open_seconds"],
    )


def execution_settings(values: Mapping[str, Any]) -> ExecutionSettings:
    """What the execution of the next plan is held to."""
    return ExecutionSettings(
        joint_state_timeout=values["joint_state_timeout"],
        description_timeout=values["description_timeout"],
        rest_timeout=values["rest_timeout"],
        execution_factor=values["execution_timeout_factor"],
        brake_seconds=values["brake_seconds"],
        monitor=MonitorSettings(
            tracking_tolerance=values["tracking_tolerance"],
            max_lag=values["max_lag"],
            start_seconds=values["start_timeout"],
            goal_tolerance=values["goal_tolerance"],
            grasp_tolerance=values["grasp_tolerance"],
        ),
        in_step=StepSettings(lead=values["start_lead"], apart=values["max_apart"])
        if values["gripper_apart"]
        else None,
    )
