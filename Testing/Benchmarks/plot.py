# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run time against error, one panel a case: plot.py TABLE.csv PICTURE.png"""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def number(text):
    try:
        return float(text)
    except ValueError:
        return float("nan")


def panel(axes, rows):
    """Points of error over time; where a case has no error, bars of time."""
    # one kind of error a panel: the one that most rows have
    kinds = [r["error_kind"] for r in rows if number(r["error"]) > 0]
    kind = max(set(kinds), key=kinds.count) if kinds else ""
    rows = [r for r in rows if r["error_kind"] == kind] if kind else rows
    methods = sorted({r["method"] for r in rows}, key=lambda m: (not m.startswith("chi"), m))
    if not kind:
        bars = {}
        for r in rows:
            name = f"{r['method']} {r['parameter']}, {r['threads']} thr."
            bars[name] = min(number(r["min_ns"]) * 1e-6, bars.get(name, math.inf))
        colors = ["tab:orange" if n.startswith("chi") else "tab:gray" for n in bars]
        axes.barh(range(len(bars)), list(bars.values()), color=colors)
        axes.set_yticks(range(len(bars)), list(bars), fontsize=6)
        axes.set_xscale("log")
        axes.set_xlabel("time / ms")
        return
    for method in methods:
        mine = sorted((r for r in rows if r["method"] == method and number(r["error"]) > 0),
                      key=lambda r: number(r["min_ns"]))
        ours = method.startswith("chi")
        axes.plot([number(r["min_ns"]) * 1e-6 for r in mine], [number(r["error"]) for r in mine],
                  "o" if ours else "x", label=method, markersize=5 if ours else 7)
        for r in mine:
            axes.annotate(r["parameter"], (number(r["min_ns"]) * 1e-6, number(r["error"])), fontsize=5,
                          xytext=(3, 3), textcoords="offset points")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("time / ms")
    axes.set_ylabel(kind)
    axes.legend(fontsize=7)
    axes.grid(True, which="both", alpha=0.2)


def plot(table, picture):
    with open(table, newline="") as source:
        rows = list(csv.DictReader(source))
    cases = list(dict.fromkeys(r["case"] for r in rows))
    if not cases:
        return
    columns = min(3, len(cases))
    lines = math.ceil(len(cases) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(5.5 * columns, 4.2 * lines), squeeze=False)
    for axis in axes.flat[len(cases):]:
        axis.set_visible(False)
    for axis, case in zip(axes.flat, cases):
        panel(axis, [r for r in rows if r["case"] == case])
        axis.set_title(case, fontsize=9)
    figure.suptitle(f"{rows[0]['topic']}: run time against error")
    figure.tight_layout()
    figure.savefig(picture, dpi=120)
    plt.close(figure)


if __name__ == "__main__":
    plot(sys.argv[1], sys.argv[2])
