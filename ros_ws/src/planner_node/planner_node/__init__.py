# SPDX-License-Identifier: Apache-2.0
"""From scene graph to symbolic plan: state, action model, search, goals, closed loop."""
