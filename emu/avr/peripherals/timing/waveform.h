#pragma once
// How a timer counts: the modes of the WGM bits, and where its counter is a number of ticks from now. Pure
// arithmetic, no registers. Source: data sheet 8272, "Modes of Operation" of the timer chapters.
//
// A counter "leaves" a value in the tick that moves it on: the tick in which the data sheet's timing diagrams
// set the flag of that value.

#include <cstdint>
#include <limits>

namespace puckloop::avr {

inline constexpr std::uint64_t kNoTick = std::numeric_limits<std::uint64_t>::max();

struct Waveform {
    enum class Kind : std::uint8_t { Normal, Ctc, Fast, Phase, PhaseFrequency };
    enum class Top : std::uint8_t { Fixed, CompareA, Capture };
    Kind kind = Kind::Normal;
    Top top = Top::Fixed;
    std::uint32_t fixed = 0;  ///< top where it is Fixed

    constexpr bool dual_slope() const { return kind == Kind::Phase || kind == Kind::PhaseFrequency; }
    /// Compare registers are double buffered.
    constexpr bool buffered() const { return kind == Kind::Fast || dual_slope(); }
};

/// A counter in motion.
struct Counter {
    std::uint32_t count = 0;
    bool down = false;  ///< dual slope: on the way to 0

    /// Ticks until the counter leaves `value` next, at least 1; kNoTick if it never comes by. `blocked`: the
    /// first tick does not count (TCNT was just written).
    std::uint64_t leaves(std::uint32_t value, const Waveform& wave, std::uint32_t top, std::uint32_t max,
                         bool blocked) const {
        const std::uint64_t first =
            wave.dual_slope() ? leaves_dual(value, top) : leaves_single(value, top, max);
        if (!blocked || first != 1) return first;
        Counter later = *this;
        later.advance(1, wave, top, max);
        const std::uint64_t next = later.leaves(value, wave, top, max, false);
        return next == kNoTick ? kNoTick : next + 1;
    }

    void advance(std::uint64_t ticks, const Waveform& wave, std::uint32_t top, std::uint32_t max) {
        if (wave.dual_slope())
            advance_dual(ticks, top);
        else
            advance_single(ticks, top, max);
    }

  private:
    /// Above the top (it was lowered, or TCNT written) a counter runs on to its maximum first.
    std::uint64_t leaves_single(std::uint32_t value, std::uint32_t top, std::uint32_t max) const {
        const std::uint32_t end = count > top ? max : top;
        if (value >= count && value <= end) return value - count + 1ull;
        if (value > top) return kNoTick;
        return std::uint64_t{end - count} + 1 + value + 1;
    }
    void advance_single(std::uint64_t ticks, std::uint32_t top, std::uint32_t max) {
        if (count > top) {
            const std::uint64_t to_zero = max - count + 1ull;
            if (ticks < to_zero) {
                count += static_cast<std::uint32_t>(ticks);
                return;
            }
            ticks -= to_zero;
            count = 0;
        }
        count = static_cast<std::uint32_t>((count + ticks) % (top + 1ull));
    }

    /// One period of the triangle as positions 0 .. 2 top - 1: up to the top, and down. A counter beyond the
    /// top turns at once.
    std::uint64_t position(std::uint64_t top) const { return down ? (2 * top - count) % (2 * top) : count; }
    std::uint64_t triangle(std::uint32_t top) const { return count > top ? count : top < 1 ? 1 : top; }
    std::uint64_t leaves_dual(std::uint32_t value, std::uint32_t top) const {
        const std::uint64_t t = triangle(top);
        if (value > t) return kNoTick;
        const std::uint64_t period = 2 * t, here = position(t);
        const auto until = [&](std::uint64_t place) { return (place + period - here) % period + 1; };
        const std::uint64_t up = until(value), downward = until((period - value) % period);
        return up < downward ? up : downward;
    }
    void advance_dual(std::uint64_t ticks, std::uint32_t top) {
        if (ticks == 0) return;
        const std::uint64_t t = triangle(top);
        const std::uint64_t there = (position(t) + ticks) % (2 * t);
        down = there >= t;
        count = static_cast<std::uint32_t>(down ? 2 * t - there : there);
    }
};

}  // namespace puckloop::avr
