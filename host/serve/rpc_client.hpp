// A program of the server's interface (docs/api.md), by POST.
//
// In:  the address of the page, as `serve` prints it; methods. Out: their results.
// Who: `watch`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

namespace lamplock::serve {

/// Host, port and token in "http://127.0.0.1:7125/#token=0123...".
struct PageAddress {
  std::string host, port, token;
};

/// Throws Error(bad_input).
PageAddress parse_page_address(const std::string& text);

class RpcClient {
 public:
  explicit RpcClient(PageAddress address) : address_(std::move(address)) {}

  /// Waits 5 s at most. Throws Error: no_device (no server, a wrong token), job_failed (the method
  /// has failed).
  nlohmann::json call(const std::string& method, const nlohmann::json& parameters);

 private:
  PageAddress address_;
  int last_id_ = 0;
};

}  // namespace lamplock::serve
