/// Sparse solvers on the tangents of hexahedral meshes: this project's multifrontal L D L', CHOLMOD as it is
/// tuned here and CHOLMOD as it comes, side by side. Every solver runs in a process of its own, so that its
/// memory is its own.
///
///   fem_linear_bench [--large] [--ldl] [--repeat N] [--only N]
///
/// --large adds meshes of 1e5 unknowns, --ldl leaves out CHOLMOD, --only skips meshes with fewer than N
/// unknowns.
///
/// Times are the best of N factorisations: CPU seconds of the process for one thread (what else runs on the
/// machine does not count), wall seconds for two. Memory is the peak of the process, the matrix included.

#include <cblas.h>
#include <cholmod.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "fem/linear/refinement.hpp"
#include "fem/linear/symmetric_solver.hpp"
#include "tests/fem/linear/sparse_matrices.hpp"

extern "C" void openblas_set_num_threads(int threads);

namespace {

using namespace brachium;

struct Figures {
  double analyse_s = 0.0, cpu_s = 1e30, wall_s = 1e30, solve_cpu_s = 1e30, flops = 0.0, entries = 0.0;
  double backward_error = 0.0, negative = -1.0, memory_mb = 0.0;
};

double cpu_now() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}
double wall_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// What `work` returns, computed in a process of its own, with that process' peak memory.
Figures apart(const std::function<Figures()>& work) {
  int ends[2];
  if (pipe(ends) != 0) std::abort();
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    const Figures figures = work();
    const bool written = write(ends[1], &figures, sizeof(figures)) == static_cast<ssize_t>(sizeof(figures));
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Figures figures;
  const bool whole = read(ends[0], &figures, sizeof(figures)) == static_cast<ssize_t>(sizeof(figures));
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!whole || status != 0) {
    std::printf("a solver ended with status %d\n", status);
    std::exit(1);
  }
  figures.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return figures;
}

void time_best(Figures& f, int repeat, const std::function<void()>& factorise,
               const std::function<void()>& solve) {
  for (int k = 0; k < repeat; ++k) {
    const double cpu = cpu_now(), wall = wall_now();
    factorise();
    f.cpu_s = std::min(f.cpu_s, cpu_now() - cpu);
    f.wall_s = std::min(f.wall_s, wall_now() - wall);
    const double before = cpu_now();
    solve();
    f.solve_cpu_s = std::min(f.solve_cpu_s, cpu_now() - before);
  }
}

Figures ours(const fem::test::Matrix& m, const std::string& name, int threads, int repeat) {
  fem::SolverOptions options;
  options.threads = threads;
  options.deterministic = name == "ldl";
  const auto solver = fem::make_symmetric_solver(name, options);
  Figures f;
  f.analyse_s = 1e30;
  for (int k = 0; k < std::min(repeat, 3); ++k) {
    const double start = cpu_now();
    solver->analyse(m.pattern, m.groups);
    f.analyse_s = std::min(f.analyse_s, cpu_now() - start);
  }
  const std::vector<double> b = fem::test::random_vector(m.n());
  std::vector<double> x(b);
  time_best(
      f, repeat, [&] { solver->factorise(m.values); },
      [&] {
        x = b;
        solver->solve(x);
      });
  f.backward_error = solve_refined(*solver, m.view(), b, x, 0.0, 0).backward_error;
  f.flops = solver->statistics().flops;
  f.entries = static_cast<double>(solver->statistics().factor_entries);
  if (solver->inertia()) f.negative = static_cast<double>(solver->inertia()->negative);
  return f;
}

// CHOLMOD with its defaults, METIS among the orders it tries.
Figures stock(const fem::test::Matrix& m, int threads, int repeat) {
  openblas_set_num_threads(threads);
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  fem::SymmetricPattern pattern = m.pattern;
  std::vector<double> values = m.values;
  cholmod_sparse a{};
  a.nrow = a.ncol = static_cast<std::size_t>(m.n());
  a.nzmax = values.size();
  a.p = pattern.column_start.data();
  a.i = pattern.row.data();
  a.x = values.data();
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.sorted = a.packed = 1;
  Figures f;
  const double start = cpu_now();
  cholmod_factor* l = cholmod_analyze(&a, &common);
  f.analyse_s = cpu_now() - start;
  f.flops = common.fl;
  f.entries = common.lnz;
  cholmod_dense* b = cholmod_ones(a.nrow, 1, CHOLMOD_REAL, &common);
  time_best(
      f, repeat, [&] { cholmod_factorize(&a, l, &common); },
      [&] {
        cholmod_dense* x = cholmod_solve(CHOLMOD_A, l, b, &common);
        cholmod_free_dense(&x, &common);
      });
  return f;
}

double gemm_gflops() {
  const int n = 1200;
  const std::vector<double> a(n * n, 1.0), b(n * n, 1.0);
  std::vector<double> c(n * n);
  openblas_set_num_threads(1);
  double best = 1e30;
  for (int k = 0; k < 5; ++k) {
    const double start = cpu_now();
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, n, n, n, 1.0, a.data(), n, b.data(), n, 0.0,
                c.data(), n);
    best = std::min(best, cpu_now() - start);
  }
  return 2e-9 * n * double(n) * n / best;
}

void print(const char* name, int threads, const Figures& f, double gemm, const Figures& reference) {
  const double seconds = threads == 1 ? f.cpu_s : f.wall_s;
  std::printf(
      "  %-22s %d  %8.3f  %8.4f %8.4f  %8.4f  %7.2f %8.2f  %5.1f %4.0f%%  %5.2f  %8.1f  %7.0f  %.0e\n", name,
      threads, f.analyse_s, f.cpu_s, f.wall_s, f.solve_cpu_s, f.flops * 1e-9, f.entries * 1e-6,
      f.flops * 1e-9 / seconds, 100.0 * f.flops * 1e-9 / seconds / (gemm * threads),
      reference.flops > 0.0 ? (threads == 1 ? reference.cpu_s : reference.wall_s) / seconds : 0.0, f.negative,
      f.memory_mb, f.backward_error);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  bool large = false, only_ldl = false;
  int repeat = 9, above = 0;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--large") == 0) large = true;
    if (std::strcmp(argv[k], "--ldl") == 0) only_ldl = true;
    if (std::strcmp(argv[k], "--repeat") == 0 && k + 1 < argc) repeat = std::atoi(argv[++k]);
    if (std::strcmp(argv[k], "--only") == 0 && k + 1 < argc) above = std::atoi(argv[++k]);
  }
  const double gemm = apart([] {
                        Figures f;
                        f.flops = gemm_gflops();
                        return f;
                      }).flops;
  std::printf("dgemm on one core: %.1f GFlop/s (OpenBLAS, 1200 x 1200)\n", gemm);
  std::vector<std::vector<int>> grids{{6, 2, 2}, {18, 4, 4}, {24, 6, 6}};
  if (large) grids.insert(grids.end(), {{40, 10, 10}, {16, 16, 16}});
  for (const auto& g : grids) {
    const int unknowns = 3 * (2 * g[0] + 1) * (2 * g[1] + 1) * (2 * g[2] + 1);
    if (unknowns < above) continue;
    const fem::test::Matrix m = fem::test::hex27_grid(g[0], g[1], g[2]);
    const int times = unknowns > 50000 ? std::min(repeat, 2) : repeat;
    std::printf("\n%d x %d x %d hexahedra of 27 nodes, %d unknowns, %.2f M entries in the lower triangle\n",
                g[0], g[1], g[2], m.n(), double(m.pattern.entries()) * 1e-6);
    std::printf(
        "  solver           threads analyse  factor CPU, wall     solve   GFlop  M in L  GF/s  of dgemm  x "
        "stock  "
        "negative  MB    error\n");
    Figures reference1, reference2;
    if (!only_ldl) {
      reference1 = apart([&] { return stock(m, 1, times); });
      print("CHOLMOD stock", 1, reference1, gemm, reference1);
      print("CHOLMOD here", 1, apart([&] { return ours(m, "cholmod", 1, times); }), gemm, reference1);
    }
    print("ldl", 1, apart([&] { return ours(m, "ldl", 1, times); }), gemm, reference1);
    if (!only_ldl) {
      reference2 = apart([&] { return stock(m, 2, times); });
      print("CHOLMOD stock", 2, reference2, gemm, reference2);
      print("CHOLMOD here", 2, apart([&] { return ours(m, "cholmod", 2, times); }), gemm, reference2);
    }
    print("ldl", 2, apart([&] { return ours(m, "ldl", 2, times); }), gemm, reference2);
  }
  return 0;
}
