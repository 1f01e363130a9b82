// The container of binary glTF ("glTF 2.0 Specification", Khronos, chapter 4), as far as the
// check of a file needs it: every view must lie in the file's buffer and every accessor in its
// view, because the mesh library does not check this. Called by read_mesh() before the library.
#pragma once

#include <filesystem>
#include <string_view>

namespace lamplock::model {

/// Throws Error (bad_input, naming `path`) for a file that is cut off, damaged, or has its numbers
/// elsewhere (other files, sparse accessors).
void check_glb(const std::filesystem::path& path, std::string_view bytes);

}  // namespace lamplock::model
