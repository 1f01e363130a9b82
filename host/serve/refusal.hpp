// A refusal of the server that a page can show in its own language.
//
// In:  its name in the table of texts, without "error.", and the values in braces. Out: the error
//      with the English text; name and values for clients (docs/api.md).
// Who: the classes of this folder. Errors of files and of the board have no names.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/error.hpp"

namespace lamplock::serve {

/// Codes of JSON-RPC 2.0, section 5.1. Those from -32099 to -32000 are of the server: docs/api.md.
namespace code {
inline constexpr int parse = -32700, request = -32600, method = -32601, parameters = -32602;
inline constexpr int refused = -32000, needs_password = -32001, needs_material = -32002;
}  // namespace code

/// A request that the server cannot fulfil, with a text that pages can translate.
class Refusal : public Error {
 public:
  using Values = std::map<std::string, std::string>;

  /// `name`: in page/texts.json without "error."; `values`: one for each name in braces of its
  /// text. Throws std::out_of_range for another name or a missing value, which is a fault of the
  /// program.
  Refusal(Exit exit, std::string name, Values values = {});
  const std::string& name() const { return name_; }
  const Values& values() const { return values_; }

 private:
  std::string name_;
  Values values_;
};

/// Member `error` of a response of JSON-RPC: `code`, `message`, and of a refusal `data` with its
/// `name` and `values`.
nlohmann::json error_json(const std::exception& error);

}  // namespace lamplock::serve
