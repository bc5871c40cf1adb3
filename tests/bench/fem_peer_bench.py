#!/usr/bin/python3
"""fem_peer_bench.py [OURS]: the clamped active block in dolfinx (Debian: python3-dolfinx-real, run by /usr/bin/python3)
and in our program fem_block_bench, one after the other on one core each, on one machine in one go.

Problem: 40 x 10 x 10 mm, fibres along x, ends held, stretch 1.1 in 4 steps, then activation 0.5 in 4 steps, 24 x 6 x 6
quadratic hexahedra, incompressible, each step to a relative residual of 1e-8. dolfinx: Q2/Q1, full Newton, MUMPS.
OURS prints one line of JSON: cpu_s, newton_iterations, factorisations, cpu_per_full_iteration_s, peak_mb, force_n,
factor_nonzeros, factor_flops, threads, ... (what it does not print is shown as -). Compiling dolfinx' element kernels, building
the mesh and starting either program are not counted; memory is the process' peak.

    python3 tests/bench/fem_peer_bench.py build/release/tests/bench/fem_block_bench [--arguments="--bulk_mpa inf --steps 1"]
        [--core 0] [--repeat 1] [--cells 24x6x6] [--solver ldl|lu] [--json out.json]
"""
import argparse
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")}
COLUMNS = ("cpu_s", "newton_iterations", "factorisations", "cpu_per_full_iteration_s", "peak_mb", "factor_nonzeros",
           "factor_flops", "assembly_s", "factor_s", "negative_modes", "force_n", "threads")
STEPS, STRETCH, ALPHA, TOLERANCE = 4, 1.1, 0.5, 1e-8


def dolfinx(cells, symmetric):
    """Runs the problem in this process and prints the JSON line."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fem" / "reference"))
    from clamped_block import LENGTH, axial_force, make
    from taylor_hood import cpu_s, peak_mb
    problem, alpha, moved = make(cells, symmetric=symmetric)
    parts = {"assembly_s": 0.0, "factor_s": 0.0}

    def timed(name, part):
        inner = getattr(problem, name)

        def outer():
            start = cpu_s()
            result = inner()
            parts[part] += cpu_s() - start
            return result
        setattr(problem, name, outer)

    timed("assemble_residual", "assembly_s")
    timed("assemble_tangent", "assembly_s")
    timed("factorise_tangent", "factor_s")
    start = cpu_s()
    for k in range(1, STEPS + 1):
        moved[0].value = (STRETCH - 1) * LENGTH * k / STEPS
        problem.step(rtol=TOLERANCE)
    for k in range(1, STEPS + 1):
        alpha.value = ALPHA * k / STEPS
        problem.step(rtol=TOLERANCE)
    total = cpu_s() - start
    peak = peak_mb()
    nonzeros, flops = problem.factor_size()
    iterations, factorisations = problem.iterations, problem.factorisations
    print(json.dumps(dict(
        program="dolfinx", cells="x".join(map(str, cells)), unknowns=problem.unknowns, cpu_s=total,
        newton_iterations=iterations, factorisations=factorisations, cpu_per_full_iteration_s=total / iterations,
        assembly_s=parts["assembly_s"], factor_s=parts["factor_s"], peak_mb=peak, force_n=axial_force(problem),
        factor_nonzeros=nonzeros, factor_flops=flops, threads=1,
        negative_modes=problem.negative_modes() if symmetric else None)))


def run(command, core):
    command = ["taskset", "-c", str(core), *command]
    done = subprocess.run(command, env={**os.environ, **ONE_THREAD}, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{done.stderr[-2000:]}")
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if not lines:
        sys.exit(f"{' '.join(command)} printed no line of JSON")
    return json.loads(lines[-1])


def best(command, core, repeat):
    return min((run(command, core) for _ in range(repeat)), key=lambda result: result["cpu_s"])


def shown(value):
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}" if value >= 1 else f"{value:.4f}"
    return str(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ours", nargs="?", help="fem_block_bench; without it dolfinx alone is measured")
    parser.add_argument("--arguments", type=shlex.split, default=[], help="passed to our program, one text: --arguments=\"--bulk_mpa inf --steps 1\"")
    parser.add_argument("--core", type=int, default=0)
    parser.add_argument("--repeat", type=int, default=1, help="the run with the least CPU time counts")
    parser.add_argument("--cells", default="24x6x6")
    parser.add_argument("--solver", choices=("ldl", "lu"), default="ldl", help="dolfinx' factorisation by MUMPS")
    parser.add_argument("--json", help="both lines are added to this file")
    parser.add_argument("--dolfinx-run", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    cells = tuple(map(int, args.cells.split("x")))
    if args.dolfinx_run:
        dolfinx(cells, args.solver == "ldl")
        return
    peer = [sys.executable, __file__, "--dolfinx-run", "--solver", args.solver, "--cells"]
    run([*peer, "1x1x1"], args.core)  # compiles the kernels, once
    results = {"dolfinx": best([*peer, args.cells], args.core, args.repeat)}
    if args.ours:
        results["ours"] = best([args.ours, *args.arguments], args.core, args.repeat)
    print(f"{'':26}" + "".join(f"{name:>14}" for name in results) + ("  dolfinx/ours" if args.ours else ""))
    for column in COLUMNS:
        values = [result.get(column) for result in results.values()]
        line = f"{column:26}" + "".join(f"{shown(value):>14}" for value in values)
        if args.ours and column not in ("threads", "negative_modes") and all(values):
            line += f"{values[0] / values[1]:14.5g}" if column == "force_n" else f"{values[0] / values[1]:14.3g}"
        print(line)
    if args.json:
        with open(args.json, "a") as file:
            file.writelines(json.dumps({"who": name, **result}) + "\n" for name, result in results.items())


if __name__ == "__main__":
    main()
