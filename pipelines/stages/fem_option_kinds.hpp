#pragma once
/// Short ways to write the options of fem.solve, beside those of common.hpp. Without a range: any number.

#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {

/// Three numbers; optional.
OptionSpec vector_option(std::string key, std::string unit, std::string doc);
OptionSpec optional_flag(std::string key, std::string doc);
OptionSpec optional_texts(std::string key, std::string doc);
OptionSpec optional_choice(std::string key, std::vector<std::string> allowed, std::string doc);
OptionSpec required_text(std::string key, std::string doc);
OptionSpec required_choice(std::string key, std::vector<std::string> allowed, std::string doc);
OptionSpec required_number(std::string key, std::string unit, Bounds bounds, std::string doc);
/// One table, optional; a list of tables, empty by default; names with numbers, empty by default; a number of
/// cells.
OptionSpec table_option(std::string key, std::vector<OptionSpec> fields, std::string doc);
OptionSpec list_option(std::string key, std::vector<OptionSpec> fields, std::string doc);
OptionSpec map_option(std::string key, Bounds bounds, std::string doc);
OptionSpec cells_option(std::string key, std::int64_t fallback, std::string doc);

}  // namespace brachium::pipelines
