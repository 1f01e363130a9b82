// The material library: records that come back, keys, several processes, killed processes, other
// files in its place, versions.
#include "host/material/library.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>
#include <vector>

#include "host/geometry/random.hpp"
#include "host/material/schema.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::material::library_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A measurement that differs from others by its depth.
Measurement cut_with_depth(double depth_mm) {
  Measurement one;
  one.material = "plywood";
  one.laser = "diode-3w";
  one.feed_mm_min = 90;
  one.power_w = 2.5;
  one.depth_mm = depth_mm;
  one.source = "test";
  return one;
}

std::vector<double> depths_by_tests(const fs::path& file) {
  Library library(file);
  std::vector<double> depths;
  for (const Measurement& one : library.measurements_of("plywood"))
    if (one.source == "test") depths.push_back(*one.depth_mm);
  return depths;
}

TEST(material_library, has_the_delivered_records_and_keeps_changes) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.file("library.db");
  Measurement added;
  Library::change(file, [&](Library& library) { added = library.add(cut_with_depth(0.25)); });
  Library library(file);
  EXPECT_EQ(library.laser("diode-3w").power_w, 3);
  EXPECT_EQ(library.material("pmma-black").density_g_cm3, 1.18);
  EXPECT_EQ(library.measurements_of("pmma-black").size(), 12u);
  for (const Material& one : library.all<Material>()) EXPECT_NE(one.source, "") << one.name;
  EXPECT_TRUE(same_record(library.measurement("plywood", added.number), cut_with_depth(0.25)));
  Material plywood = library.material("plywood");
  plywood.name = "birch";
  Library::change(file, [&](Library& changed) { changed.replace(plywood); });
  EXPECT_EQ(library.measurements_of("birch").size(), 7u) << "records follow a new name";
  Library::change(file, [&](Library& changed) { changed.remove(plywood); });
  EXPECT_TRUE(library.measurements_of("birch").empty());
  EXPECT_THAT(test::error_of([&] { library.material("pmma-balck"); }),
              HasSubstr("material pmma-balck: the library has no such record; did you mean "
                        "'pmma-black'?"));
}

TEST(material_library, refuses_records_whole) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.file("library.db");
  const auto refusal = [&](const std::function<void(Library&)>& change) {
    return test::error_of([&] { Library::change(file, change); });
  };
  Measurement wrong = cut_with_depth(0.3);
  wrong.feed_mm_min = -1;
  EXPECT_THAT(refusal([&](Library& library) { library.add(wrong); }),
              HasSubstr("measurement of plywood: 'feed_mm_min' is -1; give more than 0"));
  EXPECT_FALSE(fs::exists(file)) << "a refused change makes no library";
  wrong = cut_with_depth(0.3);
  wrong.laser = "diode-3v";
  EXPECT_THAT(refusal([&](Library& library) {
                library.add(cut_with_depth(0.3));
                library.add(wrong);
              }),
              HasSubstr("'laser' is 'diode-3v', which the library does not have; did you mean"));
  { Library made(file); }
  EXPECT_THAT(refusal([&](Library& library) {
                library.add(cut_with_depth(0.3));
                library.add(library.material("wool"));
              }),
              HasSubstr("material wool: the library has it already"));
  EXPECT_TRUE(depths_by_tests(file).empty()) << "the first of two records was kept";
  EXPECT_THAT(refusal([](Library& library) { library.remove(library.laser("diode-3w")); }),
              HasSubstr("laser diode-3w: it is used by 9 settings and 39 measurements; remove"));
  Library library(file);
  Setting setting = library.settings_of("wool").front();
  EXPECT_THAT(refusal([&](Library& changed) { changed.add(setting); }), HasSubstr("setting"));
  Library::change(file, [&](Library& changed) {
    setting.operation = "score";
    changed.add(setting);
  });
  EXPECT_EQ(library.settings_of("wool").size(), 2u);
}

TEST(material_library, reading_makes_no_file) {
  const test::TemporaryFolder folder;
  Library library = Library::for_reading(folder.file("none.db"));
  EXPECT_EQ(library.all<Laser>().size(), 1u);
  EXPECT_FALSE(fs::exists(folder.file("none.db")));
}

TEST(material_library, imports_what_it_exports) {
  const test::TemporaryFolder folder;
  const Records records = Library::for_reading("").records();
  ImportCount count;
  const auto import = [&](const Records& wanted, bool replaces) {
    Library::change(folder.file("a.db"),
                    [&](Library& library) { count = library.import_records(wanted, replaces); });
  };
  import(records, false);
  EXPECT_EQ(count.added + count.replaced, 0u);
  Records changed = records;
  changed.materials.front().note = "another";
  changed.measurements.push_back(changed.measurements.front());  // a second cut with this depth
  EXPECT_THAT(test::error_of([&] { import(changed, false); }), HasSubstr("with other values"));
  EXPECT_TRUE(depths_by_tests(folder.file("a.db")).empty());
  import(changed, true);
  EXPECT_EQ(count.replaced, 1u);
  EXPECT_EQ(count.added, 1u);
  import(changed, true);
  EXPECT_EQ(count.added + count.replaced, 0u);
}

TEST(material_library, other_files_are_refused_and_stay_as_they_are) {
  const test::TemporaryFolder folder;
  const auto refusal = [](const fs::path& file) {
    return test::error_of([&] { const Library library(file); });
  };
  std::string noise(5000, '\0');
  geometry::Random random(5);
  for (char& c : noise) c = static_cast<char>(random.next());
  EXPECT_THAT(refusal(folder.write("noise.db", noise)), HasSubstr("it is not a material library"));
  EXPECT_THAT(refusal(folder.write("text.db", "a text that is no database, and long enough")),
              HasSubstr("it is not a material library"));
  EXPECT_THAT(refusal(folder.file("")), HasSubstr("not a file"));
  EXPECT_THAT(refusal("/proc/none/library.db"), HasSubstr("cannot be opened"));
  EXPECT_THAT(refusal("/dev/full"), HasSubstr("not a file"));
  { Database(folder.file("other.db")).execute("CREATE TABLE t (a)"); }
  EXPECT_THAT(refusal(folder.file("other.db")), HasSubstr("the database of another program"));
  { const Library library(folder.file("newer.db")); }
  Database(folder.file("newer.db")).execute("PRAGMA user_version = 9999");
  EXPECT_THAT(refusal(folder.file("newer.db")), HasSubstr("use a newer lamplock"));
}

/// Damaged pages give an error or records, and never end the program.
TEST(material_library, damaged_libraries) {
  const test::TemporaryFolder folder;
  { const Library library(folder.file("whole.db")); }
  std::ifstream whole(folder.file("whole.db"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
  geometry::Random random(6);
  int refused = 0;
  for (int i = 0; i < test::scaled(200, 20); ++i) {
    std::string damaged = bytes;
    if (i % 4 == 0) damaged.resize(1 + random.next() % damaged.size());
    for (int k = 0; k < 40; ++k)
      damaged[random.next() % damaged.size()] = static_cast<char>(random.next());
    try {
      Library library(folder.write("damaged.db", damaged));
      (void)library.records();
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::bad_input);
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(material_library, versions_are_migrated_whole) {
  const test::TemporaryFolder folder;
  const std::array steps{"CREATE TABLE t (a REAL)", "ALTER TABLE t ADD COLUMN b REAL",
                         "UPDATE t SET b = a * 2"};
  const auto part = [&](std::size_t count) { return std::span(steps).first(count); };
  int created = 0;
  Database database(folder.file("library.db"));
  migrate(database, part(1), [&] { ++created; });
  database.execute("INSERT INTO t VALUES (21)");
  const std::array failing{steps[0], steps[1], "UPDATE nothing SET b = 1"};
  EXPECT_THROW(migrate(database, failing, [] {}), Error);
  EXPECT_EQ(database.number("PRAGMA user_version"), 1) << "a failed migration changed the version";
  EXPECT_EQ(database.query("SELECT * FROM t")[0].size(), 1u) << "and left a column";
  migrate(database, part(3), [&] { ++created; });
  migrate(database, part(3), [&] { ++created; });
  EXPECT_EQ(created, 1);
  EXPECT_EQ(std::get<double>(database.query("SELECT b FROM t")[0][0]), 42);
  EXPECT_THROW(migrate(database, part(2), [] {}), Error);
}

/// Runs `work` in a process of its own.
pid_t in_process(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  int status = 0;
  try {
    work();
  } catch (...) {
    status = 1;
  }
  ::_exit(status);
}

int status_of(pid_t process) {
  int status = 0;
  ::waitpid(process, &status, 0);
  return status;
}

/// They also make the library at the same time.
TEST(material_library, four_processes_write_at_once) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.file("library.db");
  constexpr int processes = 4;
  const int writes = test::scaled(20, 4);
  std::vector<pid_t> children;
  children.reserve(processes);
  for (int p = 0; p < processes; ++p)
    children.push_back(in_process([&] {
      for (int i = 0; i < writes; ++i)
        Library::change(file, [&](Library& library) {
          library.add(cut_with_depth((p * 1000 + i + 1) / 1000.0));
        });
    }));
  for (const pid_t child : children) EXPECT_EQ(status_of(child), 0);
  std::vector<double> wanted;
  for (int p = 0; p < processes; ++p)
    for (int i = 0; i < writes; ++i) wanted.push_back((p * 1000 + i + 1) / 1000.0);
  EXPECT_THAT(depths_by_tests(file), testing::UnorderedElementsAreArray(wanted));
}

/// Each write is two records; the process says after each that it is done, and is killed while it
/// does the next ones.
TEST(material_library, a_killed_process_loses_its_last_write_only) {
  geometry::Random random(7);
  for (int round = 0; round < test::scaled(6, 2); ++round) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.file("library.db");
    { const Library made(file); }
    std::array<int, 2> pipe_ends{};
    ASSERT_EQ(::pipe(pipe_ends.data()), 0);
    const pid_t child = in_process([&] {
      for (int i = 0; i < 100; ++i) {
        Library::change(file, [&](Library& library) {
          library.add(cut_with_depth((2 * i + 1) / 1000.0));
          library.add(cut_with_depth((2 * i + 2) / 1000.0));
        });
        const char done = 'w';
        if (::write(pipe_ends[1], &done, 1) != 1) ::_exit(2);
      }
      ::pause();
    });
    ::close(pipe_ends[1]);
    std::size_t done = 0;
    char byte = 0;
    const std::size_t enough = 1 + random.next() % 12;
    while (done < enough && ::read(pipe_ends[0], &byte, 1) == 1) ++done;
    ::usleep(static_cast<useconds_t>(random.next() % 3000));
    ::kill(child, SIGKILL);
    status_of(child);
    while (::read(pipe_ends[0], &byte, 1) == 1) ++done;
    ::close(pipe_ends[0]);
    const std::size_t kept = depths_by_tests(file).size();
    EXPECT_GE(kept, 2 * done);
    EXPECT_LE(kept, 2 * (done + 1));
    EXPECT_EQ(kept % 2, 0u) << "half of a write is there";
    EXPECT_EQ(Database(file).query("PRAGMA integrity_check")[0],
              SqlRow{SqlValue(std::string("ok"))});
    Library::change(file, [](Library& library) { library.add(cut_with_depth(0.999)); });
  }
}

}  // namespace
}  // namespace lamplock::material::library_test
