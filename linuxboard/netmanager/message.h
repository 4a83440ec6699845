#pragma once
// What robots and their network manager write to each other by TCP: lines of text that end with CR.
//
//   robot to manager    TO [@X,Y] DATA     TO a robot's number, -1 or 9999 for all; X, Y where it is, m
//   manager to robot    FROM DATA
//
// Numbers are decimal, four digits with leading zeros as well ("0012"). DATA is anything but CR. A LF behind
// a CR is left out.

#include <optional>
#include <string>
#include <string_view>

namespace puckloop::netmanager {

inline constexpr int kEverybody = -1;
/// Of a robot's number: 0 to 9998.
inline constexpr int kMostNumber = 9998;
inline constexpr int kEverybodyByFourDigits = 9999;
/// Longest line; what sends a longer one is not a robot.
inline constexpr std::size_t kLongest = 4096;

struct Place {
    double x = 0, y = 0;  ///< m
    friend bool operator==(const Place&, const Place&) = default;
};

struct Message {
    int to = kEverybody;
    std::optional<Place> place{};
    std::string data{};
    friend bool operator==(const Message&, const Message&) = default;
};

/// A line without its CR; nothing for what is none.
std::optional<Message> parse_message(std::string_view line);
/// With its CR.
std::string line_from(int number, std::string_view data);

}  // namespace puckloop::netmanager
