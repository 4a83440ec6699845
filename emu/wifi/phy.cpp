#include "emu/wifi/phy.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::wifi {

using cosim::kMicrosecond;
using cosim::Time;

namespace {

// Sensitivity: 16.3.8 (-76 dBm at 11 Mbit/s), 15.4.6 (-80 dBm at 2 Mbit/s); 5.5 Mbit/s, for which there is
// none, between them. 17.3.10, table 17-18, for OFDM.
constexpr Rate kSpread[] = {
    {1e6, -80, 0, true}, {2e6, -80, 0, true}, {5.5e6, -78, 0, false}, {11e6, -76, 0, false}};
constexpr Rate kOfdm[] = {{6e6, -82, 24, true},    {9e6, -81, 36, false},  {12e6, -79, 48, true},
                          {18e6, -77, 72, false},  {24e6, -74, 96, true},  {36e6, -70, 144, false},
                          {48e6, -66, 192, false}, {54e6, -65, 216, false}};

constexpr Time kLongPreamble = 192 * kMicrosecond, kShortPreamble = 96 * kMicrosecond;
constexpr Time kOfdmPreamble = 20 * kMicrosecond, kSymbol = 4 * kMicrosecond;
constexpr Time kSignalExtension = 6 * kMicrosecond;  // behind a frame of 802.11g
constexpr std::size_t kServiceBits = 16, kTailBits = 6;

std::span<const Rate> rates_of(const WifiSettings& settings) {
    return settings.standard == "g" ? std::span<const Rate>(kOfdm) : std::span<const Rate>(kSpread);
}

const Rate* find(std::span<const Rate> rates, double bits) {
    const auto found = std::find_if(rates.begin(), rates.end(),
                                    [&](const Rate& rate) { return std::abs(rate.bits - bits) < 1.0; });
    return found == rates.end() ? nullptr : &*found;
}

std::int64_t first_window_of(const WifiSettings& settings) {
    constexpr std::int64_t kOfB = 31, kOfG = 15;
    if (settings.shortest_window != 0) return settings.shortest_window;
    return settings.standard == "g" ? kOfG : kOfB;
}

}  // namespace

std::optional<SettingsProblem> problem_of(const WifiSettings& settings) {
    if (settings.standard != "b" && settings.standard != "g")
        return SettingsProblem{"standard", fmt::format("there is no standard '{}'", settings.standard),
                               "\"b\" or \"g\""};
    if (settings.preamble != "long" && settings.preamble != "short")
        return SettingsProblem{"preamble", fmt::format("there is no preamble '{}'", settings.preamble),
                               "\"long\" or \"short\""};
    if (settings.standard == "g" && settings.preamble == "short")
        return SettingsProblem{"preamble", "802.11g has one preamble", "standard = \"b\""};
    if (settings.longest_window < first_window_of(settings))
        return SettingsProblem{
            "longest_window",
            fmt::format("the longest window is shorter than the first, {} slots", first_window_of(settings)),
            "1023"};
    const std::span<const Rate> rates = rates_of(settings);
    for (const auto& [key, bits] :
         {std::pair("rate", settings.rate), std::pair("broadcast_rate", settings.broadcast_rate)}) {
        if (bits == 0 || find(rates, bits) != nullptr) continue;
        std::string known;
        for (const Rate& rate : rates)
            known += fmt::format("{}{:g}", known.empty() ? "" : ", ", rate.bits / 1e6);
        return SettingsProblem{
            key, fmt::format("802.11{} has no rate of {:g} Mbit/s", settings.standard, bits / 1e6),
            known + " Mbit/s"};
    }
    return std::nullopt;
}

Phy::Phy(const WifiSettings& settings)
    : rates_(rates_of(settings)), sifs_(10 * kMicrosecond), first_window_(first_window_of(settings)) {
    if (const auto found = problem_of(settings))
        throw InputError("", "wifi", found->problem, found->expected);
    const bool g = settings.standard == "g";
    slot_ = (g ? 9 : 20) * kMicrosecond;
    sensing_ = (g ? 4 : 15) * kMicrosecond;
    preamble_ = g ? kOfdmPreamble : settings.preamble == "short" ? kShortPreamble : kLongPreamble;
}

const Rate& Phy::rate_of(double bits) const {
    return *find(rates_, bits);
}

const Rate& Phy::ack_rate(const Rate& rate) const {
    const Rate* best = &rates_.front();
    for (const Rate& one : rates_)
        if (one.basic && one.bits <= rate.bits) best = &one;
    return *best;
}

Time Phy::air_time(std::size_t octets, const Rate& rate) const {
    const std::size_t bits = 8 * octets;
    if (rate.symbol_bits == 0)
        return preamble_ + static_cast<Time>(std::ceil(static_cast<double>(bits) / (rate.bits / 1e6))) *
                               kMicrosecond;  // whole ones, as the header has it
    const auto a_symbol = static_cast<std::size_t>(rate.symbol_bits);
    const std::size_t symbols = (kServiceBits + bits + kTailBits + a_symbol - 1) / a_symbol;
    return preamble_ + static_cast<Time>(symbols) * kSymbol + kSignalExtension;
}

Time Phy::shortest_packet() const {
    constexpr std::size_t kFewest = 20;  // an IP header
    return air_time(kFrameOctets + kFewest, rates_.back());
}

}  // namespace puckloop::wifi
