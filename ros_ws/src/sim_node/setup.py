# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "sim_node"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=find_packages(),
    package_data={PACKAGE: ["py.typed", "meshes/*.obj", "scenes/*.yaml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/scenes", sorted(map(str, Path(PACKAGE, "scenes").glob("*.yaml")))),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "sim_node = sim_node.executable:sim_node",
            "render_dataset = sim_node.executable:render_dataset",
            "disturb = sim_node.executable:disturb",
        ]
    },
)
