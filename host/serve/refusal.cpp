#include "host/serve/refusal.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "host/program/process_values.hpp"
#include "host/serve/error_message.hpp"
#include "host/serve/page_texts.hpp"

namespace lamplock::serve {
namespace {

std::string filled(const std::string& text, const Refusal::Values& values) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find('{', at), end = text.find('}', begin);
    result += text.substr(at, begin - at);
    if (end == std::string::npos) break;
    result += values.at(text.substr(begin + 1, end - begin - 1));
    at = end + 1;
  }
  return result;
}

/// The parts of "WHERE: WHAT; REMEDY". They are divided before values are filled in.
Error error_of(Exit exit, const std::string& name, const Refusal::Values& values) {
  const std::string& text = english_texts().at("error." + name);
  const std::size_t what = text.find(": "), remedy = text.rfind("; ");
  return {exit, filled(text.substr(0, what), values),
          filled(text.substr(what + 2, remedy - what - 2), values),
          filled(text.substr(remedy + 2), values)};
}

}  // namespace

Refusal::Refusal(Exit exit, std::string name, Values values)
    : Error(error_of(exit, name, values)), name_(std::move(name)), values_(std::move(values)) {}

nlohmann::json error_json(const std::exception& error) {
  const bool lacks_material = dynamic_cast<const program_run::NoMaterial*>(&error) != nullptr;
  nlohmann::json json{{"code", lacks_material ? code::needs_material : code::refused},
                      {"message", message_of(error)}};
  if (const auto* const refusal = dynamic_cast<const Refusal*>(&error))
    json["data"] = {{"name", refusal->name()}, {"values", refusal->values()}};
  return json;
}

}  // namespace lamplock::serve
