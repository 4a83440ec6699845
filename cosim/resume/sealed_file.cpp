#include "cosim/resume/sealed_file.h"

#include "base/error.h"
#include "base/sha256.h"
#include "base/states/archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <unistd.h>

namespace puckloop::cosim {

std::vector<std::uint8_t> seal(const SealedKind& kind, std::span<const std::uint8_t> content) {
    std::vector<std::uint8_t> bytes(kind.first_line.begin(), kind.first_line.end());
    StateWriter{bytes}(kind.format);
    bytes.insert(bytes.end(), content.begin(), content.end());
    const Sha256 digest = sha256(bytes);
    bytes.insert(bytes.end(), digest.begin(), digest.end());
    return bytes;
}

std::span<const std::uint8_t> unseal(const SealedKind& kind, std::span<const std::uint8_t> bytes,
                                     const std::string& name) {
    const std::string expected(kind.expected);
    const std::size_t head = kind.first_line.size() + sizeof kind.format;
    if (bytes.size() < head || !std::equal(kind.first_line.begin(), kind.first_line.end(), bytes.begin()))
        throw InputError(name, "", fmt::format("is no {}", kind.file), expected);
    std::uint32_t format = 0;
    StateReader{bytes.subspan(kind.first_line.size())}(format);
    if (format != kind.format)
        throw InputError(name, "",
                         fmt::format("a {} of format {}, from another version", kind.content, format),
                         fmt::format("format {}: save it again", kind.format));
    if (bytes.size() < head + std::tuple_size_v<Sha256>) throw InputError(name, "", "is cut short", expected);
    const auto sealed = bytes.first(bytes.size() - std::tuple_size_v<Sha256>);
    const Sha256 digest = sha256(sealed);
    if (!std::equal(digest.begin(), digest.end(), bytes.end() - digest.size()))
        throw InputError(name, "", "is damaged: its checksum is another", expected);
    return sealed.subspan(head);
}

std::vector<std::uint8_t> read_sealed(const SealedKind& kind, const std::filesystem::path& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) throw InputError(path.string(), "", "cannot be read: " + error.message());
    if (size > kind.largest)
        throw InputError(path.string(), "", fmt::format("is too large for a {}", kind.file));
    std::ifstream in(path, std::ios::binary);
    std::vector<std::uint8_t> bytes;
    try {
        bytes.resize(static_cast<std::size_t>(size));
    } catch (const std::bad_alloc&) {
        throw InputError(path.string(), "", "needs more memory than there is", std::string(kind.expected));
    }
    // NOLINTNEXTLINE: a stream reads characters
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in && !in.eof()) throw InputError(path.string(), "", "cannot be read");
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    return bytes;
}

void write_whole(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
    const auto fail = [&](int cause) {
        throw RunError(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(cause)));
    };
    std::string part = path.string() + ".XXXXXX";
    const int descriptor = mkostemp(part.data(), O_CLOEXEC);  // mode 0600
    if (descriptor < 0) fail(errno);
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
