"""aeroservo: flutter, divergence, reversal and their control for flexible aircraft.

The public names are listed by hand in `__init__.pyi` and loaded when first used.
"""

import lazy_loader as _lazy

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
