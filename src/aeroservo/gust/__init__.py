"""Gusts and turbulence: what shakes the aircraft."""
