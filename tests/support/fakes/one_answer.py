"""A parser that says the same of every description: ``python one_answer.py accepted|rejected [--chatter]``.

It claims the level accept for both versions. It knows nothing of the package that is tested.
"""

import json
import sys

word = sys.argv[1]
answers = {
    "start": {
        "outcome": "started",
        "protocol": "1.0",
        "parser": {"name": f"always_{word}", "version": "1", "language": "Python"},
        "claims": {"1": ["accept"], "2": ["accept"]},
    },
    "load": {"outcome": word, "issues": []} | ({"robot": None} if word == "accepted" else {}),
    "evaluate": {"outcome": "unsupported", "feature": "evaluate"},
    "stop": {"outcome": "stopped"},
}
for line in sys.stdin:
    request = json.loads(line)
    if "--chatter" in sys.argv and request["command"] == "load":
        sys.stdout.write("reading\n")
    sys.stdout.write(json.dumps({"id": request["id"]} | answers[request["command"]]) + "\n")
    sys.stdout.flush()
    if request["command"] == "stop":
        break
