#pragma once
/// A report as plain values: sections of paragraphs, tables and plots. What draws it (html.hpp) knows nothing
/// of muscles; what fills it (the stages) knows nothing of HTML.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace brachium::pipelines::report {

enum class Tone { plain, good, warning, bad };

/// Running text; `code` spans in backticks, DOIs (doi:10.xxxx/...) and https addresses become links.
struct Paragraph {
  std::string text{};
  Tone tone = Tone::plain;
  std::vector<std::string> details{};  ///< of a finding: lines folded away under it
};

struct Cell {
  std::string text{};
  Tone tone = Tone::plain;
  bool numeric = false;  ///< right-aligned
};

/// A table. Rows may be shorter than the header (the rest stays empty), never longer.
struct Grid {
  std::string caption{};
  std::vector<std::string> header{};
  std::vector<std::vector<Cell>> rows{};
  std::vector<std::string> notes{};  ///< set small under the table
};

enum class Style { line, dashed, points, step, area, bars };

/// One curve; x and y of equal length, NaN breaks a line. Long series are thinned by the drawing (min-max per
/// pixel). Values are drawn as they are: convert to the unit of the axis label first (build.hpp does).
struct Series {
  std::string label{};  ///< empty: not in the legend
  std::vector<double> x{}, y{};
  Style style = Style::line;
  int colour = -1;                ///< index into the palette; -1: next free
  std::vector<double> y_lower{};  ///< with `area`: band between y_lower and y; empty: down to zero
};

/// A vertical line or a shaded interval with a label (onsets, held-out, excluded).
struct Marker {
  double from = 0.0;
  std::optional<double> to{};
  std::string label{};
  Tone tone = Tone::plain;
};

/// A horizontal line with a label at its right end (thresholds, bias and limits of agreement).
struct Level {
  double y = 0.0;
  std::string label{};
  Tone tone = Tone::plain;
};

struct Plot {
  std::string title{};
  std::string x_label{}, y_label{};  ///< with units, e.g. "moment [N m]"
  std::vector<Series> series{};
  std::vector<Marker> markers{};
  double height_px = 180.0;  ///< of the drawing area of this panel, without title, axes and legend
  bool log_x = false, log_y = false;
  bool equal_axes = false;  ///< measured against modelled: one scale on both axes, identity line
  std::optional<double> y_min{}, y_max{};
  std::optional<double> x_min{}, x_max{};
  std::vector<Level> levels{};
  std::vector<std::string> categories{};  ///< names at x = 0, 1, 2, ... instead of numbers (bars)
  std::string note{};         ///< one sentence under the plot; also read to those who cannot see it
  std::vector<Plot> below{};  ///< further panels that share this plot's x axis (residuals); no nesting
};

/// Plots side by side, as many columns as fit; small multiples.
struct PlotRow {
  std::vector<Plot> plots{};
  double min_width_px = 0.0;  ///< least width of one plot; 0: one plot takes the full width, several share it
};

/// A part of a body's surface that can be shown or hidden.
struct ViewRegion {
  std::string name{};
  std::vector<std::array<int, 3>> triangles{};  ///< points, counter-clockwise seen from outside
  std::vector<std::array<int, 2>> edges{};  ///< pairs of points: sides of the mesh's cells on this surface
};

/// A quantity on the surface, drawn in colours.
struct ViewField {
  std::string label{};                        ///< with its unit, "fibre stress [kPa]"
  std::vector<std::vector<double>> values{};  ///< by state: one a point; NaN where it has no meaning (grey)
};

struct ViewState {
  std::string label{};              ///< "stretch, 0.50"
  std::vector<double> positions{};  ///< x y z of each point, in View3d::length_unit
};

/// A deforming body in space: a reader turns it, colours it by a field and steps through its states. What is too large
/// for a page is drawn with fewer states or a coarser surface, and the note says so (view3d.hpp).
struct View3d {
  std::string title{};
  std::string length_unit = "mm";
  std::vector<double> reference{};  ///< x y z of each point, undeformed; empty: no outline is offered
  std::vector<ViewRegion> regions{};
  std::vector<ViewState> states{};  ///< the last is shown first
  std::vector<ViewField> fields{};  ///< the first is shown first; may be empty
  std::string note{};
  std::size_t limit_bytes = 2'000'000;  ///< of the page that this view may take
};

struct Section;
/// Folded away until opened (always open in print).
struct Details {
  std::string summary{};
  std::vector<Section> content;
};

using Block = std::variant<Paragraph, Grid, PlotRow, View3d, Details>;

struct Section {
  std::string title{};
  std::string anchor{};  ///< for links; made from the title if empty
  std::vector<Block> blocks{};
};

/// One box of the chain's picture.
struct ChainNode {
  std::string name{}, run{};
  double seconds = 0.0;
  std::string status{};  ///< "done", "reused", "failed", "skipped"
  Tone tone = Tone::plain;
  std::vector<std::string> from{};  ///< names of stages it reads
};

struct Document {
  std::string title{};
  std::string verdict{};  ///< the line a reader remembers
  Tone verdict_tone = Tone::plain;
  std::vector<Paragraph> findings{};  ///< errors (bad), warnings, notes (plain); drawn in that order
  std::vector<ChainNode> chain{};
  std::vector<Section> sections{};
  std::vector<std::string> methods{};                             ///< paragraphs
  std::vector<std::pair<std::string, std::string>> provenance{};  ///< label, value
  std::string subtitle{};                                         ///< under the title: session, subject, date
};

}  // namespace brachium::pipelines::report
