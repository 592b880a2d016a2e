"""aeroservo: flutter, divergence, reversal and their control for flexible aircraft."""

__version__ = "0.1.0"
