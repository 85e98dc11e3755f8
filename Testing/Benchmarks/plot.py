# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run time against error, one panel a case: plot.py TABLE.csv PICTURE.png

Rows whose parameter names coefficients and turning get a second picture, PICTURE_coefficients.png: error
against coefficients, with the turning written at each point."""
import csv
import math
import re
import sys
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter  # noqa: E402


def number(text):
    try:
        return float(text)
    except ValueError:
        return float("nan")


def logarithmic(axes):
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        if high > 10 * low:  # within a decade the labels between are needed
            axis.set_minor_formatter(NullFormatter())
        else:
            axis.set_major_formatter(FormatStrFormatter("%g"))
            axis.set_minor_locator(LogLocator(subs=(2, 3, 5, 7)))
            axis.set_minor_formatter(FormatStrFormatter("%g"))
    axes.legend(fontsize=7)
    axes.grid(True, which="both", alpha=0.2)


def panel(axes, rows):
    """Points of error over time; where a case has no error, bars of time."""
    # one kind of error a panel: the one that most rows have; a method without it shows its own
    kinds = [r["error_kind"] for r in rows if number(r["error"]) > 0]
    kind = max(dict.fromkeys(kinds), key=kinds.count) if kinds else ""
    if kind:
        has = {r["method"] for r in rows if r["error_kind"] == kind}
        rows = [r if r["method"] in has else {**r, "method": f"{r['method']} ({r['error_kind']})"}
                for r in rows if r["error_kind"] == kind or r["method"] not in has]
    methods = sorted({r["method"] for r in rows}, key=lambda m: (not m.startswith("chi"), m))
    if not kind:
        bars = {}
        for r in rows:
            name = f"{r['method']} {r['parameter']}, {r['threads']} thr."
            bars[name] = min(number(r["min_ns"]) * 1e-6, bars.get(name, math.inf))
        colors = ["tab:orange" if n.startswith("chi") else "tab:gray" for n in bars]
        axes.barh(range(len(bars)), list(bars.values()), color=colors)
        axes.set_yticks(range(len(bars)), list(bars), fontsize=6)
        if max(bars.values()) > 20 * min(bars.values()):
            axes.set_xscale("log")  # else from zero, so that lengths compare
        axes.set_xlabel("time / ms")
        return
    for method in methods:
        mine = sorted((r for r in rows if r["method"] == method and number(r["error"]) > 0),
                      key=lambda r: number(r["min_ns"]))
        ours = method.startswith("chi")
        axes.plot([number(r["min_ns"]) * 1e-6 for r in mine], [number(r["error"]) for r in mine],
                  "o" if ours else "x", label=method, markersize=5 if ours else 7)
        several = len({r["threads"] for r in rows}) > 1
        for r in mine:
            text = r["parameter"].split(" coefficients=")[0] + (f", {r['threads']} thr." if several else "")
            axes.annotate(text, (number(r["min_ns"]) * 1e-6, number(r["error"])), fontsize=5,
                          xytext=(4, 3 if ours else -7), textcoords="offset points")
    logarithmic(axes)
    low, high = axes.get_xlim()
    axes.set_xlim(low / 1.2, high * (high / low) ** 0.5)  # room for the labels
    axes.set_xlabel("time / ms")
    axes.set_ylabel(kind)


def named(row, key):
    """The number behind `key=` in a row's parameter, or NaN."""
    found = re.search(rf"\b{key}=([-+.\deE]+)", row["parameter"])
    return number(found.group(1)) if found else math.nan


def coefficients_panel(axes, rows):
    for method in dict.fromkeys(r["method"] for r in rows):
        mine = [r for r in rows if r["method"] == method]
        ours = method.startswith("chi")
        x, y = [named(r, "coefficients") for r in mine], [number(r["error"]) for r in mine]
        axes.plot(x, y, "o" if ours else "x", label=method, markersize=5 if ours else 7)
        for r, at in zip(mine, zip(x, y)):
            axes.annotate(f"{named(r, 'turning'):.3g}", at, fontsize=6, xytext=(4, 3 if ours else -8), textcoords="offset points")
    logarithmic(axes)
    axes.set_xlabel("coefficients (numbers: turning over the true one; of a straight line, radians)", fontsize=7)
    axes.set_ylabel("distance to the true curve")


def bars_panel(axes, rows):
    """Bars of the error column, for benches whose error is a ratio that belongs to a name."""
    names = [f"{r['method'].removeprefix('chi-').removeprefix('chi ')} {r['parameter']}" for r in rows]
    values = [number(r["error"]) for r in rows]
    axes.barh(range(len(rows)), values, color="tab:orange")
    for place, (r, value) in enumerate(zip(rows, values)):
        axes.annotate(f"{value:.3g}  ({number(r['min_ns']) * 1e-6:.0f} ms)", (value, place), fontsize=6, va="center",
                      xytext=(3, 0), textcoords="offset points")
    axes.set_yticks(range(len(rows)), names, fontsize=6)
    axes.invert_yaxis()
    if max(values) > 100:  # beside what is free all else would be gone
        axes.set_xscale("log")
        axes.set_xlim(0.5 * min(values), 10 * max(values))
    else:
        axes.set_xlim(0, 1.35 * max(values))
    axes.axvline(1, color="black", linewidth=0.7)
    axes.set_xlabel(rows[0]["error_kind"])


# bench occlusion_error: colour and marker of a method, whose last number is slices a voxel
LIGHT = {"ordinates-full": "tab:blue", "ordinates-half": "tab:orange", "published-full": "tab:gray",
         "cpu-full": "tab:blue", "opengl-32-bits-full": "tab:cyan", "opengl-16-bits-full": "tab:purple",
         "cpu-half": "tab:orange", "opengl-32-bits-half": "tab:olive", "opengl-16-bits-half": "tab:red"}
SLICES = {"1": "o-", "2": "s--", "4": "^:"}


def curves_panel(axes, rows):
    """Error over time, a curve a method, from few directions to many."""
    for method in dict.fromkeys(r["method"] for r in rows):
        mine = [r for r in rows if r["method"] == method]
        if not number(mine[0]["min_ns"]) > 0:  # exact, of another geometry
            axes.axhline(number(mine[0]["error"]), color="black", linewidth=0.8, linestyle="-.", label=method)
            continue
        kind, slices = method.removeprefix("chi-").rsplit("-", 1)
        axes.plot([number(r["min_ns"]) * 1e-6 for r in mine], [number(r["error"]) for r in mine], SLICES[slices],
                  color=LIGHT[kind], label=f"{kind}, {slices} a voxel", markersize=4, linewidth=1)
        if slices == "1":
            for r in mine:
                axes.annotate(r["parameter"], (number(r["min_ns"]) * 1e-6, number(r["error"])), fontsize=6,
                              xytext=(3, 3), textcoords="offset points")
    logarithmic(axes)
    axes.set_xlabel("time / ms (numbers: directions)", fontsize=8)
    axes.set_ylabel(rows[0]["error_kind"])


def by_kind(rows, picture):
    """A column a scene, a row a kind of error."""
    kinds = list(dict.fromkeys(r["error_kind"] for r in rows))
    kinds.sort(key=lambda k: ("true" in k, "picture" in k))
    cases = list(dict.fromkeys(r["case"] for r in rows))
    ends = {"_true": "_true", "_engines": "_vtk"}  # sheets of their own, by the kind's end
    sheets = {"": [k for k in kinds if not k.endswith((*ends.values(), "_to_cpu"))]}
    sheets.update((suffix, [k for k in kinds if k.endswith(end)]) for suffix, end in ends.items())
    for suffix, wanted in sheets.items():
        shown = [c for c in cases if any(r["case"] == c and r["error_kind"] in wanted for r in rows)]
        if not shown:
            continue
        sheet, axes = plt.subplots(len(wanted), len(shown), figsize=(4.6 * len(shown), 3.4 * len(wanted)), squeeze=False)
        for line, kind in zip(axes, wanted):
            for axis, case in zip(line, shown):
                mine = [r for r in rows if r["case"] == case and r["error_kind"] == kind]
                axis.set_visible(bool(mine))
                if not mine:
                    continue
                curves_panel(axis, mine)
                axis.set_title(case, fontsize=9)
                axis.get_legend().remove()
        handles, labels = axes[0, 0].get_legend_handles_labels()
        title = "occlusion: run time against error of visibility (dV) and of the final picture, full scale 1"
        sheet.suptitle(textwrap.fill(title, 36 * len(shown)), fontsize=12)
        columns = min(2 * len(shown), len(labels))
        sheet.legend(handles, labels, loc="lower center", ncol=columns, fontsize=8)
        below = 0.012 * math.ceil(len(labels) / columns) + 0.005
        sheet.tight_layout(rect=(0, below, 1, 0.985 if len(shown) > 2 else 0.965))
        sheet.savefig(str(picture).replace(".png", f"{suffix}.png"), dpi=110)
        plt.close(sheet)


def figure(rows, panels, title, picture):
    cases = list(dict.fromkeys(r["case"] for r in rows))
    columns = min(3, len(cases))
    lines = math.ceil(len(cases) / columns)
    sheet, axes = plt.subplots(lines, columns, figsize=(5.5 * columns, 4.2 * lines), squeeze=False)
    for axis in axes.flat[len(cases):]:
        axis.set_visible(False)
    for axis, case in zip(axes.flat, cases):
        panels(axis, [r for r in rows if r["case"] == case])
        axis.set_title(case, fontsize=9)
    sheet.suptitle(title)
    sheet.tight_layout(rect=(0, 0, 1, 1 - 0.06 / lines))  # below the title
    sheet.savefig(picture, dpi=120)
    plt.close(sheet)


def plot(table, picture):
    with open(table, newline="") as source:
        rows = list(csv.DictReader(source))
    if not any(number(r["min_ns"]) > 0 for r in rows):
        return  # nothing was timed
    topic = rows[0]["topic"]
    if topic == "occlusion_error":
        by_kind(rows, picture)
        return
    ratios = {"occlusion_skip": "speedup", "tet_skip": "speedup", "occlusion_scaling": "ns_a_sample", "occlusion_table1": "time_over_volumetric"}
    if topic in ratios:
        figure([r for r in rows if r["error_kind"] == ratios[topic]], bars_panel, f"{topic}: {ratios[topic]}", picture)
        return
    figure(rows, panel, f"{topic}: run time against error", picture)
    counted = [r for r in rows if named(r, "turning") == named(r, "turning")]
    if counted:
        title = f"{rows[0]['topic']}: error against coefficients against turning"
        figure(counted, coefficients_panel, title, str(picture).replace(".png", "_coefficients.png"))


if __name__ == "__main__":
    plot(sys.argv[1], sys.argv[2])
