"""The program of the standalone server: the command `pacinian`.

`pacinian -m MODULE` runs a module, as Python does: so the server's first process starts the others.
"""

import runpy
import sys

if sys.argv[1:2] == ["-m"]:
    del sys.argv[:2]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
else:
    from pacinian.__main__ import main

    main()
