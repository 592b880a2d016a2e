"""Whole studies made of the analyses: published cases re-run, the thesis' tables."""
