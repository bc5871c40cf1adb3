/// The report's chapter of fem.muscle_map.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "pipelines/report/text.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/fem_muscle_map_view.hpp"

namespace brachium::pipelines {
namespace {

using report::Plot;
using report::PlotRow;
using report::Section;
using report::Series;
using report::Style;

struct Curve {
  std::vector<double> x, y;
};

/// A column over the angle by activation, of one muscle; failed states are left out.
std::map<double, Curve> by_activation(const data::Table& states, const std::string& muscle,
                                      const std::string& column, double scale = 1.0) {
  std::map<double, Curve> out;
  for (std::size_t k = 0; k < states.rows(); ++k) {
    const double y = scale * states.numbers(column)[k];
    if (states.texts("muscle")[k] != muscle || !std::isfinite(y)) continue;
    Curve& c = out[states.numbers("activation")[k]];
    c.x.push_back(states.numbers("angle_deg")[k]);
    c.y.push_back(y);
  }
  return out;
}

std::string activation_text(double a) {
  return fmt::format("activation {:.3g}", a);
}

/// A line an activation, markers where states were solved.
Plot over_angle(const data::Table& states, const data::Table* surrogate, const std::string& muscle,
                const std::string& column, const std::string& title, const std::string& y_label) {
  Plot plot{.title = muscle + ": " + title, .x_label = "elbow flexion [deg]", .y_label = y_label};
  int colour = 0;
  if (surrogate) {
    for (const auto& [a, curve] : by_activation(*surrogate, muscle, column))
      plot.series.push_back(
          {.label = activation_text(a), .x = curve.x, .y = curve.y, .colour = colour++ % 8});
  }
  Series dots{.label = "solved states", .style = Style::points, .colour = 6};
  for (const auto& [a, curve] : by_activation(states, muscle, column)) {
    if (surrogate) {
      dots.x.insert(dots.x.end(), curve.x.begin(), curve.x.end());
      dots.y.insert(dots.y.end(), curve.y.begin(), curve.y.end());
    } else {
      plot.series.push_back(
          {.label = activation_text(a), .x = curve.x, .y = curve.y, .colour = colour++ % 8});
    }
  }
  if (surrogate) plot.series.push_back(std::move(dots));
  return plot;
}

/// Least and greatest activation: what lies between is in the table.
std::vector<std::pair<double, Curve>> ends(std::map<double, Curve> curves) {
  std::erase_if(curves, [](const auto& c) { return c.second.x.size() < 2; });
  if (curves.empty()) return {};
  std::vector<std::pair<double, Curve>> out{*curves.begin()};
  if (curves.size() > 1) out.push_back(*curves.rbegin());
  return out;
}

Plot lever_arms(const data::Table& states, const std::string& muscle) {
  Plot plot{.title = muscle + ": lever arms", .x_label = "elbow flexion [deg]", .y_label = "lever arm [mm]"};
  const auto tdm = by_activation(states, muscle, "tdm_m", 1e3);
  if (!tdm.empty()) {
    const Curve& c = tdm.begin()->second;
    plot.series.push_back({.label = "TDM", .x = c.x, .y = c.y, .colour = 0});
  }
  int colour = 1;
  for (const auto& [column, name] :
       {std::pair{"vrla_m", "VRLA"}, {"vrla_plus_m", "VRLA+"}, {"moment_N_m", "virtual work"}}) {
    int k = 0;
    for (auto [a, curve] : ends(by_activation(states, muscle, column, 1e3))) {
      if (std::string(column) == "moment_N_m") {
        const Curve force = by_activation(states, muscle, "force_N").at(a);
        for (std::size_t i = 0; i < curve.y.size(); ++i) curve.y[i] /= force.y[i];
      }
      plot.series.push_back({.label = fmt::format("{}, {}", name, activation_text(a)),
                             .x = curve.x,
                             .y = curve.y,
                             .style = k++ == 0 ? Style::dashed : Style::line,
                             .colour = colour});
    }
    ++colour;
  }
  plot.note =
      "Flexion positive. VRLA and VRLA+ are of the wrench at the muscle's distal end; virtual work is the "
      "moment over "
      "the force, M / F.";
  return plot;
}

Plot stretch(const data::Table& states, const std::string& muscle) {
  Plot plot{
      .title = muscle + ": fibre stretch", .x_label = "elbow flexion [deg]", .y_label = "fibre stretch [1]"};
  int colour = 0;
  for (const auto& [a, mean] : ends(by_activation(states, muscle, "mean_fibre_stretch"))) {
    const Curve deviation = by_activation(states, muscle, "fibre_stretch_deviation").at(a);
    Series band{
        .label = "± standard deviation, " + activation_text(a), .style = Style::area, .colour = colour};
    band.x = mean.x;
    for (std::size_t i = 0; i < mean.y.size(); ++i) {
      band.y.push_back(mean.y[i] + deviation.y[i]);
      band.y_lower.push_back(mean.y[i] - deviation.y[i]);
    }
    plot.series.push_back(std::move(band));
    plot.series.push_back(
        {.label = "mean, " + activation_text(a), .x = mean.x, .y = mean.y, .colour = colour});
    colour += 2;
  }
  return plot;
}

/// Shares by interval of stretch at some angles, fully active where that was solved.
Plot distribution(const data::Table& table, const std::string& muscle) {
  std::map<double, std::map<double, Curve>> by_state;  // activation, angle
  for (std::size_t k = 0; k < table.rows(); ++k) {
    if (table.texts("muscle")[k] != muscle) continue;
    Curve& c = by_state[table.numbers("activation")[k]][table.numbers("angle_deg")[k]];
    c.x.push_back(table.numbers("stretch")[k]);
    c.y.push_back(100.0 * table.numbers("share")[k]);
  }
  Plot plot{.title = muscle, .x_label = "fibre stretch [1]", .y_label = "share of the muscle [%]"};
  if (by_state.empty()) return plot;
  const auto& [a, angles] = *by_state.rbegin();
  plot.title = fmt::format("{}: distribution of fibre stretch, {}", muscle, activation_text(a));
  const std::size_t every = std::max<std::size_t>(1, (angles.size() + 4) / 5);
  std::size_t k = 0;
  int colour = 0;
  for (const auto& [angle, curve] : angles) {
    if (k++ % every != 0 && k != angles.size()) continue;
    plot.series.push_back(
        {.label = fmt::format("{:.4g} deg", angle), .x = curve.x, .y = curve.y, .colour = colour++ % 8});
  }
  return plot;
}

void figures(const StageData& map, Section& section) {
  const data::Table& states = map.tables.at("states");
  const auto found = map.tables.find("surrogate");
  const data::Table* surrogate = found == map.tables.end() ? nullptr : &found->second;
  for (const std::string& m : map.tables.at("muscles").texts("muscle")) {
    PlotRow forces, arms, stretches, contact;
    for (PlotRow* row : {&forces, &arms, &stretches, &contact}) row->min_width_px = 380.0;
    forces.plots.push_back(over_angle(states, surrogate, m, "force_N", "force", "force [N]"));
    forces.plots.push_back(
        over_angle(states, surrogate, m, "moment_N_m", "moment by virtual work", "moment [N m]"));
    arms.plots.push_back(lever_arms(states, m));
    arms.plots.push_back(stretch(states, m));
    stretches.plots.push_back(distribution(map.tables.at("fibre_stretch"), m));
    contact.plots.push_back(
        over_angle(states, nullptr, m, "contact_force_N", "contact force", "contact force [N]"));
    Plot pressure{.title = m + ": greatest contact pressure",
                  .x_label = "elbow flexion [deg]",
                  .y_label = "pressure [kPa]"};
    int colour = 0;
    for (const auto& [a, c] : by_activation(states, m, "greatest_pressure_Pa", 1e-3))
      pressure.series.push_back({.label = activation_text(a), .x = c.x, .y = c.y, .colour = colour++ % 8});
    contact.plots.push_back(std::move(pressure));
    for (PlotRow* row : {&forces, &arms, &stretches, &contact}) section.blocks.emplace_back(std::move(*row));
  }
}

/// How far the moment of the stress in the belly is from that of the reactions: a measure of the mesh.
std::string discretisation_text(const data::Table& states) {
  double worst = 0.0;
  for (std::size_t k = 0; k < states.rows(); ++k) {
    const double by_reaction = states.numbers("moment_of_wrench_N_m")[k],
                 by_stress = states.numbers("moment_by_stress_N_m")[k];
    if (std::isfinite(by_reaction)) worst = std::max(worst, std::abs(by_stress / by_reaction - 1.0));
  }
  return fmt::format(
      "Moments about the hinge from the stress through the middle of the belly and the contact beyond it "
      "differ from those of the nodal reactions by at most {:.2g} %: a measure of the mesh, since they agree "
      "in the limit.",
      100.0 * worst);
}

Section folded_table(const data::Table& table) {
  Section folded;
  folded.blocks.emplace_back(report::make_grid(table, {.digits = 4}));
  return folded;
}

}  // namespace

void fill_muscle_map_report(const ReportContext& context, Section& section) {
  const StageData& map = *context.output;
  section.title += ": continuum muscles over angle and activation";
  section.blocks.emplace_back(
      report::Paragraph{fmt::format("{}, variant `{}`. {}.", map.attributes.at("limb"),
                                    map.attributes.at("variant"), map.attributes.at("verdict"))});
  for (const std::string& text : map.tables.at("muscles").texts("bones")) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
      section.blocks.emplace_back(report::Paragraph{line + "."});
  }
  if (!map.attributes.at("not_modelled").empty())
    section.blocks.emplace_back(
        report::Paragraph{"Not modelled: " + map.attributes.at("not_modelled") + "."});
  report::View3d view = limb_view(map);
  if (!view.states.empty()) section.blocks.emplace_back(std::move(view));
  figures(map, section);
  section.blocks.emplace_back(report::Paragraph{discretisation_text(map.tables.at("states"))});
  if (map.tables.contains("scaling"))
    section.blocks.emplace_back(report::make_grid(map.tables.at("scaling"), {.digits = 4}));
  report::GridOptions short_grid;
  short_grid.columns = {"muscle",   "action",   "states",      "failed",
                        "unstable", "unknowns", "pre_stretch", "max_stress_Pa"};
  section.blocks.emplace_back(report::make_grid(map.tables.at("muscles"), short_grid));
  if (map.tables.contains("surrogate_error")) {
    section.blocks.emplace_back(report::make_grid(map.tables.at("surrogate_error"), {.digits = 3}));
    section.blocks.emplace_back(
        report::Paragraph{"Each inner line of states is left out and predicted from the others: the error of "
                          "a surrogate with fewer states, "
                          "so a pessimistic estimate."});
  }
  section.blocks.emplace_back(report::Details{"every state", {folded_table(map.tables.at("states"))}});
  section.blocks.emplace_back(
      report::Details{"contact with each bone", {folded_table(map.tables.at("contacts"))}});
}

std::string muscle_map_methods(const ReportContext& context) {
  const StageData& map = *context.output;
  return fmt::format(
      "Continuum muscles of a limb with {} were solved at {} states of joint angle and activation, in "
      "frictionless contact "
      "with the humerus (penalty; Wriggers 2006, doi:10.1007/978-3-540-32609-0), after the Upper Limb Model "
      "(Valentin "
      "2019, doi:10.18419/opus-10504, ch. 7). Lever arms are those of the passive length (tendon "
      "displacement, An et al. "
      "1984, doi:10.1115/1.3138494), of the resultant force, and of its line of action.",
      map.attributes.at("variant") == "mtc" ? "meshed tendons" : "inextensible tendons",
      map.tables.at("states").rows());
}

}  // namespace brachium::pipelines
