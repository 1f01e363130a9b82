// Files that are written whole or not at all.
#include "host/file/staged_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/reserved_file.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test::staged_file_test {
namespace {

namespace fs = std::filesystem;

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

/// In a working folder of its own, as a user names files.
class Links : public testing::Test {
 protected:
  void link(const std::string& name, const std::string& to) {
    fs::create_symlink(to, folder_.file(name));
  }
  std::string path(const std::string& name) const { return folder_.file(name).string(); }
  std::string contents(const std::string& name) const { return read_file(path(name)); }

  const TemporaryFolder folder_;
};

TEST_F(Links, LeadToTheFileThatIsWritten) {
  folder_.write("real", "before");
  fs::create_directory(folder_.file("elsewhere"));
  link("link", "real");
  link("second", path("link"));
  link("dangling", "elsewhere/new");
  write_whole(path("link"), "one");
  EXPECT_EQ(contents("real"), "one");
  write_whole(path("second"), "two");
  EXPECT_EQ(contents("real"), "two");
  write_whole(path("dangling"), "three");
  EXPECT_EQ(contents("elsewhere/new"), "three");
  for (const char* name : {"link", "second", "dangling"})
    EXPECT_TRUE(fs::is_symlink(folder_.file(name))) << name;
}

TEST_F(Links, AreFollowedForAReservedFile) {
  folder_.write("real", "before");
  link("link", "real");
  ReservedFile file(folder_.file("link"), 100);
  EXPECT_EQ(contents("real"), "before");
  file.write("after");
  EXPECT_EQ(contents("real"), "after");
  EXPECT_TRUE(fs::is_symlink(folder_.file("link")));
}

TEST_F(Links, InACircleAreRefused) {
  link("a", "b");
  link("b", "a");
  EXPECT_THROW(write_whole(path("a"), "text"), Error);
  EXPECT_THROW(check_target(folder_.file("b")), Error);
  EXPECT_TRUE(fs::is_symlink(folder_.file("a")));
}

TEST(WriteWhole, KeepsTheModeOfTheFileThatItReplaces) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("private", "before");
  for (const fs::perms mode : {fs::perms{0600}, fs::perms{0755}, fs::perms{0644}}) {
    fs::permissions(file, mode);
    write_whole(file, "after");
    EXPECT_EQ(fs::status(file).permissions(), mode);
  }
}

/// Root may write every file: these are the rights of another user.
class WithoutRootsRights {
 public:
  WithoutRootsRights() {
    constexpr uid_t without_rights = 65534;  // base-passwd of Debian
    if (::geteuid() == 0) {
      EXPECT_EQ(::seteuid(without_rights), 0);
    }
  }
  ~WithoutRootsRights() { EXPECT_EQ(::seteuid(::getuid()), 0); }
  WithoutRootsRights(const WithoutRootsRights&) = delete;
  WithoutRootsRights& operator=(const WithoutRootsRights&) = delete;
};

TEST(WriteWhole, ReplacesNoFileThatTheUserMayNotWrite) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("protected", "before");
  fs::permissions(folder.file(""), fs::perms{0777});
  fs::permissions(file, fs::perms{0444});
  {
    const WithoutRootsRights user;
    EXPECT_THROW(check_target(file), Error);
    EXPECT_THROW(write_whole(file, "after"), Error);
    EXPECT_NO_THROW(write_whole(folder.file("new"), "text"));
  }
  EXPECT_EQ(read_file(file), "before");
}

}  // namespace
}  // namespace lamplock::test::staged_file_test
