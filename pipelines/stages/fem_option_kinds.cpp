#include "pipelines/stages/fem_option_kinds.hpp"

namespace brachium::pipelines {

OptionSpec vector_option(std::string key, std::string unit, std::string doc) {
  OptionSpec spec;
  spec.key = std::move(key);
  spec.type = OptionType::numbers;
  spec.unit = std::move(unit);
  spec.doc = std::move(doc);
  spec.optional = true;
  spec.length = 3;
  return spec;
}

OptionSpec optional_flag(std::string key, std::string doc) {
  OptionSpec spec = flag_option(std::move(key), false, std::move(doc));
  spec.fallback.reset();
  spec.optional = true;
  return spec;
}

OptionSpec optional_texts(std::string key, std::string doc) {
  OptionSpec spec = texts_option(std::move(key), {}, std::move(doc));
  spec.fallback.reset();
  spec.optional = true;
  return spec;
}

OptionSpec optional_choice(std::string key, std::vector<std::string> allowed, std::string doc) {
  OptionSpec spec = optional_text(std::move(key), std::move(doc));
  spec.allowed = std::move(allowed);
  return spec;
}

OptionSpec required_text(std::string key, std::string doc) {
  OptionSpec spec = optional_text(std::move(key), std::move(doc));
  spec.optional = false;
  return spec;
}

OptionSpec required_choice(std::string key, std::vector<std::string> allowed, std::string doc) {
  OptionSpec spec = required_text(std::move(key), std::move(doc));
  spec.allowed = std::move(allowed);
  return spec;
}

OptionSpec required_number(std::string key, std::string unit, Bounds bounds, std::string doc) {
  OptionSpec spec = optional_number(std::move(key), std::move(unit), bounds, std::move(doc));
  spec.optional = false;
  return spec;
}

OptionSpec table_option(std::string key, std::vector<OptionSpec> fields, std::string doc) {
  OptionSpec spec;
  spec.key = std::move(key);
  spec.type = OptionType::table;
  spec.fields = std::move(fields);
  spec.doc = std::move(doc);
  spec.optional = true;
  return spec;
}

OptionSpec list_option(std::string key, std::vector<OptionSpec> fields, std::string doc) {
  OptionSpec spec = table_option(std::move(key), std::move(fields), std::move(doc));
  spec.type = OptionType::tables;
  spec.optional = false;
  spec.fallback = std::vector<Options>{};
  return spec;
}

OptionSpec map_option(std::string key, Bounds bounds, std::string doc) {
  OptionSpec spec;
  spec.key = std::move(key);
  spec.type = OptionType::number_map;
  spec.doc = std::move(doc);
  spec.lower = bounds.lower;
  spec.upper = bounds.upper;
  spec.lower_open = bounds.lower_open;
  spec.upper_open = bounds.upper_open;
  spec.fallback = std::map<std::string, double>{};
  return spec;
}

OptionSpec cells_option(std::string key, std::int64_t fallback, std::string doc) {
  return integer_option(std::move(key), fallback, between(1, 10000), std::move(doc));
}

}  // namespace brachium::pipelines
