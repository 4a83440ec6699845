// Seeded mutations of valid images: every one must load or be refused with an InputError that names the file.

#include "base/error.h"
#include "base/random.h"
#include "emu/image/image.h"
#include "tests/image/build_images.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::image;
using namespace puckloop::image::testing;

namespace {

constexpr int kMutationsPerFormat = 6000;

std::string mutate(std::string bytes, RandomStream& random) {
    const auto any_place = [&] { return static_cast<std::size_t>(random.below(bytes.size())); };
    const auto changes = 1 + random.below(4);
    for (std::uint64_t i = 0; i < changes && !bytes.empty(); ++i) {
        switch (random.below(6)) {
        case 0:  // one bit
            bytes[any_place()] ^= static_cast<char>(1 << random.below(8));
            break;
        case 1:  // one byte
            bytes[any_place()] = static_cast<char>(random.below(256));
            break;
        case 2:  // a 32-bit field made huge
            for (std::size_t at = any_place() & ~std::size_t{3}, n = 0; n < 4 && at + n < bytes.size(); ++n)
                bytes[at + n] = static_cast<char>(random.below(2) ? 0xFF : 0x7F);
            break;
        case 3:  // cut
            bytes.resize(any_place());
            break;
        case 4:  // remove a piece
            bytes.erase(any_place(), random.below(40));
            break;
        default:  // repeat a piece
            const std::string piece = bytes.substr(any_place(), random.below(60));
            bytes.insert(any_place(), piece);
        }
    }
    return bytes;
}

void run(const std::string& name, const std::string& valid) {
    RandomStream random(1, "image mutation " + name);
    int loaded = 0;
    int refused = 0;
    for (int i = 0; i < kMutationsPerFormat; ++i) {
        try {
            const Image image = parse_image(mutate(valid, random), name);
            ++loaded;
        } catch (const InputError& error) {
            ++refused;
            if (error.file() != name) FAIL("the message does not name the file: " << error.what());
        }
    }
    CHECK(refused > kMutationsPerFormat / 4);  // the mutations bite
    CHECK(loaded > 0);
}

}  // namespace

TEST_CASE("Mutated HEX images load or are refused") {
    run("hex", hex_image());
}
TEST_CASE("Mutated ELF images load or are refused") {
    run("elf", elf_image());
}
TEST_CASE("Mutated COFF images load or are refused") {
    run("coff", coff_image());
}
