// Where a program finds its files: in a build, installed, through links.
#include "host/run/image_path.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "host/error.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::run::image_path_test {
namespace {

using lamplock::test::TemporaryFolder;

namespace fs = std::filesystem;

fs::path make_file(const fs::path& path) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << "x";
  return path;
}

TEST(ImagePath, FilesBesideTheProgramAreThoseOfABuild) {
  const TemporaryFolder folder;
  const fs::path program = make_file(folder.file("build/lamplock"));
  EXPECT_EQ(file_of_program_at(program, elf_image_name), "");
  const fs::path image = make_file(folder.file("build") / elf_image_name);
  make_file(folder.file("share/lamplock") / elf_image_name);  // of an older installation
  EXPECT_EQ(file_of_program_at(program, elf_image_name), image);
  EXPECT_EQ(file_of_program_at(program, uf2_image_name), "");
}

TEST(ImagePath, AnInstalledProgramFindsThemInShareThroughLinksToo) {
  const TemporaryFolder folder;
  const fs::path program = make_file(folder.file("usr/bin/lamplock"));
  const fs::path image = make_file(folder.file("usr/share/lamplock") / uf2_image_name);
  fs::create_directory(folder.file("elsewhere"));
  const fs::path link = folder.file("elsewhere/ll");
  fs::create_symlink(program, link);
  EXPECT_EQ(file_of_program_at(program, uf2_image_name), image);
  EXPECT_EQ(file_of_program_at(link, uf2_image_name), image);
}

TEST(ImagePath, FoldersAreNotFilesAndAnUnknownProgramHasNone) {
  const TemporaryFolder folder;
  const fs::path program = make_file(folder.file("bin/lamplock"));
  fs::create_directories(folder.file("bin") / elf_image_name);
  EXPECT_EQ(file_of_program_at(program, elf_image_name), "");
  EXPECT_EQ(file_of_program_at("", elf_image_name), "");
  EXPECT_EQ(file_of_program_at(folder.file("none"), elf_image_name), "");
}

TEST(ImagePath, TheGivenFileIsUsedUnchanged) {
  EXPECT_EQ(image_path("mine.elf", elf_image_name, "--image"), "mine.elf");
  EXPECT_THROW(image_path("", "no-such-image.uf2", "--image"), Error);
}

}  // namespace
}  // namespace lamplock::run::image_path_test
