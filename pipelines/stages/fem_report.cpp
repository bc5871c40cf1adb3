#include "pipelines/stages/fem_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "fem/solve/solve.hpp"
#include "pipelines/report/text.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_surface.hpp"

namespace brachium::pipelines {
namespace {

using report::Details;
using report::Paragraph;
using report::Plot;
using report::PlotRow;
using report::Section;
using report::Series;
using report::Tone;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

double figure(const StageData& output, const std::string& name) {
  return output.tables.at("solve").numbers(name).at(0);
}

/// Ends with one of the resultants' columns, not with a component.
bool is_resultant(const std::string& name) {
  return name.ends_with("_N") && !name.ends_with("_x_N") && !name.ends_with("_y_N") &&
         !name.ends_with("_z_N");
}

const std::map<std::string, std::string>& element_words() {
  static const std::map<std::string, std::string> words{
      {"q2_p1_discontinuous",
       "hexahedra with 27 nodes, pressure linear and discontinuous, condensed in each cell"},
      {"q2_q1_taylor_hood", "Taylor-Hood hexahedra with 27 nodes and continuous trilinear pressure"},
      {"q1_p0", "hexahedra with 8 nodes and one pressure a cell"},
      {"p2_p1_taylor_hood", "Taylor-Hood tetrahedra with 10 nodes and continuous linear pressure"},
      {"p2b_p1_discontinuous",
       "tetrahedra with 10 nodes and a bubble, pressure linear and discontinuous, condensed in each cell"},
      {"q1_displacement", "hexahedra with 8 nodes without a pressure of their own"},
      {"q2_displacement", "hexahedra with 27 nodes without a pressure of their own"}};
  return words;
}

/// Index of the first row of each phase, and its name.
std::vector<std::pair<std::size_t, std::string>> phases_of(const data::Table& table) {
  std::vector<std::pair<std::size_t, std::string>> out;
  const std::vector<std::string>& phase = table.texts("phase");
  for (std::size_t k = 0; k < phase.size(); ++k) {
    if (k == 0 || phase[k] != phase[k - 1]) out.emplace_back(k, phase[k]);
  }
  return out;
}

void what_was_solved(const ReportContext& context, Section& section) {
  const StageData& output = *context.output;
  const std::string element = context.options->text("element");
  section.blocks.emplace_back(
      Paragraph{fmt::format("{}: {} cells, {} points, {} unknowns ({}: {}).", output.attributes.at("mesh"),
                            figure(output, "cells"), figure(output, "points"), figure(output, "unknowns"),
                            element, element_words().at(element)),
                Tone::plain,
                {}});
  section.blocks.emplace_back(
      Paragraph{fmt::format("{} states in {} Newton and {} chord iterations, {} factorisations, {} outer "
                            "iterations for incompressibility; {} in all.",
                            figure(output, "states"), figure(output, "newton_iterations"),
                            figure(output, "chord_iterations"), figure(output, "factorisations"),
                            figure(output, "augmentations"), report::duration(figure(output, "total_s"))),
                Tone::plain,
                {}});
  report::GridOptions grid;
  grid.words = {"law"};
  section.blocks.emplace_back(report::make_grid(output.tables.at("materials"), grid));
  if (const auto failure = output.attributes.find("failure"); failure != output.attributes.end())
    section.blocks.emplace_back(
        Paragraph{fmt::format("The solve stopped before its end: {}. What follows is what was reached.",
                              failure->second),
                  Tone::bad,
                  {}});
}

void stability(const data::Table& steps, Section& section) {
  std::size_t stable = 0, unstable = 0, unchecked = 0;
  for (const std::string& verdict : steps.texts("stability"))
    ++(verdict == "stable" ? stable : verdict == "unstable" ? unstable : unchecked);
  const std::string method = steps.rows() > 0 ? steps.texts("method").back() : "";
  if (unstable > 0) {
    section.blocks.emplace_back(
        Paragraph{fmt::format("{} of {} states are UNSTABLE equilibria: their tangent has negative modes, "
                              "and a body would not stay there. They are marked in the table of states.",
                              unstable, steps.rows()),
                  Tone::bad,
                  {}});
  } else if (unchecked == steps.rows()) {
    section.blocks.emplace_back(Paragraph{"The stability of the states was not tested.", Tone::warning, {}});
  } else {
    section.blocks.emplace_back(Paragraph{
        fmt::format("All {} tested states are stable{}{}.", stable, method.empty() ? "" : " (" + method + ")",
                    unchecked > 0 ? fmt::format("; {} were not tested", unchecked) : ""),
        Tone::good,
        {}});
  }
}

void view(const StageData& output, Section& section) {
  const data::Table& quantities = output.tables.at("quantities");
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < quantities.rows(); ++k)
    labels.push_back(
        fmt::format("{}, {:.3g}", quantities.texts("phase")[k], quantities.numbers("phase_time")[k]));
  report::View3d body = surface_view(output.tables, lines_of(output.attributes.at("regions")), labels);
  body.title = "The deformed body";
  section.blocks.emplace_back(std::move(body));
}

/// Resultants over everything that moves: one plot a driver, with the states in which it changes.
void curves(const StageData& output, Section& section) {
  const data::Table& quantities = output.tables.at("quantities");
  std::vector<std::string> forces, drivers;
  for (const data::Column& column : quantities.columns) {
    if (is_resultant(column.name)) forces.push_back(column.name);
    if (!column.name.starts_with("activation_") && !column.name.starts_with("amplitude_")) continue;
    // Regions that are activated alike make one plot.
    const bool alike = std::any_of(drivers.begin(), drivers.end(), [&](const std::string& other) {
      return other.starts_with("activation_") && column.name.starts_with("activation_") &&
             quantities.numbers(other) == quantities.numbers(column.name);
    });
    if (!alike) drivers.push_back(column.name);
  }
  if (forces.empty() || quantities.rows() == 0) return;
  PlotRow row;
  Plot all{.title = "Forces by state", .x_label = "state", .y_label = "force [N]"};
  for (const std::string& force : forces)
    all.series.push_back({.label = report::in_words(force.substr(0, force.size() - 2)),
                          .x = quantities.numbers("state"),
                          .y = quantities.numbers(force)});
  for (const auto& [first, name] : phases_of(quantities))
    all.markers.push_back(
        {.from = quantities.numbers("state")[first] - (first > 0 ? 1.0 : 0.0), .label = name});
  row.plots.push_back(std::move(all));
  for (const std::string& driver : drivers) {
    const std::vector<double>& x = quantities.numbers(driver);
    const bool activation = driver.starts_with("activation_");
    std::string subject = driver.substr(driver.find('_') + 1);
    if (activation) {
      std::vector<std::string> regions;
      for (const data::Column& column : quantities.columns) {
        if (column.name.starts_with("activation_") && quantities.numbers(column.name) == x)
          regions.push_back(report::in_words(column.name.substr(11)));
      }
      subject = fmt::format("{}", fmt::join(regions, ", "));
    }
    Plot plot{.title = activation ? "Force and activation of " + subject : "Force and `" + subject + "`",
              .x_label = activation ? std::string("activation [1]") : "amplitude of " + subject + " [1]",
              .y_label = "force [N]"};
    for (const std::string& force : forces) {
      Series series{.label = report::in_words(force.substr(0, force.size() - 2))};
      const std::vector<double>& y = quantities.numbers(force);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double before = k > 0 ? x[k - 1] : 0.0;
        if (x[k] == before) continue;
        if (k > 0 &&
            (series.x.empty() || series.x.back() != before)) {  // where this stretch of the curve begins
          if (!series.x.empty()) {
            series.x.push_back(std::nan(""));
            series.y.push_back(std::nan(""));
          }
          series.x.push_back(before);
          series.y.push_back(y[k - 1]);
        }
        series.x.push_back(x[k]);
        series.y.push_back(y[k]);
      }
      if (series.x.size() > 1) plot.series.push_back(std::move(series));
    }
    if (!plot.series.empty()) row.plots.push_back(std::move(plot));
  }
  row.min_width_px = 320.0;
  section.blocks.emplace_back(std::move(row));
}

/// Rows of a table that are the last of their phase.
data::Table phase_ends(const data::Table& table) {
  data::Table out{table.title, {}};
  const std::vector<std::string>& phase = table.texts("phase");
  for (const data::Column& column : table.columns) {
    out.columns.push_back({column.name, column.unit, column.values});
    std::visit(
        [&](auto& values) {
          std::decay_t<decltype(values)> kept;
          for (std::size_t k = 0; k < values.size(); ++k) {
            if (k + 1 == values.size() || phase[k] != phase[k + 1]) kept.push_back(values[k]);
          }
          values = std::move(kept);
        },
        out.columns.back().values);
  }
  return out;
}

void wanted(const StageData& output, Section& section) {
  data::Table ends = phase_ends(output.tables.at("quantities"));
  ends.title = "Wanted quantities at the end of each phase";
  // Wide tables are read better by the quantity: one row a quantity, one column a phase.
  report::Grid grid;
  grid.caption = ends.title;
  grid.header = {"quantity"};
  for (const std::string& phase : ends.texts("phase")) grid.header.push_back("after " + phase);
  for (const data::Column& column : ends.columns) {
    if (column.unit.empty() || column.name == "state" || column.name == "phase_time") continue;
    std::vector<report::Cell> cells{
        report::make_text_cell(report::label_of_name(column.name, column.unit == "1" ? "" : column.unit))};
    for (const double v : std::get<std::vector<double>>(column.values))
      cells.push_back(report::make_number_cell(v, 6));
    grid.rows.push_back(std::move(cells));
  }
  section.blocks.emplace_back(std::move(grid));
  Section folded;
  folded.blocks.emplace_back(report::make_grid(output.tables.at("quantities"), {.digits = 6}));
  section.blocks.emplace_back(Details{"every state", {std::move(folded)}});
}

void convergence(const ReportContext& context, Section& section) {
  const StageData& output = *context.output;
  const data::Table &iterations = output.tables.at("iterations"), &steps = output.tables.at("steps");
  const std::vector<double>&state = iterations.numbers("state"),
        &residual = iterations.numbers("relative_residual");
  const std::vector<std::string>& kind = iterations.texts("kind");
  Plot plot{.title = "Convergence, iteration by iteration",
            .x_label = "iteration",
            .y_label = "relative residual [1]"};
  plot.log_y = true;
  std::map<std::string, Series> dots;
  Series line;
  for (std::size_t k = 0; k < state.size(); ++k) {
    const double x = static_cast<double>(k + 1);
    if (k > 0 && state[k] != state[k - 1]) {
      line.x.push_back(x - 0.5);
      line.y.push_back(std::nan(""));
    }
    if (!(residual[k] > 0.0)) continue;  // a predictor has no residual of its own
    line.x.push_back(x);
    line.y.push_back(residual[k]);
    dots[kind[k]].x.push_back(x);
    dots[kind[k]].y.push_back(residual[k]);
  }
  line.colour = 6;
  plot.series.push_back(std::move(line));
  for (auto& [name, series] : dots) {
    series.label = name;
    series.style = report::Style::points;
    plot.series.push_back(std::move(series));
  }
  const Options* solver = context.options->maybe_table("solver");
  plot.levels.push_back({solver ? solver->number("relative_residual") : fem::SolveOptions{}.relative_residual,
                         "tolerance", Tone::good});
  plot.note = "One line a state; each ends where it was accepted.";
  section.blocks.emplace_back(PlotRow{{std::move(plot)}, 0.0});
  report::GridOptions grid;
  grid.digits = 3;
  grid.columns = {
      "state",          "phase",     "phase_time",        "newton",       "chord",      "augmentations",
      "relaxations",    "cut_backs", "relative_residual", "worst_volume", "smallest_J", "stability",
      "negative_modes", "time_s"};
  grid.text_tone = {
      {"stability", [](const std::string& verdict) {
         return verdict == "unstable" ? Tone::bad : verdict == "stable" ? Tone::good : Tone::plain;
       }}};
  Section folded, rows;
  folded.blocks.emplace_back(report::make_grid(steps, grid));
  section.blocks.emplace_back(Details{"every state: iterations, volume, stability", {std::move(folded)}});
  rows.blocks.emplace_back(report::make_grid(iterations, {.digits = 3}));
  section.blocks.emplace_back(Details{"every iteration", {std::move(rows)}});
}

std::string sources_of_laws(const data::Table& materials) {
  static const std::map<std::string, std::string> laws{
      {"muscle_tendon",
       "a muscle-tendon law with isotropic ground and fibres (Valentin 2019; force-length curve after "
       "Günther et al. 2007, doi:10.1007/s00422-007-0160-6)"},
      {"neo_hooke", "a neo-Hookean law"},
      {"mooney_rivlin", "a Mooney-Rivlin law"},
      {"fung_guccione",
       "an exponential, transversely isotropic law (Guccione et al. 1991, doi:10.1115/1.2894084)"},
      {"blemker_muscle", "the muscle law of Blemker et al. 2005, doi:10.1016/j.jbiomech.2004.04.009"}};
  std::set<std::string> used;
  for (const std::string& law : materials.texts("law")) used.insert(laws.at(law));
  return fmt::format("{}", fmt::join(used, ", and "));
}

}  // namespace

void fem_chapter(const ReportContext& context, Section& section) {
  const StageData& output = *context.output;
  section.title += ": continuum mechanics";
  what_was_solved(context, section);
  if (output.tables.contains("quantities")) {
    stability(output.tables.at("steps"), section);
    view(output, section);
    curves(output, section);
    wanted(output, section);
    convergence(context, section);
  }
  Section folded;
  folded.blocks.emplace_back(report::make_grid(output.tables.at("mesh_quality"), {.digits = 3}));
  if (const auto fibres = output.tables.find("fibres"); fibres != output.tables.end())
    folded.blocks.emplace_back(report::make_grid(fibres->second, {.digits = 3}));
  section.blocks.emplace_back(Details{"mesh and fibres", {std::move(folded)}});
  if (const auto files = output.attributes.find("files");
      files != output.attributes.end() && !files->second.empty())
    section.blocks.emplace_back(
        Paragraph{fmt::format("Fields for ParaView: `{}`.", fmt::join(lines_of(files->second), "`, `")),
                  Tone::plain,
                  {}});
}

std::string fem_methods(const ReportContext& context) {
  const StageData& output = *context.output;
  const std::string element = context.options->text("element");
  const data::Table& materials = output.tables.at("materials");
  bool exact = false, augmented = false;
  for (const std::string& volume : materials.texts("volume")) exact = exact || volume == "incompressible";
  augmented = exact && element.find("taylor_hood") == std::string::npos;
  bool harmonic = false;
  for (const Options& fibre : context.options->tables("fibre"))
    harmonic = harmonic || fibre.text("kind") == "harmonic";
  std::string text = fmt::format(
      "Quasi-static equilibrium at finite strain was solved by finite elements ({}; Boffi, Brezzi & Fortin "
      "2013, doi:10.1007/978-3-642-36519-5) with {}.",
      element_words().at(element), sources_of_laws(materials));
  std::set<std::string> sources(materials.texts("source").begin(), materials.texts("source").end());
  sources.erase("given in the definition");
  if (!sources.empty()) text += fmt::format(" Parameters: {}.", fmt::join(sources, "; "));
  if (exact)
    text += augmented ? " Incompressibility was met by an augmented Lagrangian (Simo & Taylor 1991, "
                        "doi:10.1016/0045-7825(91)90100-K)."
                      : " Incompressibility was met exactly, by the pressure field.";
  if (harmonic)
    text +=
        " Fibres follow the gradient of a harmonic function between origin and insertion (Choi & Blemker "
        "2013, doi:10.1371/journal.pone.0077576).";
  const Options* solver = context.options->maybe_table("solver");
  const fem::SolveOptions defaults;
  text += fmt::format(
      " Load steps were solved by Newton's method with a consistent tangent to a relative residual of {:g}",
      solver ? solver->number("relative_residual") : defaults.relative_residual);
  if ((solver ? solver->text("stability") : defaults.stability) != "off")
    text +=
        "; equilibria were tested for stability by the inertia of the tangent (Higham 2002, "
        "doi:10.1137/1.9780898718027)";
  return text + ".";
}

}  // namespace brachium::pipelines
