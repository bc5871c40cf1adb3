#include "fem/surrogate/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void check_outputs(const std::vector<std::string>& have, const std::vector<std::string>& fed) {
  if (have != fed)
    throw data::InputError(
        "wrong-size", fmt::format("results with {} outputs for a design of {}, or of other names", fed.size(),
                                  have.size()));
}

[[noreturn]] void missing(std::size_t n) {
  throw data::InputError("states-missing", fmt::format("{} states of the design have no result yet", n),
                         "compute what wanted() names first");
}

std::string place(const StatePoint& s) {
  return fmt::format("({:.6g} rad, {:.6g})", s.theta_rad, s.activation);
}

// Range of each output over the results, 1 where it does not vary.
class Ranges {
 public:
  void add(const VectorXd& v) {
    if (lower_.size() == 0) lower_ = upper_ = v;
    lower_ = lower_.cwiseMin(v);
    upper_ = upper_.cwiseMax(v);
  }
  // Greatest entry of |v| relative to the ranges.
  double relative(const VectorXd& v) const {
    double most = 0.0;
    for (Index o = 0; o < v.size(); ++o) {
      const double range = upper_(o) - lower_(o);
      most = std::max(most, std::abs(v(o)) / (range > 0.0 ? range : 1.0));
    }
    return most;
  }

 private:
  VectorXd lower_, upper_;
};

class Sparse final : public Design {
 public:
  Sparse(const StateBounds& bounds, std::vector<std::string> outputs, const SparseDesignOptions& options)
      : bounds_(bounds),
        outputs_(std::move(outputs)),
        options_(options),
        grid_(SparseGrid::regular(options.boundary, options.start_level)) {
    bounds_.check();
    if (options_.finest_level < options_.start_level || options_.finest_level > 8) {
      throw data::InputError(
          "bad-option",
          fmt::format("finest level {} of a sparse grid that starts at level {}: it may be up to 8",
                      options_.finest_level, options_.start_level));
    }
  }

  std::vector<StatePoint> wanted() const override {
    std::vector<StatePoint> out;
    for (const SparseIndex& p : grid_.points()) {
      if (!values_.contains(p) && !failed_.contains(p)) out.push_back(state_of(p, bounds_));
    }
    std::sort(out.begin(), out.end(), [](const StatePoint& a, const StatePoint& b) {
      return a.theta_rad != b.theta_rad ? a.theta_rad < b.theta_rad : a.activation < b.activation;
    });
    return out;
  }

  void feed(const SampleSet& results) override {
    check_outputs(outputs_, results.outputs);
    results.check();
    for (const Sample& s : results.samples) {
      const SparseIndex p = index_of(s.at, bounds_, options_.boundary, options_.finest_level);
      grid_.insert(p);  // states of an earlier run may lie anywhere on the finest level
      values_[p] = s.value;
      failed_.erase(p);
    }
  }

  void fail(const StatePoint& state, const std::string& reason) override {
    failed_[index_of(state, bounds_, options_.boundary, options_.finest_level)] = reason;
  }

  Surrogate surrogate() const override {
    require_complete();
    return make_surrogate(interpolate(options_.boundary, values_), bounds_, outputs_);
  }

  std::size_t refine(std::size_t states) override {
    require_complete();
    const SparseSpline spline = interpolate(options_.boundary, values_);
    Ranges ranges;
    for (const auto& [point, value] : values_) ranges.add(value);
    std::map<SparseIndex, double> surplus;
    double greatest = 0.0;
    for (std::size_t i = 0; i < spline.points.size(); ++i) {
      surplus[spline.points[i]] = ranges.relative(spline.surplus.row(static_cast<Index>(i)).transpose());
      greatest = std::max(greatest, surplus[spline.points[i]]);
    }
    // No surplus counts as nothing: one that vanishes by symmetry says little about its children.
    for (auto& [point, c] : surplus) c = std::max(c, 1e-6 * greatest);

    std::map<SparseIndex, std::vector<double>> promises;
    const auto promise = [&](const SparseIndex& p, const std::vector<SparseIndex>& above,
                             const std::vector<SparseIndex>& below) {
      double c = surplus.at(p), decay = 1.0;
      for (const SparseIndex& q : above) {
        if (const auto at = surplus.find(q); at != surplus.end()) decay = std::min(decay, c / at->second);
      }
      for (const SparseIndex& child : below) {
        const bool too_fine =
            child.theta.level > options_.finest_level || child.alpha.level > options_.finest_level;
        if (!grid_.contains(child) && !too_fine) promises[child].push_back(c * decay);
      }
    };
    for (const auto& [p, c] : surplus) {
      std::vector<SparseIndex> up_theta, up_alpha, down_theta, down_alpha;
      for (const HierarchicalIndex& t : parents(p.theta, options_.boundary)) up_theta.push_back({t, p.alpha});
      for (const HierarchicalIndex& a : parents(p.alpha, options_.boundary)) up_alpha.push_back({p.theta, a});
      for (const HierarchicalIndex& t : children(p.theta)) down_theta.push_back({t, p.alpha});
      for (const HierarchicalIndex& a : children(p.alpha)) down_alpha.push_back({p.theta, a});
      promise(p, up_theta, down_theta);
      promise(p, up_alpha, down_alpha);
    }
    std::vector<std::pair<double, SparseIndex>> order;
    for (const auto& [child, values] : promises) {
      double log_mean = 0.0;
      for (const double v : values)
        log_mean += std::log(v > 0.0 ? v : 1e-300) / static_cast<double>(values.size());
      order.emplace_back(-log_mean, child);
    }
    std::sort(order.begin(), order.end());
    std::size_t asked = 0;
    for (const auto& [cost, child] : order) {
      if (asked >= std::max<std::size_t>(states, 1)) break;
      if (below_failure(child)) continue;
      asked += grid_.insert(child).size();
    }
    return asked;
  }

  std::size_t size() const override { return values_.size(); }

 private:
  void require_complete() const {
    std::size_t n = 0;
    for (const SparseIndex& p : grid_.points()) n += !values_.contains(p) && !failed_.contains(p);
    if (n > 0) missing(n);
  }

  bool below_failure(const SparseIndex& p) const {
    if (failed_.contains(p)) return true;
    for (const HierarchicalIndex& t : parents(p.theta, options_.boundary)) {
      if (below_failure({t, p.alpha})) return true;
    }
    for (const HierarchicalIndex& a : parents(p.alpha, options_.boundary)) {
      if (below_failure({p.theta, a})) return true;
    }
    return false;
  }

  StateBounds bounds_;
  std::vector<std::string> outputs_;
  SparseDesignOptions options_;
  SparseGrid grid_;
  SparseValues values_;
  std::map<SparseIndex, std::string> failed_;
};

class Full final : public Design {
 public:
  Full(const StateBounds& bounds, std::vector<std::string> outputs, const GridDesignOptions& options)
      : bounds_(bounds),
        outputs_(std::move(outputs)),
        options_(options),
        theta_(equidistant(bounds.theta_lower_rad, bounds.theta_upper_rad, options.theta_states)),
        alpha_(equidistant(bounds.activation_lower, bounds.activation_upper, options.activation_states)) {
    bounds_.check();
    if (options.theta_states < 2 || options.activation_states < 2 || !(options.finest > 0.0)) {
      throw data::InputError(
          "bad-option",
          "a grid of states needs at least 2 angles and 2 activations, and a least cell above 0");
    }
  }

  std::vector<StatePoint> wanted() const override {
    std::vector<StatePoint> out;
    for (const StatePoint& s : grid_states(theta_, alpha_)) {
      if (find(s) == nullptr && !has_failed(s)) out.push_back(s);
    }
    return out;
  }

  void feed(const SampleSet& results) override {
    check_outputs(outputs_, results.outputs);
    results.check();
    for (const Sample& s : results.samples) {
      const auto near = [&](const std::vector<double>& lines, double v, double span) {
        return std::any_of(lines.begin(), lines.end(),
                           [&](double l) { return std::abs(l - v) <= 1e-9 * span; });
      };
      if (!near(theta_, s.at.theta_rad, bounds_.theta_span()) ||
          !near(alpha_, s.at.activation, bounds_.activation_span())) {
        throw data::InputError("not-a-grid",
                               fmt::format("the state at {} lies on no line of the grid", place(s.at)));
      }
      if (Sample* known = find(s.at)) {
        *known = s;
      } else {
        results_.push_back(s);
      }
    }
  }

  void fail(const StatePoint& state, const std::string& reason) override {
    failed_.emplace_back(state, reason);
  }

  Surrogate surrogate() const override {
    const SampleGrid grid = known();
    return options_.hermite ? hermite_surrogate(grid, options_.hermite_options)
                            : tensor_spline(grid, options_.tensor_options);
  }

  std::size_t refine(std::size_t states) override {
    const SampleGrid grid = known();
    Ranges ranges;
    for (const Sample& s : grid.samples.samples) ranges.add(s.value);
    const Surrogate fine = coarser(grid, false), coarse = coarser(grid, true);
    struct Cell {
      double promise;
      bool in_theta;
      double middle;
    };
    std::vector<Cell> cells;
    const auto difference = [&](double theta, double alpha) {
      std::vector<OutputValue> a(outputs_.size()), b(outputs_.size());
      fine.evaluate(theta, alpha, a);
      coarse.evaluate(theta, alpha, b);
      VectorXd d(static_cast<Index>(a.size()));
      for (std::size_t o = 0; o < a.size(); ++o) d(static_cast<Index>(o)) = a[o].value - b[o].value;
      return ranges.relative(d);
    };
    // On the lines of the other direction the interpolation there is exact: the difference is this
    // direction's own.
    for (std::size_t i = 0; i + 1 < theta_.size(); ++i) {
      if (theta_[i + 1] - theta_[i] < 2.0 * options_.finest * bounds_.theta_span()) continue;
      Cell cell{0.0, true, 0.5 * (theta_[i] + theta_[i + 1])};
      for (const double a : alpha_)
        cell.promise =
            std::max(cell.promise, difference(cell.middle, a) / static_cast<double>(alpha_.size()));
      cells.push_back(cell);
    }
    for (std::size_t j = 0; j + 1 < alpha_.size(); ++j) {
      if (alpha_[j + 1] - alpha_[j] < 2.0 * options_.finest * bounds_.activation_span()) continue;
      Cell cell{0.0, false, 0.5 * (alpha_[j] + alpha_[j + 1])};
      for (const double t : theta_)
        cell.promise =
            std::max(cell.promise, difference(t, cell.middle) / static_cast<double>(theta_.size()));
      cells.push_back(cell);
    }
    std::stable_sort(cells.begin(), cells.end(),
                     [](const Cell& a, const Cell& b) { return a.promise > b.promise; });
    for (const Cell& cell : cells) {
      std::vector<double>& lines = cell.in_theta ? theta_ : alpha_;
      lines.insert(std::upper_bound(lines.begin(), lines.end(), cell.middle), cell.middle);
      if (wanted().size() >= states) break;
    }
    return wanted().size();
  }

  std::size_t size() const override { return results_.size(); }

 private:
  bool same(const StatePoint& a, const StatePoint& b) const {
    return std::abs(a.theta_rad - b.theta_rad) <= 1e-9 * bounds_.theta_span() &&
           std::abs(a.activation - b.activation) <= 1e-9 * bounds_.activation_span();
  }
  const Sample* find(const StatePoint& s) const {
    const auto at =
        std::find_if(results_.begin(), results_.end(), [&](const Sample& r) { return same(r.at, s); });
    return at == results_.end() ? nullptr : &*at;
  }
  Sample* find(const StatePoint& s) { return const_cast<Sample*>(static_cast<const Full*>(this)->find(s)); }
  bool has_failed(const StatePoint& s) const {
    return std::any_of(failed_.begin(), failed_.end(), [&](const auto& f) { return same(f.first, s); });
  }

  // The grid with all results.
  SampleGrid known() const {
    if (const std::size_t n = wanted().size(); n > 0) missing(n);
    SampleGrid grid{theta_, alpha_, {outputs_, {}}};
    for (const StatePoint& s : grid_states(theta_, alpha_)) {
      const Sample* sample = find(s);
      if (sample == nullptr) {
        const auto f =
            std::find_if(failed_.begin(), failed_.end(), [&](const auto& x) { return same(x.first, s); });
        throw data::InputError("states-missing",
                               fmt::format("the state at {} failed ({}), and a full grid needs every state",
                                           place(s), f->second),
                               "use a sparse grid, or other lines");
      }
      grid.samples.samples.push_back(*sample);
    }
    return grid;
  }

  // The surrogate of this grid, or that of the next lower degree.
  Surrogate coarser(const SampleGrid& grid, bool lower) const {
    TensorOptions tensor = options_.tensor_options;
    tensor.estimate_error = false;
    if (options_.hermite) {
      HermiteOptions hermite = options_.hermite_options;
      hermite.estimate_error = false;
      if (!lower) return hermite_surrogate(grid, hermite);
      if (hermite.degree == HermiteDegree::quintic) {
        hermite.degree = HermiteDegree::cubic;
        return hermite_surrogate(grid, hermite);
      }
      tensor.theta = ThetaCurve::cubic;
      tensor.alpha = AlphaCurve::cubic;
    } else if (lower) {
      tensor.theta = tensor.theta == ThetaCurve::quintic ? ThetaCurve::cubic : ThetaCurve::linear;
      tensor.alpha = tensor.alpha == AlphaCurve::quintic ? AlphaCurve::cubic : AlphaCurve::linear;
    }
    return tensor_spline(grid, tensor);
  }

  StateBounds bounds_;
  std::vector<std::string> outputs_;
  GridDesignOptions options_;
  std::vector<double> theta_, alpha_;
  std::vector<Sample> results_;
  std::vector<std::pair<StatePoint, std::string>> failed_;
};

}  // namespace

std::unique_ptr<Design> sparse_design(const StateBounds& bounds, std::vector<std::string> outputs,
                                      const SparseDesignOptions& options) {
  return std::make_unique<Sparse>(bounds, std::move(outputs), options);
}

std::unique_ptr<Design> grid_design(const StateBounds& bounds, std::vector<std::string> outputs,
                                    const GridDesignOptions& options) {
  return std::make_unique<Full>(bounds, std::move(outputs), options);
}

}  // namespace brachium::fem
