#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipelines/stages/common.hpp"
#include "pipelines/stages/optimise_scenario.hpp"

namespace brachium::pipelines {
namespace {

using report::Plot;
using report::Series;
using report::Style;

// Distinct texts of a column, in their order.
std::vector<std::string> names_in(const data::Table& table, const std::string& column) {
  std::vector<std::string> out;
  for (const std::string& t : table.texts(column)) {
    if (std::find(out.begin(), out.end(), t) == out.end()) out.push_back(t);
  }
  return out;
}

// Rows of a table where a text column has a value.
std::vector<std::size_t> rows_of(const data::Table& table, const std::string& column,
                                 const std::string& value) {
  std::vector<std::size_t> rows;
  const auto& texts = table.texts(column);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i] == value) rows.push_back(i);
  }
  return rows;
}

report::PlotRow force_plots(const data::Table& forces) {
  report::PlotRow row;
  row.min_width_px = 420.0;
  Plot arms{"moment arms", "angle [deg]", "moment arm, flexor positive [mm]"};
  for (const std::string& muscle : names_in(forces, "muscle")) {
    Plot plot{muscle, "angle [deg]", "force [N]"};
    Series arm{muscle, {}, {}};
    std::vector<double> activations;
    for (const std::size_t i : rows_of(forces, "muscle", muscle)) {
      const double a = forces.numbers("activation")[i];
      if (activations.empty() || activations.back() != a) {
        activations.push_back(a);
        plot.series.push_back({fmt::format("activation {:g}", a), {}, {}});
      }
      plot.series.back().x.push_back(forces.numbers("angle_deg")[i]);
      plot.series.back().y.push_back(forces.numbers("force_N")[i]);
      if (activations.size() > 1) continue;
      arm.x.push_back(forces.numbers("angle_deg")[i]);
      arm.y.push_back(forces.numbers("moment_arm_mm")[i]);
    }
    row.plots.push_back(std::move(plot));
    arms.series.push_back(std::move(arm));
  }
  row.plots.push_back(std::move(arms));
  return row;
}

// Roots as vertical marks with their angle; neighbours within 4 deg share one.
void mark_roots(std::vector<double> roots, report::Tone tone, Plot& plot) {
  std::sort(roots.begin(), roots.end());
  for (std::size_t i = 0; i < roots.size();) {
    std::size_t last = i;
    while (last + 1 < roots.size() && roots[last + 1] - roots[i] < 4.0) ++last;
    const std::string unstable = tone == report::Tone::bad ? " unstable" : "";
    if (last == i) {
      plot.markers.push_back({roots[i], {}, fmt::format("{:.1f}°{}", roots[i], unstable), tone});
    } else {
      plot.markers.push_back(
          {roots[i], roots[last], fmt::format("{:.1f}-{:.1f}°{}", roots[i], roots[last], unstable), tone});
    }
    i = last + 1;
  }
}

// Moment curves with their roots, one plot a load.
report::PlotRow moment_plots(const data::Table& curves, const data::Table& equilibria) {
  report::PlotRow row;
  row.min_width_px = 420.0;
  std::vector<double> loads = equilibria.numbers("load_N");
  std::sort(loads.begin(), loads.end());
  loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
  for (const double load : loads) {
    Plot plot{fmt::format("load {:g} N", load), "angle [deg]", "moment, flexion positive [N m]"};
    plot.height_px = 240.0;
    plot.levels.push_back({0.0, "", report::Tone::plain});
    std::vector<double> stable, unstable;
    std::size_t without = 0;
    for (const std::string& name : names_in(equilibria, "case")) {
      bool here = false;
      for (const std::size_t i : rows_of(equilibria, "case", name)) {
        if (equilibria.numbers("load_N")[i] != load) continue;
        here = true;
        const std::string& outcome = equilibria.texts("outcome")[i];
        without += outcome == "none in range";
        if (outcome == "none in range") continue;
        (outcome == "stable" ? stable : unstable).push_back(equilibria.numbers("angle_deg")[i]);
      }
      if (!here) continue;
      Series curve{name, {}, {}};
      for (const std::size_t i : rows_of(curves, "case", name)) {
        curve.x.push_back(curves.numbers("angle_deg")[i]);
        curve.y.push_back(curves.numbers("moment_N_m")[i]);
      }
      plot.series.push_back(std::move(curve));
    }
    mark_roots(stable, report::Tone::good, plot);
    mark_roots(unstable, report::Tone::bad, plot);
    if (without > 0)
      plot.note = fmt::format("{} without an equilibrium in range.",
                              without == 1 ? "One case is" : fmt::format("{} cases are", without));
    row.plots.push_back(std::move(plot));
  }
  return row;
}

// |M| over iterations: a line for each start of the first cases.
Plot convergence_plot(const data::Table& table) {
  Plot plot{"convergence", "iteration", "|moment| [N m]"};
  plot.log_y = true;
  const auto& names = table.texts("case");
  const auto &start = table.numbers("start_deg"), &iteration = table.numbers("iteration"),
             &moment = table.numbers("moment_N_m");
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (iteration[i] == 0.0) {
      if (plot.series.size() == 9) break;
      plot.series.push_back({fmt::format("{}, from {:g} deg", names[i], start[i]), {}, {}});
    }
    plot.series.back().x.push_back(iteration[i]);
    plot.series.back().y.push_back(moment[i] != 0.0 ? std::abs(moment[i]) : std::nan(""));
  }
  if (plot.series.size() == 9) plot.note = "The first cases; the table below has all.";
  return plot;
}

report::PlotRow history_plots(const data::Table& table) {
  report::PlotRow row;
  row.min_width_px = 420.0;
  for (const std::string& name : names_in(table, "case")) {
    Plot plot{name, "time [s]", "angle [deg]"};
    Plot below{"", "time [s]", "load [N]"};
    below.height_px = 80.0;
    Series angle{"angle", {}, {}}, load{"load", {}, {}},
        end{"pressed against the end of the range", {}, {}, Style::points};
    for (const std::size_t i : rows_of(table, "case", name)) {
      const double t = table.numbers("time_s")[i];
      const std::string& kind = table.texts("kind")[i];
      angle.x.push_back(t);
      angle.y.push_back(table.numbers("angle_deg")[i]);
      load.x.push_back(t);
      load.y.push_back(table.numbers("load_N")[i]);
      if (kind == "jumped") plot.markers.push_back({t, {}, "jump", report::Tone::warning});
      if (kind.starts_with("at ")) end.x.push_back(t), end.y.push_back(table.numbers("angle_deg")[i]);
    }
    plot.series.push_back(std::move(angle));
    if (!end.x.empty()) plot.series.push_back(std::move(end));
    below.series.push_back(std::move(load));
    plot.below.push_back(std::move(below));
    row.plots.push_back(std::move(plot));
  }
  return row;
}

report::GridOptions grid_options() {
  report::GridOptions grid;
  grid.names = {{"dangle_dload_deg_per_N", "dangle/dload"},
                {"dactivation_dangle_per_deg", "dactivation/dangle"},
                {"dactivation_dload_per_N", "dactivation/dload"},
                {"stiffness_N_m_per_rad", "dM/dangle"}};
  grid.decimals = {{"angle_deg", 2}, {"angle_error_deg", 2}, {"start_deg", 0},
                   {"iteration", 0}, {"iterations", 0},      {"evaluations", 0}};
  grid.digits = 4;
  grid.column_digits = {{"moment_N_m", 3}, {"step_deg", 4}, {"dangle_dload_deg_per_N", 3}};
  grid.text_tone = {{"outcome", [](const std::string& t) {
                       return t == "stable" || t == "held" ? report::Tone::good : report::Tone::warning;
                     }}};
  return grid;
}

// Rows of one system, without its name.
data::Table of_system(const data::Table& table, const std::string& system) {
  data::Table out{table.title, {}};
  const std::vector<std::size_t> rows = rows_of(table, "system", system);
  for (const data::Column& c : table.columns) {
    if (c.name == "system") continue;
    out.columns.push_back({c.name, c.unit, c.values});
    std::visit(
        [&](auto& values) {
          std::decay_t<decltype(values)> kept;
          for (const std::size_t i : rows) kept.push_back(values[i]);
          values = std::move(kept);
        },
        out.columns.back().values);
  }
  return out;
}

// What a row of `equilibria` or `positions` answers, in a cell.
report::Cell answer(const data::Table& table, const std::vector<std::size_t>& rows) {
  std::string text;
  report::Tone tone = report::Tone::plain;
  const bool angles = !table.numbers("angle_deg").empty() && [&] {
    return std::any_of(table.columns.begin(), table.columns.end(),
                       [](const data::Column& c) { return c.name == "stiffness_N_m_per_rad"; });
  }();
  for (const std::size_t i : rows) {
    const std::string& outcome = table.texts("outcome")[i];
    if (!text.empty()) text += "; ";
    if (outcome == "none in range") {
      text +=
          angles ? "none" : fmt::format("none ({:+.2f} N m left)", table.numbers("remaining_moment_N_m")[i]);
      tone = report::Tone::warning;
    } else if (angles) {
      text +=
          fmt::format("{:.1f}{}", table.numbers("angle_deg")[i], outcome == "unstable" ? " unstable" : "");
    } else {
      text += fmt::format("{:.3f}", table.numbers("activation")[i]);
    }
  }
  return report::make_text_cell(text, tone);
}

// One row a case, one column a system.
report::Grid side_by_side(const data::Table& table, const std::string& caption) {
  report::Grid grid;
  grid.caption = caption;
  grid.header = {"case"};
  const std::vector<std::string> systems = names_in(table, "system");
  grid.header.insert(grid.header.end(), systems.begin(), systems.end());
  for (const std::string& name : names_in(table, "case")) {
    std::vector<report::Cell> cells{report::make_text_cell(name)};
    for (const std::string& system : systems) {
      std::vector<std::size_t> rows;
      for (const std::size_t i : rows_of(table, "case", name)) {
        if (table.texts("system")[i] == system) rows.push_back(i);
      }
      cells.push_back(answer(table, rows));
    }
    grid.rows.push_back(std::move(cells));
  }
  return grid;
}

// A column over time, a plot a case, a line a system.
report::PlotRow over_time(const data::Table& table, const std::string& column, const std::string& axis) {
  report::PlotRow row;
  row.min_width_px = 420.0;
  for (const std::string& name : names_in(table, "case")) {
    Plot plot{name, "time [s]", axis};
    for (const std::string& system : names_in(table, "system")) {
      Series series{system, {}, {}};
      for (const std::size_t i : rows_of(table, "case", name)) {
        if (table.texts("system")[i] != system) continue;
        series.x.push_back(table.numbers("time_s")[i]);
        series.y.push_back(table.numbers(column)[i]);
      }
      plot.series.push_back(std::move(series));
    }
    row.plots.push_back(std::move(plot));
  }
  return row;
}

void fill_system(const std::map<std::string, data::Table>& tables, report::Section& section) {
  const auto table = [&](const std::string& name) -> const data::Table& { return tables.at(name); };
  report::GridOptions grid = grid_options();
  for (const std::string& name : names_in(table("forces"), "muscle")) {
    grid.names["activation_" + name] = name + ": activation";
    grid.names["dangle_dactivation_" + name + "_deg"] = "dangle/dactivation " + name;
    grid.column_digits["dangle_dactivation_" + name + "_deg"] = 3;
  }
  section.blocks.push_back(force_plots(table("forces")));
  if (table("equilibria").rows() > 0) {
    section.blocks.push_back(
        report::Paragraph{"Activation-driven: the joint rests where the sum of all moments vanishes, and "
                          "stays there where it falls with the angle."});
    section.blocks.push_back(moment_plots(table("moments"), table("equilibria")));
    section.blocks.push_back(report::make_grid(table("equilibria"), grid));
    section.blocks.push_back(report::PlotRow{{convergence_plot(table("convergence"))}});
    report::Section iterations;
    iterations.blocks.push_back(report::make_grid(table("convergence"), grid));
    section.blocks.push_back(report::Details{"every iteration", {iterations}});
  }
  if (table("positions").rows() > 0) {
    section.blocks.push_back(report::Paragraph{
        "Position-driven: the activation of one muscle that holds an angle. Where there is none, the nearest "
        "activation, the moment that is left, and the further load that would hold it."});
    section.blocks.push_back(report::make_grid(table("positions"), grid));
    report::Section iterations;
    iterations.blocks.push_back(report::make_grid(table("position_convergence"), grid));
    section.blocks.push_back(report::Details{"every iteration of the activations", {iterations}});
  }
  if (table("motions").rows() > 0) {
    section.blocks.push_back(
        report::Paragraph{"Position-driven over time: the activation that holds each angle."});
    section.blocks.push_back(over_time(table("motions"), "nearest_activation", "activation"));
  }
  if (table("histories").rows() > 0) {
    section.blocks.push_back(report::Paragraph{"Force-driven: where the load takes the joint."});
    section.blocks.push_back(history_plots(table("histories")));
    if (table("events").rows() > 0) section.blocks.push_back(report::make_grid(table("events"), grid));
  }
}

}  // namespace

void fill_scenario_report(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  section.title += ": static equilibrium";
  section.blocks.push_back(report::Paragraph{
      "Forces between the states that were given or solved by interpolation; moment arms are "
      "positive for flexors. A load above 0 extends."});
  const std::vector<std::string> systems = names_in(output.tables.at("forces"), "system");
  if (systems.size() > 1) {
    if (output.tables.at("equilibria").rows() > 0)
      section.blocks.push_back(
          side_by_side(output.tables.at("equilibria"), "Equilibrium angles [deg], all roots"));
    if (output.tables.at("positions").rows() > 0)
      section.blocks.push_back(side_by_side(output.tables.at("positions"), "Activations that hold an angle"));
    if (output.tables.at("motions").rows() > 0)
      section.blocks.push_back(over_time(output.tables.at("motions"), "nearest_activation", "activation"));
    if (output.tables.at("histories").rows() > 0)
      section.blocks.push_back(over_time(output.tables.at("histories"), "angle_deg", "angle [deg]"));
  }
  for (const std::string& system : systems) {
    std::map<std::string, data::Table> own;
    for (const auto& [name, table] : output.tables) own[name] = of_system(table, system);
    if (systems.size() == 1) {
      fill_system(own, section);
    } else {
      report::Section part;
      fill_system(own, part);
      section.blocks.push_back(report::Details{system, {part}});
    }
  }
}

std::string scenario_methods(const ReportContext& context) {
  return fmt::format(
      "Static equilibria are roots of the joint moment (equivalent static system, Valentin 2019, "
      "doi:10.18419/opus-10504), found by Newton's method inside brackets of changing sign to {:g} of the "
      "sum of "
      "the sizes of all moments; an equilibrium is stable where the moment falls with the angle.",
      context.options->number("relative_tolerance"));
}

}  // namespace brachium::pipelines
