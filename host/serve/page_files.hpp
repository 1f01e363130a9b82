// The files of the page, embedded in the program.
#pragma once

#include <string_view>

namespace lamplock::serve {

/// Target of the document; page_document() inserts its texts and its style.
inline constexpr const char* page_target = "/";

/// A file as clients get it.
struct PageFile {
  std::string_view target;
  const char* type;
  std::string_view (*text)();
};
/// Null if there is no file with this target.
const PageFile* find_page_file(std::string_view target);

std::string_view page_html();
std::string_view page_css();
std::string_view page_texts_json();
std::string_view page_texts_js();
std::string_view page_link_js();
std::string_view page_jog_js();
std::string_view page_job_js();
std::string_view page_views_js();
std::string_view page_cloud_painter_js();
std::string_view page_path_painter_js();
std::string_view page_cloud_js();
std::string_view page_camera_js();
std::string_view page_place_js();
std::string_view page_records_js();
std::string_view page_main_js();

}  // namespace lamplock::serve
