// `puckloop bench --case avr`: this project's ATmega1284P and libsimavr on the same ELFs, in turn.

#include "base/files/shipped_files.h"
#include "benchmark/case_kit.h"
#include "benchmark/speeds/avr_speed.h"

#include <fmt/format.h>

#include <cstdlib>

namespace puckloop::tools {

namespace {

struct Subject {
    std::string name, unit;
    std::filesystem::path image;
    double (*own)(const std::filesystem::path&, double);
    std::optional<double> (*other)(const std::filesystem::path&, double);
};

std::vector<Subject> subjects() {
    std::vector<Subject> list;
    for (const char* name : {"crc", "sort", "matrix"})
        if (const auto image = shipped_file(fmt::format("benchmark/avr/{}.elf", name)); !image.empty())
            list.push_back(
                {fmt::format("avr, {}", name), "MHz", image, &avr_program_speed, &simavr_program_speed});
    std::vector<std::filesystem::path> firmware{shipped_image("tam.elf")};
    if (const char* folder = std::getenv("PUCKLOOP_IMAGES"))
        firmware.push_back(std::filesystem::path(folder) / "tam_firmware.elf");
    for (const auto& image : firmware)
        if (std::filesystem::exists(image))
            list.push_back({fmt::format("avr, {} waiting", image.filename().string()), "x real time", image,
                            &tam_idle_speed, &simavr_idle_speed});
    return list;
}

}  // namespace

void Kit::time_avr() {
    for (const Subject& subject : subjects()) {
        Figure own{subject.name, subject.unit, {}, {}, {}};
        Figure other{subject.name + ", libsimavr", subject.unit, {}, {}, {}};
        Figure ratio{subject.name + ", to libsimavr", "x libsimavr", {}, {}, {}};
        for (int round = 0; round < options_.rounds; ++round) {
            add_reference(own);
            own.values.push_back(subject.own(subject.image, options_.slice_s));
            const auto theirs = subject.other(subject.image, options_.slice_s);
            if (!theirs) continue;
            other.values.push_back(*theirs);
            ratio.values.push_back(own.values.back() / *theirs);
        }
        figures_.push_back(own);
        if (other.values.empty())
            figures_.back().note =
                "this build has no libsimavr to compare with (Debian package libsimavr-dev)";
        else
            figures_.insert(figures_.end(), {other, ratio});
    }
}

}  // namespace puckloop::tools
