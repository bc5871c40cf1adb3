#pragma once
/// A document as one self-contained HTML file: styles, SVG pictures and the few lines of script are inside
/// it, nothing is fetched, so that it can be mailed, opened offline and printed. Light and dark follow the
/// reader's system.

#include <string>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// UTF-8 text of the page. The same document gives the same bytes, on every machine and thread count.
/// Throws std::logic_error where the document contradicts itself: x and y of a series differ in length, a row
/// has more cells than its header, a panel has panels of its own.
std::string render_html(const Document& document);

}  // namespace brachium::pipelines::report
