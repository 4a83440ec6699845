#include "cosim/trace/trace_hash.h"

#include <fmt/format.h>

#include <array>

namespace puckloop::cosim {

namespace {
constexpr std::string_view kHead = "puckloop trace 1\n";
constexpr std::size_t kChunk = 16384;
}  // namespace

TraceHash::TraceHash() {
    sha256_init(&context_);
}

void TraceHash::begin(const std::vector<LinkSpec>& links) {
    ByteWriter writer(buffer_);
    writer.text(kHead);
    writer.u32(static_cast<std::uint32_t>(links.size()));
    for (const LinkSpec& link : links)
        for (const std::string& text : {link.name, link.a.node, link.a.port, link.b.node, link.b.port})
            writer.text(text);
}

void TraceHash::record(const TraceRecord& record) {
    ByteWriter writer(buffer_);
    writer.time(record.time);
    writer.u16(record.link);
    writer.u8(static_cast<std::uint8_t>(record.direction));
    writer.u8(static_cast<std::uint8_t>(record.fault));
    writer.payload(record.payload);
    if (buffer_.size() >= kChunk) drain();
}

void TraceHash::drain() {
    sha256_update(&context_, buffer_.size(), buffer_.data());
    buffer_.clear();
}

std::string TraceHash::finish() {
    drain();
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    sha256_digest(&context_, digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t byte : digest)
        text += fmt::format("{:02x}", byte);
    return text;
}

}  // namespace puckloop::cosim
