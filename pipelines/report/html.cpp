#include "pipelines/report/html.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "pipelines/report/chain.hpp"
#include "pipelines/report/grid.hpp"
#include "pipelines/report/legend.hpp"
#include "pipelines/report/number.hpp"
#include "pipelines/report/plot.hpp"
#include "pipelines/report/style.hpp"
#include "pipelines/report/text.hpp"
#include "pipelines/report/view3d.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr double kPageWidth = 1052.0;  // [px] of the text, see style.cpp
constexpr double kColumnGap = 26.0;
constexpr std::size_t kFewNotes = 6;  // more are folded away

/// Lines that a reader opens when the finding's own sentence is not enough.
std::string folded(const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string out = "<details class=\"more\"><summary>one by one</summary><ul>";
  for (const std::string& line : lines) out += "<li>" + inline_markup(line) + "</li>";
  return out + "</ul></details>";
}

/// Writes one page; anchors are unique within it.
class Page {
 public:
  std::string render(const Document& document);

 private:
  std::string unique_anchor(const std::string& wanted);
  void heading(int level, const std::string& title, const std::string& anchor);
  void head(const Document& document);
  void findings(const std::vector<Paragraph>& findings);
  void contents(const Document& document, const std::vector<std::string>& anchors);
  void end_matter(const Document& document);
  void section(const Section& section, const std::string& anchor, int level);
  void block(const Paragraph& paragraph, int level);
  void block(const Grid& grid, int level);
  void block(const PlotRow& row, int level);
  void block(const View3d& view, int level);
  void block(const Details& details, int level);

  std::string out_;
  bool has_view_ = false;
  std::set<std::string> anchors_ = {"findings", "chain", "contents", "methods", "provenance", "probe"};
};

std::string Page::unique_anchor(const std::string& wanted) {
  std::string base = wanted;
  for (char& c : base) {
    if (static_cast<unsigned char>(c) <= ' ') c = '-';  // an id has no white space
  }
  std::string anchor = base;
  for (int k = 2; !anchors_.insert(anchor).second; ++k) anchor = base + "-" + std::to_string(k);
  return anchor;
}

void Page::heading(int level, const std::string& title, const std::string& anchor) {
  const std::string tag = "h" + std::to_string(std::min(level, 6));
  out_ += "<" + tag + " id=\"" + escape(anchor) + "\">" + inline_markup(title) + "</" + tag + ">\n";
}

void Page::head(const Document& document) {
  out_ +=
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";
  out_ += escape(plain_text(document.title));
  out_ += "</title>\n<style>";
  out_ += style_sheet();
  out_ += "</style>\n</head>\n<body>\n<header>\n<h1>" + inline_markup(document.title) + "</h1>\n";
  if (!document.subtitle.empty())
    out_ += "<p class=\"subtitle\">" + inline_markup(document.subtitle) + "</p>\n";
  if (!document.verdict.empty()) {
    out_ += "<p class=\"verdict " + tone_class(document.verdict_tone) + "\">" +
            inline_markup(document.verdict) + "</p>\n";
  }
  out_ += "</header>\n<main>\n";
}

void Page::findings(const std::vector<Paragraph>& findings) {
  out_ += "<section>\n";
  heading(2, "Findings", "findings");
  const auto list = [&](Tone tone, const char* word) {
    std::string items;
    std::size_t count = 0;
    for (const Paragraph& finding : findings) {
      if (finding.tone != tone) continue;
      ++count;
      items += "<li class=\"" + tone_class(tone) + "\"><b>" + word + "</b><span>" +
               inline_markup(finding.text) + folded(finding.details) + "</span></li>\n";
    }
    if (count == 0) return count;
    const bool fold = count > kFewNotes && (tone == Tone::plain || tone == Tone::good);
    if (fold) out_ += "<details><summary>" + std::to_string(count) + " notes</summary>\n";
    out_ += "<ul class=\"findings\">\n" + items + "</ul>\n";
    if (fold) out_ += "</details>\n";
    return count;
  };
  const std::size_t grave = list(Tone::bad, "✗ Error") + list(Tone::warning, "! Warning");
  if (grave == 0) out_ += "<p class=\"none\">No errors and no warnings.</p>\n";
  list(Tone::good, "✓ Good");
  list(Tone::plain, "Note");
  out_ += "</section>\n";
}

void Page::contents(const Document& document, const std::vector<std::string>& anchors) {
  out_ += "<nav aria-labelledby=\"contents\">\n";
  heading(2, "Contents", "contents");
  out_ += "<ol>\n";
  const auto entry = [&](const std::string& anchor, const std::string& title) {
    out_ += "<li><a href=\"#" + escape(anchor) + "\">" + escape(plain_text(title)) + "</a></li>\n";
  };
  for (std::size_t k = 0; k < anchors.size(); ++k) entry(anchors[k], document.sections[k].title);
  if (!document.methods.empty()) entry("methods", "Methods");
  if (!document.provenance.empty()) entry("provenance", "Provenance");
  out_ += "</ol>\n</nav>\n";
}

void Page::end_matter(const Document& document) {
  if (!document.methods.empty()) {
    out_ += "<section class=\"methods\">\n";
    heading(2, "Methods", "methods");
    for (const std::string& text : document.methods) out_ += "<p>" + inline_markup(text) + "</p>\n";
    out_ += "</section>\n";
  }
  if (!document.provenance.empty()) {
    out_ += "<section>\n";
    heading(2, "Provenance", "provenance");
    out_ += "<div class=\"scroll\" tabindex=\"0\"><table class=\"prov\"><tbody>\n";
    for (const auto& [label, value] : document.provenance) {
      out_ += "<tr><th scope=\"row\">" + escape(label) + "</th><td>" + inline_markup(value) + "</td></tr>\n";
    }
    out_ += "</tbody></table></div></section>\n";
  }
  out_ += "</main>\n<script>";
  out_ += page_script();
  if (has_view_) out_ += view3d_script();
  out_ += "</script>\n</body>\n</html>\n";
}

void Page::section(const Section& section, const std::string& anchor, int level) {
  out_ += "<section>\n";
  if (!section.title.empty()) heading(level, section.title, anchor);
  for (const Block& part : section.blocks) {
    std::visit([&](const auto& value) { block(value, level); }, part);
  }
  out_ += "</section>\n";
}

void Page::block(const Paragraph& paragraph, int) {
  const std::string tone =
      paragraph.tone == Tone::plain ? "" : " class=\"" + tone_class(paragraph.tone) + "\"";
  out_ += "<p" + tone + ">" + inline_markup(paragraph.text) + "</p>\n";
}

void Page::block(const Grid& grid, int) {
  out_ += draw_grid(grid);
}

void Page::block(const PlotRow& row, int) {
  if (row.plots.empty()) return;
  const std::size_t n = row.plots.size();
  const double automatic = n == 1 ? kPageWidth : n == 2 || n == 4 ? 400.0 : 300.0;
  const double least = std::clamp(row.min_width_px > 0.0 ? row.min_width_px : automatic, 120.0, kPageWidth);
  const double columns = std::min(
      static_cast<double>(n), std::max(1.0, std::floor((kPageWidth + kColumnGap) / (least + kColumnGap))));
  PlotFrame frame{.width_px = (kPageWidth - (columns - 1.0) * kColumnGap) / columns};
  for (const Plot& plot : row.plots) frame.left_px = std::max(frame.left_px, left_padding(plot));
  const std::string legend = draw_legend(row.plots.front());
  const bool common = n > 1 && !legend.empty() &&
                      std::all_of(row.plots.begin(), row.plots.end(),
                                  [&](const Plot& plot) { return draw_legend(plot) == legend; });
  frame.legend = !common;
  out_ += "<div class=\"row\" style=\"--w:" + (n == 1 ? "100%" : pixels(least) + "px") + "\">\n";
  if (common) out_ += "<div class=\"rowlegend\">" + legend + "</div>\n";
  for (const Plot& plot : row.plots) out_ += draw_plot(plot, frame);
  out_ += "</div>\n";
}

void Page::block(const View3d& view, int) {
  has_view_ = true;
  out_ += draw_view3d(view);
}

void Page::block(const Details& details, int level) {
  out_ += "<details><summary>" + inline_markup(details.summary) + "</summary>\n";
  for (const Section& inner : details.content) {
    section(inner, unique_anchor(inner.anchor.empty() ? make_anchor(inner.title) : inner.anchor), level + 1);
  }
  out_ += "</details>\n";
}

std::string Page::render(const Document& document) {
  head(document);
  findings(document.findings);
  if (!document.chain.empty()) {
    out_ += "<section>\n";
    heading(2, "The chain", "chain");
    out_ += draw_chain(document.chain) + "</section>\n";
  }
  std::vector<std::string> anchors;
  for (const Section& part : document.sections) {
    anchors.push_back(unique_anchor(part.anchor.empty() ? make_anchor(part.title) : part.anchor));
  }
  contents(document, anchors);
  for (std::size_t k = 0; k < anchors.size(); ++k) section(document.sections[k], anchors[k], 2);
  end_matter(document);
  return std::move(out_);
}

}  // namespace

std::string render_html(const Document& document) {
  return Page().render(document);
}

}  // namespace brachium::pipelines::report
