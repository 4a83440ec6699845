#pragma once
// Reads the events of a results folder in a thread of its own: frames of all links by protocol, what became
// of range-and-bearing frames, IRcom words, faults, resets, lines of logs, changes of LEDs.

#include "view/events/event_cache.h"
#include "view/events/event_table.h"
#include "view/events/sound_spells.h"
#include "view/recording/recording.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace puckloop::view {

class EventReader {
  public:
    /// Begins to read; `recording` must outlive it. `most` and `generation`: of EventTable. Of a run that is
    /// over what took longer than `worth_keeping` is kept for the next reader (event_cache.h).
    explicit EventReader(const Recording& recording, std::size_t most = EventTable::kMost,
                         std::uint32_t generation = 0,
                         std::chrono::milliseconds worth_keeping = std::chrono::milliseconds(500));
    /// Stops reading.
    ~EventReader();
    EventReader(const EventReader&) = delete;
    EventReader& operator=(const EventReader&) = delete;

    const EventTable& table() const { return table_; }
    /// Until everything is read. Throws what was wrong, if it was: InputError, RunError.
    void wait();
    /// Nothing is left to read.
    bool done() const { return done_; }

    /// JSON: generation, events, left_out, tracks, done, progress (0..1), what is read now, what was wrong.
    std::string status() const;
    /// LEDs from change `first` on: four 32-bit numbers (first, how many follow, how many in all, 0), then
    /// times (64-bit floats, s), robots (16 bits), LEDs (8 bits: 0..7 ring, 8 body, 9 front, 10..18 the
    /// turret's three, each red, green and blue, 19 the speaker plays), values (8 bits).
    std::string leds(std::size_t first, std::size_t most) const;
    /// Light between stations: two 32-bit numbers (count, 0), then begins (64-bit floats, s), durations
    /// (32-bit floats), senders, receivers (16 bits each), fates (8 bits).
    std::string beams() const;

    static constexpr std::size_t kMostLeds = 4'000'000;

    /// Fates of beams: delivered, then lost by Cause of traces/rab_losses/losses.h, and a word of IRcom.
    static constexpr std::uint8_t kDelivered = 0, kIrcomWord = 32;

  private:
    struct Stopped {};
    void run() noexcept;
    void read_all();
    /// What an earlier viewer kept; false: nothing that is still so.
    bool load_kept(const std::string& sources);
    void read_logs();
    void read_resets();
    void read_trace();
    void read_rab();
    void read_ircom();
    /// Stations by number.
    void add_beam(double begin, double duration, std::size_t sender, std::size_t receiver, std::uint8_t fate);
    void led(const std::string& from, const std::string& signal, double time, double value);
    void speaker(std::size_t robot, double time, double value);
    void add_led(std::size_t robot, std::uint8_t led, double time, std::uint8_t value);
    void check_stop() const {
        if (stop_) throw Stopped{};
    }
    std::string robot_of(const std::string& name) const;
    std::size_t station(const std::string& name) const;

    const Recording& recording_;
    std::chrono::milliseconds worth_keeping_;
    EventTable table_;
    std::atomic<bool> stop_ = false, done_ = false;
    std::atomic<double> progress_ = 0.0;
    mutable std::mutex mutex_;
    std::string phase_;
    std::string trouble_;
    std::exception_ptr error_;
    LedEvents leds_;
    BeamEvents beams_;
    std::map<std::size_t, SoundSpells> speakers_;  // by robot
    std::thread thread_;
};

}  // namespace puckloop::view
