#include "view/server/access.h"

#include "base/error.h"

#include <fmt/format.h>

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace puckloop::view {

std::string new_token() {
    std::array<std::uint8_t, 16> bytes{};
    ::ssize_t got = -1;
    do
        got = ::getrandom(bytes.data(), bytes.size(), 0);
    while (got < 0 && errno == EINTR);
    if (got != static_cast<::ssize_t>(bytes.size()))
        throw RunError(fmt::format("no random token: {}", std::strerror(errno)));
    std::string token;
    for (const std::uint8_t byte : bytes)
        token += fmt::format("{:02x}", byte);
    return token;
}

std::string_view name_of(Refusal refusal) {
    constexpr std::array<std::string_view, kRefusals> kNames{
        "another host",  "another origin",    "a wrong token",       "another method",
        "unknown names", "malformed request", "too many connections"};
    return kNames[static_cast<std::size_t>(refusal)];
}

std::optional<Refusal> Access::check(std::string_view host, std::string_view origin) const {
    const std::string local = fmt::format("127.0.0.1:{}", port_), named = fmt::format("localhost:{}", port_);
    if (host != local && host != named) return Refusal::Host;
    if (!origin.empty() && origin != "http://" + local && origin != "http://" + named) return Refusal::Origin;
    return std::nullopt;
}

std::optional<std::string_view> Access::rest_of(std::string_view target) const {
    const std::size_t length = token_.size() + 2;
    if (target.size() < length || target.front() != '/' || target[length - 1] != '/') return std::nullopt;
    unsigned difference = 0;
    for (std::size_t i = 0; i < token_.size(); ++i)
        difference |= static_cast<unsigned>(static_cast<unsigned char>(target[i + 1] ^ token_[i]));
    if (difference != 0) return std::nullopt;
    return target.substr(length);
}

}  // namespace puckloop::view
