// Files of board states and of snapshots of runs. Each input is also read with the SHA-256 that it should end
// with, and with this build's id where the seeds have zeros, or the parser after these checks would hardly be
// reached.

#include "base/error.h"
#include "base/sha256.h"
#include "cosim/resume/run_snapshot.h"
#include "cosim/resume/state_file.h"
#include "tests/fuzz/target.h"

#include <algorithm>
#include <string>
#include <vector>

void puckloop::fuzz::run_input(Input input) {
    std::vector<std::uint8_t> bytes(input.begin(), input.end());
    const std::string zeros(cosim::build_id().size(), '0');
    if (const auto at = std::ranges::search(bytes, zeros); !at.empty())
        std::ranges::copy(cosim::build_id(), at.begin());
    for (int round = 0; round < 2; ++round) {
        try {
            cosim::decode(bytes, "fuzzed.state");
        } catch (const InputError& error) {
            require_refusal(error.what(), "fuzzed.state");
        }
        try {
            cosim::decode_snapshot(bytes, "fuzzed.snap");
        } catch (const InputError& error) {
            require_refusal(error.what(), "fuzzed.snap");
        }
        if (bytes.size() < Sha256{}.size()) return;
        const Sha256 digest = sha256(std::span(bytes).first(bytes.size() - Sha256{}.size()));
        std::copy(digest.begin(), digest.end(), bytes.end() - digest.size());
    }
}
