// The methods of the server as one table: parameters with types and ranges, and who may call them.
//
// In:  the name and the parameters of a request. Out: whether they may be used; the table of
//      docs/api.md, which a test compares with this one.
// Who: the server, before it calls a method.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

namespace lamplock::serve {

enum class Type : std::uint8_t { text, number, whole, flag, numbers, place, object, objects };

struct Parameter {
  const char* name;
  Type type;
  bool is_required;
  double min = 0, max = 0;        ///< of numbers; of texts the length; of lists each number
  const char* choices = nullptr;  ///< of texts: "more|less|full"
  const char* about = "";
};

/// Who may call a method.
enum class Right : std::uint8_t {
  all,      ///< every client with the token
  control,  ///< the client that holds control
  firing    ///< the same, and on a real board it must have been paired at the machine
};

struct Method {
  const char* name;
  Right right;
  std::span<const Parameter> parameters;
  const char* about;
  const char* result;
};

std::span<const Method> methods();
/// Null if there is none.
const Method* find_method(std::string_view name);

/// Empty, or what is wrong with the parameters: "feed: must be a number of 1 to 1000000".
std::string refusal_of(const Method& method, const nlohmann::json& parameters);

/// Text of the table, Markdown.
std::string methods_table();

}  // namespace lamplock::serve
