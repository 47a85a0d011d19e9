# SPDX-License-Identifier: Apache-2.0
"""When: paths to trajectories within the joints' limits."""
