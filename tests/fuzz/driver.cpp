// Runs a fuzz target on its seeds and on mutations of them:
//
//     fuzz_NAME [--seed N] [--inputs N | --seconds S] [FILE | FOLDER]...
//
// An input that ends the program is in the file fuzz_NAME.input of the working folder, which is written
// before each run and removed at the end; given as FILE it brings the failure back.

#include "base/random.h"
#include "tests/fuzz/target.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace puckloop::fuzz {

namespace {

constexpr std::size_t kLongest = 1 << 16;  // bytes of a mutated input

using Octets = std::vector<std::uint8_t>;

/// Values at which lengths and counts go wrong.
constexpr std::array<std::uint64_t, 10> kEdges = {0,           1,           0x7F,        0x80,       0xFF,
                                                  0x7FFF'FFFF, 0x8000'0000, 0xFFFF'FFFF, 1ULL << 63, ~0ULL};

void mutate_once(Octets& bytes, const std::vector<Octets>& seeds, RandomStream& random) {
    const auto place = [&] {
        return bytes.empty() ? 0 : static_cast<std::size_t>(random.below(bytes.size()));
    };
    const auto at = [&](std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); };
    switch (random.below(8)) {
    case 0:
        if (!bytes.empty()) bytes[place()] ^= static_cast<std::uint8_t>(1U << random.below(8));
        break;
    case 1:
        if (!bytes.empty()) bytes[place()] = static_cast<std::uint8_t>(random.below(256));
        break;
    case 2: {  // a number of 1, 2, 4 or 8 bytes becomes one of the edges
        const std::size_t from = place();
        const std::uint64_t edge = kEdges[random.below(kEdges.size())];
        const std::size_t width = std::size_t{1} << random.below(4);
        for (std::size_t i = 0; i < width && from + i < bytes.size(); ++i)
            bytes[from + i] = static_cast<std::uint8_t>(edge >> (8 * i));
        break;
    }
    case 3:
        bytes.resize(place());
        break;
    case 4: {  // a piece leaves
        const std::size_t from = place();
        const std::size_t length = std::min<std::size_t>(random.below(64), bytes.size() - from);
        bytes.erase(at(from), at(from + length));
        break;
    }
    case 5: {  // a piece comes twice
        const std::size_t from = place();
        const std::size_t length = std::min<std::size_t>(random.below(64), bytes.size() - from);
        const Octets piece(at(from), at(from + length));
        bytes.insert(at(place()), piece.begin(), piece.end());
        break;
    }
    case 6: {  // a piece of another seed
        const Octets& other = seeds[random.below(seeds.size())];
        if (other.empty()) break;
        const std::size_t from = random.below(other.size());
        const std::size_t length = std::min<std::size_t>(1 + random.below(200), other.size() - from);
        bytes.insert(at(place()), other.begin() + static_cast<std::ptrdiff_t>(from),
                     other.begin() + static_cast<std::ptrdiff_t>(from + length));
        break;
    }
    default:
        bytes.insert(at(place()), static_cast<std::size_t>(1 + random.below(40)),
                     static_cast<std::uint8_t>(random.below(256)));
    }
    if (bytes.size() > kLongest) bytes.resize(kLongest);
}

/// Keeps the input that is on, so that it is there when the program ends by a signal. Memory shared with the
/// file: nothing is written to the disk for each input.
class KeptInput {
  public:
    explicit KeptInput(std::string path) : path_(std::move(path)) {
        const int descriptor = ::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW, 0600);
        require(descriptor >= 0 && ::ftruncate(descriptor, kSize) == 0, "a file for the input that is on");
        memory_ = static_cast<std::uint8_t*>(
            ::mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0));
        ::close(descriptor);
        require(memory_ != MAP_FAILED, "memory for the input that is on");
    }
    void keep(Input input) {
        const std::uint64_t size = input.size();
        std::memcpy(memory_, &size, sizeof size);
        std::copy(input.begin(), input.end(), memory_ + sizeof size);
    }
    void remove() { ::unlink(path_.c_str()); }

    /// What `bytes` of such a file hold; the bytes themselves of any other file.
    static Octets content(const fs::path& file, Octets bytes) {
        if (file.extension() != ".input" || bytes.size() != kSize) return bytes;
        std::uint64_t size = 0;
        std::memcpy(&size, bytes.data(), sizeof size);
        size = std::min<std::uint64_t>(size, kSize - sizeof size);
        return {bytes.begin() + sizeof size, bytes.begin() + static_cast<std::ptrdiff_t>(sizeof size + size)};
    }

  private:
    static constexpr std::size_t kSize = 2 * kLongest + 8;
    std::string path_;
    std::uint8_t* memory_ = nullptr;
};

int refuse(const std::string& message) {
    std::fprintf(stderr, "puckloop: %s\n", message.c_str());
    return 2;
}

int run(int argc, char** argv) {
    std::uint64_t seed = 1, inputs = 0;
    double seconds = 0.0;
    std::vector<fs::path> files;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (i + 1 < argc && argument == "--seed") {
            seed = std::strtoull(argv[++i], nullptr, 10);
        } else if (i + 1 < argc && argument == "--inputs") {
            inputs = std::strtoull(argv[++i], nullptr, 10);
        } else if (i + 1 < argc && argument == "--seconds") {
            seconds = std::strtod(argv[++i], nullptr);
        } else if (argument.starts_with("-")) {
            return refuse("unknown option " + argument);
        } else if (fs::is_directory(argument)) {
            for (const auto& entry : fs::directory_iterator(argument))
                files.push_back(entry.path());
        } else {
            files.emplace_back(argument);
        }
    }
    std::ranges::sort(files);
    std::vector<Octets> seeds;
    for (const fs::path& file : files) {
        std::ifstream in(file, std::ios::binary);
        if (!in) return refuse(file.string() + ": cannot be read");
        seeds.push_back(KeptInput::content(file, {std::istreambuf_iterator<char>(in), {}}));
    }
    if (seeds.empty()) return refuse("give at least one seed");

    const fs::path program = *argv;
    KeptInput kept(program.filename().string() + ".input");
    for (const Octets& bytes : seeds) {
        kept.keep(Input(bytes).first(std::min(bytes.size(), 2 * kLongest)));
        run_input(bytes);
    }
    RandomStream random(seed, "fuzz");
    const auto start = std::chrono::steady_clock::now();
    const auto over = [&](std::uint64_t count) {
        if (seconds > 0.0 && count % 64 == 0)
            return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds;
        return seconds <= 0.0 && count >= inputs;
    };
    std::uint64_t count = 0;
    for (; !over(count); ++count) {
        Octets bytes = seeds[random.below(seeds.size())];
        for (std::uint64_t change = 1 + random.below(5); change > 0; --change)
            mutate_once(bytes, seeds, random);
        kept.keep(bytes);
        run_input(bytes);
    }
    kept.remove();
    std::printf("%zu seeds and %llu mutations of them: no failure\n", seeds.size(),
                static_cast<unsigned long long>(count));
    return 0;
}

}  // namespace

}  // namespace puckloop::fuzz

int main(int argc, char** argv) {
    return puckloop::fuzz::run(argc, argv);
}
