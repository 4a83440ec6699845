// A node process for tests: serves toy nodes, or misbehaves in the shared memory as its arguments say.

#include "base/random.h"
#include "cosim/remote/processes/node_processes.h"
#include "cosim/remote/processes/node_server.h"
#include "cosim/remote/protocol.h"
#include "toy_nodes.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <thread>

#include <unistd.h>

namespace {

using namespace puckloop;
using namespace puckloop::cosim;

/// Beside the node's work writes anything anywhere into what it shares with the conductor, positions above
/// all.
[[noreturn]] void write_nonsense(SharedMemory& memory, std::uint64_t seed) {
    auto& shared = *reinterpret_cast<SharedWithNode*>(memory.data());
    RandomStream random(seed, "nonsense");
    std::this_thread::sleep_for(std::chrono::microseconds(random.below(30'000)));
    while (true) {
        RingState& ring = random.below(3) == 0 ? shared.to_node : shared.from_node;
        switch (random.below(6)) {
        case 0:
            ring.written += random.below(100);
            break;
        case 1:
            ring.written = random.next() >> random.below(64);
            break;
        case 2:
            ring.read = random.next() >> random.below(64);
            break;
        case 3:
            memory.data()[random.below(sizeof shared)] = static_cast<std::byte>(random.next());
            break;
        case 4:
            shared.node.rings = static_cast<std::uint32_t>(random.next());
            break;
        default:
            std::memset(ring.bytes + random.below(RingState::kCapacity - 64),
                        static_cast<int>(random.below(256)), 64);
        }
        std::this_thread::sleep_for(std::chrono::microseconds(random.below(300)));
    }
}

/// The same in what all processes of the run share: who sleeps, who works, on which core.
[[noreturn]] void write_nonsense_for_all(SharedMemory& memory, std::uint64_t seed) {
    RandomStream random(seed, "nonsense for all");
    while (true) {
        const std::size_t word = random.below(sizeof(SharedByRun) / 4);
        auto& target = *reinterpret_cast<std::atomic<std::uint32_t>*>(memory.data() + 4 * word);
        target = static_cast<std::uint32_t>(random.next() >> random.below(64));
        std::this_thread::sleep_for(std::chrono::microseconds(random.below(300)));
    }
}

/// The name of the node that this process is started for.
std::string node_name(const char* title) {
    const std::string text = title;
    return text.substr(std::min(text.size(), text.rfind(' ') + 1));
}

}  // namespace

int main(int argc, char** argv) {
    const std::string mode = argc > 1 ? argv[1] : "node";
    if (mode == "garbage") {
        const char text[] = "this is no message at all, whoever reads it";
        if (write(protocol::kDescriptor, text, sizeof text) < 0) return 1;
        pause();
    }
    if (mode == "silent") pause();
    if (mode == "exit") return 5;
    // node NAME SEED: the process of node NAME writes nonsense; NAME SEED all: where all processes see it.
    if (argc > 3 && node_name(argv[0]) == argv[2]) {
        const bool all = argc > 4;
        // Never given back: the thread writes until the process has ended.
        static auto* const memory = new SharedMemory(dup(protocol::kDescriptor + (all ? 1 : 0)),
                                                     all ? sizeof(SharedByRun) : sizeof(SharedWithNode));
        std::thread(all ? write_nonsense_for_all : write_nonsense, std::ref(*memory),
                    std::strtoull(argv[3], nullptr, 10))
            .detach();
    }
    return serve_node(protocol::kDescriptor, toy::make);
}
