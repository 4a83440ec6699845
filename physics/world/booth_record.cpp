#include "physics/world/booth_record.h"

#include "base/error.h"
#include "base/text/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

namespace puckloop::physics {

namespace {

constexpr std::array<const char*, 3> kColours{"red", "green", "blue"};
constexpr std::size_t kLeds = booth::kLights * kColours.size();
constexpr std::size_t kFirstLed = 4, kFields = kFirstLed + kLeds;

std::string header() {
    std::string text = "t_s,tam,front,back";
    for (const booth::LampPlace& light : booth::kLight)
        for (const char* colour : kColours)
            text += fmt::format(",{}_{}", light.name, colour);
    return text;
}

bool parse(std::string_view line, std::string& name, BoothColour& colour) {
    const auto fields = csv_cells(line, ',');
    if (fields.size() != kFields) return false;
    name = fields[1];
    if (!csv_number(fields[0], colour.seconds)) return false;
    const std::array<double*, 3> brightest{&colour.red, &colour.green, &colour.blue};
    for (std::size_t i = 0; i < kLeds; ++i) {
        double value = 0.0;
        if (!csv_number(fields[kFirstLed + i], value)) return false;
        double& most = *brightest[i % brightest.size()];
        most = std::max(most, value);
    }
    return true;
}

}  // namespace

BoothRecord::BoothRecord(const std::string& path, const WorldModel& world) : file_(path, header()) {
    for (std::size_t i = 0; i < world.booth_count(); ++i) {
        last_.push_back(row_of(world.booth(i)));
        write(world, i);
    }
    file_.flush();
}

BoothRecord::Row BoothRecord::row_of(const BoothModel& booth) {
    Row row{.barriers = booth.barriers};
    std::copy(booth.lights().begin(), booth.lights().end(), row.lights.begin());
    return row;
}

void BoothRecord::write(const WorldModel& world, std::size_t index) {
    std::string text = fmt::format("{:.3f},{}", world.seconds(), world.description().booths[index].name);
    for (const double share : last_[index].barriers)
        text += fmt::format(",{:.3f}", share);
    for (const ColouredLight& light : last_[index].lights)
        text += fmt::format(",{:.4f},{:.4f},{:.4f}", light.red, light.green, light.blue);
    file_.row(text);
}

void BoothRecord::after_step(const WorldModel& world) {
    bool changed = false;
    for (std::size_t i = 0; i < last_.size(); ++i) {
        const Row row = row_of(world.booth(i));
        if (row == last_[i]) continue;
        last_[i] = row;
        write(world, i);
        changed = true;
    }
    if (changed) file_.flush();
}

std::vector<BoothColours> read_booth_colours(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw RunError(fmt::format("cannot read {}", file.string()));
    std::vector<BoothColours> all;
    std::string line, name;
    std::getline(in, line);  // header
    for (int number = 2; std::getline(in, line); ++number) {
        BoothColour colour;
        if (!parse(line, name, colour)) {
            if (in.peek() == std::ifstream::traits_type::eof()) break;
            throw RunError(fmt::format("{}: line {}: not a row of a TAM", file.string(), number));
        }
        auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
        if (found == all.end()) found = all.insert(all.end(), {name, {}});
        found->colours.push_back(colour);
    }
    return all;
}

}  // namespace puckloop::physics
