#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a command with ROS and the workspace sourced; exec, so that signals reach the command.
# shellcheck disable=SC1090,SC1091
set -eo pipefail
source "/opt/ros/$ROS_DISTRO/setup.bash" --
source /opt/tamp/local_setup.bash --
exec "$@"
