#pragma once
// What the parts of `puckloop frames` share: one file per wire format, and how their input comes in.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

class Command;

void declare_rab_frames(Command& frames, int& status);
void declare_epuck_frames(Command& frames, int& status);
void declare_xbee_frames(Command& frames, int& status);
void declare_ircom_frames(Command& frames, int& status);

/// What was written on standard output so far is out. Throws RunError where it cannot be written.
void flush_output();

/// Gives the subcommand --json and what it does; its output is then flushed.
void declare_action(Command& command, bool& json, std::function<void()> act);

/// Hands over each argument, or without arguments each line of standard input as it comes, white space around
/// it removed. `origin` is empty for arguments, else "standard input, line 3". Throws InputError if there is
/// neither argument nor line.
void for_each_input(const std::vector<std::string>& arguments,
                    const std::function<void(const std::string& text, const std::string& origin)>& take);

/// A number in base 10 or 16 (there with or without 0x), all of `text`. Throws InputError, naming origin
/// and `what`: empty, no number, outside low..high.
std::int64_t parse_number(std::string_view text, int base, std::int64_t low, std::int64_t high,
                          std::string_view origin, std::string_view what);

/// Pairs of hexadecimal digits; white space between bytes is skipped. Throws InputError, naming origin and
/// byte.
std::vector<std::uint8_t> bytes_of(const std::string& text, const std::string& origin);

/// Text for an error message, quoted, on one line: control characters and all past 40 characters replaced.
std::string shown(std::string_view text);

}  // namespace puckloop::tools
