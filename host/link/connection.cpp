#include "host/link/connection.hpp"

#include <array>
#include <utility>

namespace lamplock::link {

std::vector<std::uint8_t> Connection::encode(const wire::FrameHeader& header,
                                             std::span<const std::uint8_t> payload) {
  std::array<std::uint8_t, wire::max_content> content{};
  wire::ByteWriter writer(content);
  wire::write_header(writer, header);
  writer.put_bytes(payload);
  std::vector<std::uint8_t> frame(wire::max_frame);
  frame.resize(wire::encode_frame(writer.written(), frame));
  return frame;
}

void Connection::send_query(std::uint32_t session, std::uint32_t tag) {
  std::array<std::uint8_t, sizeof wire::protocol_version> payload{};
  wire::ByteWriter writer(payload);
  writer.put(wire::protocol_version);
  send({wire::FrameType::query, session, tag}, payload);
}

void Connection::flush() {
  const std::size_t taken = transport_.write(out_);
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(taken));
}

std::optional<Message> Connection::receive() {
  if (messages_.empty()) read();
  if (messages_.empty()) return std::nullopt;
  Message message = std::move(messages_.front());
  messages_.pop_front();
  return message;
}

bool Connection::reconnect() {
  out_.clear();
  messages_.clear();
  parser_.reset();
  return transport_.reconnect();
}

void Connection::read() {
  constexpr std::size_t piece = 4096;
  std::array<std::uint8_t, piece> bytes{};
  const std::size_t count = transport_.read(bytes);
  parser_.push(std::span<const std::uint8_t>(bytes).first(count), *this);
}

void Connection::on_frame(std::span<const std::uint8_t> content) {
  wire::ByteReader in(content);
  const wire::FrameHeader header = wire::read_header(in);
  wire::Status status;
  if (in.ok() && header.type == wire::FrameType::status &&
      wire::read_status(header, in.rest(), status)) {
    messages_.emplace_back(status);
  } else if (in.ok() && header.type == wire::FrameType::refused &&
             in.left() == wire::refused_size) {
    messages_.emplace_back(RefusedFrame{header.number, wire::read_refused(in)});
  } else {
    ++bad_frames_;
  }
}

}  // namespace lamplock::link
