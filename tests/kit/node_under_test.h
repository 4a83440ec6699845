#pragma once
// What the tests of board nodes share: a small program as an image, grants cut at random, a log read once.

#include "base/random.h"
#include "cosim/core/time.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/devices/device.h"
#include "emu/image/image.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace puckloop::tests {

/// `source` behind a reset vector to `main`, with the device's register names known.
inline image::Image assembled(const dspic::DeviceInfo& device, const std::string& source) {
    dspic::AssembleOptions options;
    for (const dspic::RegisterInfo& info : device.registers)
        options.predefined[std::string(info.name)] = info.address;
    image::Image image;
    image.file = "test.s";
    image.program = dspic::assemble("        goto main\n" + source, options).words;
    return image;
}

/// Grants up to `end` that end anywhere, none longer than `longest`.
inline std::vector<cosim::Time> random_cuts(RandomStream& random, cosim::Time longest, cosim::Time end) {
    std::vector<cosim::Time> cuts;
    for (cosim::Time at = 0; at < end;) {
        at += 1 + static_cast<cosim::Time>(random.below(static_cast<std::uint64_t>(longest)));
        cuts.push_back(std::min(at, end));
    }
    return cuts;
}

/// The file's text; the file is removed.
inline std::string contents(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::filesystem::remove(file);
    return text.str();
}

}  // namespace puckloop::tests
