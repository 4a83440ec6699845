#pragma once
// The scene of programs uploaded by the boot loader: robot "cable" by a cable to UART1, robot "air" by its
// Bluetooth module, from the computer that is linked with it.

#include <filesystem>
#include <optional>
#include <string>

namespace puckloop::tests {

struct UploadImages {
    std::filesystem::path loader;  ///< the boot loader alone
    std::filesystem::path demo;    ///< a demo with the boot loader, which sets up the module
};
/// Nothing, with a warning, where PUCKLOOP_IMAGES does not have them: the test is skipped.
std::optional<UploadImages> upload_images();

struct UploadScene {
    std::string run;              ///< lines of [run]
    std::string cable, computer;  ///< the ends: "pty", "script:FILE"
    std::string air{};            ///< further lines of that robot's board
    std::string by_cable{};       ///< of the other one's
    std::string tables{};         ///< further tables
};
std::string scenario_of(const UploadScene& scene, const UploadImages& images);

}  // namespace puckloop::tests
