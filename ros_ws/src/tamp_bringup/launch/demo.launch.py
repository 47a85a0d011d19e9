# SPDX-License-Identifier: Apache-2.0
"""Starts the nodes on a full ROS 2 Jazzy: ``ros2 launch tamp_bringup demo.launch.py``.

``ros2 launch tamp_bringup demo.launch.py --show-args`` lists the arguments. An argument wins over
``config/demo.yaml``. When a node ends, the others are stopped.
"""

from ament_index_python.packages import (
    PackageNotFoundError,
    get_package_prefix,
    get_package_share_path,
)
from launch import LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    EmitEvent,
    LogInfo,
    OpaqueFunction,
    RegisterEventHandler,
)
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

SIMULATOR = "sim_node"
OTHERS = ("perception_node", "planner_node", "motion_node")
# What nodes name absolutely, by ROS's own custom; in a namespace it is that of the graph there.
NAMESPACED = [("/clock", "clock"), ("/tf", "tf"), ("/tf_static", "tf_static")]
SWITCH = ["true", "false"]
# A node ends itself within 5 s, and within 10 s where the machine has a lot to do.
STOP_SECONDS = "10"


def generate_launch_description() -> LaunchDescription:
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "seed", default_value="0", description="seed of the first scene, 0 or more"
            ),
            DeclareLaunchArgument(
                "blocks", default_value="5", description="blocks of the first scene, 3 to 7"
            ),
            DeclareLaunchArgument(
                "real_time_factor",
                default_value="1.0",
                description="simulated seconds a second; 0: as fast as it goes",
            ),
            DeclareLaunchArgument(
                "simulation",
                default_value="true",
                choices=SWITCH,
                description="false: no simulator, bring your own camera, arm and wall time",
            ),
            DeclareLaunchArgument(
                "namespace",
                default_value="",
                description="of every node, topic, clock and frame, such as /left; two graphs in "
                "two namespaces run side by side",
            ),
            DeclareLaunchArgument(
                "rviz", default_value="false", choices=SWITCH, description="also start rviz2"
            ),
            OpaqueFunction(function=start_graph),
        ]
    )


def start_graph(context: LaunchContext) -> list:
    """The nodes, once the arguments are known; what is missing is found before any is started."""

    def given(name: str) -> str:
        return LaunchConfiguration(name).perform(context)

    simulation = given("simulation") == "true"
    names = (SIMULATOR, *OTHERS) if simulation else OTHERS
    if missing := [name for name in names if not is_installed(name)]:
        raise RuntimeError(f"not built or not sourced: {', '.join(missing)}; nothing was started")
    scene = {
        "seed": number("seed", given("seed"), int),
        "blocks": number("blocks", given("blocks"), int),
        "real_time_factor": number("real_time_factor", given("real_time_factor"), float),
    }
    share = get_package_share_path("tamp_bringup") / "config"
    place = {}
    if namespace := given("namespace").strip("/"):
        place = {"namespace": f"/{namespace}", "remappings": NAMESPACED}
    entities = []
    for name in names:
        # Both stand under /** for ROS, where the later file wins.
        own = scene if name == SIMULATOR else {"use_sim_time": simulation}
        node = Node(
            package=name,
            executable=name,
            parameters=[str(share / "demo.yaml"), own],
            output="screen",
            sigterm_timeout=STOP_SECONDS,
            sigkill_timeout=STOP_SECONDS,
            **place,
        )
        # The handler first: a node may end at once.
        ended = OnProcessExit(target_action=node, on_exit=when_ended(name))
        entities += [RegisterEventHandler(ended), node]
    if given("rviz") == "true":
        entities.append(rviz(str(share / "demo.rviz"), simulation, place))
    return entities


def rviz(layout: str, simulation: bool, place: dict) -> object:
    """RViz, whose window may be closed while the graph runs on; a sentence where it is missing."""
    if not is_installed("rviz2"):
        return LogInfo(
            msg="rviz2 is not installed, so the graph runs without it; "
            "sudo apt-get install ros-jazzy-rviz2"
        )
    return Node(
        package="rviz2",
        executable="rviz2",
        arguments=["-d", layout],
        parameters=[{"use_sim_time": simulation}],
        **place,
    )


def when_ended(name: str):
    """What happens when a node ends: it is said, and the others are stopped."""

    def stop_the_rest(event, context: LaunchContext) -> list:
        if context.is_shutdown:  # all of them are being stopped
            return []
        reason = f"{name} ended with exit code {event.returncode}; without it the graph is no use"
        return [
            LogInfo(msg=f"{reason}, so the rest is stopped"),
            EmitEvent(event=Shutdown(reason=reason)),
        ]

    return stop_the_rest


def is_installed(package: str) -> bool:
    """Whether ROS finds a package."""
    try:
        get_package_prefix(package)
    except PackageNotFoundError:
        return False
    return True


def number(name: str, text: str, kind: type):
    """The number that an argument gives; raises RuntimeError before anything is started."""
    try:
        return kind(text)
    except ValueError:
        wanted = "a whole number" if kind is int else "a number"
        raise RuntimeError(f"{name}:={text} is not {wanted}; nothing was started") from None
