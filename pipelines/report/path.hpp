#pragma once
/// The `d` attribute of an SVG path, written as short as tenths of a pixel allow: relative moves, no needless
/// zeros.

#include <string>

namespace brachium::pipelines::report {

/// Positions are rounded, not steps, so that rounding never adds up.
class PathWriter {
 public:
  void move_to(double x, double y);  ///< [px]
  void line_to(double x, double y);  ///< [px]; a step of less than a tenth is left out
  void dot(double x, double y);      ///< [px] a line of no length: a round dot under stroke-linecap: round
  void close();
  const std::string& text() const { return text_; }
  bool empty() const { return text_.empty(); }

 private:
  void number(long tenth);

  std::string text_;
  char command_ = 0;
  long x_ = 0, y_ = 0;  // [px / 10] where the pen is
};

}  // namespace brachium::pipelines::report
