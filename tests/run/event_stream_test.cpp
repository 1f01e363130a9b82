// Lines for another program: all of them in order, and never a wait or an error for the machine.
#include "host/run/event_stream.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string>

#include "host/file.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::run::event_stream_test {
namespace {

using testing::HasSubstr;

/// A named pipe whose reader reads when a test calls it.
class EventPipe : public testing::Test {
 protected:
  EventPipe() {
    std::signal(SIGPIPE, SIG_IGN);  // NOLINT(cert-err33-c): as the program does
    EXPECT_EQ(::mkfifo(name().c_str(), 0600), 0);
    reader_ = ::open(name().c_str(), O_RDONLY | O_NONBLOCK);
  }
  ~EventPipe() override { close_reader(); }
  std::string name() const { return folder_.file("pipe").string(); }
  std::string read_some() const {
    std::string text(65536, ' ');
    const ssize_t size = ::read(reader_, text.data(), text.size());
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }
  void close_reader() {
    if (reader_ >= 0) ::close(reader_);
    reader_ = -1;
  }

  test::TemporaryFolder folder_;
  int reader_ = -1;
};

TEST_F(EventPipe, DeliversEverythingToASlowReader) {
  EventStream stream(name());
  std::string sent, received;
  for (int i = 0; i < 20'000; ++i) {
    const std::string line(static_cast<std::size_t>(i % 97), 'a');
    stream.add(line);
    sent += line + "\n";
    if (i % 100 == 0) received += read_some();
  }
  while (received.size() < sent.size()) {
    stream.poll();
    const std::string some = read_some();
    if (some.empty()) break;
    received += some;
  }
  EXPECT_TRUE(received == sent);
  stream.finish();
  EXPECT_EQ(stream.loss(), "");
}

TEST_F(EventPipe, NeverWaitsForAReaderThatDoesNotRead) {
  EventStream stream(name());
  const std::string line(1'000'000, 'b');
  const auto begin = std::chrono::steady_clock::now();
  int lines = 0;
  while (stream.loss().empty() && lines < 100) stream.add((++lines, line));
  EXPECT_EQ(stream.loss(), "its reader is too slow");
  EXPECT_EQ(lines, 17);
  EventStream rest(name());
  rest.add(line);
  rest.finish(std::chrono::milliseconds{10});
  EXPECT_EQ(rest.loss(), "its reader does not read");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{5});
}

TEST_F(EventPipe, ReportsAReaderThatHasGone) {
  EventStream stream(name());
  stream.add("one");
  EXPECT_EQ(read_some(), "one\n");
  close_reader();
  stream.add("two");
  EXPECT_EQ(stream.loss(), "Broken pipe");
  stream.add("three");
  stream.finish();
  EXPECT_EQ(stream.loss(), "Broken pipe");
  EXPECT_THAT(test::error_of([&] { EventStream again(name()); }),
              HasSubstr("no program reads this pipe; start its reader first"));
}

TEST(EventStream, ReplacesAFileAndReportsAFullDisk) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("a.jsonl").string();
  write_file(file, "old text");
  EventStream::check(file);
  EXPECT_EQ(read_text_file(file), "old text");
  EventStream stream(file);
  stream.add("new");
  EXPECT_EQ(read_text_file(file), "new\n");  // at once
  EventStream full("/dev/full");
  full.add("x");
  EXPECT_EQ(full.loss(), "No space left on device");
  EXPECT_THAT(test::error_of([&] { EventStream none((folder.file("none") / "b").string()); }),
              HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace lamplock::run::event_stream_test
