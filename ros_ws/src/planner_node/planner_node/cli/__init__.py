# SPDX-License-Identifier: Apache-2.0
"""planner_node for programs and for people who type: the client, the commands, the printing."""
