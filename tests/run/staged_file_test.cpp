// Files that are written whole or not at all.
#include "host/file/staged_file.hpp"

#include <gtest/gtest.h>

#include "host/error.hpp"
#include "host/file.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test::staged_file_test {
namespace {

TEST(WriteWhole, keeps_the_reason_of_the_writer_with_the_name_of_the_file) {
  const TemporaryFolder folder;
  const std::string target = folder.write("a.toml", "before").string();
  try {
    write_whole(target, [](const std::filesystem::path& path) {
      write_file(path, "half");
      throw Error(Exit::job_failed, path.string() + ": line 3",
                  "block is missing in " + path.string(), "give one; or remove it");
    });
    FAIL() << "the error of the writer is lost";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::job_failed);
    EXPECT_EQ(error.message(),
              target + ": line 3: block is missing in " + target + "; give one; or remove it");
  }
  EXPECT_EQ(read_file(target), "before");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.file("")), {}), 1)
      << "no half file remains";
}

}  // namespace
}  // namespace lamplock::test::staged_file_test
