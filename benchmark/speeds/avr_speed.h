#pragma once
// Speed of the ATmega1284P: a program on the bare chip, and the TAM's firmware on its board; and of libsimavr
// executing the same images, in a program of its own (simavr_speed.cpp).

#include <filesystem>
#include <optional>

namespace puckloop::tools {

/// Millions of clocks a second of processor time, for about `slice_s` of it. Throws InputError.
double avr_program_speed(const std::filesystem::path& image, double slice_s);
/// The same of libsimavr; nothing where this build has none.
std::optional<double> simavr_program_speed(const std::filesystem::path& image, double slice_s);

/// Simulated by processor seconds of the TAM's board once its firmware waits for something to happen, with a
/// radio module that answers at once. Throws InputError.
double tam_idle_speed(const std::filesystem::path& image, double slice_s);
/// The same of libsimavr, which has the module but nothing on the two-wire bus.
std::optional<double> simavr_idle_speed(const std::filesystem::path& image, double slice_s);

/// Until then a TAM's firmware has started up (fact sheet, section 6: 2.24 s).
inline constexpr double kTamStartUp = 4.0;

}  // namespace puckloop::tools
