#pragma once
// Who may ask: whoever knows the token, from a page that this server made, under an address of this machine.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::view {

/// 128 random bits of the system as 32 hexadecimal digits. Throws RunError.
std::string new_token();

/// Why a request is refused.
enum class Refusal : std::uint8_t { Host, Origin, Token, Method, Unknown, Malformed, TooMany };
inline constexpr std::size_t kRefusals = 7;
/// "another host", ...
std::string_view name_of(Refusal refusal);

class Access {
  public:
    Access(std::string token, std::uint16_t port) : token_(std::move(token)), port_(port) {}

    /// A Host other than this server's comes with a name that somebody made point here (DNS rebinding).
    /// `origin`: empty if the request has none.
    std::optional<Refusal> check(std::string_view host, std::string_view origin) const;
    /// What follows the token of "/TOKEN/rest"; nothing for another token. The time does not depend on where
    /// it differs.
    std::optional<std::string_view> rest_of(std::string_view target) const;

  private:
    std::string token_;
    std::uint16_t port_;
};

}  // namespace puckloop::view
