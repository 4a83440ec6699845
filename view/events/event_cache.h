#pragma once
// What reading the events of a recorded folder came to, kept beside them: `view.events`. Decoding an hour
// takes a while; the next viewer has its events at once. It is of this program and of files as they were
// (names, sizes, times of their last change); anything else is read again. It may be removed at any time.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::view {

inline constexpr const char* kEventCacheFile = "view.events";

/// Of what events are read from: this program and each file's size and last change. Another text: read again.
std::string event_sources(const std::filesystem::path& folder);

/// Changes of LEDs, as EventReader::leds() has them.
struct LedEvents {
    std::vector<double> times;
    std::vector<std::uint16_t> robots;
    std::vector<std::uint8_t> leds, values;
    std::uint64_t left_out = 0;
};

/// As EventReader::beams() has it.
struct BeamEvents {
    std::vector<double> begins;
    std::vector<float> durations;
    std::vector<std::uint16_t> senders, receivers;
    std::vector<std::uint8_t> fates;
};

class EventTable;

/// False: there is none of these sources, or it is damaged; the three are as they were then.
bool load_events(const std::filesystem::path& folder, const std::string& sources, EventTable& table,
                 LedEvents& leds, BeamEvents& beams);
/// A folder that cannot be written, or a full disk, leaves none.
void save_events(const std::filesystem::path& folder, const std::string& sources, const EventTable& table,
                 const LedEvents& leds, const BeamEvents& beams);

}  // namespace puckloop::view
