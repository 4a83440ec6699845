// API frames of the XBee module, both modes, and their meaning. A frame that is taken comes back as it was
// sent.

#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    using namespace protocols;
    for (const XBeeApiMode mode : {XBeeApiMode::Plain, XBeeApiMode::Escaped}) {
        XBeeReader reader(mode);
        for (const std::uint8_t byte : input) {
            const auto reading = reader.take(byte);
            if (!reading) continue;
            explain(*reading);
            if (!reading->ok()) continue;
            decode_xbee(reading->data);
            XBeeReader again(mode);
            std::optional<XBeeReading> back;
            for (const std::uint8_t octet : encode_xbee(reading->data, mode))
                back = again.take(octet);
            require(back && back->ok() && back->data == reading->data, "a frame encoded is the frame read");
        }
    }
}
