#include "benchmark/scenarios/rab_scenario.h"

#include "benchmark/scenarios/scenario_file.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::tools {

std::filesystem::path write_rab_scenario(const std::filesystem::path& folder, int robots,
                                         const std::filesystem::path& main_image,
                                         const std::filesystem::path& rab_image) {
    constexpr double kCircle = 30.0;  // cm
    std::string text = "[run]\n[arena]\nsize = [\"1 m\", \"1 m\"]\n";
    for (int i = 0; i < robots; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / robots;
        text += fmt::format(
            "[[robot]]\nposition = [\"{:.2f} cm\", \"{:.2f} cm\"]\n[robot.pic]\nfirmware = \"{}\"\n"
            "[robot.rab]\nfirmware = \"{}\"\n[robot.linux]\nprogram = [\"puckloop-control\", "
            "\"--behaviour\", "
            "\"still\", \"--rab\", \"--rab-id\", \"{}\"]\nstart = \"{} ms\"\n",
            kCircle * std::cos(angle), kCircle * std::sin(angle),
            std::filesystem::absolute(main_image).string(), std::filesystem::absolute(rab_image).string(),
            i + 1, 200 + 3 * i);
    }
    return write_scenario(folder, fmt::format("rab{}", robots), text);
}

}  // namespace puckloop::tools
