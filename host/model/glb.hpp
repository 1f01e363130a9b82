// The container of binary glTF ("glTF 2.0 Specification", Khronos, chapter 4) and the places of its
// numbers. In: the bytes of a file. Out: its description and its numbers, after a check that every
// view lies in the file's buffer, every accessor in its view, and that nodes are trees. Called by
// read_glb().
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace lamplock::model {

struct Glb {
  std::shared_ptr<const nlohmann::json> document;  // never null
  std::string_view buffer;                         // part of the bytes of the file
};

/// Throws Error (bad_input, naming `path`) for a file that is cut off, damaged, has its numbers
/// elsewhere (in other files) or requires an extension that is not read.
Glb open_glb(const std::filesystem::path& path, std::string_view bytes);

/// Numbers of an accessor; the Glb must outlive it.
class GlbAccessor {
 public:
  /// `index` must be an accessor of a checked file.
  GlbAccessor(const Glb& glb, std::size_t index);

  std::size_t count() const { return count_; }
  /// Numbers of an element: 3 for VEC3.
  std::size_t components() const { return components_; }
  bool is_single() const { return type_ == float_type; }
  /// Number `component` of element `index`, both less than the counts. Integers that mean
  /// numbers from -1 or 0 to 1 are converted.
  double at(std::size_t index, std::size_t component) const;

 private:
  static constexpr std::uint64_t float_type = 5126;

  /// Elements that replace others ("glTF 2.0 Specification", 3.6.2.3): their indices in ascending
  /// order, and their numbers.
  struct Sparse {
    std::size_t count = 0;
    std::uint64_t index_type = 0;
    const char *indices = nullptr, *values = nullptr;
  };
  /// The first byte of an element; null for an element of zeros.
  const char* element(std::size_t index) const;

  const char* data_ = nullptr;  // null: all elements are zeros but those of sparse_
  Sparse sparse_{};
  std::uint64_t type_ = 0;
  std::size_t count_ = 0, components_ = 0, stride_ = 0;
  bool normalized_ = false;
};

}  // namespace lamplock::model
