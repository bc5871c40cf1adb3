#include "emg/butterworth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "data/model/error.hpp"

namespace brachium::emg {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

// A second-order section from the analogue denominator s^2 + c1 s + c0, by s = (z - 1)/(z + 1), with the analogue
// numerator n2 s^2 + n1 s + n0.
Biquad bilinear(double n2, double n1, double n0, double c1, double c0) {
  const double a0 = 1.0 + c1 + c0;
  return {(n2 + n1 + n0) / a0, 2.0 * (n0 - n2) / a0, (n2 - n1 + n0) / a0, 2.0 * (c0 - 1.0) / a0,
          (1.0 - c1 + c0) / a0};
}

// First order: (n1 s + n0)/(s + c)
Biquad bilinear(double n1, double n0, double c) {
  const double a0 = 1.0 + c;
  return {(n1 + n0) / a0, (n0 - n1) / a0, 0.0, (c - 1.0) / a0, 0.0};
}

// Left-half-plane poles of the prototype |H|^2 = 1/(1 + Ω^(2n)) with positive imaginary part.
std::vector<Complex> prototype_pairs(int order) {
  std::vector<Complex> poles;
  for (int k = 0; k < order / 2; ++k)
    poles.push_back(std::polar(1.0, pi * (2.0 * k + order + 1.0) / (2.0 * order)));
  return poles;
}

std::vector<Biquad> low_pass_sections(int order, double edge) {
  std::vector<Biquad> sections;
  for (const Complex& p : prototype_pairs(order)) {
    sections.push_back(bilinear(0.0, 0.0, edge * edge, -2.0 * p.real() * edge, edge * edge));
  }
  if (order % 2 == 1) sections.push_back(bilinear(0.0, edge, edge));
  return sections;
}

std::vector<Biquad> high_pass_sections(int order, double edge) {
  std::vector<Biquad> sections;
  for (const Complex& p : prototype_pairs(order)) {
    sections.push_back(bilinear(1.0, 0.0, 0.0, -2.0 * p.real() * edge, edge * edge));
  }
  if (order % 2 == 1) sections.push_back(bilinear(1.0, 0.0, edge));
  return sections;
}

// One band-pass section, k s/(s^2 + c1 s + c0), with unit gain at the centre Ω0.
Biquad band_pass_section(double c1, double c0, double centre) {
  const double k = std::hypot(c0 - centre * centre, c1 * centre) / centre;
  return bilinear(0.0, k, 0.0, c1, c0);
}

// Each prototype pole p gives the two roots of s^2 - p B s + Ω0^2.
std::vector<Biquad> band_pass_sections(int order, double bandwidth, double centre) {
  std::vector<Biquad> sections;
  for (const Complex& p : prototype_pairs(order)) {
    const Complex half = 0.5 * bandwidth * p;
    const Complex root = std::sqrt(half * half - centre * centre);
    for (const Complex& s : {half + root, half - root}) {
      sections.push_back(band_pass_section(-2.0 * s.real(), std::norm(s), centre));
    }
  }
  if (order % 2 == 1) sections.push_back(band_pass_section(bandwidth, centre * centre, centre));
  return sections;
}

// Notch of centre w0 and half-power width 2 atan(beta):  (1 - 2 cos w0 z^-1 + z^-2) over the same with damped poles
Biquad notch_section(double w0, double beta) {
  const double gain = 1.0 / (1.0 + beta);
  const double middle = -2.0 * std::cos(w0) * gain;
  return {gain, middle, gain, middle, (1.0 - beta) * gain};
}

Complex response(const Biquad& s, double w) {
  const Complex z = std::polar(1.0, -w);  // z^-1
  return (s.b0 + z * (s.b1 + z * s.b2)) / (1.0 + z * (s.a1 + z * s.a2));
}

// -d(phase)/dw [samples]; of numerator and denominator apart: Re(Σ k c_k z^-k / Σ c_k z^-k)
double group_delay(const Biquad& s, double w) {
  const Complex z = std::polar(1.0, -w);
  const auto part = [&](double c0, double c1, double c2) {
    return (z * (c1 + 2.0 * z * c2) / (c0 + z * (c1 + z * c2))).real();
  };
  return part(s.b0, s.b1, s.b2) - part(1.0, s.a1, s.a2);
}

double largest_pole(std::span<const Biquad> sections) {
  double radius = 0.0;
  for (const Biquad& s : sections) {
    const Complex root = std::sqrt(Complex(s.a1 * s.a1 - 4.0 * s.a2));
    radius = std::max({radius, std::abs(-s.a1 + root) / 2.0, std::abs(-s.a1 - root) / 2.0});
  }
  return radius;
}

// Samples after which the impulse response's tail holds less than level^2 of its energy: what was before then
// contributes less than `level` of the output's RMS, for an input of flat spectrum.
double transient_samples(std::span<const Biquad> sections, double level) {
  const double radius = largest_pole(sections);
  if (!(radius > 0.0)) return 0.0;
  const auto n = static_cast<std::size_t>(std::ceil(std::log(1e-3 * level) / std::log(radius)));
  std::vector<double> energy(n + 1);
  std::vector<std::array<double, 2>> state(sections.size());
  for (std::size_t k = 0; k <= n; ++k) {
    double x = k == 0 ? 1.0 : 0.0;
    for (std::size_t s = 0; s < sections.size(); ++s) {
      const Biquad& b = sections[s];
      const double y = b.b0 * x + state[s][0];
      state[s][0] = b.b1 * x - b.a1 * y + state[s][1];
      state[s][1] = b.b2 * x - b.a2 * y;
      x = y;
    }
    energy[k] = x * x;
  }
  double total = 0.0, tail = 0.0;
  for (const double e : energy) total += e;
  std::size_t k = n + 1;
  while (k > 0 && tail + energy[k - 1] < level * level * total) tail += energy[--k];
  return static_cast<double>(k);
}

void check_edge(std::vector<data::Diagnostic>& list, const char* name, double edge, double rate_hz) {
  const auto add = [&](const char* code, std::string message) {
    list.push_back({data::Severity::error, code, std::move(message), std::nullopt, {}});
  };
  if (!(edge > 0.0) || !std::isfinite(edge)) {
    add("out-of-range", fmt::format("`{}` = {} Hz must be > 0", name, edge));
  } else if (!(edge < 0.5 * rate_hz)) {
    add("cutoff-above-nyquist",
        fmt::format("`{}` = {} Hz is not below {} Hz, half the sampling rate of {} Hz", name, edge,
                    0.5 * rate_hz, rate_hz));
  }
}

void check(const FilterSpec& spec, double rate_hz) {
  std::vector<data::Diagnostic> list;
  const auto add = [&](std::string message) {
    list.push_back({data::Severity::error, "out-of-range", std::move(message), std::nullopt, {}});
  };
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) {
    throw data::InputError("out-of-range", fmt::format("`rate_hz` = {} must be > 0", rate_hz));
  }
  if (spec.kind != FilterKind::notch && (spec.order < 1 || spec.order > 10)) {
    add(fmt::format("`order` = {} must lie between 1 and 10", spec.order));
  }
  switch (spec.kind) {
    case FilterKind::low_pass:
      check_edge(list, "high_hz", spec.high_hz, rate_hz);
      break;
    case FilterKind::high_pass:
      check_edge(list, "low_hz", spec.low_hz, rate_hz);
      break;
    case FilterKind::band_pass:
      check_edge(list, "low_hz", spec.low_hz, rate_hz);
      check_edge(list, "high_hz", spec.high_hz, rate_hz);
      if (spec.low_hz > 0.0 && !(spec.low_hz < spec.high_hz)) {
        add(fmt::format("`low_hz` = {} Hz must lie below `high_hz` = {} Hz", spec.low_hz, spec.high_hz));
      }
      break;
    case FilterKind::notch:
      check_edge(list, "line_hz", spec.line_hz, rate_hz);
      if (spec.harmonics < 1) add(fmt::format("`harmonics` = {} must be at least 1", spec.harmonics));
      if (!(spec.width_hz > 0.0) || !(spec.width_hz < spec.line_hz)) {
        add(fmt::format("`width_hz` = {} Hz must lie between 0 and the line frequency", spec.width_hz));
      }
      break;
  }
  if (!list.empty()) throw data::InputError(std::move(list));
}

std::string list_of(std::span<const double> frequencies) {
  std::string text;
  for (const double f : frequencies) text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", f);
  return text;
}

// Frequencies between which the gain may cross 1/sqrt(2): a logarithmic grid of 2 % steps and every notch's neighbourhood.
std::vector<double> scan_grid(std::span<const DesignedFilter> cascade) {
  std::vector<double> grid;
  const double nyquist = 0.5 * cascade.front().rate_hz;
  for (int i = 0; i <= 800; ++i) grid.push_back(nyquist * (1.0 - 1e-9) * std::pow(1e-7, 1.0 - i / 800.0));
  for (const DesignedFilter& filter : cascade) {
    if (filter.spec.kind != FilterKind::notch) continue;
    for (int k = 1; k <= filter.spec.harmonics; ++k) {
      for (const double offset : {-0.7, 0.0, 0.7})
        grid.push_back(k * filter.spec.line_hz + offset * filter.spec.width_hz);
    }
  }
  std::erase_if(grid, [&](double f) { return !(f > 0.0 && f < nyquist); });
  std::sort(grid.begin(), grid.end());
  return grid;
}

std::vector<double> half_power_edges(std::span<const DesignedFilter> cascade) {
  std::vector<double> edges;
  const auto excess = [&](double f) { return gain(cascade, f) - 1.0 / std::numbers::sqrt2; };
  const std::vector<double> grid = scan_grid(cascade);
  double before = excess(grid.front());
  for (std::size_t i = 1; i < grid.size(); ++i) {
    const double here = excess(grid[i]);
    if ((before < 0.0) != (here < 0.0)) {
      double low = grid[i - 1], high = grid[i];
      for (int k = 0; k < 80 && high - low > 1e-15 * high; ++k) {
        const double middle = 0.5 * (low + high);
        ((excess(middle) < 0.0) == (before < 0.0) ? low : high) = middle;
      }
      edges.push_back(0.5 * (low + high));
    }
    before = here;
  }
  return edges;
}

// Where a causal filter's delay is quoted: inside its pass band.
double delay_frequency(const FilterSpec& spec, double rate_hz) {
  switch (spec.kind) {
    case FilterKind::high_pass:
      return std::min(2.0 * spec.low_hz, 0.5 * rate_hz);
    case FilterKind::band_pass:
      return std::sqrt(spec.low_hz * spec.high_hz);
    case FilterKind::low_pass:
    case FilterKind::notch:
      break;
  }
  return 0.0;
}

}  // namespace

FilterSpec FilterSpec::low_pass(double edge_hz, int order) {
  FilterSpec spec;
  spec.kind = FilterKind::low_pass, spec.high_hz = edge_hz, spec.order = order;
  return spec;
}

FilterSpec FilterSpec::high_pass(double edge_hz, int order) {
  FilterSpec spec;
  spec.kind = FilterKind::high_pass, spec.low_hz = edge_hz, spec.order = order;
  return spec;
}

FilterSpec FilterSpec::band_pass(double low_hz, double high_hz, int order) {
  FilterSpec spec;
  spec.kind = FilterKind::band_pass, spec.low_hz = low_hz, spec.high_hz = high_hz, spec.order = order;
  return spec;
}

FilterSpec FilterSpec::notch(double line_hz, int harmonics, double width_hz) {
  FilterSpec spec;
  spec.kind = FilterKind::notch, spec.line_hz = line_hz, spec.harmonics = harmonics, spec.width_hz = width_hz;
  return spec;
}

DesignedFilter design(const FilterSpec& spec, double rate_hz) {
  check(spec, rate_hz);
  DesignedFilter filter{spec, rate_hz, {}, {}};
  const auto prewarp = [&](double f) { return std::tan(pi * f / rate_hz); };
  const int n = spec.kind == FilterKind::notch ? 1 : spec.order;
  const double C = spec.cutoff == CutoffConvention::per_pass
                       ? 1.0
                       : std::pow(std::pow(2.0, 1.0 / spec.passes()) - 1.0, 1.0 / (2.0 * n));
  switch (spec.kind) {
    case FilterKind::low_pass:
      filter.sections = low_pass_sections(n, prewarp(spec.high_hz) / C);
      break;
    case FilterKind::high_pass:
      filter.sections = high_pass_sections(n, prewarp(spec.low_hz) * C);
      break;
    case FilterKind::band_pass: {
      const double low = prewarp(spec.low_hz), high = prewarp(spec.high_hz);
      filter.sections = band_pass_sections(n, (high - low) / C, std::sqrt(low * high));
      break;
    }
    case FilterKind::notch:
      for (int k = 1; k <= spec.harmonics; ++k) {
        const double f = k * spec.line_hz;
        if (f < 0.98 * 0.5 * rate_hz) {
          filter.sections.push_back(notch_section(2.0 * pi * f / rate_hz, prewarp(spec.width_hz) * C));
        } else {
          filter.left_out_hz.push_back(f);
        }
      }
      break;
  }
  return filter;
}

Complex DesignedFilter::pass_response(double frequency_hz) const {
  Complex product = 1.0;
  for (const Biquad& s : sections) product *= response(s, 2.0 * pi * frequency_hz / rate_hz);
  return product;
}

double DesignedFilter::gain(double frequency_hz) const {
  const double one = std::abs(pass_response(frequency_hz));
  return spec.passes() == 2 ? one * one : one;
}

double gain(std::span<const DesignedFilter> cascade, double frequency_hz) {
  double product = 1.0;
  for (const DesignedFilter& filter : cascade) product *= filter.gain(frequency_hz);
  return product;
}

FilterReport describe(const DesignedFilter& filter) {
  FilterReport report;
  const FilterSpec& spec = filter.spec;
  report.effective_order = (spec.kind == FilterKind::notch ? 2 : spec.order) * spec.passes();
  report.edges_hz = half_power_edges({&filter, 1});
  if (spec.phase == Phase::causal) {
    report.delay_at_hz = delay_frequency(spec, filter.rate_hz);
    for (const Biquad& s : filter.sections) {
      report.group_delay_s += group_delay(s, 2.0 * pi * report.delay_at_hz / filter.rate_hz) / filter.rate_hz;
    }
  }
  report.transient_s = transient_samples(filter.sections, transient_level) / filter.rate_hz;

  const std::string phase = spec.phase == Phase::zero_lag
                                ? "zero lag"
                                : fmt::format("causal, group delay {:.4g} ms at {:.4g} Hz",
                                              1e3 * report.group_delay_s, report.delay_at_hz);
  if (spec.kind == FilterKind::notch) {
    std::string centres;
    for (std::size_t k = 1; k <= filter.sections.size(); ++k) {
      centres += fmt::format("{}{:.6g}", k == 1 ? "" : ", ", static_cast<double>(k) * spec.line_hz);
    }
    report.description =
        fmt::format("notch at {} Hz, {}, -3 dB at {} Hz", centres, phase, list_of(report.edges_hz));
    if (!filter.left_out_hz.empty()) {
      report.description +=
          fmt::format("; left out, too close to half the sampling rate: {} Hz", list_of(filter.left_out_hz));
    }
  } else {
    report.description =
        fmt::format("{} Butterworth, effective order {}, {}, -3 dB after all passes at {} Hz",
                    to_string(spec.kind), report.effective_order, phase, list_of(report.edges_hz));
  }
  return report;
}

FilterReport describe(std::span<const DesignedFilter> cascade) {
  FilterReport report;
  if (cascade.empty()) {
    report.description = "none";
    return report;
  }
  if (cascade.size() == 1) return describe(cascade.front());
  for (const DesignedFilter& filter : cascade) {
    const FilterReport one = describe(filter);
    report.description += (report.description.empty() ? "" : "; ") + one.description;
    report.effective_order += one.effective_order;
    report.group_delay_s += one.group_delay_s;
    report.transient_s += one.transient_s;
  }
  report.edges_hz = half_power_edges(cascade);
  return report;
}

}  // namespace brachium::emg
