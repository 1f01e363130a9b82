#include "host/material/record_file.hpp"

#include <fmt/format.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "host/file.hpp"
#include "host/material/fields.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::material {
namespace {

/// Sets a field from a value of the file.
class NodeReader {
 public:
  NodeReader(const Field& field, const toml::node& node, const std::string& where)
      : field_(field), node_(node), where_(where) {}

  void operator()(double* value) const { *value = number(); }
  void operator()(std::optional<double>* value) const { *value = number(); }
  void operator()(int* value) const {
    const auto whole = node_.is_integer() ? node_.value<int>() : std::nullopt;
    if (!whole) refuse_kind("must be a whole number", "write digits only");
    *value = *whole;
  }
  void operator()(bool* value) const {
    const auto* flag = node_.as_boolean();
    if (flag == nullptr) refuse_kind("must be true or false", "write one of them, without quotes");
    *value = flag->get();
  }
  void operator()(std::string* value) const {
    const auto* text = node_.as_string();
    if (text == nullptr) refuse_kind("must be a text", "write it in quotes");
    *value = text->get();
  }

 private:
  [[noreturn]] void refuse_kind(const std::string& what, const std::string& remedy) const {
    refuse(where_, fmt::format("'{}' {}", field_.key, what), remedy);
  }
  double number() const {
    const auto value = node_.value<double>();
    if (!value || !node_.is_number()) refuse_kind("must be a number", "write it without quotes");
    return *value;
  }

  const Field& field_;
  const toml::node& node_;
  const std::string& where_;
};

template <class Record>
Record read_record(const toml::table& table, const std::filesystem::path& file) {
  Record record;
  const std::vector<Field> known = fields(record);
  for (const auto& [key, node] : table) {
    const std::string where = toml_location(file, key.source());
    std::visit(NodeReader(field_named(known, key.str(), where), node, where),
               field_named(known, key.str(), where).place);
  }
  check_record(record, toml_location(file, table.source()));
  return record;
}

template <class Record>
std::vector<Record> read_tables(const toml::node& node, const std::filesystem::path& file) {
  const toml::array* list = node.as_array();
  if (list == nullptr || !list->is_array_of_tables())
    refuse(toml_location(file, node.source()),
           fmt::format("'{}' must be a list of tables", kind_of<Record>()),
           fmt::format("write [[{}]]", kind_of<Record>()));
  std::vector<Record> records;
  for (const toml::node& one : *list) records.push_back(read_record<Record>(*one.as_table(), file));
  return records;
}

/// Names are keys. The line of the second one is found by its place in the list.
template <class Record>
void check_distinct_names(const std::vector<Record>& records, const toml::node& node,
                          const std::filesystem::path& file) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (!names.insert(records[i].name).second)
      refuse(toml_location(file, node.as_array()->get(i)->source()),
             fmt::format("'name' is '{}', as of another {}", records[i].name, kind_of<Record>()),
             "give each record a name of its own");
}

std::string quoted(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

/// The fields that differ from those of an empty record, and the required ones.
template <class Record>
std::string table_text(Record record) {
  Record untouched;
  const std::vector<Field> said = fields(record), by_default = fields(untouched);
  std::string text = fmt::format("\n[[{}]]\n", kind_of<Record>());
  for (std::size_t i = 0; i < said.size(); ++i) {
    const std::string value = value_text(said[i]);
    if (is_absent(said[i]) || (!said[i].is_required && value == value_text(by_default[i])))
      continue;
    const bool is_text = std::holds_alternative<std::string*>(said[i].place);
    text += fmt::format("{} = {}\n", said[i].key, is_text ? quoted(value) : value);
  }
  return text;
}

template <class Record>
std::string tables_text(const std::vector<Record>& records) {
  std::string text;
  for (const Record& record : records) text += table_text(record);
  return text;
}

}  // namespace

Records parse_records(std::string_view text, const std::filesystem::path& file) {
  const toml::table root = parse_toml(text, file);
  Records records;
  for (const auto& [key, node] : root) {
    if (key == kind_of<Laser>()) {
      records.lasers = read_tables<Laser>(node, file);
      check_distinct_names(records.lasers, node, file);
    } else if (key == kind_of<Material>()) {
      records.materials = read_tables<Material>(node, file);
      check_distinct_names(records.materials, node, file);
    } else if (key == kind_of<Setting>()) {
      records.settings = read_tables<Setting>(node, file);
    } else if (key == kind_of<Measurement>()) {
      records.measurements = read_tables<Measurement>(node, file);
    } else {
      refuse(toml_location(file, key.source()), fmt::format("unknown table '{}'", key.str()),
             did_you_mean(key.str(),
                          {kind_of<Laser>(), kind_of<Material>(), kind_of<Setting>(),
                           kind_of<Measurement>()},
                          "use [[laser]], [[material]], [[setting]] and [[measurement]]"));
    }
  }
  if (root.empty())
    refuse(file, "it has no record", "write [[laser]], [[material]], [[setting]], [[measurement]]");
  return records;
}

Records read_records(const std::filesystem::path& file) {
  return parse_records(read_text_file(file), file);
}

std::string to_toml(const Records& records) {
  return "# Records of the material library: lamplock material import THIS\n" +
         tables_text(records.lasers) + tables_text(records.materials) +
         tables_text(records.settings) + tables_text(records.measurements);
}

}  // namespace lamplock::material
