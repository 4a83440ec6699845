#pragma once
// What happened in a recorded run, event by event: when, on which track, with a text. One thread fills the
// table while another serves it.
//
// Times and flags are in memory, texts in a file without a name in the folder for temporary files: an hour of
// twenty robots has some hundred million characters of them.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::view {

inline constexpr std::uint8_t kFailed =
    1;  ///< something is wrong with it: `!!` of `trace decode`, a lost frame
inline constexpr std::uint8_t kRare = 2;  ///< never left out: faults, resets, lines of logs, events

struct Track {
    std::string name;   ///< "robot0.uart robot0.pic", "robot0.pic log"
    std::string kind;   ///< the decoder's protocol, or "log", "reset", "event", "light"
    std::string robot;  ///< whose it is; empty: nobody's
};

class EventTable {
  public:
    /// More plain events (neither failed nor rare) than `most` are thinned: of each track every second stays,
    /// of what comes later every second too, and so on.
    /// `generation`: of the first status; goes up from there.
    explicit EventTable(std::size_t most = kMost, std::uint32_t generation = 0);

    /// The number of a track, which is made where there is none of that name. RunError above 65,535.
    std::uint16_t track(const Track& track);
    /// `begin` and `duration` in s. Texts are cut at kLongestText bytes. Throws RunError when the disk is
    /// full.
    void add(std::uint16_t track, double begin, double duration, std::uint8_t flags, std::string_view text);

    struct Status {
        std::uint32_t generation =
            0;  ///< goes up when events were thinned: numbers of events are others then
        std::size_t events = 0, left_out = 0;
        std::vector<Track> tracks;
    };
    Status status() const;

    /// Events from number `first` on, at most `most`: four 32-bit numbers (generation, `first`, how many
    /// follow, how many there are in all), then begins (64-bit floats), durations (32-bit floats), tracks (16
    /// bits), flags (8 bits), each for all of them; little-endian.
    std::string block(std::size_t first, std::size_t most) const;
    /// Texts of events; "" of a number that there is none of. Throws RunError.
    std::vector<std::string> texts(const std::vector<std::size_t>& numbers) const;
    /// Numbers of the events whose text has `part`, whatever the case of its letters; at most `most`.
    std::vector<std::uint32_t> find(std::string_view part, std::size_t most) const;

    /// Everything but the texts, to be written to a file and to come from it (event_cache.h).
    struct Kept {
        std::vector<double> begins;
        std::vector<float> durations;
        std::vector<std::uint16_t> tracks;
        std::vector<std::uint8_t> flags;
        std::vector<std::uint16_t> text_sizes;
        std::vector<Track> names;
        std::uint64_t left_out = 0;
        std::uint64_t text_bytes = 0;  ///< of all texts, which follow one another
        std::uint64_t texts_at = 0;    ///< where they begin in their file
        static constexpr std::size_t kBytesOfEvent =
            sizeof(double) + sizeof(float) + 2 * sizeof(std::uint16_t) + sizeof(std::uint8_t);
    };
    Kept keep() const;
    /// The texts in the order of the events. Throws RunError.
    void each_text(const std::function<void(std::string_view)>& take) const;
    /// In place of everything: events whose texts are in `texts`, which is this table's then. False: they do
    /// not fit each other, and nothing has changed.
    bool take(Kept kept, std::FILE* texts);

    static constexpr std::size_t kMost = 2'000'000;
    static constexpr std::size_t kLongestText = 4096;

  private:
    void thin();
    std::string read(std::uint64_t at, std::size_t count) const;
    /// A text, out of a large piece of the file that is read where it is needed; for rising numbers.
    std::string_view text_of(std::size_t number, std::string& piece, std::uint64_t& piece_at) const;

    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    mutable std::mutex mutex_;
    std::size_t most_;
    std::vector<double> begins_;
    std::vector<float> durations_;
    std::vector<std::uint16_t> tracks_;
    std::vector<std::uint8_t> flags_;
    std::vector<std::uint64_t> text_at_;
    std::vector<std::uint16_t> text_size_;
    std::unique_ptr<std::FILE, Closer> texts_;
    std::uint64_t written_ = 0;
    std::string pending_;  // texts that are not in the file yet
    std::vector<Track> names_;
    std::map<std::string, std::uint16_t> by_name_;
    std::vector<std::uint64_t> seen_;  // plain events of each track
    std::uint64_t stride_ = 1;         // of which every so many-th stays
    std::size_t plain_ = 0, left_out_ = 0;
    std::uint32_t generation_ = 0;
};

}  // namespace puckloop::view
