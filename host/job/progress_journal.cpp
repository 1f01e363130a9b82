#include "host/job/progress_journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <span>
#include <system_error>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/job/job.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::job {
namespace {

constexpr std::string_view heading =
    "# kind session job first_unfired flashes may_have_fired check\n";
constexpr std::array<std::string_view, 3> names{"begun", "running", "ended"};
constexpr int hexadecimal = 16, decimal = 10;
constexpr mode_t for_all_to_read = 0644;

std::uint32_t check_of(std::string_view text) {
  return wire::crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// Removes and returns a word of the text, with the space after it.
std::string_view take_word(std::string_view& text) {
  const std::string_view word = text.substr(0, text.find(' '));
  text.remove_prefix(std::min(text.size(), word.size() + 1));
  return word;
}

bool take_number(std::string_view& text, std::uint32_t& value, int base = decimal) {
  const std::string_view word = take_word(text);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, base);
  return error == std::errc{} && end == word.data() + word.size();
}

std::string without_check(const ProgressRecord& record) {
  return fmt::format("{} {:08x} {:08x} {} {} {}", names[static_cast<std::size_t>(record.progress)],
                     record.session, record.job, record.first_unfired, record.flashes,
                     record.may_have_fired);
}

/// The record of a line; empty if the line is damaged or no record.
std::optional<ProgressRecord> parse(std::string_view line) {
  const auto found = std::find(names.begin(), names.end(), take_word(line));
  if (found == names.end()) return std::nullopt;
  ProgressRecord record;
  record.progress = static_cast<Progress>(found - names.begin());
  std::uint32_t check = 0;
  const bool whole = take_number(line, record.session, hexadecimal) &&
                     take_number(line, record.job, hexadecimal) &&
                     take_number(line, record.first_unfired) && take_number(line, record.flashes) &&
                     take_number(line, record.may_have_fired) &&
                     take_number(line, check, hexadecimal);
  if (!whole || !line.empty() || check != check_of(without_check(record))) return std::nullopt;
  return record;
}

/// A complete line may concern points that were sent to the board; an incomplete one does not.
bool has_whole_line(std::string_view text) {
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    if (end != 0 && text.front() != '#') return true;
    text.remove_prefix(end + 1);
  }
  return false;
}

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// A file is found after a power loss only if its folder is on the disk too.
void sync_folder(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);  // fails on some file systems, which do not need it
  ::close(descriptor);
}

}  // namespace

std::uint32_t hash_of(const Job& job) {
  std::array<std::uint8_t, wire::max_job_header_size> bytes{};
  wire::ByteWriter out(bytes);
  wire::write_job_header(out, job.header);
  std::uint32_t hash = wire::crc32(out.written());
  constexpr std::size_t piece = 1 << 16;
  RecordEncoder encoder(job, 0);
  for (auto records = encoder.next(piece, piece); !records.empty();
       records = encoder.next(piece, piece))
    hash = wire::crc32(records, hash);
  return hash;
}

std::string progress_line(const ProgressRecord& record) {
  const std::string text = without_check(record);
  return fmt::format("{} {:08x}\n", text, check_of(text));
}

const ProgressRecord* JournalContents::find_offered(std::uint32_t session) const {
  const auto found = std::ranges::find(offered, session, &ProgressRecord::session);
  return found == offered.end() ? nullptr : &*found;
}

JournalContents contents_of(std::string_view text) {
  JournalContents contents;
  auto& [run, offered] = contents;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    const auto record = parse(text.substr(0, end));
    text.remove_prefix(end + 1);
    if (!record) continue;
    if (record->progress == Progress::begun) {
      offered.push_back(*record);
      continue;
    }
    if (const ProgressRecord* begun = contents.find_offered(record->session))
      run = KeptRun{*begun, *record};
    else if (!run || run->begun.session != record->session)
      run = KeptRun{*record, *record};
    run->last = *record;
    offered.clear();
  }
  return contents;
}

JournalContents ProgressJournal::read() const {
  std::error_code failure;
  const auto size = std::filesystem::file_size(file_, failure);
  if (failure || size == 0) return {};
  const std::string text = read_file(file_);
  const JournalContents contents = contents_of(text);
  if (contents.empty() && has_whole_line(text))
    throw Error(Exit::bad_input, file_.string(), "is damaged: it has no readable record",
                "find the first point that was not fired (last message, or the glass) and continue "
                "with --from N, or discard this run with --discard");
  return contents;
}

void ProgressJournal::lock() {
  std::error_code failure;
  if (descriptor_ < 0 && std::filesystem::exists(file_, failure)) open(O_RDWR | O_APPEND);
}

void ProgressJournal::append(const ProgressRecord& record) {
  if (descriptor_ < 0) open(O_RDWR | O_APPEND | O_CREAT);
  if (!write_all(descriptor_, progress_line(record)) || ::fsync(descriptor_) != 0)
    fail("cannot be written");
  // The job could not continue from a file that was removed: the records would be lost with it.
  struct stat state {};
  if (::fstat(descriptor_, &state) == 0 && state.st_nlink == 0)
    throw Error(Exit::job_failed, file_.string(), "was removed during the job",
                "keep it until the job has ended");
}

void ProgressJournal::remove() {
  close();
  std::error_code error;
  std::filesystem::remove(file_, error);
  if (error) fail("cannot be removed");
}

/// Ends an incomplete last line, so that the next record begins a line of its own.
void ProgressJournal::open(int flags) {
  descriptor_ = ::open(file_.c_str(), flags | O_CLOEXEC, for_all_to_read);
  if (descriptor_ < 0) fail("cannot be opened");
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close();
    throw Error(Exit::job_failed, file_.string(), "another program runs this job",
                "wait for its end, or end that program");
  }
  const off_t size = ::lseek(descriptor_, 0, SEEK_END);
  if (size <= 0) {
    sync_folder(file_);
    if (!write_all(descriptor_, heading)) fail("cannot be written");
    return;
  }
  char last = '\n';
  const bool is_read = ::pread(descriptor_, &last, 1, size - 1) == 1;
  if (!is_read || (last != '\n' && !write_all(descriptor_, "\n"))) fail("cannot be written");
}

void ProgressJournal::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

void ProgressJournal::fail(const char* what) const {
  const std::string reason = std::generic_category().message(errno);
  throw Error(Exit::job_failed, file_.string(), fmt::format("{} ({})", what, reason),
              "check folder and free space, or choose another file with --progress FILE");
}

}  // namespace lamplock::job
