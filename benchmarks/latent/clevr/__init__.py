# SPDX-License-Identifier: Apache-2.0
"""Scenes of things on a table and questions about them, as CLEVR has them, by our own renderer."""
