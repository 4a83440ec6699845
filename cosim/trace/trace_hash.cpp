#include "cosim/trace/trace_hash.h"

#include "base/states/archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

namespace puckloop::cosim {

namespace {
constexpr std::string_view kHead = "puckloop trace 1\n";
constexpr std::size_t kChunk = 16384;

template <class Archive>
void list(Archive& archive, sha256_ctx& context) {
    for (std::uint32_t& word : context.state)
        archive(word);
    archive(context.count);
    archive.bounded(context.index, 0, SHA256_BLOCK_SIZE - 1);
    for (std::uint8_t& byte : context.block)
        archive(byte);
}
}  // namespace

TraceHash::TraceHash() {
    sha256_init(&context_);
}

void TraceHash::begin(const std::vector<LinkSpec>& links) {
    ByteWriter writer(buffer_);
    const auto last = std::ranges::find(links, false, &LinkSpec::hashed_when_unused);
    writer.text(kHead);
    writer.u32(static_cast<std::uint32_t>(last - links.begin()));
    for (const LinkSpec& link : std::span(links.begin(), last))
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

std::vector<std::uint8_t> TraceHash::save() {
    drain();
    std::fill(std::begin(context_.block) + context_.index, std::end(context_.block),
              std::uint8_t{0});  // of old
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    list(writer, context_);
    return bytes;
}

void TraceHash::load(const std::vector<std::uint8_t>& saved) {
    StateReader reader(saved);
    list(reader, context_);
    reader.end();
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
