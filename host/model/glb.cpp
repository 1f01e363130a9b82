#include "host/model/glb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "host/bytes.hpp"
#include "host/file.hpp"

namespace lamplock::model {
namespace {

using nlohmann::json;
using std::filesystem::path;

/// Maximum depth of nodes, and of lists in the description; deeper ones would overflow the stack of
/// the reader.
constexpr int max_depth = 100;

constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;

[[noreturn]] void refuse_glb(const path& file, const std::string& what) {
  refuse(file, what, "the file is cut off or damaged: export it again");
}

/// Removes the next chunk from `rest`; empty at the end of the file.
std::string_view next_chunk(const path& file, std::string_view& rest, std::string_view type) {
  if (rest.empty()) return {};
  if (rest.size() < chunk_header_bytes) refuse_glb(file, "a chunk is cut off");
  const std::size_t length = load<std::uint32_t>(rest.data());
  if (rest.substr(4, 4) != type) refuse_glb(file, "a chunk of an unknown kind");
  if (rest.size() - chunk_header_bytes < length) refuse_glb(file, "a chunk is cut off");
  const std::string_view chunk = rest.substr(chunk_header_bytes, length);
  rest.remove_prefix(chunk_header_bytes + length);
  return chunk;
}

/// A count or an offset; 0 if it is missing.
std::uint64_t number_of(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? 0 : found->get<std::uint64_t>();
}

/// Bytes of one number of an accessor; 0 for an unknown type.
std::uint64_t component_bytes(std::uint64_t type) {
  constexpr std::uint64_t first =
      5120;  // BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, -, UINT, FLOAT
  constexpr std::array<std::uint64_t, 7> bytes{1, 1, 2, 2, 0, 4, 4};
  return type >= first && type - first < bytes.size() ? bytes[type - first] : 0;
}

std::uint64_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  return type == "MAT4" ? 16 : 0;
}

/// A number of an index, in the types that indices may have.
std::uint64_t load_index(const char* bytes, std::uint64_t type) {
  constexpr std::uint64_t uint8 = 5121, uint16 = 5123;
  if (type == uint8) return load<std::uint8_t>(bytes);
  return type == uint16 ? load<std::uint16_t>(bytes) : load<std::uint32_t>(bytes);
}

/// Indices have types without a sign.
bool is_index_type(std::uint64_t type) { return type == 5121 || type == 5123 || type == 5125; }

/// The first byte of the numbers that `place` describes with a view and an offset.
const char* data_at(const Glb& glb, const json& place) {
  const json& view = glb.document->at("bufferViews").at(number_of(place, "bufferView"));
  return glb.buffer.data() + number_of(view, "byteOffset") + number_of(place, "byteOffset");
}

class Checker {
 public:
  Checker(const path& file, const Glb& glb)
      : file_(file), glb_(glb), document_(*glb.document), buffer_bytes_(glb.buffer.size()) {}

  void check() {
    check_extensions();
    for (const json& buffer : list("buffers")) {
      if (const auto uri = buffer.find("uri"); uri != buffer.end()) {
        const bool is_text = uri->is_string() && uri->get<std::string>().starts_with("data:");
        refuse(
            file_,
            is_text ? "its numbers are a text in the document" : "its numbers are in another file",
            "export it as one binary file (.glb)");
      }
      require(number_of(buffer, "byteLength") <= buffer_bytes_, "fewer numbers than announced");
    }
    require(list("buffers").size() <= 1, "more than one buffer");
    for (const json& view : list("bufferViews")) {
      require(number_of(view, "buffer") < list("buffers").size(), "a view without a buffer");
      require(fits(number_of(view, "byteOffset"), number_of(view, "byteLength"), buffer_bytes_),
              "a view reaches beyond the buffer");
    }
    std::size_t index = 0;
    for (const json& accessor : list("accessors")) check_accessor(accessor, index++);
    check_nodes();
  }

 private:
  const json& list(const char* key) const {
    static const json none = json::array();
    const auto found = document_.find(key);
    if (found == document_.end()) return none;
    require(found->is_array(), fmt::format("'{}' is not a list", key));
    return *found;
  }

  static bool fits(std::uint64_t offset, std::uint64_t length, std::uint64_t room) {
    return offset <= room && length <= room - offset;
  }

  void check_extensions() const {
    constexpr std::array<std::string_view, 6> read{
        "KHR_mesh_quantization",  // integers as positions
        // Light, pictures and their places change no geometry.
        "KHR_lights_punctual", "KHR_texture_transform", "KHR_texture_basisu", "EXT_texture_webp",
        "EXT_texture_avif"};
    for (const json& extension : list("extensionsRequired")) {
      const auto name = extension.get<std::string>();
      if (name.starts_with("KHR_materials_") || std::ranges::find(read, name) != read.end())
        continue;
      refuse(file_, fmt::format("it requires the extension '{:.40}', which is not read", name),
             "export it without compression and extensions");
    }
  }

  /// A reader without this extension would show one of the copies.
  void require_single(const json& node) const {
    const auto extensions = node.find("extensions");
    if (extensions == node.end() || !extensions->contains("EXT_mesh_gpu_instancing")) return;
    refuse(file_, "it repeats a mesh by the extension 'EXT_mesh_gpu_instancing', which is not read",
           "export it with the copies as nodes of their own");
  }

  /// Nodes must be trees that are not too deep for the reader, which walks them by recursion.
  void check_nodes() const {
    const json& nodes = list("nodes");
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> parents(nodes.size(), none);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      require_single(nodes[i]);
      const auto children = nodes[i].find("children");
      if (children == nodes[i].end()) continue;
      for (const json& child : *children) {
        const auto c = child.get<std::size_t>();
        require(c < nodes.size() && parents[c] == none, "nodes that do not form trees");
        parents[c] = i;
      }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      int depth = 0;
      for (std::size_t at = i; parents[at] != none; at = parents[at])
        require(++depth < max_depth, "nodes that are nested too deeply");
    }
  }

  void check_accessor(const json& accessor, std::size_t index) {
    const auto require_here = [&](bool condition, const char* what) {
      if (!condition) refuse_glb(file_, fmt::format("accessor {} {}", index, what));
    };
    const std::uint64_t bytes = component_bytes(number_of(accessor, "componentType")) *
                                components_of(accessor.value("type", std::string()));
    require_here(bytes > 0, "has an unknown type");
    const std::uint64_t count = number_of(accessor, "count");
    const auto sparse = accessor.find("sparse");
    if (sparse != accessor.end()) check_sparse(*sparse, count, bytes, require_here);
    if (!accessor.contains("bufferView")) {
      // All other elements are zeros, and no view limits their count.
      require_here(sparse != accessor.end(), "has no numbers");
      require_here(count <= std::numeric_limits<std::uint32_t>::max(), "has too many elements");
      return;
    }
    const std::uint64_t view = number_of(accessor, "bufferView");
    require_here(view < list("bufferViews").size(), "has no such view");
    const json& of = list("bufferViews")[view];
    const std::uint64_t room = number_of(of, "byteLength");
    const std::uint64_t stride = std::max(number_of(of, "byteStride"), bytes);
    // A count larger than the space must not overflow the product.
    require_here(count <= room && fits(number_of(accessor, "byteOffset"),
                                       count == 0 ? 0 : (count - 1) * stride + bytes, room),
                 "is beyond its view");
    constexpr std::uint64_t max_stride = 252;  // by the specification
    require_here(stride <= max_stride, "has too long a stride");
    const std::uint64_t given = number_of(of, "byteStride");
    require_here(given == 0 || given >= bytes, "has a stride shorter than an element");
  }

  /// `count` and `bytes` are those of the accessor: elements, and bytes of one.
  template <class Require>
  void check_sparse(const json& sparse, std::uint64_t count, std::uint64_t bytes,
                    const Require& require_here) {
    const std::uint64_t replaced = number_of(sparse, "count");
    const json &indices = sparse.at("indices"), &values = sparse.at("values");
    const std::uint64_t type = number_of(indices, "componentType");
    require_here(is_index_type(type), "has sparse indices of an unknown type");
    for (const auto& [place, size] :
         {std::pair{&indices, component_bytes(type)}, {&values, bytes}}) {
      require_here(place->contains("bufferView"), "has no sparse numbers");
      const std::uint64_t view = number_of(*place, "bufferView");
      require_here(view < list("bufferViews").size(), "has no such view");
      const std::uint64_t room = number_of(list("bufferViews")[view], "byteLength");
      require_here(replaced <= room && fits(number_of(*place, "byteOffset"), replaced * size, room),
                   "has sparse numbers beyond their view");
    }
    // Accessors that share a view must not make the check below quadratic.
    replaced_ += replaced;
    require_here(replaced_ <= buffer_bytes_, "repeats sparse numbers");
    const char* data = data_at(glb_, indices);
    std::uint64_t min_index = 0;
    for (std::uint64_t i = 0; i < replaced; ++i) {
      const std::uint64_t index = load_index(data + i * component_bytes(type), type);
      require_here(index >= min_index && index < count, "has sparse indices out of order");
      min_index = index + 1;
    }
  }

  void require(bool condition, const std::string& what) const {
    if (!condition) refuse_glb(file_, what);
  }

  const path& file_;
  const Glb& glb_;
  const json& document_;
  std::size_t buffer_bytes_;
  std::uint64_t replaced_ = 0;  // elements of all sparse accessors
};

}  // namespace

Glb open_glb(const path& file, std::string_view bytes) {
  if (bytes.size() < header_bytes || !bytes.starts_with("glTF")) refuse_glb(file, "is not a GLB");
  if (load<std::uint32_t>(bytes.data() + 4) != 2) {
    refuse(file, "is not a GLB of version 2", "export it as glTF 2.0");
  }
  const std::size_t length = load<std::uint32_t>(bytes.data() + 8);
  if (length < header_bytes || length > bytes.size()) refuse_glb(file, "the file is cut off");
  std::string_view rest = bytes.substr(header_bytes, length - header_bytes);
  const std::string_view text = next_chunk(file, rest, "JSON");
  Glb glb;
  glb.buffer = next_chunk(file, rest, std::string_view("BIN\0", 4));
  bool too_deep = false;
  glb.document = std::make_shared<const json>(json::parse(
      text,
      [&too_deep](int depth, json::parse_event_t, const json&) {
        too_deep = too_deep || depth > max_depth;
        return !too_deep;
      },
      false));
  if (too_deep || !glb.document->is_object()) refuse_glb(file, "its description cannot be read");
  try {
    Checker(file, glb).check();
  } catch (const json::exception&) {
    refuse_glb(file, "its description has values of a wrong kind");
  }
  return glb;
}

GlbAccessor::GlbAccessor(const Glb& glb, std::size_t index) {
  const json& accessor = glb.document->at("accessors").at(index);
  type_ = number_of(accessor, "componentType");
  count_ = number_of(accessor, "count");
  components_ = components_of(accessor.value("type", std::string()));
  normalized_ = accessor.value("normalized", false);
  if (accessor.contains("bufferView")) {
    data_ = data_at(glb, accessor);
    stride_ = number_of(glb.document->at("bufferViews").at(number_of(accessor, "bufferView")),
                        "byteStride");
  }
  if (stride_ == 0) stride_ = component_bytes(type_) * components_;
  if (const auto sparse = accessor.find("sparse"); sparse != accessor.end()) {
    const json& indices = sparse->at("indices");
    sparse_ = {number_of(*sparse, "count"), number_of(indices, "componentType"),
               data_at(glb, indices), data_at(glb, sparse->at("values"))};
  }
}

const char* GlbAccessor::element(std::size_t index) const {
  // Binary search for the index among those that are replaced.
  std::size_t begin = 0, end = sparse_.count;
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    const std::uint64_t replaced = load_index(
        sparse_.indices + middle * component_bytes(sparse_.index_type), sparse_.index_type);
    if (replaced == index) return sparse_.values + middle * component_bytes(type_) * components_;
    if (replaced < index) begin = middle + 1;
    if (replaced > index) end = middle;
  }
  return data_ == nullptr ? nullptr : data_ + index * stride_;
}

double GlbAccessor::at(std::size_t index, std::size_t component) const {
  const char* here = element(index);
  if (here == nullptr) return 0;
  here += component * component_bytes(type_);
  // The largest integer is 1, the smallest negative one is -1 ("glTF 2.0 Specification", 3.11).
  const auto integer = [&](auto value) {
    const auto number = static_cast<double>(value);
    if (!normalized_) return number;
    return std::max(number / static_cast<double>(std::numeric_limits<decltype(value)>::max()),
                    -1.0);
  };
  enum : std::uint64_t { int8 = 5120, uint8, int16, uint16, uint32 = 5125 };
  switch (type_) {
    case int8:
      return integer(load<std::int8_t>(here));
    case uint8:
      return integer(load<std::uint8_t>(here));
    case int16:
      return integer(load<std::int16_t>(here));
    case uint16:
      return integer(load<std::uint16_t>(here));
    case uint32:
      return integer(load<std::uint32_t>(here));
    default:
      return load<float>(here);
  }
}

}  // namespace lamplock::model
