#pragma once
/// A report as plain values: sections of paragraphs, tables and plots. What draws it (html.hpp) knows nothing of
/// muscles; what fills it (the stages) knows nothing of HTML.

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace brachium::pipelines::report {

enum class Tone { plain, good, warning, bad };

/// Running text; `code` spans in backticks, DOIs become links.
struct Paragraph {
  std::string text;
  Tone tone = Tone::plain;
};

struct Cell {
  std::string text;
  Tone tone = Tone::plain;
  bool numeric = false;  ///< right-aligned
};

struct Grid {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
};

enum class Style { line, dashed, points, step, area, bars };

/// One curve; x and y of equal length, NaN breaks a line. Long series are thinned by the drawing (min-max per pixel).
struct Series {
  std::string label;
  std::vector<double> x, y;
  Style style = Style::line;
  int colour = -1;               ///< index into the palette; -1: next free
  std::vector<double> y_lower;   ///< with `area`: band between y_lower and y
};

/// A vertical line or a shaded interval with a label (onsets, held-out, excluded).
struct Marker {
  double from = 0.0;
  std::optional<double> to;
  std::string label;
  Tone tone = Tone::plain;
};

struct Plot {
  std::string title;
  std::string x_label, y_label;  ///< with units
  std::vector<Series> series;
  std::vector<Marker> markers;
  double height_px = 180.0;
  bool log_x = false, log_y = false;
  bool equal_axes = false;       ///< measured against modelled
  std::optional<double> y_min, y_max;
};

/// Plots side by side, as many columns as fit; small multiples.
struct PlotRow {
  std::vector<Plot> plots;
};

struct Section;
/// Folded away until opened (always open in print).
struct Details {
  std::string summary;
  std::vector<Section> content;
};

using Block = std::variant<Paragraph, Grid, PlotRow, Details>;

struct Section {
  std::string title;
  std::string anchor;  ///< for links; made from the title if empty
  std::vector<Block> blocks;
};

/// One box of the chain's picture.
struct ChainNode {
  std::string name, run;
  double seconds = 0.0;
  std::string status;  ///< "done", "reused", "failed", "skipped"
  Tone tone = Tone::plain;
  std::vector<std::string> from;  ///< names of stages it reads
};

struct Document {
  std::string title;
  std::string verdict;  ///< the line a reader remembers
  Tone verdict_tone = Tone::plain;
  std::vector<Paragraph> findings;  ///< errors first, then warnings
  std::vector<ChainNode> chain;
  std::vector<Section> sections;
  std::vector<std::string> methods;                            ///< paragraphs
  std::vector<std::pair<std::string, std::string>> provenance; ///< label, value
};

}  // namespace brachium::pipelines::report
