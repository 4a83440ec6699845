#pragma once
// The experiments with sound of Couceiro et al. (Robotics and Autonomous Systems 62, 2014), repeated on
// emulated boards: sound against distance (fig. 7), five sounds in a row (fig. 8), ears and radio (fig. 11).
// Their set-up is in the fact sheet of published experiments; what it leaves open stands beside each figure
// here.

#include "reproductions/ellipse.h"
#include "reproductions/trial.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::tools {

struct SoundOptions {
    std::filesystem::path firmware;  ///< answers BTcom's commands T, U and D on UART1
    std::filesystem::path walker;    ///< at selector 2 it walks and writes a line when it hears
    std::filesystem::path folder;    ///< where trials leave their results
    int trials = 10;
    std::uint64_t seed = 1;
    double walk_s = 360.0;            ///< of ears and radio
    std::filesystem::path overlay{};  ///< physical parameters of all robots; empty: none
};

/// The three microphones' volumes, one answer.
struct Volumes {
    double at = 0.0;  ///< s from a trial's beginning, or m between the robots' centres
    std::array<double, 3> counts{};

    double mean() const { return (counts[0] + counts[1] + counts[2]) / 3.0; }
};
using Readings = std::vector<std::vector<Volumes>>;  ///< of each trial

inline constexpr int kCalls = 5;
/// Words of the codec's sound table, at 7200 a second.
inline constexpr std::array<int, kCalls> kCallWords{2112, 1760, 3412, 3732, 8016};
inline constexpr double kCallRate = 7200.0;
inline constexpr double kCallSpacing = 1.5;  ///< s between the beginnings of the five in a row; not published
inline constexpr double kFirstCall = 1.0;    ///< s

/// A place where the walker heard the caller.
struct Heard {
    double seconds = 0.0, x = 0.0, y = 0.0;
};
struct Ears {
    std::vector<Heard> heard;
    int calls = 0;  ///< that were played
    std::vector<physics::PathPoint> path;
};

/// Called before each trial with its number and how many there are.
using TrialProgress = std::function<void(int trial, int trials)>;

/// One robot plays sound 1 without pause, the other drives away from 75 to 300 mm at 10 mm/s; `at` in m.
Readings sound_against_distance(const SoundOptions& options, const TrialProgress& progress = {});
/// Two robots stand 10 cm apart; one plays the five sounds; `at` in s.
Readings five_sounds(const SoundOptions& options, const TrialProgress& progress = {});
/// In a field of 60 x 60 cm one robot in the middle plays sound 5 every five seconds, the other walks from a
/// corner.
Ears ears_and_radio(const SoundOptions& options, const TrialProgress& progress = {});

/// Reads "u,12,13,9"; anything else is not an answer.
bool parse_volumes(const std::string& line, Volumes& volumes);

/// Median and deciles over all trials of the mean volume in bins of `at`; empty bins are left out.
struct Bin {
    double at = 0.0, p10 = 0.0, median = 0.0, p90 = 0.0;
    int count = 0;
};
std::vector<Bin> binned(const Readings& readings, double width);

}  // namespace puckloop::tools
