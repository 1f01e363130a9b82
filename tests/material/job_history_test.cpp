// The history of jobs in the material library.
#include "host/material/job_history.hpp"

#include <gmock/gmock.h>

#include "host/material/database.hpp"
#include "host/material/library.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::material::job_history_test {
namespace {

JobRecord job_named(const std::string& file) {
  return {file,
          "virtual",
          "2026-11-28T09:30:00Z",
          "2026-11-28T09:31:10Z",
          "done",
          "why",
          "point",
          true,
          12,
          20,
          3};
}

TEST(job_history, comes_back_newest_first) {
  const test::TemporaryFolder folder;
  const auto library = folder.file("library.db");
  EXPECT_TRUE(last_jobs(library, 10).empty());
  EXPECT_FALSE(std::filesystem::exists(library)) << "reading makes no file";
  JobRecord program = job_named("b.ngc");
  program.wasted_beats.reset();
  program.report = "2026-11-28T09-30-00Z-0123";
  add_job(library, job_named("a.llj"));
  add_job(library, program);
  EXPECT_EQ(last_jobs(library, 10), (std::vector{program, job_named("a.llj")}));
  EXPECT_EQ(last_jobs(library, 1), (std::vector{program}));
  EXPECT_FALSE(Library(library).all<Material>().empty()) << "a new library has its records";
}

TEST(job_history, keeps_the_last_thousand) {
  const test::TemporaryFolder folder;
  const auto library = folder.file("library.db");
  add_job(library, job_named("first"));
  {
    Database database(library);
    database.execute("UPDATE job SET number = 5000");
  }
  add_job(library, job_named("second"));
  EXPECT_EQ(last_jobs(library, 10).size(), 2u);
  {
    Database database(library);
    database.execute("UPDATE job SET number = 6000 WHERE file = 'second'");
  }
  add_job(library, job_named("third"));
  EXPECT_EQ(last_jobs(library, 10), (std::vector{job_named("third"), job_named("second")}));
}

}  // namespace
}  // namespace lamplock::material::job_history_test
