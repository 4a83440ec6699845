// Inputs for a firmware on the host: from libFuzzer, from files, or drawn at random from a seed.
//
//     NAME_hosted [--seed N] [--inputs N] [FILE...]

#include "firmware/host/input.h"
#include "firmware/host/memory.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    hosted::restore_memory();
    hosted::run_input({data, size});
    return 0;
}

#ifndef HOSTED_BY_LIBFUZZER

namespace {

constexpr std::size_t kLongest = 96;  // bytes of a drawn input

std::vector<std::uint8_t> drawn(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bytes(random() % kLongest);
    for (std::uint8_t& byte : bytes)
        byte = static_cast<std::uint8_t>(random());
    return bytes;
}

/// Runs it, and prints what came out. Twice where `again`: both runs have to be the same.
void run(const std::vector<std::uint8_t>& bytes, const std::string& name, bool again) {
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    const hosted::Seen first = hosted::seen();
    std::printf("%s: %016llx %llu characters %llu others\n", name.c_str(),
                static_cast<unsigned long long>(first.hash),
                static_cast<unsigned long long>(first.bytes_sent),
                static_cast<unsigned long long>(first.other));
    std::fflush(stdout);
    if (!again) return;
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    if (hosted::seen().hash == first.hash) return;
    std::fprintf(stderr, "ERROR: %s: the second run of one input differs from the first\n", name.c_str());
    std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
    std::uint64_t seed = 1, inputs = 0;
    std::vector<std::string> files;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (i + 1 < argc && argument == "--seed")
            seed = std::strtoull(argv[++i], nullptr, 10);
        else if (i + 1 < argc && argument == "--inputs")
            inputs = std::strtoull(argv[++i], nullptr, 10);
        else
            files.push_back(argument);
    }
    for (const std::string& file : files) {
        std::ifstream in(file, std::ios::binary);
        if (!in) {
            std::fprintf(stderr, "puckloop: %s: cannot be read\n", file.c_str());
            return 2;
        }
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
        run(bytes, file, true);
    }
    for (std::uint64_t i = 0; i < inputs; ++i)
        run(drawn(seed + i), "seed " + std::to_string(seed + i), i == 0);
    return 0;
}

#endif
