#include "benchmark/scenarios/wander_scenario.h"

#include "benchmark/scenarios/scenario_file.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::tools {

std::filesystem::path write_wander_scenario(const std::filesystem::path& folder, int robots,
                                            const std::filesystem::path& main_image) {
    constexpr double kCell = 30.0;  // cm
    constexpr int kTurn = 137;      // degrees from one heading to the next: no two neighbours alike
    constexpr int kStart = 1000, kStartStep = 7;  // ms
    const int side = static_cast<int>(std::ceil(std::sqrt(robots)));
    const double first = -kCell * (side - 1) / 2.0;
    const double size = kCell * (side + 1);
    std::string text =
        fmt::format("[run]\nseed = 1\n[arena]\nsize = [\"{:.2f} cm\", \"{:.2f} cm\"]\n", size, size);
    for (int i = 0; i < robots; ++i)
        text += fmt::format("[[robot]]\nposition = [\"{:.2f} cm\", \"{:.2f} cm\"]\nheading = \"{} deg\"\n"
                            "[robot.pic]\nfirmware = \"{}\"\n[robot.linux]\nprogram = [\"puckloop-control\", "
                            "\"--behaviour\", \"wander\", \"--duration\", \"600\"]\nstart = \"{} ms\"\n",
                            first + kCell * (i % side), first + kCell * (i / side), i * kTurn % 360,
                            std::filesystem::absolute(main_image).string(), kStart + kStartStep * i);
    return write_scenario(folder, fmt::format("wander{}", robots), text);
}

}  // namespace puckloop::tools
