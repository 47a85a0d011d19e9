# SPDX-License-Identifier: Apache-2.0
"""Launch and parameter files, RViz layout, and one executable that starts the whole graph."""
