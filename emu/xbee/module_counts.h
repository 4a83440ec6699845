#pragma once
// What a module counts for the run's report.

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace puckloop::xbee {

struct ModuleCounts {
    // Serial line.
    std::uint64_t bytes_in = 0;
    std::uint64_t framing_errors = 0;
    std::uint64_t overflow = 0;    ///< bytes that the serial receive buffer had no room for
    std::uint64_t while_down = 0;  ///< bytes that came while the module was off, in reset or starting
    std::uint64_t frames_in = 0;   ///< whole API frames
    std::array<std::uint64_t, 6> bad_frames{};  ///< by protocols::XBeeFault
    std::uint64_t between_frames = 0;           ///< bytes of no frame
    std::uint64_t odd_frames = 0;               ///< of a type that this module does not take from its host
    std::uint64_t frames_out = 0;
    std::uint64_t dropped_out = 0;  ///< frames or packets that the serial transmit buffer had no room for
    // Commands.
    std::uint64_t at_commands = 0;
    std::uint64_t bad_values = 0;
    std::map<std::string, std::uint64_t> unknown_at;
    std::uint64_t command_modes = 0;   ///< "+++"
    std::uint64_t without_effect = 0;  ///< sleep modes asked for that it has not
    std::uint64_t sleeps = 0;
    std::uint64_t while_asleep = 0;  ///< bytes that came then
    // Air.
    std::uint64_t sent = 0;  ///< packets handed to the network layer
    std::uint64_t too_long = 0;
    std::map<std::uint8_t, std::uint64_t> fates;  ///< by delivery status
    std::uint64_t retries = 0;                    ///< of the network layer, for them
    std::uint64_t received = 0;                   ///< packets with data
    std::uint64_t discoveries = 0;                ///< ND and DN
    std::uint64_t shown = 0;                      ///< answered to those of others
    std::array<std::uint64_t, 4> bad_air{};       ///< by protocols::MeshFault
    std::uint64_t not_for_us = 0;                 ///< of another address
    std::uint64_t resets = 0;
};

}  // namespace puckloop::xbee
