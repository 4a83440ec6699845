#include "tests/end_to_end/kit/upload_scene.h"

#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace puckloop::tests {

std::optional<UploadImages> upload_images() {
    const auto loader = outside("PUCKLOOP_IMAGES", "tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex");
    const auto demo = outside("PUCKLOOP_IMAGES", "demoGCtronic-rev117+bootloader.hex");
    if (loader && demo) return UploadImages{*loader, *demo};
    WARN("PUCKLOOP_IMAGES has no boot loader: skipped");
    return std::nullopt;
}

std::string scenario_of(const UploadScene& scene, const UploadImages& images) {
    return fmt::format(R"([run]
{}
[arena]
size = ["2 m", "2 m"]
{}
[[robot]]
name = "cable"
position = ["-40 cm", "0 cm"]
[robot.pic]
firmware = "{}"
uart1 = "{}"
uart2 = "script:/dev/null"
{}
[[robot]]
name = "air"
position = ["40 cm", "0 cm"]
[robot.pic]
firmware = "{}"
uart2 = "script:/dev/null"
{}
[robot.pic.bluetooth]
computer = "{}"
)",
                       scene.run, scene.tables, images.loader.string(), scene.cable, scene.by_cable,
                       images.demo.string(), scene.air, scene.computer);
}

}  // namespace puckloop::tests
