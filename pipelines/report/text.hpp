#pragma once
/// Text on its way into HTML and SVG: escaped, with code spans, links and typeset units; numbers as a reader
/// wants them.

#include <string>
#include <string_view>

namespace brachium::pipelines::report {

/// `text` for element content and attribute values: & < > " ' become references, control characters (which
/// neither HTML nor XML admits) and bytes that are not UTF-8 become U+FFFD.
std::string escape(std::string_view text);

/// Running text as HTML: escaped, `code` in backticks, doi:10... and https://... as links; a number and its
/// unit, "1.02 N m" or "30 %", stay on one line. What stands in backticks is left as it is.
std::string inline_markup(std::string_view text);

/// `text` with narrow no-break spaces between a number and a unit, and inside the unit. Not escaped.
std::string bind_units(std::string_view text);

/// Units as one sets them: "N m" with a narrow no-break space, "m/s^2" with a superscript, "uV" as µV, "deg"
/// as °. The unit 1 is left out. Only inside the brackets at the end of a label, "moment [N m]"; the rest is
/// left as it is. Not escaped.
std::string typeset_label(std::string_view label);

/// A unit alone, set as in typeset_label.
std::string typeset_unit(std::string_view unit);

/// `text` without the backticks of code spans, for places that admit no markup. Not escaped.
std::string plain_text(std::string_view text);

/// A name for links: lower case letters, digits and hyphens; never empty.
std::string make_anchor(std::string_view title);

/// A name in words, its unit (if the name ends in it, or in the one given) in brackets: "rmse_N_m" -> "RMSE
/// [N m]", "load_mass_kg" -> "load mass [kg]", "tendon_slack_length_factor" -> "tendon slack length factor".
std::string label_of_name(std::string_view name, std::string_view unit = "");

/// Underscores as spaces, the abbreviations of the field as they are written: "r2" -> "R²".
std::string in_words(std::string_view name);

}  // namespace brachium::pipelines::report
