#include "protocols/infrared/ircom.h"

#include <fmt/format.h>

#include <array>
#include <bit>

namespace puckloop::protocols {

namespace {

using cosim::kMicrosecond;
using cosim::Time;

constexpr int kCheckBits = 2, kDataBits = 8;
constexpr Time kGlitch = 40 * kMicrosecond;     // shorter light, or shorter dark, is no half period
constexpr Time kShortest = 150 * kMicrosecond;  // of a MARK; between 195 and this: distorted by a comparator
constexpr Time kBorder = 390 * kMicrosecond;    // between MARK and SPACE
constexpr Time kLongest = 700 * kMicrosecond;   // of a SPACE
constexpr std::size_t kMostEdges = 1000;        // beyond, the light is no word

bool is_space(std::uint16_t symbols, int symbol) {
    return (symbols >> (kIrcomSymbols - 1 - symbol) & 1) != 0;
}

int halves_of(bool space) {
    return space ? kIrcomSpaceHalves : kIrcomMarkHalves;
}

/// Times of the edges that remain when short pulses are left out.
std::vector<Time> without_glitches(std::span<const IrcomEdge> edges) {
    std::vector<Time> times;
    for (const IrcomEdge& edge : edges) {
        if (!times.empty() && edge.time - times.back() < kGlitch)
            times.pop_back();
        else
            times.push_back(edge.time);
    }
    return times;
}

}  // namespace

int ircom_check(std::uint8_t word) {
    return (4 - std::popcount(word) % 4) % 4;
}

std::uint16_t ircom_symbols(std::uint8_t word) {
    return static_cast<std::uint16_t>(word << kCheckBits | ircom_check(word));
}

std::string ircom_text(std::uint16_t symbols) {
    std::string text;
    for (int i = 0; i < kIrcomSymbols; ++i)
        text += is_space(symbols, i) ? 'S' : 'M';
    return text;
}

std::vector<IrcomEdge> ircom_edges(std::uint16_t symbols, const IrcomTiming& timing) {
    std::vector<IrcomEdge> edges;
    Time now = -timing.mark;
    if (is_space(symbols, 0)) now = -timing.space;
    bool lit = false;
    for (int i = 0; i < kIrcomSymbols; ++i) {
        const bool space = is_space(symbols, i);
        for (int half = 0; half < halves_of(space); ++half) {
            now += space ? timing.space : timing.mark;
            lit = !lit;
            edges.push_back({now, lit});
        }
    }
    if (lit) edges.pop_back();  // on and off at once
    return edges;
}

std::string_view name_of(IrcomFault fault) {
    constexpr std::array<std::string_view, 8> kNames{"none", "short", "long",  "symbol",
                                                     "gap",  "start", "check", "no light"};
    return kNames[static_cast<std::size_t>(fault)];
}

std::string explain(const IrcomReading& reading) {
    const int expected = ircom_check(reading.word);
    switch (reading.fault) {
    case IrcomFault::None:
        return fmt::format("word {:02X} check {}", reading.word, reading.check);
    case IrcomFault::Short:
        return "ends within a symbol or before twelve symbols";
    case IrcomFault::Long:
        return "goes on after twelve symbols";
    case IrcomFault::Symbol:
        return fmt::format("edge {}: a symbol ends after a wrong number of half periods (expected 10 of a "
                           "MARK, 5 of a SPACE)",
                           reading.edge);
    case IrcomFault::Gap:
        return fmt::format("edge {}: the interval before it is no half period (expected 150 to 390 us of a "
                           "MARK, to 700 us of a SPACE)",
                           reading.edge);
    case IrcomFault::Start:
        return fmt::format("{} does not begin with two MARKs", ircom_text(reading.symbols));
    case IrcomFault::Check:
        return fmt::format("word {:02X} has check {} (expected {})", reading.word, reading.check, expected);
    case IrcomFault::NoLight:
        return "the first edge is no rise of light";
    }
    return {};
}

IrcomReading read_ircom(std::span<const IrcomEdge> edges) {
    IrcomReading reading;
    const std::vector<Time> times = without_glitches(edges);
    const auto fail = [&](IrcomFault fault, std::size_t edge = 0) {
        reading.fault = fault;
        reading.edge = static_cast<int>(edge);
        return reading;
    };
    reading.edges = static_cast<int>(times.size());
    if (times.empty()) return fail(IrcomFault::Short);
    reading.start = times.front();
    reading.end = times.back();
    if (!edges.front().lit) return fail(IrcomFault::NoLight);
    // The first half period of the word lies before its first edge: it is of the kind of the next one.
    int symbol = 0, halves = 1;
    bool space = false;
    for (std::size_t i = 1; i < times.size(); ++i) {
        const Time gap = times[i] - times[i - 1];
        if (gap < kShortest || gap > kLongest) return fail(IrcomFault::Gap, i);
        const bool long_gap = gap > kBorder;
        if (symbol == kIrcomSymbols) return fail(IrcomFault::Long, i);
        if (i == 1 || halves == 0)
            space = long_gap;
        else if (long_gap != space)
            return fail(IrcomFault::Symbol, i);
        if (++halves < halves_of(space)) continue;
        reading.symbols = static_cast<std::uint16_t>(reading.symbols << 1 | (space ? 1 : 0));
        ++symbol;
        halves = 0;
    }
    // The last edge is not there where the light would have gone on with it.
    if (symbol == kIrcomSymbols - 1 && halves + 1 == halves_of(space) && times.size() % 2 == 0) {
        reading.symbols = static_cast<std::uint16_t>(reading.symbols << 1 | (space ? 1 : 0));
        ++symbol;
    }
    if (symbol < kIrcomSymbols) return fail(IrcomFault::Short);
    reading.check = reading.symbols & ((1 << kCheckBits) - 1);
    reading.word = static_cast<std::uint8_t>(reading.symbols >> kCheckBits);
    if (reading.symbols >> (kCheckBits + kDataBits) != 0) return fail(IrcomFault::Start);
    if (reading.check != ircom_check(reading.word)) return fail(IrcomFault::Check);
    return reading;
}

std::optional<IrcomReading> IrcomReader::edge(Time now, bool lit) {
    std::optional<IrcomReading> ended = until(now);
    const bool lit_now = lit_first_ == (times_.size() % 2 == 1);  // after the edges so far
    if (times_.empty())
        lit_first_ = lit;
    else if (lit_now == lit)
        return ended;  // no change
    if (times_.size() < kMostEdges) times_.push_back(now);
    return ended;
}

std::optional<IrcomReading> IrcomReader::until(Time now) {
    if (times_.empty() || now - times_.back() < kRest) return std::nullopt;
    std::vector<IrcomEdge> edges;
    bool lit = lit_first_;
    for (const Time time : times_) {
        edges.push_back({time, lit});
        lit = !lit;
    }
    times_.clear();
    return read_ircom(edges);
}

}  // namespace puckloop::protocols
