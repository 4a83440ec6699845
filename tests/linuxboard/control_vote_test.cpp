// Medians of sensor records, against sorting.

#include "base/random.h"
#include "linuxboard/control/record_vote.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

using namespace puckloop;
using protocols::EpuckSensors;

TEST_CASE("several sensor records give their medians, and one garbled one of three or more has no weight") {
    RandomStream random(51, "record vote");
    for (int round = 0; round < 200; ++round) {
        std::vector<EpuckSensors> records(1 + random.below(5));
        for (EpuckSensors& record : records) {
            for (std::size_t i = 0; i < record.light.size(); ++i) {
                record.proximity[i] = static_cast<std::int16_t>(static_cast<int>(random.below(4096)) - 2048);
                record.light[i] = static_cast<std::int16_t>(random.below(4096));
            }
            record.battery_ok = static_cast<std::uint16_t>(random.below(2));
            record.ircom_data = static_cast<std::uint8_t>(random.below(256));
        }
        const EpuckSensors voted = control::median_of(records);
        const auto median = [&](auto value_of) {
            std::vector<int> values;
            for (const EpuckSensors& record : records)
                values.push_back(value_of(record));
            std::sort(values.begin(), values.end());
            return values[(values.size() - 1) / 2];
        };
        for (std::size_t i = 0; i < voted.light.size(); ++i) {
            CHECK(voted.proximity[i] == median([i](const auto& record) { return record.proximity[i]; }));
            CHECK(voted.light[i] == median([i](const auto& record) { return record.light[i]; }));
        }
        CHECK(voted.battery_ok == median([](const auto& record) { return record.battery_ok; }));
        CHECK(voted.ircom_data == records.back().ircom_data);
    }
    EpuckSensors sound;
    sound.light.fill(3000);
    EpuckSensors garbled = sound;
    garbled.light.fill(3000 ^ 0x400);
    CHECK(control::median_of(std::vector{sound, garbled, sound}).light == sound.light);
}
