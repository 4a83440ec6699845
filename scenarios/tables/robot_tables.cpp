#include "scenarios/tables/robot_tables.h"

#include "emu/dspic/devices/errata.h"
#include "emu/pic/board_revision.h"
#include "scenarios/tables/bluetooth_tables.h"
#include "scenarios/tables/board_keys.h"
#include "scenarios/tables/camera_keys.h"
#include "scenarios/tables/linux_keys.h"
#include "scenarios/tables/network_tables.h"
#include "scenarios/tables/world_tables.h"
#include "scenarios/values/image_key.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::scenarios {

namespace {

/// The file that keeps a board's memory: nobody else's.
std::filesystem::path read_nvm(Reader& reader, const std::vector<std::filesystem::path>& others) {
    const std::string name = reader.text("nvm", "");
    if (name.empty()) return {};
    std::error_code ignored;
    const std::filesystem::path file = reader.folder() / name;
    for (const std::filesystem::path& other : others)
        if (std::filesystem::weakly_canonical(other, ignored) ==
            std::filesystem::weakly_canonical(file, ignored))
            reader.fail("nvm", fmt::format("'{}' keeps another board's memory already", name),
                        "a file of its own for each board");
    return file;
}

std::string read_revision(Reader& reader) {
    std::string name = reader.text("board", std::string(pic::name_of(pic::Revision::Rev12)));
    if (!pic::revision_of(name))
        reader.fail("board", fmt::format("there is no revision '{}' of the main board", name),
                    "\"1.2\" (analogue accelerometer) or \"1.3\" (LSM330)");
    return name;
}

std::vector<std::string> read_errata(Reader& reader) {
    std::vector<std::string> names = reader.texts("errata");
    for (const std::string& name : names)
        if (!dspic::erratum_of(name))
            reader.fail("errata", fmt::format("there is no erratum '{}'", name),
                        fmt::format("one of {}", fmt::join(dspic::kErratumNames, ", ")));
    return names;
}

PicBoard read_pic(const std::string& file, const std::string& where, const TomlValue& table,
                  const std::vector<std::filesystem::path>& others, std::size_t index) {
    Reader reader(file, where, table);
    PicBoard pic;
    pic.firmware = read_firmware(reader, "pic");
    pic.crystal_ppm = read_clock_error(reader, "crystal_error");
    pic.adc_noise_given = reader.has("adc_noise");
    pic.adc_noise = read_adc_noise(reader, pic.adc_noise);
    pic.selector = static_cast<int>(reader.integer("selector", 0, 0, 15));
    pic.uart1 = reader.text("uart1", "");
    pic.uart2 = reader.text("uart2", "");
    if (const TomlValue* bluetooth = reader.table("bluetooth")) {
        if (!pic.uart1.empty())
            reader.fail("uart1", "the Bluetooth module is on UART1", "either 'uart1' or 'bluetooth'");
        pic.bluetooth = read_bluetooth_module(file, where + ".bluetooth", *bluetooth, index);
    }
    pic.resets = read_times(reader, "reset", 0.0);
    pic.nvm = read_nvm(reader, others);
    constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
    if (const double boot = reader.quantity("boot", Dimension::Time, kNotGiven); !std::isnan(boot)) {
        constexpr double kLongest = 86'400.0 * 30;  // s, as a run
        if (!(boot >= 0 && boot <= kLongest))
            reader.fail("boot", "boot is out of range", "0 s to 720 h, such as \"40 s\"");
        pic.boot = boot;
    }
    pic.camera = read_board_camera(reader);
    pic.camera_turned = reader.flag("camera_turned", false);
    pic.revision = read_revision(reader);
    pic.errata = read_errata(reader);
    if (reader.has("i2c_slave")) pic.i2c_slave = reader.flag("i2c_slave", false);
    reader.finish();
    return pic;
}

RabBoard read_rab(const std::string& file, const std::string& where, const TomlValue& table,
                  const std::vector<std::filesystem::path>& others) {
    Reader reader(file, where, table);
    RabBoard rab;
    rab.firmware = read_firmware(reader, "rab");
    rab.crystal_ppm = read_clock_error(reader, "crystal_error");
    rab.adc_noise = read_adc_noise(reader, rab.adc_noise);
    rab.nvm = read_nvm(reader, others);
    reader.finish();
    return rab;
}

LinuxBoard read_linux(const std::string& file, const std::string& where, const TomlValue& table,
                      const std::string& robot_name) {
    Reader reader(file, where, table);
    LinuxBoard board;
    board.hostname = robot_name;
    read_program(reader, board);
    read_devices(reader, board);
    read_cameras(reader, board);
    board.address = read_network_address(reader);
    board.place_line = table.line;
    reader.finish();
    return board;
}

}  // namespace

void read_robot(const std::string& file, const TomlValue& table, Scenario& scenario) {
    const std::string fallback = fmt::format("robot{}", scenario.robots.size());
    Reader reader(file, fallback, table);
    RobotBoards boards;
    physics::Robot body;
    boards.name = body.name = read_name(reader, fallback, scenario);
    const auto position = reader.quantities("position", Dimension::Length, 2);
    body.x = position[0];
    body.y = position[1];
    body.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    body.place = place_of(table);
    if (const TomlValue* parameters = reader.table("parameters"))
        body.parameters = read_parameters(file, boards.name, *parameters);
    std::vector<std::filesystem::path> memories;
    for (const RobotBoards& other : scenario.robots) {
        if (!other.pic.nvm.empty()) memories.push_back(other.pic.nvm);
        if (other.rab && !other.rab->nvm.empty()) memories.push_back(other.rab->nvm);
    }
    const TomlValue* pic = reader.table("pic");
    if (!pic) reader.fail("pic", "[robot.pic] is missing", "[robot.pic] with firmware = \"image.hex\"");
    boards.pic = read_pic(file, boards.name + ".pic", *pic, memories, scenario.robots.size());
    if (!boards.pic.nvm.empty()) memories.push_back(boards.pic.nvm);
    if (const TomlValue* rab = reader.table("rab"))
        boards.rab = read_rab(file, boards.name + ".rab", *rab, memories);
    if (const TomlValue* linux_table = reader.table("linux"))
        boards.linux_board = read_linux(file, boards.name + ".linux", *linux_table, boards.name);
    if (boards.linux_board && !boards.pic.uart2.empty())
        reader.fail("linux", "the Linux board is on UART2", "either 'uart2' in [robot.pic] or [robot.linux]");
    const bool linux_cameras = boards.linux_board && !boards.linux_board->cameras.empty();
    if (linux_cameras && !boards.pic.camera.empty())
        reader.fail("linux", "the main board and the Linux board both have cameras",
                    "camera in [robot.pic] or cameras in [robot.linux]");
    body.camera = linux_cameras || !boards.pic.camera.empty();
    boards.ground_sensor = reader.flag("ground_sensor", true);
    boards.rgb_turret = reader.flag("rgb_turret", true);
    reader.finish();
    scenario.robots.push_back(std::move(boards));
    scenario.world.robots.push_back(std::move(body));
}

}  // namespace puckloop::scenarios
