#include "bench/debugger/dap_channel.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>

namespace puckloop::exec::debugger {

namespace {

constexpr std::size_t kLongestMessage = 16u << 20;
constexpr std::size_t kLongestHeader = 4096;
constexpr std::string_view kEnd = "\r\n\r\n", kLength = "Content-Length:";

[[noreturn]] void no_dap(std::string_view problem) {
    throw InputError("dap", "standard input", problem,
                     "messages of the Debug Adapter Protocol, as an editor sends them");
}

}  // namespace

std::optional<std::string> DapReader::next() {
    const std::size_t end = pending_.find(kEnd);
    if (end == std::string::npos) {
        if (pending_.size() > kLongestHeader) no_dap("a header without an end");
        return std::nullopt;
    }
    const std::string_view header = std::string_view(pending_).substr(0, end);
    const std::size_t at = header.find(kLength);
    if (at == std::string_view::npos) no_dap("a header without Content-Length");
    std::size_t first = at + kLength.size();
    while (first < header.size() && header[first] == ' ')
        ++first;
    std::size_t length = 0;
    const auto [stop, error] = std::from_chars(header.data() + first, header.data() + header.size(), length);
    if (error != std::errc{} || length > kLongestMessage ||
        (stop != header.data() + header.size() && *stop != '\r'))
        no_dap("a Content-Length that is no number up to 16777216");
    const std::size_t begin = end + kEnd.size();
    if (pending_.size() - begin < length) return std::nullopt;
    std::string content = pending_.substr(begin, length);
    pending_.erase(0, begin + length);
    return content;
}

bool DapChannel::read_some(bool wait) {
    pollfd poll_for{in_, POLLIN, 0};
    const int ready = ::poll(&poll_for, 1, wait ? -1 : 0);
    if (ready <= 0) return wait && errno == EINTR;
    char bytes[65536];
    const ssize_t got = ::read(in_, bytes, sizeof bytes);
    if (got < 0 && errno == EINTR) return true;
    if (got <= 0) {
        closed_ = true;
        return false;
    }
    reader_.add({bytes, static_cast<std::size_t>(got)});
    return true;
}

std::optional<nlohmann::json> DapChannel::receive(bool wait) {
    while (true) {
        if (const auto content = reader_.next()) {
            nlohmann::json message = nlohmann::json::parse(*content, nullptr, false);
            if (!message.is_object()) no_dap("a message that is no JSON object");
            return message;
        }
        if (closed_ || !read_some(wait)) {
            if (closed_ || !wait) return std::nullopt;
        }
    }
}

void DapChannel::send(const nlohmann::json& message) {
    const std::string content = message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const std::string text = fmt::format("Content-Length: {}\r\n\r\n{}", content.size(), content);
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t wrote = ::write(out_, text.data() + sent, text.size() - sent);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) {
            closed_ = true;  // the editor has gone
            return;
        }
        sent += static_cast<std::size_t>(wrote);
    }
}

}  // namespace puckloop::exec::debugger
