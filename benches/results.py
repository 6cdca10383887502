"""Writes pages of docs/results by their commands, with date, machine and commit in the head:

    cargo build --release && python3 benches/results.py comparison

Pages: adaptive, assembly, bernstein, bound, comparison, orders, serial, stability, time_to_error. PROGRAM names another
build of the program, COMMIT what it was built from, NOTE what else the machine did. Python 3 alone is needed.
"""

import csv
import datetime
import json
import math
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
OUT = ROOT / "target/results"
PROGRAM = os.environ.get("PROGRAM", "target/release/unilateral")


def output(*command):
    """What a command prints; a row that did not converge, exit code 1, stands in the tables."""
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}")
    return done.stdout


def run(options, folder):
    """Runs the program, with its report in a folder of OUT."""
    output(PROGRAM, *options.split(), "--quiet", "--out", str(OUT / folder))


def rows(folder):
    return json.loads((OUT / folder / "report.json").read_text())["rows"]


def finest(folder):
    """The last row of each scheme on each scene that was run, in the order of the report."""
    ran = (row for row in rows(folder) if row["status"] != "time-limit")
    return {(row["scene"], row["label"]): row for row in ran}


def number(x, form):
    return "-" if x is None else format(x, form)


def table(head, lines, left=1):
    """A table whose first columns are aligned to the left."""
    cells = [list(map(str, line)) for line in [head, *lines]]
    rule = ["---" if k < left else "--:" for k in range(len(head))]
    return "\n".join("| " + " | ".join(line) + " |" for line in [cells[0], rule, *cells[1:]]) + "\n"


def head(page, title, *commands):
    cpu = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text()).group(1)
    commit = os.environ.get("COMMIT") or output("git", "rev-parse", "--short", "HEAD").strip()
    lines = [("command", f"`{command}`") for command in commands]
    lines.append(("date", datetime.date.today().isoformat()))
    note = os.environ.get("NOTE", "")
    lines.append(("machine", f"{cpu}, {os.cpu_count()} cores{note and ', ' + note}"))
    lines.append(("commit", f"{commit}, version {output(PROGRAM, '--version').split()[1]}"))
    made = f"Written by `python3 benches/results.py {page}`, not edited by hand."
    return f"# {title}\n\n{made}\n\n" + table(["", ""], lines, 2)


def seconds_to_errors(folder):
    """Seconds by scene and norm, error, label."""
    found = {}
    with open(OUT / folder / "reach.csv") as file:
        for row in csv.DictReader(file):
            if row["standing"] == "reached" and row["norm"] != "energy":
                by_error = found.setdefault((row["scene"], row["norm"]), {})
                by_error.setdefault(float(row["error"]), {})[row["label"]] = float(row["seconds"])
    return found


def quotients(by_error, over, others):
    """The least error that all reach, and the time of one scheme over that of the others."""
    reached = [error for error, of in by_error.items() if {over, *others} <= of.keys()]
    if not reached:
        return ["-"] * (1 + len(others))
    of = by_error[min(reached)]
    return [f"{min(reached):.0e}"] + [f"{of[over] / of[other]:.2f}" for other in others]


def comparison():
    over, fair, unfair, cr = "wopsip:facet-means@factor=10", "sipg:facet-means@factor=1.05", "sipg", "cr"
    schemes = f"p1,cr,sipg,{fair},{over},nipg:facet-means,wopsip:facet-means,sipg-p2,wopsip-p2"
    mesh = "--mesh tests/data/unstructured_{}.msh --scene"
    domains = {
        "plane": "--scene radial-2d,ball-2d,hill-2d,signorini-2d,hertz-2d --levels 16,32,64,128",
        "space": "--scene radial-3d,ball-3d,hill-3d,signorini-line-3d,signorini-harmonic-3d --levels 4,8,16",
        "square": mesh.format("square") + " radial-2d,ball-2d,hill-2d --levels 0,1,2,3",
        "half-square": mesh.format("half_square") + " signorini-2d,hertz-2d --levels 0,1,2,3",
        "cube": mesh.format("cube") + " radial-3d,ball-3d,hill-3d --levels 0,1,2",
        "half-cube": mesh.format("half_cube") + " signorini-line-3d,signorini-harmonic-3d --levels 0,1,2",
    }
    times = f"work-precision --threads 1 --rounds 3 --limit 1 --subject {over} --scheme"
    loose = f"{fair},{over} --tolerance 0.1"
    for folder, domain in domains.items():
        run(f"{times} {schemes} {domain}", folder)
        run(f"{times} {loose} {domain}", f"{folder}-loose")
    lines, details = [], []
    for folder in domains:
        early = seconds_to_errors(f"{folder}-loose")
        for (scene, norm), by_error in seconds_to_errors(folder).items():
            lines.append(
                [folder, scene, norm, *quotients(by_error, over, [fair, unfair, cr]),
                 *quotients(early.get((scene, norm), {}), over, [fair]),
                 *quotients(by_error, "wopsip-p2", ["sipg-p2"])])
        for (scene, label), row in sorted(finest(folder).items()):
            error, steps, seconds = row["error"], row["iterations"], row["seconds"]
            details.append(
                [folder, scene, row["level"], f"`{label}`", number(error["l2"], ".2e"), number(error["h1"], ".2e"),
                 number(row["bound"]["effectivity"], ".2f"), steps["systems"], steps["linear"],
                 number(seconds["total"], ".3f"), number(seconds["bound"], ".3f"), row["status"]])
    (ROOT / "docs/results/radial-3d-time.svg").write_bytes((OUT / "space/radial-3d-time.svg").read_bytes())
    commands = [f"{times} {schemes} {domain}" for domain in domains.values()]
    text = head("comparison", "Over-penalty beside interior penalty, with the same choices", *commands,
                f"{times} {loose}, and so on")
    text += f"""
## Time of over-penalty over that of others

Columns four to seven: `{over}` at the smallest error that it, `{fair}`, `{unfair}` and `{cr}` reach. `sipg` has bounds at
vertices and its default penalty. *Looser stop*: both with `--tolerance 0.1`. The last two columns: `wopsip-p2` over
`sipg-p2`, bounds at nodes. `-`: they do not reach one error. Meshes: *plane* and *space* are Kuhn meshes of boxes, the
others are those of Gmsh and their refinements.

"""
    text += table(
        ["meshes", "scene", "error in", "down to", f"over `{fair}`", f"over `{unfair}`", f"over `{cr}`",
         "looser stop, down to", "looser stop, over the same", "quadratics, down to", "quadratics"], lines, 3)
    text += """
## The finest meshes

Systems: linear systems of the scheme. Steps: those of Krylov methods, zero with factors. Seconds: the least of the rounds,
without the bound, beside those of the bound.

"""
    return text + table(
        ["meshes", "scene", "level", "scheme", "L2", "H1", "bound/error", "systems", "steps", "seconds", "bound", "status"],
        details, 4)


def time_to_error():
    command = "work-precision --rounds 5 --scheme p1,cr,sipg,wopsip,wopsip:facet-means,p2"
    command += " --scene radial-2d,ball-2d,signorini-2d,hertz-2d,radial-3d,signorini-line-3d"
    schemes = command.split()[4].split(",")
    run(command, "time_to_error")
    lines = []
    for (scene, norm), by_error in seconds_to_errors("time_to_error").items():
        by_most = [(error, of) for error, of in sorted(by_error.items()) if len(of) >= 4]
        for error, of in reversed(by_most[:2]):
            times = [f"{of[s]:.1e} ({of[s] / min(of.values()):.2g})" if s in of else "-" for s in schemes]
            lines.append([f"{scene}, {norm} {error:.0e}", *times])
    text = head("time_to_error", "Time to reach an error: six schemes", command)
    text += """
Seconds to reach an error and, in parentheses, the ratio to the fastest scheme; the least of five interleaved rounds, times
between levels interpolated. `-` marks a scheme whose levels do not reach the error or start below it. The rows are the two
smallest errors that at least four schemes reach. SIPG and WOPSIP have bounds at vertices and default penalties here, but
for `wopsip:facet-means`: see `comparison.md` for equal choices.

"""
    return text + table(["scene, error", *(f"`{s}`" for s in schemes)], lines)


def bernstein():
    schemes = "--scheme p2,p2:bernstein,sipg-p2,sipg-p2:bernstein --threads 1 --repeat 3 --no-fields"
    commands = [
        f"compare {schemes} --scene radial-2d,ball-2d,signorini-2d --levels 16,32,64,128",
        f"compare {schemes} --scene radial-3d,signorini-line-3d --levels 4,8,16",
    ]
    lines = []
    for k, command in enumerate(commands):
        run(command, f"bernstein-{k}")
        for (scene, label), row in finest(f"bernstein-{k}").items():
            lines.append(
                [f"{scene}, {row['level']}", f"`{label}`", number(row["error"]["h1"], ".2e"),
                 number(row["order"]["h1"], ".2f"), number(row["bound"]["discrete"], ".2e"),
                 number(max(row["penetration"], 0.0), ".2e"), row["iterations"]["outer"],
                 number(row["seconds"]["total"], ".3g")])
    text = head("bernstein", "Bounds at nodes and on Bernstein coefficients", *commands)
    text += "\nThe finest level of each series. The order is that of the last two levels.\n\n"
    return text + table(
        ["scene, level", "scheme", "H1 error", "order", "error bound", "penetration", "active sets", "seconds"], lines, 2)


def bound():
    scenes = "radial-2d,signorini-harmonic-2d,signorini-2d,ball-2d,icelike-1d,torsion-2d"
    linears = f"compare --no-fields --levels 32 --scheme p1,cr,sipg,nipg,iipg,ldg,br2,bmmpr,wopsip,wopsip:facet-means --scene {scenes}"
    quadratics = "compare --no-fields --levels 32 --scheme p2,sipg-p2,nipg-p2,iipg-p2,ldg-p2,br2-p2,bmmpr-p2,wopsip-p2"
    quadratics += " --scene radial-2d,ball-2d,bilateral-1d,signorini-harmonic-2d,signorini-2d"
    uniform = "compare --no-fields --threads 1 --repeat 3 --scheme p1,cr,sipg,wopsip:facet-means"
    adaptive = f"{uniform.replace(' --repeat 3', '')} --adaptive theta=0.5,steps=12 --scene ball-2d,lshape-2d"
    times = [adaptive, f"{uniform} --scene radial-2d --levels 256", f"{uniform} --scene radial-3d --levels 24"]
    commands = [linears, quadratics, *times]
    for k, command in enumerate(commands):
        run(command, f"bound-{k}")

    def by_scheme(folders, cell):
        found = {key: row for folder in folders for key, row in finest(folder).items()}
        labels = list(dict.fromkeys(label for _, label in found))
        scenes = list(dict.fromkeys(scene for scene, _ in found))
        lines = [[scene, *(cell(found[scene, label]) for label in labels)] for scene in scenes]
        return table(["scene", *(f"`{label}`" for label in labels)], lines)

    def quotient(key):
        return lambda row: number(row["bound"][key], ".2f") if row["bound"][key] else number(row["bound"]["total"], ".1e")

    text = head("bound", "Error bounds over errors", *commands)
    text += "\nA row whose solution is not known, torsion-2d, has the bound `total` itself.\n"
    for title, folders, cell in [
        ("Linears: `effectivity`, the bound on the solution over its error", ["bound-0"], quotient("effectivity")),
        ("Linears: `effectivity_of_v`, the bound on the admissible function over its error", ["bound-0"],
         quotient("effectivity_of_v")),
        ("Quadratics: `effectivity`", ["bound-1"], quotient("effectivity")),
        ("Quadratics: `effectivity_of_v`", ["bound-1"], quotient("effectivity_of_v")),
        ("Seconds of the bound over those of the solve; of adaptive meshes all steps", ["bound-2", "bound-3", "bound-4"],
         lambda row: number(row["seconds"]["bound"] / row["seconds"]["solve"], ".2f")),
    ]:
        text += f"\n## {title}\n\n" + by_scheme(folders, cell)
    return text


def slope(rows, key):
    """The slope of a figure against unknowns, over the last half of the steps."""
    first, last = rows[len(rows) // 2], rows[-1]
    return math.log(key(last) / key(first)) / math.log(last["unknowns"] / first["unknowns"])


def steps_of(folder):
    """The lines of the adaptive series of a run: rates, quotients of bounds, and the last step that converged."""
    series, lines = {}, []
    for row in rows(folder):
        series.setdefault((row["scene"], row["label"]), []).append(row)
    for (scene, label), steps in series.items():
        end = steps[-1]["status"]
        steps = [row for row in steps if row["status"] == "converged"]
        last = steps[-1]
        unknowns = f"{last['unknowns']}" + ("" if end == "converged" else f", then {end}")
        of_bound = slope(steps, lambda row: row["bound"]["discrete"])
        of_error = slope(steps, lambda row: row["error"]["broken_energy"])
        effectivity = [row["bound"]["effectivity"] for row in steps]
        stages = [stage["stage"] for stage in last["iterations"]["stages"]]
        star = "*" if "interior-point" in stages else ""
        lines.append(
            [scene, f"`{label}`", last["level"], unknowns, f"{of_bound:.2f}, {of_error:.2f}",
             f"{min(effectivity):.2f} to {max(effectivity):.2f}",
             f"{last['iterations']['outer']}, {last['iterations']['linear']}{star}"])
    return lines


def seconds_to_bounds(folder, goals):
    """Seconds to the error bound that is the goal of a scene, by scene and label."""
    found = {}
    with open(OUT / folder / "reach.csv") as file:
        for row in csv.DictReader(file):
            if row["norm"] == "bound" and float(row["error"]) == goals[row["scene"]]:
                sign = {"missed": "> ", "undercut": "< "}.get(row["standing"], "")
                seconds = row["seconds"] or row["seconds_bound"]
                found[row["scene"], row["label"]] = f"{sign}{float(seconds):.2g}"
    return found


def adaptive():
    linears = "p1,cr,sipg,wopsip,wopsip:facet-means"
    commands = [
        f"compare --no-fields --scheme {linears} --scene lshape-2d,ball-2d,hertz-2d,signorini-two-2d --adaptive steps=30,unknowns=3e5",
        f"compare --no-fields --scheme {linears} --scene signorini-harmonic-3d --levels 2 --adaptive steps=30,unknowns=3e5",
        "compare --no-fields --scheme p2,sipg-p2,wopsip-p2 --scene ball-2d,lshape-2d --adaptive steps=20,unknowns=1e5",
    ]
    clocked = "work-precision --threads 1 --rounds 2 --limit 10 --scheme p1,p2,cr,sipg,wopsip,wopsip:facet-means,sipg-p2"
    goals = {"lshape-2d": 1e-1, "ball-2d": 1e-1, "signorini-two-2d": 5e-2, "hertz-2d": 1e-2, "signorini-harmonic-3d": 2e-1}
    by_clock = [
        f"{clocked} --scene lshape-2d,ball-2d,signorini-two-2d,hertz-2d --levels 8,16,32,64,128",
        f"{clocked} --scene signorini-harmonic-3d --levels 2,4,8,16",
    ]
    lines, uniform, followed = [], {}, {}
    for k, command in enumerate(commands):
        run(command, f"adaptive-{k}")
        lines += steps_of(f"adaptive-{k}")
    for k, command in enumerate(by_clock):
        run(command, f"adaptive-uniform-{k}")
        run(re.sub("--levels .*", "--adaptive steps=30,unknowns=1e5", command), f"adaptive-clock-{k}")
        uniform |= seconds_to_bounds(f"adaptive-uniform-{k}", goals)
        followed |= seconds_to_bounds(f"adaptive-clock-{k}", goals)
    text = head("adaptive", "Meshes that follow the error", *commands, *by_clock,
                "the last two with --adaptive steps=30,unknowns=1e5 in place of levels")
    text += """
## Steps

Slopes are those of bound and error in the broken energy norm against unknowns, over the last half of the steps. Active
sets and Krylov steps are those of the last step that converged. A star marks solves that the interior point method ended.

"""
    text += table(
        ["scene", "scheme", "steps", "unknowns", "slope of bound, error", "bound/error", "active sets, Krylov steps"], lines, 2)
    text += """
## Against uniform meshes, by the clock

Seconds to an error bound on uniform / adaptive meshes. `> t` where the finest mesh, which takes `t`, does not reach it;
`< t` where the coarsest one undercuts it.

"""
    labels = list(dict.fromkeys(label for _, label in uniform))
    both = lambda *key: " / ".join(of.get(key, "-") for of in [uniform, followed])
    lines = [[f"`{label}`", *(both(scene, label) for scene in goals)] for label in labels]
    return text + table(["scheme", *(f"{scene}, {goal:.0e}" for scene, goal in goals.items())], lines)


def stability():
    command = "stability --mesh tests/data/cube.msh"
    run(command, "stability")
    page = (OUT / "stability/stability.md").read_text().split("\n", 1)[1]
    return head("stability", "Stability: hard cases and their criteria", command) + page


def of_bench(page, title, command):
    return head(page, title, command) + "\n" + output(*command.split())


def assembly():
    return of_bench("assembly", "What assembly costs", "cargo bench --bench assembly -- --table")


def serial():
    return of_bench("serial", "Serial shares of the phases of a run", "cargo bench --bench serial -- --rounds 2")


def orders():
    command = "cargo test --release --test study -- --ignored needs_time_to_write_the_page_of_orders"
    output(*command.split())
    return (ROOT / "docs/results/orders.md").read_text()


PAGES = [adaptive, assembly, bernstein, bound, comparison, orders, serial, stability, time_to_error]

if __name__ == "__main__":
    wanted = sys.argv[1:]
    known = {page.__name__: page for page in PAGES}
    if not wanted or not set(wanted) <= known.keys():
        sys.exit(f"name a page: {', '.join(known)}")
    OUT.mkdir(parents=True, exist_ok=True)
    for name in wanted:
        (ROOT / f"docs/results/{name}.md").write_text(known[name]())
