#include "pipelines/report/chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipelines/report/chain_layout.hpp"
#include "pipelines/report/legend.hpp"
#include "pipelines/report/marks.hpp"
#include "pipelines/report/number.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr int kLayersAcross = 5;  // more do not fit beside each other
constexpr double kBoxHeight = 64.0;
constexpr double kInputHeight = 34.0;
constexpr double kMargin = 6.0;
constexpr double kArrow = 7.0;
constexpr double kLeastScale = 0.8;  // on narrow screens the picture scrolls rather than shrink further

struct At {
  double x, y;
};

/// Symbol and word for a status: never the colour alone.
std::string status_text(const ChainNode& node) {
  if (node.status == "done") return "✓ " + duration(node.seconds);
  if (node.status == "reused") return "↺ reused";
  if (node.status == "failed") return "✗ failed after " + duration(node.seconds);
  if (node.status == "skipped") return "– skipped";
  return node.status;
}

std::string status_class(const ChainNode& node) {
  if (node.tone != Tone::plain) return tone_class(node.tone);
  if (node.status == "failed") return "bad";
  if (node.status == "done") return "good";
  return "plain";
}

class ChainPicture {
 public:
  explicit ChainPicture(const std::vector<ChainNode>& nodes) : layout_(layout_chain(nodes)) {
    across_ = layout_.layers <= kLayersAcross;
    for (const ChainBox& box : layout_.boxes) {
      double widest = text_width(box.name, 14.0);
      if (box.node) {
        widest =
            std::max({widest, text_width(box.node->run, 12.0), text_width(status_text(*box.node), 12.0)});
      }
      box_width_ = std::max(box_width_, widest + 26.0);
    }
    box_width_ = std::ceil(box_width_);
  }

  std::string draw() const {
    const At size = extent();
    std::string out = fmt::format(
        "<div class=\"scroll\" tabindex=\"0\"><svg class=\"chain\" role=\"img\" viewBox=\"0 0 {0} {1}\" "
        "width=\"{0}\" "
        "height=\"{1}\" "
        "style=\"--w:{2}px\"><title>The chain of stages</title><desc>{3}</desc>",
        pixels(size.x), pixels(size.y), pixels(kLeastScale * size.x), escape(description()));
    for (const ChainEdge& edge : layout_.edges) out += arrow(edge);
    for (const ChainBox& box : layout_.boxes) out += draw_box(box);
    return out + "</svg></div>\n";
  }

 private:
  double along_pitch() const { return across_ ? box_width_ + 46.0 : kBoxHeight + 40.0; }
  double across_pitch() const { return across_ ? kBoxHeight + 22.0 : box_width_ + 26.0; }

  At extent() const {
    const double along = (layout_.layers - 1) * along_pitch() + (across_ ? box_width_ : kBoxHeight);
    const double crosswise = layout_.extent * across_pitch() + (across_ ? kBoxHeight : box_width_);
    return across_ ? At{along + 2 * kMargin, crosswise + 2 * kMargin}
                   : At{crosswise + 2 * kMargin, along + 2 * kMargin};
  }

  At centre(double position, int layer) const {
    const double along = layer * along_pitch();
    const double crosswise = position * across_pitch();
    return {kMargin + box_width_ / 2.0 + (across_ ? along : crosswise),
            kMargin + kBoxHeight / 2.0 + (across_ ? crosswise : along)};
  }

  static double height_of(const ChainBox& box) { return box.node ? kBoxHeight : kInputHeight; }

  std::string arrow(const ChainEdge& edge) const {
    const ChainBox& from = layout_.boxes[edge.from];
    const ChainBox& to = layout_.boxes[edge.to];
    const double half = (across_ ? box_width_ : kBoxHeight) / 2.0;
    const double half_from = across_ ? half : height_of(from) / 2.0;
    const double half_to = (across_ ? half : height_of(to) / 2.0) + kArrow;
    const auto point = [&](std::size_t k, double shift) {
      At at = centre(edge.positions[k], from.layer + static_cast<int>(k));
      (across_ ? at.x : at.y) += shift;
      return at;
    };
    // Curves stand in the gaps between layers only; beside boxes the arrow runs straight.
    const std::size_t last = edge.positions.size() - 1;
    At pen = point(0, half_from);
    std::string d = "M" + pixels(pen.x) + " " + pixels(pen.y);
    for (std::size_t k = 1; k <= last; ++k) {
      const At b = point(k, k == last ? -half_to : -half);
      const At c1 = across_ ? At{(pen.x + b.x) / 2.0, pen.y} : At{pen.x, (pen.y + b.y) / 2.0};
      const At c2 = across_ ? At{(pen.x + b.x) / 2.0, b.y} : At{b.x, (pen.y + b.y) / 2.0};
      d += "C" + pixels(c1.x) + " " + pixels(c1.y) + " " + pixels(c2.x) + " " + pixels(c2.y) + " " +
           pixels(b.x) + " " + pixels(b.y);
      pen = b;
      if (k < last) {
        pen = point(k, half);
        d += "L" + pixels(pen.x) + " " + pixels(pen.y);
      }
    }
    const At tip = pen;
    const std::string head = across_ ? "M" + pixels(tip.x) + " " + pixels(tip.y - 4.5) + "l" +
                                           pixels(kArrow) + " 4.5l" + pixels(-kArrow) + " 4.5z"
                                     : "M" + pixels(tip.x - 4.5) + " " + pixels(tip.y) + "l4.5 " +
                                           pixels(kArrow) + "l4.5 " + pixels(-kArrow) + "z";
    return "<path class=\"edge\" d=\"" + d + "\"/><path class=\"head\" d=\"" + head + "\"/>";
  }

  std::string draw_box(const ChainBox& box) const {
    const At at = centre(box.position, box.layer);
    const double height = height_of(box);
    const std::string tone = box.node ? status_class(*box.node) : "input";
    const std::string dim = box.node && (box.node->status == "skipped") ? " dim" : "";
    std::string out =
        fmt::format("<g class=\"box {}{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\"/>",
                    tone, dim, pixels(at.x - box_width_ / 2.0), pixels(at.y - height / 2.0),
                    pixels(box_width_), pixels(height), box.node ? "8" : "17");
    const auto text = [&](const char* kind, double dy, const std::string& content) {
      out += fmt::format("<text class=\"{}\" text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>", kind,
                         pixels(at.x), pixels(at.y + dy), escape(content));
    };
    if (box.node) {
      text("name", -12.0, box.name);
      text("run", 5.0, box.node->run);
      text("status", 22.0, status_text(*box.node));
    } else {
      text("run", 4.5, box.name);
    }
    return out + "</g>";
  }

  std::string description() const {
    std::string out;
    for (const ChainBox& box : layout_.boxes) {
      if (!box.node) continue;
      out += box.name + " (" + box.node->run + ", " + box.node->status;
      if (box.node->status == "done") out += ", " + duration(box.node->seconds);
      out += ")";
      for (std::size_t k = 0; k < box.node->from.size(); ++k)
        out += (k == 0 ? " reads " : ", ") + box.node->from[k];
      out += ". ";
    }
    return out;
  }

  ChainLayout layout_;
  bool across_ = true;
  double box_width_ = 120.0;
};

}  // namespace

std::string draw_chain(const std::vector<ChainNode>& nodes) {
  return nodes.empty() ? std::string() : ChainPicture(nodes).draw();
}

}  // namespace brachium::pipelines::report
