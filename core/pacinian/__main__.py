"""`python -m pacinian`."""

from pacinian.cli.main import main

main()
