// The page of a job without its data, made at build time from the files in host/report/page/.
#pragma once

#include <string_view>

namespace lamplock::report {

/// HTML with style and script; contains data_place and cloud_place once each, to be replaced.
std::string_view page_template();

/// Placeholders for the JSON and for the base64 of the cloud.
inline constexpr std::string_view data_place = "@DATA@", cloud_place = "@CLOUD@";

}  // namespace lamplock::report
