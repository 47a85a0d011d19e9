# SPDX-License-Identifier: Apache-2.0
"""What ``make eval-perception`` measures on: sets of pictures, and how their graphs are counted."""
