# SPDX-License-Identifier: Apache-2.0
"""sim_node for programs and for people who type."""
