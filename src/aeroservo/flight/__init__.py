"""Rigid flight mechanics: equations of motion, trim and linear models."""
