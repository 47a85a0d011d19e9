# SPDX-License-Identifier: Apache-2.0
"""Carrying plans out: send trajectories, watch the arm, end in an orderly way."""
