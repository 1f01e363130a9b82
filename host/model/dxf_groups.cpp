#include "host/model/dxf_groups.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "host/file.hpp"
#include "host/model/text.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

constexpr std::string_view export_again = "export the drawing again";

const DxfGroup* last_of(const DxfEntity& entity, int code) {
  for (auto group = entity.groups.rbegin(); group != entity.groups.rend(); ++group) {
    if (group->code == code) return &*group;
  }
  return nullptr;
}

/// The line without blanks at both ends; a blank line gives an empty part of the text.
std::string_view content_of(std::string_view line) {
  const std::string_view content = trimmed(line);
  return content.empty() ? line.substr(0, 0) : content;
}

std::string_view without_mark(const std::filesystem::path& file, std::string_view bytes) {
  // "AC1032" and similar: version of a DWG.
  if (bytes.starts_with("AC1") && bytes.substr(0, 32).find('\0') != std::string_view::npos)
    refuse(file, "it is a DWG file with the name of a DXF", "save it as a DXF");
  return without_byte_order_mark(bytes);
}

}  // namespace

DxfGroups::DxfGroups(const std::filesystem::path& file, std::string_view bytes, bool was_binary)
    : file_(file), bytes_(bytes), was_binary_(was_binary), lines_(without_mark(file, bytes)) {}

DxfGroup DxfGroups::next() {
  if (has_ahead_) {
    has_ahead_ = false;
    return ahead_;
  }
  constexpr int comment = 999;
  while (true) {
    const auto code_line = lines_.next();
    const auto value_line = lines_.next();
    if (!code_line || !value_line) {
      refuse(file_, fmt::format("line {}: the drawing is cut off: no EOF", lines_.number()),
             std::string(export_again));
    }
    const std::string_view code = content_of(*code_line);
    const auto number = to_integer(code);
    if (!number || *number < -5 || *number > 1071) {  // the range of codes
      position_of(code).refuse(fmt::format("'{:.20}' is not a group code", code),
                               std::string(export_again));
    }
    if (*number != comment) return {static_cast<int>(*number), content_of(*value_line)};
  }
}

const DxfGroup& DxfGroups::peek() {
  if (!has_ahead_) {
    ahead_ = next();
    has_ahead_ = true;
  }
  return ahead_;
}

void DxfGroups::next_entity(DxfEntity& entity) {
  const DxfGroup first = next();
  if (first.code != 0) {
    position_of(first.value)
        .refuse(fmt::format("group {} is not the begin of an entity", first.code),
                std::string(export_again));
  }
  entity.kind = first.value;
  entity.groups.clear();
  if (first.value == "EOF") return;
  while (peek().code != 0) entity.groups.push_back(next());
}

FilePosition DxfGroups::position_of(std::string_view value) const {
  return {file_, bytes_, static_cast<std::size_t>(value.data() - bytes_.data()), was_binary_};
}

double DxfGroups::number(const DxfGroup& group) const {
  const auto number = to_double(group.value);
  if (!number && has_decimal_comma(group.value))
    position_of(group.value)
        .refuse(fmt::format("'{:.20}' has a decimal comma", group.value), write_decimal_points);
  if (!number || !std::isfinite(*number)) {
    position_of(group.value)
        .refuse(fmt::format("'{:.20}' is not a usable number", group.value),
                std::string(export_again));
  }
  return *number;
}

int DxfGroups::integer(const DxfGroup& group) const {
  const auto number = to_integer(group.value);
  if (!number || *number < std::numeric_limits<int>::min() ||
      *number > std::numeric_limits<int>::max()) {
    position_of(group.value)
        .refuse(fmt::format("'{:.20}' is not a usable whole number", group.value),
                std::string(export_again));
  }
  return static_cast<int>(*number);
}

double DxfGroups::number(const DxfEntity& entity, int code, double otherwise) const {
  const DxfGroup* group = last_of(entity, code);
  return group != nullptr ? number(*group) : otherwise;
}

int DxfGroups::integer(const DxfEntity& entity, int code, int otherwise) const {
  const DxfGroup* group = last_of(entity, code);
  return group != nullptr ? integer(*group) : otherwise;
}

std::string_view DxfGroups::text(const DxfEntity& entity, int code,
                                 std::string_view otherwise) const {
  const DxfGroup* group = last_of(entity, code);
  return group != nullptr ? group->value : otherwise;
}

geometry::Point DxfGroups::point(const DxfEntity& entity, int x,
                                 const geometry::Point& otherwise) const {
  return {number(entity, x, otherwise.x), number(entity, x + 10, otherwise.y),
          number(entity, x + 20, otherwise.z)};
}

}  // namespace lamplock::model
