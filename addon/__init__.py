# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender loads, and nothing else. Imports go one way: reference, library, blender, choose, ui."""
