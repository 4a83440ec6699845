#include "linuxboard/control/record_vote.h"

#include <algorithm>
#include <vector>

namespace puckloop::control {

using protocols::EpuckSensors;

EpuckSensors median_of(std::span<const EpuckSensors> records) {
    EpuckSensors voted = records.back();
    const auto median = [&](auto&& value_of) {
        std::vector<int> values;
        for (const EpuckSensors& record : records)
            values.push_back(value_of(record));
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    };
    for (std::size_t i = 0; i < voted.proximity.size(); ++i) {
        voted.proximity[i] = static_cast<std::int16_t>(
            median([i](const EpuckSensors& record) { return record.proximity[i]; }));
        voted.light[i] =
            static_cast<std::int16_t>(median([i](const EpuckSensors& record) { return record.light[i]; }));
    }
    voted.battery_ok =
        static_cast<std::uint16_t>(median([](const EpuckSensors& record) { return record.battery_ok; }));
    return voted;
}

}  // namespace puckloop::control
