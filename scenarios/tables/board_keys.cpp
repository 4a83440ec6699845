#include "scenarios/tables/board_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::scenarios {

std::vector<double> read_times(Reader& reader, std::string_view key, double start) {
    constexpr double kLongestRun = 86'400.0 * 30;  // s
    std::vector<double> times;
    for (const std::string& text : reader.texts(key)) {
        try {
            times.push_back(parse_quantity(text, Dimension::Time));
        } catch (const QuantityError& error) {
            reader.fail(key, fmt::format("{}: {}", key, error.problem), error.expected);
        }
        if (times.back() <= (times.size() > 1 ? times[times.size() - 2] : start))
            reader.fail(key, fmt::format("the times of {} do not rise from {:g} s on", key, start),
                        "times later than that, each later than the one before");
        if (times.back() > kLongestRun)
            reader.fail(key, fmt::format("{}: {} is later than any run", key, text), "at most 720 h");
    }
    return times;
}

double read_clock_error(Reader& reader, std::string_view key) {
    const double ppm = reader.quantity(key, Dimension::Ratio, 0.0) * 1e6;
    if (std::abs(ppm) > 10'000)
        reader.fail(key, fmt::format("{} is out of range", key), "-1 % to 1 %, such as \"20 ppm\"");
    return ppm;
}

double read_adc_noise(Reader& reader, double fallback) {
    const double counts = reader.quantity("adc_noise", Dimension::Number, fallback);
    if (counts < 0 || counts > 1000)
        reader.fail("adc_noise", "adc_noise is out of range", "0 to 1000 counts");
    return counts;
}

std::string read_name(Reader& reader, const std::string& fallback, const Scenario& scenario) {
    const std::string name = reader.text("name", fallback);
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    });
    constexpr std::size_t kLongestName = 64;
    if (name.size() > kLongestName) reader.fail("name", "the name is too long", "at most 64 letters");
    if (!plain)
        reader.fail("name", "the name has other signs than letters, digits, _ and -",
                    "a name such as epuck12");
    for (const RobotBoards& other : scenario.robots)
        if (other.name == name) reader.fail("name", fmt::format("another robot is called '{}'", name));
    for (const TamBoard& other : scenario.tams)
        if (other.name == name) reader.fail("name", fmt::format("a TAM is called '{}'", name));
    return name;
}

}  // namespace puckloop::scenarios
