"""`python -m aeroservo.cli` is `aeroservo`."""

from aeroservo.cli import main

main()
