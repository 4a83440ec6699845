#pragma once
// The results folder of a run, as a page shows it: what is known at once, which is the arena, who was where
// when, and what the folder lacks. What takes long to read is read_events.h's.

#include "physics/render/path_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::view {

class Recording {
  public:
    /// Throws InputError for what is no results folder, for damaged files and for those of another version,
    /// with the remedy. Files that a run which was killed could not write are notes.
    /// `live`: of a run that goes on, so that a missing report is nothing to note.
    explicit Recording(std::filesystem::path folder, bool live = false);
    bool live() const { return live_; }

    const std::filesystem::path& folder() const { return folder_; }
    /// Robots, then TAMs: beams name their ends by the place in this list.
    const std::vector<std::string>& stations() const { return stations_; }
    std::size_t robots() const { return robots_; }
    double duration_s() const { return duration_s_; }
    /// Each says what is missing and the remedy.
    const std::vector<std::string>& notes() const { return notes_; }

    /// JSON: title, seed, duration, how it ended, notes, arena, stations, TAMs' colours, columns of sensors.
    std::string head() const;
    /// For each path of head()'s "paths", in that order: the number of points (32 bits), then times (s), x, y
    /// (m) and headings (rad), 32-bit floats; little-endian.
    std::string poses() const;
    /// Of a robot: numbers of rows and of columns (32 bits), then times (s, 64-bit floats), then column by
    /// column 32-bit floats. At most kMostRows rows, every so many-th of the file. Throws RunError for
    /// damaged rows.
    std::string sensors(std::size_t robot) const;

    /// Of the pheromones of head()'s arena, in that order: the number of squares and 0 (32 bits), then times
    /// (s, 64-bit floats), trails (16 bits), x, y (m) and strengths (0..1), 32-bit floats; at most
    /// kMostSquares, the first.
    std::string trails() const;

    /// Files of rows that grow with the run.
    enum class Rows : std::uint8_t { Objects, Robots, Tracker };
    /// Whole lines of objects.csv, trajectory.csv or tracker.csv from byte `from` on, at most kMostTail
    /// bytes.
    std::string tail(Rows rows, std::size_t from) const;

    static constexpr std::size_t kMostRows = 20'000;
    static constexpr std::size_t kMostTail = 1 << 20;
    static constexpr std::size_t kMostSquares = 1'000'000;

  private:
    void read_report();
    void read_arena();
    void read_paths();
    void read_booths();
    std::vector<std::string> sensor_columns() const;

    std::filesystem::path folder_;
    bool live_ = false;
    std::vector<std::string> notes_, stations_;
    std::size_t robots_ = 0;
    double duration_s_ = 0.0;
    physics::Paths paths_;
    std::size_t robot_paths_ = 0;          // of paths_, the first
    std::string report_, arena_, booths_;  // JSON of head(); empty: none
    std::vector<std::string> trails_;      // names of pheromones
};

}  // namespace puckloop::view
