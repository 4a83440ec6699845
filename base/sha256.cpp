#include "base/sha256.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nettle/sha2.h>

#include <cstring>
#include <fstream>

namespace puckloop {

namespace {

static_assert(std::tuple_size_v<Sha256> == SHA256_DIGEST_SIZE);

Sha256 digest_of(sha256_ctx& context) {
    Sha256 digest{};
    sha256_digest(&context, digest.size(), digest.data());
    return digest;
}

std::string text_of(const Sha256& digest) {
    return fmt::format("{:02x}", fmt::join(digest, ""));
}

}  // namespace

Sha256 sha256(std::span<const std::uint8_t> bytes) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes.size(), bytes.data());
    return digest_of(context);
}

std::string sha256_text(std::span<const std::uint8_t> bytes) {
    return text_of(sha256(bytes));
}

std::string sha256_text(std::string_view bytes) {
    return sha256_text({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::string sha256_of_file(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    sha256_ctx context;
    sha256_init(&context);
    std::array<char, 65536> buffer{};
    std::array<std::uint8_t, 65536> bytes{};
    while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
        const auto count = static_cast<std::size_t>(in.gcount());
        std::memcpy(bytes.data(), buffer.data(), count);
        sha256_update(&context, count, bytes.data());
    }
    return text_of(digest_of(context));
}

}  // namespace puckloop
