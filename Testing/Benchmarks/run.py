# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run every benchmark that was built: run.py BUILD DATA OUT

Writes OUT/<topic>.csv, the rows of bench_<topic> and bench_<topic>_vtk together, and OUT/<topic>.png.
"""
import subprocess
import sys
import time
from pathlib import Path

from plot import plot

HEADER = "topic,case,method,parameter,n,threads,min_ns,error,error_kind"
HERE = Path(__file__).resolve().parent


def main():
    build, data, out = (Path(p).resolve() for p in sys.argv[1:4])
    out.mkdir(parents=True, exist_ok=True)
    if not (out / "fibres128.raw").exists():
        subprocess.run([sys.executable, HERE / "scenes.py", data, out], check=True)
    given = {
        "bench_fiber_vtk": ["128", out / "peers"],  # where the wheel with its peer stays for the next run
        "bench_occlusion": [out / "brain128.raw"],
        "bench_occlusion_error": [out],
        "bench_occlusion_error_vtk": [out],  # reads what the one before has left there
        "bench_occlusion_table1": [data],
        "bench_tet_vtk": [data],  # where it keeps a mesh
        "bench_tube_vtk": [data],
    }
    rows, failed = {}, []
    for program in sorted((build / "bin").glob("bench_*")):
        topic = program.name[len("bench_"):].removesuffix("_vtk")
        start = time.perf_counter()
        result = subprocess.run([program, *given.get(program.name, [])], stdout=subprocess.PIPE, text=True)
        print(f"{program.name}: {time.perf_counter() - start:.0f} s", flush=True)
        if result.returncode != 0:
            failed.append(program.name)
        lines = [line for line in result.stdout.splitlines() if line.count(",") == HEADER.count(",")]
        rows.setdefault(topic, []).extend(line for line in lines if line != HEADER)
    for topic, lines in rows.items():
        table = out / f"{topic}.csv"
        table.write_text("\n".join([HEADER] + lines) + "\n")
        plot(table, out / f"{topic}.png")
        print(f"{table}: {len(lines)} rows; {topic}.png")
    if failed:
        sys.exit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    main()
