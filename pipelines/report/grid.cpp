#include "pipelines/report/grid.hpp"

#include <stdexcept>

#include "pipelines/report/legend.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr std::size_t kLongText = 18;

std::string class_attribute(const Cell& cell) {
  // A long text must not be squeezed into a column of single words when the table scrolls.
  std::string classes = cell.numeric ? "n" : cell.text.size() > kLongText ? "w" : "";
  if (cell.tone != Tone::plain) classes += (classes.empty() ? "" : " ") + tone_class(cell.tone);
  return classes.empty() ? "" : " class=\"" + classes + "\"";
}

}  // namespace

std::string draw_grid(const Grid& grid) {
  std::vector<bool> numeric(grid.header.size(), false);
  for (const auto& row : grid.rows) {
    if (row.size() > grid.header.size()) {
      throw std::logic_error("table `" + grid.caption + "`: a row has more cells than the header");
    }
    for (std::size_t k = 0; k < row.size(); ++k) numeric[k] = numeric[k] || row[k].numeric;
  }
  std::string out = "<div class=\"scroll\" tabindex=\"0\"><table>";
  if (!grid.caption.empty()) out += "<caption>" + inline_markup(grid.caption) + "</caption>";
  out += "<thead><tr>";
  for (std::size_t k = 0; k < grid.header.size(); ++k) {
    out += std::string("<th scope=\"col\"") + (numeric[k] ? " class=\"n\">" : ">") +
           inline_markup(typeset_label(grid.header[k])) + "</th>";
  }
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : grid.rows) {
    out += "<tr>";
    for (std::size_t k = 0; k < grid.header.size(); ++k) {
      if (k >= row.size()) {
        out += "<td></td>";
        continue;
      }
      const bool heads_row = k == 0 && !row[k].numeric;
      out += (heads_row ? "<th scope=\"row\"" : "<td") + class_attribute(row[k]) + ">" +
             inline_markup(row[k].text) + (heads_row ? "</th>" : "</td>");
    }
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n";
  for (const std::string& note : grid.notes) out += "<p class=\"note\">" + inline_markup(note) + "</p>\n";
  return out;
}

}  // namespace brachium::pipelines::report
