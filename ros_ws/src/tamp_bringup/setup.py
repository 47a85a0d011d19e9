# SPDX-License-Identifier: Apache-2.0
from setuptools import find_packages, setup

PACKAGE = "tamp_bringup"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=find_packages(),
    package_data={PACKAGE: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/launch", ["launch/demo.launch.py"]),
        (f"share/{PACKAGE}/config", ["config/demo.yaml", "config/demo.rviz"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "demo = tamp_bringup.executable:demo",
        ]
    },
)
