"""Unsteady and steady air forces: sections, strips and lifting surfaces."""
