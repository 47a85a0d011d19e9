# SPDX-License-Identifier: Apache-2.0
"""Settings of the whole suite."""

from __future__ import annotations

from hypothesis import settings

# No test is about speed: benchmarks measure it.
settings.register_profile("any_speed", deadline=None)
settings.load_profile("any_speed")
