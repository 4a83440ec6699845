#pragma once
// Pause times of teams that talk by WiFi (Couceiro et al., Robotics and Autonomous Systems 62, 2014, fig.
// 17): robots wander in 2.0 x 1.8 m and send to all every five seconds, over UART2, a forwarder on the Linux
// board and the network manager; the time from before a robot's send call to the receipt at another robot.
//
// Not published, so chosen here: the message ("hello 00012", 17 bytes on the wire), where the access point is
// (3 m from the middle), 802.11g, the robots' places at the beginning (drawn), what a forwarder does.

#include "reproductions/team_trace.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

inline constexpr int kFewestInTeam = 2, kMostInTeam = 14;
/// Medians of the published boxes, ms, for the smallest and the largest team; read off the figure.
inline constexpr double kPublishedPauseOf2 = 157, kPublishedPauseOf14 = 172;
inline constexpr int kPublishedPackets = 2000;

struct TeamSpec {
    std::filesystem::path folder;                            ///< of the scenario and its results
    std::filesystem::path firmware;                          ///< of the main boards, at selector 10
    std::vector<std::string> forwarder{"puckloop-forward"};  ///< words; "--server manager:7700" follows
    std::string standard = "g";                              ///< of the radio
    double rate = 0;                                         ///< Mbit/s of its frames to one; 0: by power
    int robots = 2;
    double seconds = 30;
    std::uint64_t seed = 1;
};

/// A message that a robot got, or should have got; times in ms.
struct Pause {
    std::size_t from = 0, to = 0;
    double begun = 0;               ///< s of the run
    double pause = -1;              ///< negative: lost
    std::array<double, 4> parts{};  ///< as kPauseParts; 0 where one is not known apart from the next
};
inline constexpr std::array<const char*, 4> kPauseParts{"main board to Linux board", "to the manager and on",
                                                        "by radio to the receiver",
                                                        "Linux board to main board"};

/// From the trace's messages, of those that begin from `from` to `until`, s.
std::vector<Pause> pauses_of(const std::vector<TeamMessage>& messages, double from, double until);

/// One run. Messages of its first seconds, in which forwarders connect, and of the last ones, which may be
/// under way at the end, do not count. Throws InputError for what the scenario reader refuses, RunError where
/// the run did not reach its end.
std::vector<Pause> run_team(const TeamSpec& spec);

/// What all runs of a team's size gave; times in ms.
struct TeamPauses {
    int robots = 0, runs = 0;
    std::size_t packets = 0, lost = 0;  ///< one for each receiver of each message
    double low = 0, quarter = 0, median = 0, three_quarters = 0, high = 0;  ///< 5, 25, 50, 75, 95 %
    double mean = 0;
    std::array<double, 4> parts{};  ///< means
};
TeamPauses summary_of(int robots, int runs, const std::vector<Pause>& pauses);
/// The published median for a team, on a line between the two that are given.
double published_pause(int robots);
/// ms that each further robot adds, by least squares over the medians; 0 with one size.
double growth_of(const std::vector<TeamPauses>& teams);

/// Teams of all sizes with one forwarder.
struct PauseSeries {
    std::string forwarder;  ///< its name
    std::vector<TeamPauses> teams{};
};

/// One line per team size, beside the published medians, and what the parts are.
std::string pause_table(const PauseSeries& series);
/// Boxes (quartiles) with whiskers (5 and 95 %) beside the published medians, as SVG.
std::string pause_picture(const std::vector<PauseSeries>& series, const std::string& caption);
/// Heads of the columns, and a line for each packet.
std::string pauses_csv_head();
std::string pauses_csv(const std::string& forwarder, int robots, int run, const std::vector<Pause>& pauses);

}  // namespace puckloop::tools
