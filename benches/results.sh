#!/usr/bin/env bash
# Writes a page of docs/results by its command, with date, machine and commit in the head:
#
#     cargo build --release && benches/results.sh comparison
#
# PROGRAM names another build of the program, COMMIT what it was built from.
set -euo pipefail
cd "$(dirname "$0")/.."
PROGRAM=${PROGRAM:-target/release/unilateral}
COMMIT=${COMMIT:-$(git rev-parse --short HEAD)}
OUT=target/results
mkdir -p "$OUT" docs/results

# the head of a page: its title, then its commands
head() {
    echo "# $1"
    echo
    shift
    echo "Written by \`benches/results.sh $PAGE\`, not edited by hand."
    echo
    echo "| | |"
    echo "|---|---|"
    for command in "$@"; do echo "| command | \`$command\` |"; done
    echo "| date | $(date -u +%F) |"
    echo "| machine | $(sed -n 's/^model name.*: //p' /proc/cpuinfo | sed q), $(nproc) cores |"
    echo "| commit | $COMMIT, version $("$PROGRAM" --version | cut -d' ' -f2) |"
    echo
}

# runs the program with words as they stand in the head
program() { "$PROGRAM" $1; }

# from the tables of times: over-penalty over interior penalty, both on facet means with a tuned factor
ratios() {
    python3 - "$OUT"/times-{plane,space}/reach.csv << 'END'
import csv, sys

OVER, FAIR, UNFAIR, CR = (
    "wopsip:facet-means@factor=10", "sipg:facet-means@factor=1.05", "sipg", "cr")
seconds = {}
for file in sys.argv[1:]:
    for row in csv.DictReader(open(file)):
        if row["standing"] == "reached":
            by_error = seconds.setdefault((row["scene"], row["norm"]), {})
            by_error.setdefault(float(row["error"]), {})[row["label"]] = float(row["seconds"])
print(f"| scene | error in | down to | over `{FAIR}` | over `{UNFAIR}` | over `{CR}` |")
print("|---|---|--:|--:|--:|--:|")
for (scene, norm), by_error in seconds.items():
    reached = [error for error, of in by_error.items() if {OVER, FAIR, UNFAIR, CR} <= of.keys()]
    if norm != "energy" and reached:
        of = by_error[min(reached)]
        figures = " | ".join(f"{of[OVER] / of[other]:.2f}" for other in (FAIR, UNFAIR, CR))
        print(f"| {scene} | {norm} | {min(reached):.0e} | {figures} |")
END
}

comparison() {
    local schemes=p1,cr,sipg,sipg:facet-means,sipg@factor=1.05,sipg:facet-means@factor=1.05
    schemes+=,nipg:facet-means,wopsip:facet-means,wopsip:facet-means@factor=10
    local plane="--scene radial-2d,ball-2d,signorini-2d,hertz-2d --levels 16,32,64,128"
    local space="--scene radial-3d,ball-3d,signorini-line-3d,signorini-harmonic-3d --levels 4,8,16"
    local errors="compare --threads 1 --no-fields --scheme $schemes"
    local times="work-precision --threads 1 --rounds 3 --subject wopsip:facet-means@factor=10 --scheme $schemes"
    head "Over-penalty beside interior penalty, with the same choices" \
        "$errors $plane" "$errors $space" "$times $plane" "$times $space"
    for domain in plane space; do
        program "$times ${!domain} --quiet --out $OUT/times-$domain"
    done
    echo "## Time of \`wopsip:facet-means@factor=10\` over that of others"
    echo
    echo "At the smallest error that all four reach. \`sipg\` has bounds at vertices and its default penalty."
    echo
    ratios
    echo
    for domain in plane space; do
        echo "## Errors on the finest level, $domain"
        echo
        echo '```text'
        program "$errors ${!domain} --out $OUT/errors-$domain" | sed '/^Times are in seconds/d'
        echo '```'
        echo
    done
    for domain in plane space; do
        echo "## Times, $domain"
        echo
        echo "Seconds and, in parentheses, the ratio to the fastest scheme. \`> t\`: the finest level, which takes"
        echo "\`t\`, does not reach the error; \`< t\`: the coarsest level undercuts it. The spread is the median"
        echo "over the least of three runs."
        echo
        # the tables of times and costs; runs and phases stand in the report
        awk '/^- /{next} /^### /{keep = / costs at | time to reach /} !/^[|#]/ && NF{keep = NR > 1} keep' \
            "$OUT/times-$domain/report.md" | cat -s
        echo
    done
    cp "$OUT/times-space/radial-3d-time.svg" docs/results/
}

stability() {
    local command="stability --mesh tests/data/cube.msh --out $OUT/stability"
    head "Stability: hard cases and their criteria" "$command"
    program "$command --quiet"
    sed 1d "$OUT/stability/stability.md"
}

assembly() {
    head "What assembly costs" "cargo bench --bench assembly -- --table"
    cargo bench --bench assembly -- --table
}

PAGE=${1:?"a page: comparison, stability, assembly"}
"$PAGE" > "$OUT/$PAGE.md"
mv "$OUT/$PAGE.md" "docs/results/$PAGE.md"
