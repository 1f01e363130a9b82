#include "host/job/job_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>

#include "host/error.hpp"
#include "host/file.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::job {
namespace {

constexpr std::array<std::uint8_t, 8> magic{'L', 'L', 'J', 0x1A, '\r', '\n', 0x00, 0xB5};
/// Files without glass are version 1, those with its refraction version 2.
constexpr std::uint16_t plain_version = 1, glass_version = 2;
constexpr std::size_t glass_bytes = 2 * sizeof(double);
constexpr std::size_t payload_bytes = 1 << 16;

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw Error(Exit::bad_input, name, what,
              "make the job again with lamplock job (points) or lamplock raster (rows)");
}

bool has_magic(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

std::vector<std::uint8_t> encode_records(const Job& job) {
  std::vector<std::uint8_t> stream;
  RecordEncoder encoder(job, 0);
  for (auto piece = encoder.next(payload_bytes, payload_bytes); !piece.empty();
       piece = encoder.next(payload_bytes, payload_bytes))
    stream.insert(stream.end(), piece.begin(), piece.end());
  return stream;
}

/// Data between the version and the checksum of a file.
struct Contents {
  std::uint16_t version;
  std::span<const std::uint8_t> bytes;
};

/// Checks magic, version and checksum.
Contents open_envelope(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (!has_magic(bytes)) fail(name, "is not a lamplock job file");
  if (bytes.size() < magic.size() + sizeof plain_version + sizeof(std::uint32_t))
    fail(name, "is truncated");
  wire::ByteReader tail(bytes.last(sizeof(std::uint32_t)));
  const auto body = bytes.first(bytes.size() - sizeof(std::uint32_t));
  if (tail.take<std::uint32_t>() != wire::crc32(body)) fail(name, "is truncated or corrupt");
  wire::ByteReader in(body.subspan(magic.size()));
  const auto version = in.take<std::uint16_t>();
  if (version != plain_version && version != glass_version)
    fail(name, fmt::format("has version {}, this program reads {} and {}", version, plain_version,
                           glass_version));
  return {version, in.rest()};
}

void put_glass(wire::ByteWriter& out, const glass::Refraction& refraction) {
  out.put(std::bit_cast<std::uint64_t>(refraction.index));
  out.put(std::bit_cast<std::uint64_t>(refraction.entry_mm));
}

glass::Refraction take_glass(wire::ByteReader& in, const std::string& name) {
  glass::Refraction refraction;
  refraction.index = std::bit_cast<double>(in.take<std::uint64_t>());
  refraction.entry_mm = std::bit_cast<double>(in.take<std::uint64_t>());
  if (!(refraction.index >= 1) || !std::isfinite(refraction.index) ||
      !std::isfinite(refraction.entry_mm))
    fail(name, "has a malformed refraction");
  return refraction;
}

std::vector<wire::Target> decode_targets(std::span<const std::uint8_t> stream,
                                         const wire::JobHeader& header, const std::string& name) {
  std::vector<wire::Target> targets;
  wire::RecordState state;
  state.steps = header.origin_steps;
  const Result result = wire::walk_records(stream, header.axes, state, [&](const auto& record) {
    targets.push_back({record.steps, record.beats, record.shots, record.channel, record.energy});
    return Result::ok;
  });
  if (result != Result::ok || targets.size() != header.points_total)
    fail(name, "has a malformed pulse stream");
  return targets;
}

Rows decode_rows(std::span<const std::uint8_t> stream, const wire::JobHeader& header,
                 const std::string& name) {
  Rows rows;
  std::size_t first_run = 0;
  wire::RowState state;
  state.steps = header.origin_steps;
  const auto take_line = [&](const wire::RowLine& line) {
    rows.lines.push_back({line, first_run, rows.runs.size() - first_run});
    first_run = rows.runs.size();
    return Result::ok;
  };
  const auto take_run = [&](std::uint16_t run) {
    rows.runs.push_back(run);
    return Result::ok;
  };
  const Result result = wire::walk_row_records(stream, header.axes, state, take_line, take_run);
  if (result != Result::ok || state.runs != 0 || rows.lines.size() != header.points_total)
    fail(name, "has a malformed stream of rows");
  return rows;
}

}  // namespace

std::vector<std::uint8_t> encode_job_file(const Job& job) {
  const std::vector<std::uint8_t> stream = encode_records(job);
  if (stream.size() > std::numeric_limits<std::uint32_t>::max())
    fail("job", "is too long for a file");
  wire::JobHeader header = job.header;
  header.settings_hash = job.settings.hash();
  std::array<std::uint8_t, wire::max_job_header_size> header_bytes{};
  wire::ByteWriter header_out(header_bytes);
  wire::write_job_header(header_out, header);

  const bool in_glass = job.refraction.bends();
  std::vector<std::uint8_t> bytes(magic.size() + sizeof plain_version + sizeof(std::uint16_t) +
                                  header_out.size() + sizeof(std::uint32_t) + stream.size() +
                                  (in_glass ? glass_bytes : 0) + sizeof(std::uint32_t));
  wire::ByteWriter out(bytes);
  out.put_bytes(magic);
  out.put(in_glass ? glass_version : plain_version);
  out.put(static_cast<std::uint16_t>(header_out.size()));
  out.put_bytes(header_out.written());
  out.put(static_cast<std::uint32_t>(stream.size()));
  out.put_bytes(stream);
  if (in_glass) put_glass(out, job.refraction);
  out.put(wire::crc32(out.written()));
  return bytes;
}

Job decode_job_file(std::span<const std::uint8_t> bytes, const std::string& name) {
  const Contents contents = open_envelope(bytes, name);
  wire::ByteReader in(contents.bytes);
  const auto header_size = in.take<std::uint16_t>();
  if (!in.ok() || in.left() < header_size) fail(name, "is malformed");
  Job job;
  const Result result = wire::read_job_header(in.rest().first(header_size), job.header);
  if (result == Result::bad_version) fail(name, "was made for another version of the firmware");
  if (result != Result::ok || job.header.first_index != 0) fail(name, "has a malformed header");
  wire::ByteReader rest(in.rest().subspan(header_size));
  const auto stream_size = rest.take<std::uint32_t>();
  const std::size_t tail_size = contents.version == glass_version ? glass_bytes : 0;
  if (!rest.ok() || rest.left() != stream_size + tail_size) fail(name, "is malformed");
  const auto stream = rest.rest().first(stream_size);
  if (tail_size != 0) {
    wire::ByteReader tail(rest.rest().subspan(stream_size));
    job.refraction = take_glass(tail, name);
  }
  job.settings = apply_overrides(settings::Values{}, job.header, name);
  if (job.settings.hash() != job.header.settings_hash)
    fail(name, "was made with a settings table that this program does not have");
  if (job.is_rows())
    job.rows = decode_rows(stream, job.header, name);
  else
    job.targets = decode_targets(stream, job.header, name);
  if (job.size() == 0) fail(name, fmt::format("has no {}s", job.item()));
  return job;
}

bool starts_with_job(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure)) return false;
  std::array<std::uint8_t, magic.size()> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return in && has_magic(bytes);
}

void write_job_file(const std::filesystem::path& file, const Job& job) {
  const std::vector<std::uint8_t> bytes = encode_job_file(job);
  write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Job read_job_file(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  return decode_job_file({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                         file.string());
}

}  // namespace lamplock::job
