#pragma once
/// How the page looks, and the little it can do beyond being read.

#include <string_view>

namespace brachium::pipelines::report {

/// The style sheet. Curve colours are those of Okabe & Ito 2008 (Color universal design,
/// jfly.uni-koeln.de/color), darkened for white paper and lightened for a dark screen until each stands out
/// from its ground by at least 3 : 1 (WCAG 2.2, success criterion 1.4.11); text colours reach 4.5 : 1
/// (1.4.3).
std::string_view style_sheet();

/// Script for comfort only: opens folded parts before printing and when a link leads into them, reads values
/// off a plot.
std::string_view page_script();

}  // namespace brachium::pipelines::report
