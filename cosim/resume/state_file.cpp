#include "cosim/resume/state_file.h"

#include "base/error.h"
#include "cosim/resume/sealed_file.h"

namespace puckloop::cosim {

namespace {

/// The greatest that is read: eight robots have about ten megabytes.
constexpr SealedKind kStateFileKind{
    "puckloop state of boards\n",     kStateFormat,           "state file", "state",
    "a file written by --save-state", std::uintmax_t{1} << 30};

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
    std::vector<std::uint8_t> content;
    StateWriter{content}(Body{file.build, file.boards});
    return seal(kStateFileKind, content);
}

StateFile decode(std::span<const std::uint8_t> bytes, const std::string& name) {
    const auto content = unseal(kStateFileKind, bytes, name);
    try {
        StateReader reader(content);
        Body body;
        reader(body);
        reader.end();
        return {std::move(body.build), std::move(body.boards)};
    } catch (const StateError& error) {
        throw InputError(name, "", error.what(), std::string(kStateFileKind.expected));
    }
}

StateFile read_state_file(const std::filesystem::path& path) {
    return decode(read_sealed(kStateFileKind, path), path.string());
}

void write_state_file(const std::filesystem::path& path, const StateFile& file) {
    write_whole(path, encode(file));
}

}  // namespace puckloop::cosim
