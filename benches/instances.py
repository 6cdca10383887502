"""Counts the functions that the compiler instantiates for one example, and names the largest of this library.

    python3 benches/instances.py [--example NAME] [--most N]

Generic functions are compiled anew in every crate that calls them. Those of the solver should be compiled once, in the
library (`src/instances.rs`): a crate that uses it should instantiate next to nothing of the rooms that SOLVER names. A line
is a function with the copies that the crate compiles and its size: statements of the compiler's intermediate code, of all
copies together. The exit status is 1 if functions of these rooms weigh more than LIMIT: a leak.

The compiler counts on request only (`-Zdump-mono-stats`), which a released one permits where RUSTC_BOOTSTRAP is set. Only
the example is compiled so: the variable would make cargo build the dependencies again.
"""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

SOLVER = ["algebra", "assemble", "error_bound", "inequality", "linear", "measure", "mesh", "nested", "parallel"]
LIMIT = 2_000


def command_of(example):
    """The command line with which cargo compiles an example, and its environment."""
    os.utime(f"examples/{example}.rs")
    cargo = ["cargo", "build", "--release", "--example", example, "-v"]
    shown = subprocess.run(cargo, capture_output=True, text=True)
    if shown.returncode != 0:
        sys.exit(shown.stderr)
    found = re.search(rf"Running `(.*--crate-name {example} .*)`", shown.stderr)
    if found is None:
        sys.exit(f"cargo did not say how it compiles {example}:\n{shown.stderr}")
    words = shlex.split(found.group(1))
    first = next(k for k, word in enumerate(words) if not re.match(r"\w+=", word))
    return words[first:], dict(word.split("=", 1) for word in words[:first])


def instances(example):
    """The functions that are instantiated for an example: name, copies, size of all copies."""
    command, environment = command_of(example)
    with tempfile.TemporaryDirectory() as folder:
        command[command.index("--out-dir") + 1] = folder
        command += [f"-Zdump-mono-stats={folder}", "-Zdump-mono-stats-format=json"]
        done = subprocess.run(
            command, env={**os.environ, **environment, "RUSTC_BOOTSTRAP": "1"}, capture_output=True, text=True
        )
        if done.returncode != 0:
            sys.exit(done.stderr)
        [name] = [name for name in os.listdir(folder) if name.endswith(".json")]
        with open(f"{folder}/{name}") as file:
            return [(of["name"], of["instantiation_count"], of["total_estimate"]) for of in json.load(file)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--example", default="one_problem")
    parser.add_argument("--most", type=int, default=20, help="so many functions are named")
    arguments = parser.parse_args()

    found = instances(arguments.example)
    rooms = "|".join(SOLVER)
    of_solver = [of for of in found if re.search(rf"\bunilateral::({rooms})::", of[0])]
    print(f"{'copies':>8}{'size':>9}  function")
    for name, copies, size in sorted(of_solver, key=lambda of: -of[2])[: arguments.most]:
        print(f"{copies:8}{size:9}  {name}")
    for title, of in [("of the solver's rooms", of_solver), ("in all", found)]:
        print(f"{sum(copies for _, copies, _ in of):8}{sum(size for *_, size in of):9}  {title}")
    weight = sum(size for *_, size in of_solver)
    if weight > LIMIT:
        print(f"functions of the solver's rooms weigh more than {LIMIT}: which call is outside a table of `compiled!`?")
        sys.exit(1)


if __name__ == "__main__":
    main()
