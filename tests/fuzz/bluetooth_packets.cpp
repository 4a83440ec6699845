// Packets of the LMX9820 Bluetooth module. One that is taken comes back as it was sent.

#include "protocols/radio/lmx9820_packet.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    using namespace protocols;
    LmxReader reader;
    for (const std::uint8_t byte : input) {
        const auto reading = reader.take(byte);
        if (!reading) continue;
        to_text(reading->packet);
        if (!reading->ok()) continue;
        LmxReader again;
        std::optional<LmxReading> back;
        for (const std::uint8_t octet : encode_lmx(reading->packet))
            back = again.take(octet);
        require(back && back->ok() && back->packet == reading->packet, "a packet encoded is the packet read");
    }
}
