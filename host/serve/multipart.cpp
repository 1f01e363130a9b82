#include "host/serve/multipart.hpp"

#include <cstddef>

#include "host/error.hpp"

namespace lamplock::serve {
namespace {

constexpr std::size_t max_parts = 20, max_boundary = 70;  // the second by RFC 2046
constexpr std::string_view line_end = "\r\n";

[[noreturn]] void refuse(const char* why) {
  throw Error(Exit::bad_input, "form", why, "send multipart/form-data (RFC 7578)");
}

/// The value of a parameter of a header, with or without quotes; empty if there is none.
std::string parameter(std::string_view header, std::string_view name) {
  const std::string wanted = " " + std::string(name) + "=";
  std::size_t at = header.find(wanted);
  if (at == std::string_view::npos) return "";
  at += wanted.size();
  const bool is_quoted = at < header.size() && header[at] == '"';
  if (is_quoted) ++at;
  const std::size_t end = header.find_first_of(is_quoted ? "\"" : "; \r", at);
  return std::string(header.substr(at, end == std::string_view::npos ? end : end - at));
}

FormPart part_of(std::string_view text) {
  const std::size_t head_end = text.find("\r\n\r\n");
  if (head_end == std::string_view::npos) refuse("a part has no end of its header");
  const std::string_view head = text.substr(0, head_end);
  return {parameter(head, "name"), parameter(head, "filename"), text.substr(head_end + 4)};
}

}  // namespace

std::vector<FormPart> parse_form(std::string_view content_type, std::string_view body) {
  const std::string boundary = parameter(content_type, "boundary");
  if (boundary.empty() || boundary.size() > max_boundary) refuse("the header has no boundary");
  const std::string mark = "--" + boundary;
  if (!body.starts_with(mark)) refuse("the body does not begin with its boundary");
  body.remove_prefix(mark.size());
  std::vector<FormPart> parts;
  while (body.starts_with(line_end)) {
    body.remove_prefix(line_end.size());
    const std::size_t end = body.find(std::string(line_end) + mark);
    if (end == std::string_view::npos) refuse("the body has no end");
    if (parts.size() == max_parts) refuse("the body has too many parts");
    parts.push_back(part_of(body.substr(0, end)));
    body.remove_prefix(end + line_end.size() + mark.size());
  }
  if (!body.starts_with("--")) refuse("the body has no end");
  return parts;
}

}  // namespace lamplock::serve
