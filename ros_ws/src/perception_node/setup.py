# SPDX-License-Identifier: Apache-2.0
from setuptools import find_packages, setup

PACKAGE = "perception_node"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=find_packages(),
    package_data={PACKAGE: ["py.typed", "weights/*.safetensors", "weights/*.json", "*.c", "*/*.c"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "perception_node = perception_node.executable:perception_node",
            "train_visual = perception_node.executable:train_visual",
            "train_masks = perception_node.executable:train_masks",
        ]
    },
)
