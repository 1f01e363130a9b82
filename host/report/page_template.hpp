// The page of a job without its data: made at build time of the files in host/report/page/.
#pragma once

#include <string_view>

namespace lamplock::report {

/// HTML with style and script; data_place and cloud_place, once each, are to be replaced.
std::string_view page_template();

/// Where the JSON and the base64 of the cloud belong.
inline constexpr std::string_view data_place = "@DATA@", cloud_place = "@CLOUD@";

}  // namespace lamplock::report
