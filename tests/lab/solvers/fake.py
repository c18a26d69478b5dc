"""A worker whose solver misbehaves as its first argument says; speaks the protocol of `solvers/worker.py`."""

import json
import sys
import threading

how = sys.argv[1]


def write(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def say(told: object) -> None:
    write(json.dumps(told))


if how == "dies at once":
    sys.exit("no such library")
if how == "says nothing of itself":
    say({"hello": 1})
else:
    say({"versions": {"fake": "1"}, "offers": [["fake", "cold"]]})
for line in sys.stdin:
    problem = json.loads(line)["problem"]
    N, points = len(problem["positions"]), problem["frames"][0]
    good = {"re": [1.0] * N, "im": [0.0] * N, "points": points, "p50": 1e-3, "p99": 2e-3,
            "samples": 3, "traced": 10, "resident": 1e6}  # fmt: skip
    if how == "crashes":
        sys.stderr.write("first words\n")
        sys.exit("last words")
    if how == "hangs":
        threading.Event().wait()
    answers = {
        "works": good,
        "fails": {"error": "ValueError: not today"},
        "is short": {**good, "re": [1.0] * 5, "im": [0.0] * 5},
        "is ragged": {**good, "re": [1.0] * 5},
        "is not finite": {**good, "im": [float("nan")] * N},
        "moves": {**good, "points": points[1:]},
        "forgets": {"re": good["re"]},
        "says text": {**good, "re": ["a"] * N},
        "is a list": [1, 2, 3],
    }
    if how == "is no JSON":
        write("Hello!")
    else:
        say(answers[how])
