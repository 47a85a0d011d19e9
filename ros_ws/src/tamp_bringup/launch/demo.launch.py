# SPDX-License-Identifier: Apache-2.0
"""Starts the four nodes on a full ROS 2 Jazzy: ``ros2 launch tamp_bringup demo.launch.py``.

Arguments: ``seed``, ``blocks``, ``real_time_factor``, ``rviz`` (true/false) and ``simulation``
(false: bring your own camera and arm).
"""

from ament_index_python.packages import get_package_share_path
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    share = get_package_share_path("tamp_bringup")
    parameters = str(share / "config" / "demo.yaml")
    simulation = LaunchConfiguration("simulation")
    arguments = [
        DeclareLaunchArgument("seed", default_value="0", description="seed of the first scene"),
        DeclareLaunchArgument("blocks", default_value="5", description="blocks, 3 to 7"),
        DeclareLaunchArgument("real_time_factor", default_value="1.0"),
        DeclareLaunchArgument("rviz", default_value="false"),
        DeclareLaunchArgument("simulation", default_value="true"),
    ]
    scene = {
        "seed": ParameterValue(LaunchConfiguration("seed"), value_type=int),
        "blocks": ParameterValue(LaunchConfiguration("blocks"), value_type=int),
        "real_time_factor": ParameterValue(
            LaunchConfiguration("real_time_factor"), value_type=float
        ),
    }
    clock = {"use_sim_time": ParameterValue(simulation, value_type=bool)}
    nodes = [
        Node(
            package="sim_node",
            executable="sim_node",
            parameters=[parameters, scene],
            condition=IfCondition(simulation),
            output="screen",
        ),
        *(
            Node(package=name, executable=name, parameters=[parameters, clock], output="screen")
            for name in ("perception_node", "planner_node", "motion_node")
        ),
        Node(
            package="rviz2",
            executable="rviz2",
            arguments=["-d", str(share / "config" / "demo.rviz")],
            condition=IfCondition(LaunchConfiguration("rviz")),
        ),
    ]
    return LaunchDescription(arguments + nodes)
