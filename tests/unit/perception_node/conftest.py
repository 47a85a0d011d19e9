# SPDX-License-Identifier: Apache-2.0
"""Tests of perception run on shared processors: nothing here depends on how long it takes."""

from hypothesis import settings

settings.register_profile("any_speed", deadline=None)
settings.load_profile("any_speed")
