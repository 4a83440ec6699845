#pragma once
// Values of command line options, checked: each ends the program with one line and status 2 when it is wrong.

#include <string>

namespace puckloop::control {

inline constexpr int kWrongUse = 2;  ///< exit status: wrong use, or a device that cannot be opened

/// "<program>: --<option> <text>: expected <expected>".
[[noreturn]] void wrong_value(const char* option, const char* text, const std::string& expected);

double number(const char* option, const char* text, const std::string& expected, double low, double high);
/// At least `least` seconds.
double seconds(const char* option, const char* text, double least = 0.0);
int whole(const char* option, const char* text, int low, int high);
/// A byte: 0 to 255, or 0x00 to 0xff.
int byte(const char* option, const char* text);

}  // namespace puckloop::control
