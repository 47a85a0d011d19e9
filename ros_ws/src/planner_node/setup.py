# SPDX-License-Identifier: Apache-2.0
from setuptools import find_packages, setup

PACKAGE = "planner_node"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=find_packages(),
    package_data={PACKAGE: ["py.typed", "weights/*.safetensors", "*/*.c", "goals/grammar/*.txt"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "planner_node = planner_node.executable:planner_node",
            "plan_to_goal = planner_node.executable:plan_to_goal",
            "achieve_goal = planner_node.executable:achieve_goal",
            "stop = planner_node.executable:stop",
            "write_pddl = planner_node.executable:write_pddl",
        ]
    },
)
