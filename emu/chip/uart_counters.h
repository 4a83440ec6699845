#pragma once

#include <cstdint>

namespace puckloop::chip {

/// What one UART's receiver and transmitter have seen since power-up.
struct UartCounters {
    std::uint64_t sent = 0;
    std::uint64_t received = 0;  ///< characters sampled, those with errors included
    std::uint64_t framing_errors = 0;
    std::uint64_t parity_errors = 0;
    std::uint64_t overruns = 0;  ///< characters lost because the FIFO was full or OERR stood

    template <class Archive>
    void state(Archive& archive) {
        archive(sent, received, framing_errors, parity_errors, overruns);
    }
};

}  // namespace puckloop::chip
