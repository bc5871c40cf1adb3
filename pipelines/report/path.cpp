#include "pipelines/report/path.hpp"

#include <cmath>

#include "pipelines/report/number.hpp"

namespace brachium::pipelines::report {

void PathWriter::number(long tenth) {
  const std::string digits = tenths(tenth);
  // A minus sign separates as well as a space does.
  const bool after_command = !text_.empty() && text_.back() >= 'A';
  if (!after_command && digits.front() != '-') text_ += ' ';
  text_ += digits;
}

void PathWriter::move_to(double x, double y) {
  x_ = std::lround(10.0 * x);
  y_ = std::lround(10.0 * y);
  text_ += 'M';
  command_ = 'M';
  number(x_);
  number(y_);
}

void PathWriter::line_to(double x, double y) {
  const long next_x = std::lround(10.0 * x);
  const long next_y = std::lround(10.0 * y);
  if (next_x == x_ && next_y == y_) return;
  if (command_ != 'l') text_ += command_ = 'l';
  number(next_x - x_);
  number(next_y - y_);
  x_ = next_x;
  y_ = next_y;
}

void PathWriter::dot(double x, double y) {
  move_to(x, y);
  text_ += "h0";
  command_ = 'h';
}

void PathWriter::close() {
  text_ += 'z';
  command_ = 'z';
}

}  // namespace brachium::pipelines::report
