#include "pipelines/report/html.hpp"

#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {

std::string render_html(const Document& document) {
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>";
  out += escape(document.title) + "</title>\n</head>\n<body>\n<h1>" + escape(document.title) + "</h1>\n<p>";
  out += inline_markup(document.verdict) + "</p>\n</body>\n</html>\n";
  return out;
}

}  // namespace brachium::pipelines::report
