"""The command line: thin wrappers that read options, call the same functions as Python users, and format."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line; exits with 0 (done), 2 (bad input) or 1 (anything else), never with a traceback.

    Raises
    ------
    SystemExit
        Always, with one of these codes.
    """
    from aeroservo.cli.app import app
    from aeroservo.cli.output import complain, quiet_warnings

    for stream in (sys.stdout, sys.stderr):  # names may hold anything; a terminal may not
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    quiet_warnings()
    try:
        app()
    except ValueError as error:
        if type(error).__module__.startswith("numpy"):  # LinAlgError is a ValueError, but not the user's
            complain(f"the computation failed: {error}")
            raise SystemExit(1) from None
        complain(str(error))
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        complain("interrupted")
        raise SystemExit(1) from None
    except Exception as error:
        complain(f"internal error, please report it: {type(error).__name__}: {error}")
        raise SystemExit(1) from None
