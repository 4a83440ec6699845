#include "cosim/resume/state_file.h"

#include "base/error.h"

#include <fmt/format.h>
#include <nettle/sha2.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

namespace puckloop::cosim {

namespace {

constexpr std::string_view kFirstLine = "puckloop state of boards\n";
constexpr std::size_t kHead = kFirstLine.size() + sizeof kStateFormat;
/// The greatest that is read: eight robots have about ten megabytes.
constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 30;

using Digest = std::array<std::uint8_t, SHA256_DIGEST_SIZE>;

Digest digest_of(std::span<const std::uint8_t> bytes) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes.size(), bytes.data());
    Digest digest{};
    sha256_digest(&context, digest.size(), digest.data());
    return digest;
}

struct Body {
    std::string build;
    std::vector<BoardState> boards;

    template <class Archive>
    void state(Archive& archive) {
        archive(build, boards);
    }
};

}  // namespace

std::vector<std::uint8_t> encode(const StateFile& file) {
    std::vector<std::uint8_t> bytes(kFirstLine.begin(), kFirstLine.end());
    StateWriter writer(bytes);
    writer(kStateFormat, Body{file.build, file.boards});
    const Digest digest = digest_of(bytes);
    bytes.insert(bytes.end(), digest.begin(), digest.end());
    return bytes;
}

StateFile decode(std::span<const std::uint8_t> bytes, const std::string& name) {
    const std::string expected = "a file written by --save-state";
    if (bytes.size() < kHead || !std::equal(kFirstLine.begin(), kFirstLine.end(), bytes.begin()))
        throw InputError(name, "", "is no state file", expected);
    std::uint32_t format = 0;
    try {
        StateReader(bytes.subspan(kFirstLine.size()))(format);
        if (format != kStateFormat)
            throw InputError(name, "", fmt::format("a state of format {}, from another version", format),
                             fmt::format("format {}: save it again", kStateFormat));
        if (bytes.size() < kHead + SHA256_DIGEST_SIZE) throw InputError(name, "", "is cut short", expected);
        const auto content = bytes.first(bytes.size() - SHA256_DIGEST_SIZE);
        const Digest digest = digest_of(content);
        if (!std::equal(digest.begin(), digest.end(), bytes.end() - SHA256_DIGEST_SIZE))
            throw InputError(name, "", "is damaged: its checksum is another", expected);
        StateReader reader(content.subspan(kHead));
        Body body;
        reader(body);
        reader.end();
        return {std::move(body.build), std::move(body.boards)};
    } catch (const StateError& error) {
        throw InputError(name, "", error.what(), expected);
    }
}

StateFile read_state_file(const std::filesystem::path& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) throw InputError(path.string(), "", "cannot be read: " + error.message());
    if (size > kLargest) throw InputError(path.string(), "", "is too large for a state file");
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
    if (!in && !in.eof()) throw InputError(path.string(), "", "cannot be read");
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    return decode(bytes, path.string());
}

void write_state_file(const std::filesystem::path& path, const StateFile& file) {
    const auto fail = [&](int cause) {
        throw RunError(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(cause)));
    };
    std::string part = path.string() + ".XXXXXX";
    const int descriptor = mkostemp(part.data(), O_CLOEXEC);  // mode 0600
    if (descriptor < 0) fail(errno);
    const std::vector<std::uint8_t> bytes = encode(file);
    int cause = 0;
    for (std::size_t done = 0; done < bytes.size() && cause == 0;) {
        const auto count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
        if (count > 0)
            done += static_cast<std::size_t>(count);
        else if (errno != EINTR)
            cause = errno;
    }
    if (::close(descriptor) != 0 && cause == 0) cause = errno;
    if (cause == 0 && std::rename(part.c_str(), path.c_str()) != 0) cause = errno;
    if (cause == 0) return;
    ::unlink(part.c_str());
    fail(cause);
}

}  // namespace puckloop::cosim
