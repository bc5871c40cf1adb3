#include "data/io/stage_file.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <nlohmann/json.hpp>

#include "data/io/hdf5_support.hpp"
#include "data/io/subject_file.hpp"
#include "data/model/error.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using hdf5::Handle;
using nlohmann::json;

// ---------------------------------------------------------------- findings as JSON

constexpr std::pair<Severity, const char*> severities[] = {
    {Severity::note, "note"}, {Severity::warning, "warning"}, {Severity::error, "error"}};

std::string to_json(const std::vector<Diagnostic>& diagnostics) {
  json list = json::array();
  for (const Diagnostic& d : diagnostics) {
    json item = {{"code", d.code}, {"message", d.message}, {"help", d.help}};
    for (const auto& [severity, name] : severities) {
      if (severity == d.severity) item["severity"] = name;
    }
    if (d.where) {
      item["where"] = {{"file", d.where->file},
                       {"line", d.where->line},
                       {"column", d.where->column},
                       {"length", d.where->length},
                       {"text", d.where->text}};
    }
    list.push_back(std::move(item));
  }
  return list.dump(1, ' ', false, json::error_handler_t::replace);
}

std::vector<Diagnostic> from_json(const std::string& text) {
  std::vector<Diagnostic> diagnostics;
  for (const json& item : json::parse(text)) {
    Diagnostic d;
    d.code = item.at("code").get<std::string>();
    d.message = item.at("message").get<std::string>();
    d.help = item.at("help").get<std::string>();
    for (const auto& [severity, name] : severities) {
      if (item.at("severity") == name) d.severity = severity;
    }
    if (item.contains("where")) {
      const json& w = item.at("where");
      d.where = data::SourceSpan{w.at("file").get<std::string>(), w.at("line").get<int>(),
                                 w.at("column").get<int>(), w.at("length").get<int>(),
                                 w.at("text").get<std::string>()};
    }
    diagnostics.push_back(std::move(d));
  }
  return diagnostics;
}

// ---------------------------------------------------------------- writing

struct ContentWriter {
  hid_t root;
  const std::filesystem::path& file;

  void need(bool done, const std::string& what) const {
    if (!done) hdf5::fail_write(root, file, what);
  }

  void texts(const char* name, const std::map<std::string, std::string>& values) const {
    const Handle group = hdf5::create_group(root, name);
    need(static_cast<bool>(group), name);
    for (const auto& [key, value] : values) need(hdf5::write_attribute(group.get(), key, value), name);
  }

  void column(hid_t group, const data::Column& column, hid_t row_scale) const {
    const std::string what = fmt::format("column `{}`", column.name);
    const hsize_t rows = std::visit([](const auto& v) { return v.size(); }, column.values);
    const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const auto* numbers = std::get_if<std::vector<double>>(&column.values);
    const Handle type = numbers ? Handle(H5Tcopy(H5T_IEEE_F64LE), H5Tclose) : hdf5::text_type();
    const Handle dataset(H5Dcreate2(group, column.name.c_str(), type.get(), space.get(), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
    need(static_cast<bool>(dataset), what);
    herr_t status = 0;
    if (numbers) {
      if (rows > 0)
        status = H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers->data());
      need(hdf5::write_attribute(dataset.get(), "units", column.unit) &&
               hdf5::write_attribute(dataset.get(), "unit", column.unit),
           what);
    } else {
      std::vector<const char*> pointers;
      for (const std::string& text : std::get<std::vector<std::string>>(column.values))
        pointers.push_back(text.c_str());
      if (rows > 0)
        status = H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                          static_cast<const void*>(pointers.data()));
    }
    need(status >= 0 && H5DSattach_scale(dataset.get(), row_scale, 0) >= 0, what);
  }

  void table(hid_t tables, const std::string& name, const data::Table& table) const {
    hdf5::check_name(name, "table");
    const Handle group = hdf5::create_group(tables, name.c_str());
    json order = json::array();
    for (const data::Column& c : table.columns) order.push_back(c.name);
    need(group && hdf5::write_attribute(group.get(), "title", table.title) &&
             hdf5::write_attribute(group.get(), "column_order",
                                   order.dump(-1, ' ', false, json::error_handler_t::replace)),
         fmt::format("table `{}`", name));
    // Rows are numbered from 1, as a dimension scale that all columns share.
    const hsize_t rows = table.rows();
    std::vector<long long> numbers(rows);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<long long>(i) + 1;
    const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const Handle scale(
        H5Dcreate2(group.get(), "row", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    need(scale &&
             (rows == 0 ||
              H5Dwrite(scale.get(), H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) >= 0) &&
             H5DSset_scale(scale.get(), "row") >= 0,
         fmt::format("table `{}`", name));
    for (const data::Column& c : table.columns) {
      hdf5::check_name(c.name, "column");
      if (c.name == "row")
        throw InputError("bad-name", "`row` cannot be the name of a column", "it names the row numbers");
      if (std::visit([](const auto& v) { return v.size(); }, c.values) != rows) {
        throw std::logic_error("StageFileWriter: columns of table `" + name + "` differ in length");
      }
      column(group.get(), c, scale.get());
    }
  }
};

// ---------------------------------------------------------------- reading

struct ContentReader {
  const std::filesystem::path& file;

  [[noreturn]] void damaged(const std::string& what) const {
    throw InputError("damaged-file", fmt::format("`{}`: {} cannot be read", file.string(), what),
                     "run the stage again");
  }

  std::map<std::string, std::string> texts(hid_t root, const char* name) const {
    std::map<std::string, std::string> values;
    const Handle group(H5Gopen2(root, name, H5P_DEFAULT), H5Gclose);
    if (!group) {
      throw InputError(
          "missing-group",
          fmt::format("`{}` has no group `{}`: it is not the output of a stage", file.string(), name),
          "a session file holds signals only");
    }
    for (const std::string& key : hdf5::attribute_names(group.get())) {
      auto value = hdf5::text_attribute(group.get(), key);
      if (!value) damaged(fmt::format("attribute `{}` of `{}`", key, name));
      values.emplace(key, std::move(*value));
    }
    return values;
  }

  std::string text(hid_t root, const char* name) const {
    const Handle dataset(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
    auto values = dataset ? hdf5::read_texts(dataset.get()) : std::nullopt;
    if (!values || values->size() != 1) damaged(fmt::format("`{}`", name));
    return std::move(values->front());
  }

  data::Column column(hid_t group, const std::string& table, const std::string& name) const {
    const Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(dataset ? H5Dget_type(dataset.get()) : -1, H5Tclose);
    const Handle space(dataset ? H5Dget_space(dataset.get()) : -1, H5Sclose);
    if (!dataset || !type || !space) damaged(fmt::format("column `{}` of table `{}`", name, table));
    data::Column column{name, hdf5::text_attribute(dataset.get(), "unit").value_or(""), {}};
    if (H5Tget_class(type.get()) == H5T_STRING) {
      auto texts = hdf5::read_texts(dataset.get());
      if (!texts) damaged(fmt::format("column `{}` of table `{}`", name, table));
      column.values = std::move(*texts);
    } else {
      std::vector<double> numbers(
          static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get()))));
      if (!numbers.empty() &&
          H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) < 0) {
        damaged(fmt::format("column `{}` of table `{}`", name, table));
      }
      column.values = std::move(numbers);
    }
    return column;
  }

  data::Table table(hid_t tables, const std::string& name) const {
    const Handle group(H5Gopen2(tables, name.c_str(), H5P_DEFAULT), H5Gclose);
    const auto order = group ? hdf5::text_attribute(group.get(), "column_order") : std::nullopt;
    if (!order) damaged(fmt::format("table `{}`", name));
    data::Table table{hdf5::text_attribute(group.get(), "title").value_or(""), {}};
    for (const json& item : json::parse(*order))
      table.columns.push_back(column(group.get(), name, item.get<std::string>()));
    return table;
  }

  StageFileContent content() const {
    const Handle handle = hdf5::open_for_reading(file);
    const hid_t root = handle.get();
    StageFileContent content;
    content.attributes = texts(root, "attributes");
    content.fingerprint = texts(root, "fingerprint");
    try {
      content.diagnostics = from_json(text(root, "diagnostics"));
      const Handle tables(H5Gopen2(root, "tables", H5P_DEFAULT), H5Gclose);
      if (!tables) damaged("`tables`");
      for (const std::string& name : hdf5::children(tables.get(), H5O_TYPE_GROUP))
        content.tables[name] = table(tables.get(), name);
    } catch (const json::exception&) {
      damaged("its findings or tables");
    }
    if (H5Lexists(root, "subject", H5P_DEFAULT) > 0) {
      content.subject = parse_subject(text(root, "subject"), fmt::format("{} (subject)", file.string()));
    }
    return content;
  }
};

}  // namespace

void StageFileWriter::finish(const StageFileContent& content) {
  {
    const hdf5::Lock lock;
    const auto root = static_cast<hid_t>(hdf5_id());
    const ContentWriter write{root, target()};
    write.texts("attributes", content.attributes);
    write.texts("fingerprint", content.fingerprint);
    write.need(hdf5::write_text(root, "diagnostics", to_json(content.diagnostics)), "the findings");
    if (content.subject)
      write.need(hdf5::write_text(root, "subject", subject_to_toml(*content.subject)), "the subject");
    const Handle tables = hdf5::create_group(root, "tables");
    write.need(static_cast<bool>(tables), "tables");
    for (const auto& [name, table] : content.tables) write.table(tables.get(), name, table);
  }
  commit();
}

StageFileContent read_stage_content(const std::filesystem::path& file) {
  const hdf5::Lock lock;
  return ContentReader{file}.content();
}

std::optional<std::map<std::string, std::string>> read_fingerprint(
    const std::filesystem::path& file) noexcept {
  try {
    const hdf5::Lock lock;
    const Handle handle = hdf5::open_for_reading(file);
    return ContentReader{file}.texts(handle.get(), "fingerprint");
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace brachium::io
