"""The server measured with real processes and real sockets.

latency.py   a hand's pose until it is emitted   sender.py   the game that sends it    echo.py    beside it
load.py      thousands of updates a second       crowd.py    who sends them            watch.py   who looks on
soak.py      a game, for a long time             game.py     its script                visitor.py who is killed
apart.py     a process of the benchmark's own    peer.py     a client on bare sockets  places.py  that tell when
drift.py     what a soak changed                 report.py   which aims are met        tables.py, picture.py
"""
