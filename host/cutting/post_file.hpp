// Post-processors as TOML files, and those that the program has.
//
// In:  a name, or a file. Out: templates. Who: the use case of cutting.
//
//   name = "grbl"        about = "..."
//   machine = "laser"    laser, mill, knife or lathe: the moves that are written
//   decimals = 4         of positions
//   checked = true       lamplock's interpreter checks the programs
//   [lines]              one key for each event of post.hpp: a line or a list of lines
//   rapid = "G0 X{x} Y{y}"
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/cutting/post.hpp"

namespace lamplock::cutting {

/// A post-processor of the program: the name and the text of its file in host/cutting/posts.
struct PostText {
  std::string_view name, text;
};
std::vector<PostText> post_texts();
std::vector<std::string> post_names();

/// The templates of one of the names, or of a file whose name ends in .toml. Throws Error
/// (bad_input) for an unknown name, and at file and line for unknown keys, values of another kind,
/// and what template_fault() refuses; without lines for rapid, line, arc_cw and arc_ccw.
Post post_of(const std::string& name_or_file);

}  // namespace lamplock::cutting
