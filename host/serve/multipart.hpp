// The body of a form with files (multipart/form-data, RFC 7578).
//
// In:  a body with its Content-Type. Out: its parts. Who: uploads of slicers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::serve {

struct FormPart {
  std::string name, file_name{};  ///< file_name: empty for a plain field
  std::string_view content{};     ///< in the body
};

/// Throws Error(bad_input) for a body that has not this form, or more than 20 parts.
std::vector<FormPart> parse_form(std::string_view content_type, std::string_view body);

}  // namespace lamplock::serve
