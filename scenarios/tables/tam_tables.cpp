#include "scenarios/tables/tam_tables.h"

#include "scenarios/tables/board_keys.h"
#include "scenarios/tables/radio_tables.h"

#include <fmt/format.h>

namespace puckloop::scenarios {

namespace {

/// The name of the project's own firmware, wherever the build has put it.
constexpr std::string_view kOwn = "own";
constexpr double kHighestBattery = 5.0;  // V
constexpr double kSlowestBaud = 300.0, kFastestBaud = 115'200.0;

void read_board(Reader& reader, TamBoard& tam) {
    if (const std::string image = reader.text("firmware", std::string(kOwn)); image != kOwn)
        tam.firmware = reader.folder() / image;
    if (const std::string image = reader.text("boot_loader", ""); !image.empty())
        tam.boot_loader = reader.folder() / image;
    std::error_code ignored;  // what is not there is said when it is loaded
    if (!tam.boot_loader.empty() && std::filesystem::weakly_canonical(tam.boot_loader, ignored) ==
                                        std::filesystem::weakly_canonical(tam.firmware, ignored))
        reader.fail("boot_loader", "boot_loader is the same file as 'firmware'",
                    "the boot loader's image alone, such as \"optiboot_atmega1284p.hex\"");
    tam.resonator_ppm = read_clock_error(reader, "resonator_error");
    tam.adc_noise = read_adc_noise(reader, tam.adc_noise);
    tam.network = static_cast<int>(reader.integer("network", tam.network, 0, 3));
    tam.battery = reader.quantity("battery", Dimension::Voltage, tam.battery);
    if (!(tam.battery >= 0 && tam.battery <= kHighestBattery))
        reader.fail("battery", "battery is out of range", "0 to 5 V, such as \"3.7 V\"");
    tam.console = reader.text("console", "");
    tam.console_baud = reader.quantity("console_baud", Dimension::Number, tam.console_baud);
    if (!(tam.console_baud >= kSlowestBaud && tam.console_baud <= kFastestBaud))
        reader.fail("console_baud", "console_baud is out of range", "300 to 115200");
    tam.start = reader.quantity("start", Dimension::Time, 0.0);
    constexpr double kLongest = 86'400.0 * 30;  // s, as a run
    if (!(tam.start >= 0 && tam.start <= kLongest))
        reader.fail("start", "start is out of range", "0 s to 720 h, such as \"2 s\"");
    tam.resets = read_times(reader, "reset", tam.start);
}

}  // namespace

void read_tam(const std::string& file, const TomlValue& table, Scenario& scenario) {
    const std::string fallback = fmt::format("tam{}", scenario.tams.size());
    Reader reader(file, fallback, table);
    TamBoard tam;
    physics::Booth booth;
    tam.name = booth.name = read_name(reader, fallback, scenario);
    const auto position = reader.quantities("position", Dimension::Length, 2);
    booth.x = position[0];
    booth.y = position[1];
    booth.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    booth.reflectivity = reader.quantity("reflectivity", Dimension::Ratio, booth.reflectivity);
    booth.place = place_of(table);
    read_board(reader, tam);
    tam.xbee = read_tam_module(file, tam.name, reader.table("xbee"), scenario.tams.size(), tam.network);
    reader.finish();
    scenario.tams.push_back(std::move(tam));
    scenario.world.booths.push_back(std::move(booth));
}

}  // namespace puckloop::scenarios
