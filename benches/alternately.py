"""Compares two builds of the program by time: old, old again, new, in turn, and the least of each over the rounds.

    python3 benches/alternately.py OLD NEW -- --scene radial-2d --scheme p1,wopsip --levels 64,128

OLD and NEW are two binaries of `unilateral`; behind `--` stand the options of `compare` (`--threads 1` for one thread).
A line is a row of the report, the sum of all rows, or the processor seconds of the whole run. The second run of the old
binary shows what the machine adds by itself: `itself` is its least over the least of the first. A line is `worse` if
new over old exceeds the bar by more than that spread. Where the spread itself is above the bar, times decide nothing,
and counts do: outer steps and linear iterations of the row, instructions of the whole run (`--instructions`, which runs
each binary once more under `perf stat` or, where the machine does not count, under valgrind, on one thread).

The exit status is 1 if a line is worse. Python 3 alone is needed.
"""

import argparse
import json
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile


def run(binary, options):
    """Rows of a run by their names, and the processor seconds of the whole run."""
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [binary, "compare", *options, "--quiet", "--no-fields", "--out", folder]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if not os.path.exists(f"{folder}/report.json"):
            sys.exit(f"{binary} wrote no report:\n{done.stderr}")
        with open(f"{folder}/report.json") as file:
            rows = json.load(file)["rows"]
    seconds = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return {f"{row['scene']} {row['label']} {row['level']}": row for row in rows}, seconds


def instructions(binary, options):
    """Instructions of a run on one thread, or None where nothing counts them."""
    with tempfile.TemporaryDirectory() as folder:
        command = [binary, "compare", *options, "--threads", "1", "--quiet", "--no-fields", "--out", folder]
        perf = ["perf", "stat", "-x", ",", "-e", "instructions:u"]
        valgrind = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
        for counter, pattern in [(perf, r"^(\d+),"), (valgrind, r"I\s+refs:\s+([\d,]+)")]:
            if shutil.which(counter[0]):
                errors = subprocess.run(counter + command, capture_output=True, text=True).stderr
                found = re.search(pattern, errors, re.MULTILINE)
                if found:
                    return int(found.group(1).replace(",", ""))
    return None


def counts(row):
    """What the solver did: status, outer steps, linear iterations."""
    return row["status"], row["iterations"]["outer"], row["iterations"]["linear"]


def verdict(ratio, itself, bar, old_counts, new_counts):
    """Whether a line is worse, and why this can be said."""
    spread = abs(math.log(itself))
    if spread <= math.log(bar):
        return "worse" if math.log(ratio) > math.log(bar) + spread else ""
    if old_counts is None:
        return "noise"
    pairs = zip(old_counts[1:], new_counts[1:])
    is_worse = old_counts[0] != new_counts[0] or any(new > bar * old for old, new in pairs)
    return "worse by counts" if is_worse else "noise, counts hold"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--bar", type=float, default=1.05, help="ratio up to which a line counts as equal")
    parser.add_argument("--seconds", default="total", help="which seconds of a row: assemble, solve, bound, total")
    parser.add_argument("--instructions", action="store_true")
    own, options = sys.argv[1:], []
    if "--" in own:
        own, options = own[: own.index("--")], own[own.index("--") + 1 :]
    arguments = parser.parse_args(own)
    if arguments.rounds < 9:
        sys.exit("--rounds: at least nine, so that each least is of a quiet moment")

    binaries = [arguments.old, arguments.old, arguments.new]
    least = [{}, {}, {}]
    last = [{}, {}, {}]
    for _ in range(arguments.rounds):
        for k, binary in enumerate(binaries):
            rows, processor = run(binary, options)
            seconds = {name: row["seconds"][arguments.seconds] for name, row in rows.items()}
            seconds["sum of rows"] = sum(seconds.values())
            seconds["processor seconds of the run"] = processor
            for name, value in seconds.items():
                least[k][name] = min(value, least[k].get(name, math.inf))
            last[k] = rows

    first, again, new = least
    if first.keys() != new.keys():
        print("only in one of them:", ", ".join(sorted(first.keys() ^ new.keys())))
    width = max(map(len, first))
    print(f"{'least of ' + str(arguments.rounds):{width}}  {'old s':>9}  {'new s':>9}  new/old  itself")
    is_worse = False
    for name in [name for name in first if name in new]:
        ratio, itself = new[name] / first[name], again[name] / first[name]
        old_counts, new_counts = (counts(rows[name]) if name in rows else None for rows in (last[0], last[2]))
        said = verdict(ratio, itself, arguments.bar, old_counts, new_counts)
        if old_counts != new_counts:
            said += f" (status, outer, linear: {old_counts} -> {new_counts})"
        is_worse |= said.startswith("worse")
        print(f"{name:{width}}  {first[name]:9.4f}  {new[name]:9.4f}  {ratio:7.3f}  {itself:6.3f}  {said}".rstrip())
    if arguments.instructions:
        old_count, new_count = (instructions(binary, options) for binary in binaries[1:])
        if old_count is None or new_count is None:
            print("instructions: neither perf nor valgrind counts them here")
        else:
            is_worse |= new_count > arguments.bar * old_count
            print(f"instructions of the run on one thread: {old_count} -> {new_count}, {new_count / old_count:.3f}")
    sys.exit(1 if is_worse else 0)


if __name__ == "__main__":
    main()
