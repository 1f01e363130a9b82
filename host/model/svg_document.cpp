#include "host/model/svg_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "host/model/gzip.hpp"
#include "host/model/svg_namespaces.hpp"
#include "host/model/svg_style.hpp"
#include "host/model/xml_entities.hpp"
#include "host/model/xml_text.hpp"
#include "host/printable.hpp"
#include "host/text.hpp"

namespace lamplock::model {

using pugi::xml_node;

namespace {

/// "%20" as the byte of that code, in the fragment of an address.
std::string without_percent_codes(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    constexpr int hexadecimal = 16;
    const std::string_view code = text[i] == '%' ? text.substr(i + 1, 2) : std::string_view{};
    const auto [end, failure] =
        std::from_chars(code.data(), code.data() + code.size(), byte, hexadecimal);
    const bool is_code = code.size() == 2 && failure == std::errc{} && end == code.data() + 2;
    plain += is_code ? static_cast<char>(byte) : text[i];
    if (is_code) i += 2;
  }
  return plain;
}

}  // namespace

SvgDocument::SvgDocument(const std::filesystem::path& file, std::string bytes) : file_(file) {
  if (is_gzip(bytes)) bytes = gunzip(file, bytes);
  ExpandedXml expanded = expand_entities(file, xml_in_utf8(std::move(bytes)));
  text_ = std::move(expanded.text);
  left_out_["entity of another file"] = expanded.external;
  left_out_["entity without a declaration"] = expanded.undeclared;
  const pugi::xml_parse_result result = document_.load_buffer(
      text_.data(), text_.size(), pugi::parse_default | pugi::parse_pi | pugi::parse_ws_pcdata,
      pugi::encoding_utf8);
  if (!result) {
    FilePosition{file_, text_, static_cast<std::size_t>(result.offset)}.refuse(
        fmt::format("not valid XML ({})", result.description()), "export the drawing again");
  }
  root_ = document_.document_element();
  for (const xml_node& node : document_.children("xml-stylesheet"))
    left_out_["style sheet of another file"] += node.type() == pugi::node_pi ? 1U : 0U;
  keep_svg();
  number_ids(root_, 0);
  const StyleOutcome outcome = apply_styles(root_);
  if (outcome.too_complex)
    position_of(root_).refuse(
        "the style sheet has too many rules for a drawing with so many elements",
        "export the drawing without a style sheet");
  const std::string rule = printable(fmt::format("{:.40}", outcome.first_unread_rule));
  left_out_[fmt::format("rule of a style sheet, first '{}'", rule)] = outcome.unread_rules;
  std::erase_if(left_out_, [](const auto& one) { return one.second == 0; });
}

void SvgDocument::keep_svg() {
  const NamespaceOutcome outcome = keep_svg_elements(root_, max_svg_depth);
  if (!outcome.is_svg) {
    const std::string space =
        outcome.root_uri.empty() ? "" : fmt::format(" of the namespace '{:.60}'", outcome.root_uri);
    position_of(root_).refuse(
        fmt::format("the document is '{:.40}'{}, not svg", root_.name(), space),
        "give an SVG drawing; its namespace is http://www.w3.org/2000/svg");
  }
  left_out_["element of another namespace"] = outcome.foreign;
}

FilePosition SvgDocument::position_of(const xml_node& node) const {
  return {file_, text_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0))};
}

void SvgDocument::number_ids(const xml_node& node, int depth) {
  if (depth > max_svg_depth)
    position_of(node).refuse(fmt::format("groups are nested deeper than {}", max_svg_depth),
                             "ungroup some");
  const char* id = node.attribute("id").value();
  if (*id != '\0') by_id_.try_emplace(id, node);
  for (const xml_node& child : node.children()) number_ids(child, depth + 1);
}

xml_node SvgDocument::find(std::string_view id) const {
  const auto found = by_id_.find(std::string(id));
  return found == by_id_.end() ? xml_node{} : found->second;
}

xml_node SvgDocument::find_fragment(std::string_view fragment) const {
  const xml_node found = find(fragment);
  return found ? found : find(without_percent_codes(fragment));
}

xml_node SvgDocument::find_url(std::string_view value) const {
  if (!value.starts_with("url(")) return {};
  value = trimmed(value.substr(0, value.find(')')).substr(std::string_view("url(").size()));
  if (value.starts_with('"') || value.starts_with('\''))
    value = value.substr(1, value.find_first_of("\"'", 1) - 1);
  value = trimmed(value);
  const std::size_t hash = value.find('#');
  return hash == std::string_view::npos ? xml_node{} : find_fragment(value.substr(hash + 1));
}

xml_node SvgDocument::used_by(const xml_node& use) const {
  std::string_view target = trimmed(use.attribute("href").value());
  if (target.empty()) target = trimmed(use.attribute("xlink:href").value());
  if (!target.starts_with('#')) return {};
  const xml_node used = find_fragment(target.substr(1));
  if (!used)
    position_of(use).refuse(fmt::format("there is no element '{:.40}'", target.substr(1)),
                            "repair the drawing");
  return used;
}

}  // namespace lamplock::model
