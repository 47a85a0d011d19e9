# SPDX-License-Identifier: Apache-2.0
"""Campaigns of tasks: families to draw from, records, the running, failures, the report."""
