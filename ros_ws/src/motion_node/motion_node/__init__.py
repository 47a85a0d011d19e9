# SPDX-License-Identifier: Apache-2.0
"""From symbolic plan to joint trajectory: kinematics, k-order path problem, bounds."""
