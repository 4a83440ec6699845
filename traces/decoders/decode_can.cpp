// CAN frames, once each, as they were reported to their senders.

#include "traces/decoders/decoders.h"

#include <fmt/format.h>

namespace puckloop::tools {

void decode_can(const cosim::TraceRow& row, const CanOnBus& seen, const TakeFrame& take) {
    DecodedFrame frame{seen.start, seen.end(), row.link, seen.sender, "can", seen.text(), {}};
    frame.fields = {{"bus", seen.bus},
                    {"id", seen.frame.id},
                    {"extended", seen.frame.extended},
                    {"remote", seen.frame.remote},
                    {"length", seen.frame.length}};
    if (seen.error != protocols::CanError::None) frame.errors.push_back(seen.error_text());
    take(frame);
}

}  // namespace puckloop::tools
