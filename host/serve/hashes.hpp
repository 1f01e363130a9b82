// Hashes by libsodium: of passwords, and of the style of the page for its policy.
//
// In:  a password, a text. Out: what may be stored or sent. Who: logins, the page, --set-password.
#pragma once

#include <string>
#include <string_view>

namespace lamplock::serve {

inline constexpr std::size_t min_password = 8, max_password = 200;  ///< bytes

/// Argon2id with 64 MB (RFC 9106), as a text with its parameters and a random salt. Takes 0.1 s.
std::string password_hash(std::string_view password);
/// Takes 0.1 s, whatever the password is.
bool is_password(const std::string& hash, std::string_view password);
/// A text that password_hash() has made.
bool is_password_hash(const std::string& text);

/// "sha256-" and Base64, as in a Content-Security-Policy.
std::string policy_hash(std::string_view text);

}  // namespace lamplock::serve
