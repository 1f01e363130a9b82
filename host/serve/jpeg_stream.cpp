#include "host/serve/jpeg_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "host/error.hpp"
#include "host/letter_case.hpp"
#include "host/text.hpp"

namespace lamplock::serve {
namespace {

constexpr std::size_t max_head_bytes = 8 * 1024;
constexpr std::string_view end_of_head = "\r\n\r\n", end_of_line = "\r\n";

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
  throw Error(Exit::bad_input, "camera", what, remedy);
}

[[noreturn]] void refuse_size() {
  refuse("sends a picture that is too large", "choose a smaller picture at the camera");
}

/// The value of a header; empty if it is not there.
std::string_view value_of(std::string_view head, std::string_view name) {
  while (!head.empty()) {
    const std::string_view line = head.substr(0, head.find(end_of_line));
    head.remove_prefix(std::min(line.size() + end_of_line.size(), head.size()));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || in_lower_case(line.substr(0, colon)) != name) continue;
    return trimmed(line.substr(colon + 1));
  }
  return {};
}

std::optional<std::size_t> length_in(std::string_view head) {
  const std::string_view text = value_of(head, "content-length");
  if (text.empty()) return std::nullopt;
  std::size_t length = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (error == std::errc::result_out_of_range || length > max_picture_bytes) refuse_size();
  if (error != std::errc() || end != text.data() + text.size())
    refuse("sends a Content-Length that is not a number", "check its address");
  return length;
}

/// "--NAME" of `multipart/x-mixed-replace; boundary=NAME`.
std::string boundary_in(std::string_view type) {
  constexpr std::string_view key = "boundary=";
  const std::size_t at = in_lower_case(type).find(key);
  if (at == std::string::npos)
    refuse("sends a stream without a boundary", "give the address of an MJPEG stream");
  std::string_view name = type.substr(at + key.size());
  name = name.substr(0, name.find(';'));
  if (name.size() > 1 && name.front() == '"') name = name.substr(1, name.find('"', 1) - 1);
  // Some cameras give the name with the hyphens before it.
  return name.starts_with("--") ? std::string(name) : "--" + std::string(name);
}

std::string checked(std::string picture) {
  if (picture.size() > max_picture_bytes) refuse_size();
  // Some cameras fill the end of a picture with zeros.
  while (!picture.empty() && picture.back() == '\0') picture.pop_back();
  if (!is_jpeg(picture))
    refuse("sends a picture that is not a JPEG",
           "give the address of a JPEG picture or of an MJPEG stream");
  return picture;
}

}  // namespace

bool is_jpeg(std::string_view bytes) {
  return bytes.size() > 4 && bytes.starts_with("\xFF\xD8\xFF") && bytes.ends_with("\xFF\xD9");
}

std::vector<std::string> JpegStream::take(std::string_view bytes) {
  std::vector<std::string> pictures;
  rest_ += bytes;
  for (bool goes = true; goes;) {
    switch (state_) {
      case State::head:
        goes = take_head();
        break;
      case State::part_head:
        goes = take_part_head();
        break;
      case State::picture:
        goes = take_picture(pictures);
        break;
      case State::over:
        rest_.clear();
        goes = false;
    }
  }
  return pictures;
}

std::optional<std::string> JpegStream::close() {
  const bool is_whole = state_ == State::picture && boundary_.empty() && !length_;
  state_ = State::over;
  if (!is_whole) return std::nullopt;
  return checked(std::move(rest_));
}

bool JpegStream::take_head() {
  const std::size_t end = rest_.find(end_of_head);
  if (end == std::string::npos) {
    if (rest_.size() > max_head_bytes) refuse("does not answer in HTTP", "check its address");
    return false;
  }
  const std::string head = rest_.substr(0, end + end_of_line.size());
  rest_.erase(0, end + end_of_head.size());
  const std::size_t status = head.find(' ');
  if (!head.starts_with("HTTP/1.") || status == std::string::npos)
    refuse("does not answer in HTTP", "check its address");
  if (head.compare(status + 1, 3, "200") != 0)
    refuse(fmt::format("refuses the request: {}", head.substr(0, head.find(end_of_line))),
           "check its address");
  if (!value_of(head, "transfer-encoding").empty())
    refuse("sends its answer in chunks, which is not supported",
           "give the address of a stream without chunks, for example of ustreamer");
  const std::string_view type = value_of(head, "content-type");
  const std::string lower = in_lower_case(type);
  if (lower.starts_with("multipart/")) {
    boundary_ = boundary_in(type);
    state_ = State::part_head;
  } else if (lower.starts_with("image/jpeg")) {
    length_ = length_in(head);
    state_ = State::picture;
  } else {
    refuse("sends neither image/jpeg nor an MJPEG stream", "give the address of one of them");
  }
  return true;
}

bool JpegStream::take_part_head() {
  const std::size_t end = rest_.find(end_of_head);
  if (end == std::string::npos) {
    if (rest_.size() > max_head_bytes) refuse("sends a broken stream", "check its address");
    return false;
  }
  if (rest_.find(boundary_) > end) refuse("sends a broken stream", "check its address");
  length_ = length_in(std::string_view(rest_).substr(0, end + end_of_line.size()));
  rest_.erase(0, end + end_of_head.size());
  state_ = State::picture;
  return true;
}

bool JpegStream::take_picture(std::vector<std::string>& pictures) {
  std::size_t end = length_.value_or(std::string::npos);
  if (!length_ && !boundary_.empty()) {
    const std::string edge = "\r\n" + boundary_;
    end = rest_.find(edge, searched_);
    searched_ = rest_.size() - std::min(rest_.size(), edge.size());
  }
  if (end == std::string::npos || rest_.size() < end) {
    if (rest_.size() > max_picture_bytes + max_head_bytes) refuse_size();
    return false;
  }
  pictures.push_back(checked(rest_.substr(0, end)));
  rest_.erase(0, end);
  searched_ = 0;
  state_ = boundary_.empty() ? State::over : State::part_head;
  return true;
}

}  // namespace lamplock::serve
