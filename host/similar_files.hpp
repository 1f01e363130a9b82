// Suggests existing files for a name that does not exist.
//
// In:  the path as a user wrote it. Out: what to do about it. Who: everything that opens a file or
//      a folder named by the user.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lamplock {

/// What the path must name.
enum class PathKind { file, folder, port };

/// Existing paths of this kind that differ from the missing one by a slip in one part.
std::vector<std::string> similar_paths(const std::filesystem::path& missing, PathKind kind);

/// "did you mean 'models/ball.stl'?", or that its folder does not exist, or to check the name.
std::string missing_path_remedy(const std::filesystem::path& missing,
                                PathKind kind = PathKind::file);

}  // namespace lamplock
