# SPDX-License-Identifier: GPL-3.0-or-later
"""A preset and a scene become a material: what the scene holds, the nodes, the lights, and what measures them."""
