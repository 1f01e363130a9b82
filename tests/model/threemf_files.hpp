// Writes 3MF packages, valid and invalid ones, for the tests of their reader.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <minizip/zip.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/model/read_mesh.hpp"
#include "tests/points/shapes.hpp"

namespace lamplock::threemf {

using model::Mesh;
using model::read_mesh;
using test::error_of;
using test::TemporaryFolder;

/// Writes ZIP archives part by part.
class Archive {
 public:
  explicit Archive(const std::filesystem::path& file)
      : zip_(zipOpen64(file.c_str(), APPEND_STATUS_CREATE)) {}
  ~Archive() { zipClose(zip_, nullptr); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  void add(const std::string& name, const std::string& bytes) const {
    zip_fileinfo info{};
    zipOpenNewFileInZip64(zip_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                          Z_BEST_SPEED, 0);
    zipWriteInFileInZip(zip_, bytes.data(), static_cast<unsigned>(bytes.size()));
    zipCloseFileInZip(zip_);
  }

  /// Adds a part whose header claims an unpacked size of `bytes`.
  void add_claim(const std::string& name, const std::string& packed, std::uint64_t bytes) const {
    zip_fileinfo info{};
    constexpr int raw = 1;
    zipOpenNewFileInZip2_64(zip_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                            Z_BEST_SPEED, raw, 0);
    zipWriteInFileInZip(zip_, packed.data(), static_cast<unsigned>(packed.size()));
    zipCloseFileInZipRaw64(zip_, bytes, 0);
  }

 private:
  zipFile zip_;
};

inline constexpr const char* model_name = "3D/3dmodel.model";

inline std::string relations(const std::string& target) {
  return "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/"
         "2006/relationships\"><Relationship Id=\"rel0\" Target=\"" +
         target +
         "\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>"
         "</Relationships>";
}

inline constexpr const char* namespaces =
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
    "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" "
    "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" ";

inline std::string model_text(const std::string& resources, const std::string& build,
                              const std::string& attributes = "unit=\"millimeter\"") {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?><model {} {}><resources>{}</resources>"
      "<build>{}</build></model>",
      namespaces, attributes, resources, build);
}

inline std::string mesh_text(const Mesh& mesh) {
  std::string text = "<mesh><vertices>";
  for (const auto& v : mesh.vertices)
    text += fmt::format("<vertex x=\"{:.9g}\" y=\"{:.9g}\" z=\"{:.9g}\"/>", v.x, v.y, v.z);
  text += "</vertices><triangles>";
  for (const auto& t : mesh.triangles)
    text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", t[0], t[1], t[2]);
  return text + "</triangles></mesh>";
}

inline std::string object(int id, const std::string& content, const std::string& type = "model") {
  return fmt::format("<object id=\"{}\" type=\"{}\">{}</object>", id, type, content);
}

/// Components that refer to these objects.
inline std::string holding(const std::vector<int>& ids) {
  std::string text = "<components>";
  for (const int id : ids) text += fmt::format("<component objectid=\"{}\"/>", id);
  return text + "</components>";
}

inline std::string item(int id, const std::string& more = "") {
  return fmt::format("<item objectid=\"{}\" {}/>", id, more);
}

/// A box of 2 x 2 x 2 units round the origin.
inline std::string box_text() { return mesh_text(test::box(1, 1, 1)); }

class Threemf : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& resources, const std::string& build) const {
    return write_model(model_text(resources, build));
  }
  std::filesystem::path write_model(
      const std::string& text,
      const std::vector<std::pair<std::string, std::string>>& more = {}) const {
    auto file = folder_.write("a.3mf", "");
    const Archive archive(file);
    archive.add("[Content_Types].xml", "<Types/>");
    archive.add("_rels/.rels", relations("/3D/3dmodel.model"));
    archive.add(model_name, text);
    for (const auto& [name, bytes] : more) archive.add(name, bytes);
    return file;
  }
  /// A box in another part, placed by the first.
  std::filesystem::path write_parts(const std::string& part, const std::string& other) const {
    return write_model(model_text("", item(1, "p:path=\"/" + part + "\"")), {{part, other}});
  }
  std::string error(const std::string& resources, const std::string& build) const {
    return error_of([&] { read_mesh(write(resources, build)); });
  }
  /// Error of a model of a box in which `what` is replaced.
  std::string box_error(const std::string& what, const std::string& instead) const {
    std::string text = box_text();
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return error(object(1, text.replace(at, what.size(), instead)), item(1));
  }

  const TemporaryFolder folder_;
};

}  // namespace lamplock::threemf
