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
