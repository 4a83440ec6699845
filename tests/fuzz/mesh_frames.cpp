// Frames of the radio mesh between XBee modules.

#include "protocols/radio/mesh_frame.h"
#include "tests/fuzz/target.h"

#include <vector>

void puckloop::fuzz::run_input(Input input) {
    using namespace protocols;
    // Few mutations keep the check sequence: each input is also read with the right one.
    std::vector<std::uint8_t> octets(input.begin(), input.end());
    for (int round = 0; round < 2; ++round) {
        const MeshReading reading = decode_mesh(octets);
        if (reading.fault == MeshFault::None)
            require(decode_mesh(encode_mesh(reading.frame)).frame == reading.frame,
                    "a frame encoded is the frame read");
        if (octets.size() < 2) return;
        const std::uint16_t check = fcs_of(std::span(octets).first(octets.size() - 2));
        octets[octets.size() - 2] = static_cast<std::uint8_t>(check);
        octets[octets.size() - 1] = static_cast<std::uint8_t>(check >> 8);
    }
}
